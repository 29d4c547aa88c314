//! What a board implements. Every unit is SI unless said otherwise.

use embassy_time::Instant;
use heapless::{String, Vec};
use sophie_control::allocation::wrench::PerArm;
use sophie_control::arming::ArmingInhibit;
pub use sophie_control::chain::ImuReading;
use sophie_control::maths::vector::Vec3;
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_control::navigation::flow_range_sample::GroundView;
use sophie_control::params::Params;
use sophie_mavlink::wire::signing::{Record, Stored};

use crate::links::RcState;
use crate::stack_use::StackUse;
use crate::start::retained_state::Words;

/// Why a port gave nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortError {
    /// The part did not answer in time.
    Timeout,
    /// The part answered with something that fails its own check.
    Corrupt,
    /// The part is not there or was never set up.
    Absent,
    /// Another part answers.
    WrongPart,
}

/// Most samples that an inertial sensor hands over at once.
pub const IMU_BATCH: usize = 8;

/// The vehicle's inertial sensor.
pub trait Imu {
    /// What is handed over at once: no more room than the part's driver fills, since it is copied at each read.
    type Batch: AsRef<[ImuReading]>;

    /// Samples per second: a whole multiple of 1 kHz within 2 %, for which the filters are designed.
    fn rate_hz(&self) -> f32;

    /// Waits for data-ready and reads every sample since the last call, oldest first. The future is dropped when
    /// the part stays silent for [`crate::flight::imu::SILENCE`], and the call made again: it must be safe to drop.
    ///
    /// # Errors
    /// A silent or garbled sensor.
    async fn read(&mut self) -> Result<Self::Batch, PortError>;

    /// When the newest sample that was read was ready in the part: its data-ready, not the end of the transfer. While the
    /// line is silent, when the part was asked for it.
    fn ready_at(&self) -> Instant;

    /// The data-ready line is silent for good, or again and again, and samples are read by the clock. A port without such
    /// a line has none that could be silent.
    fn line_silent(&self) -> bool {
        false
    }
}

/// The four inertial sensors at the arm tips, one BNO055 each.
pub trait ArmImus {
    /// Reads the gravity vector of arm `arm` (0..=3) in that arm's axes, m/s²; the axes are the body's when
    /// the arm is straight. Gravity points down: (0, 0, 9.81) for a level arm.
    ///
    /// # Errors
    /// A silent, absent or uncalibrated sensor; the other three still work.
    async fn gravity(&mut self, arm: usize) -> Result<Vec3, PortError>;
}

/// The board's barometer.
pub trait Barometer {
    /// A board that has none spawns no task for it.
    const FITTED: bool;

    /// Measures once, within [`crate::navigation::barometer::READING`]: waits for it and holds no bus meanwhile.
    ///
    /// # Errors
    /// A silent, absent or garbled part.
    async fn read(&mut self) -> Result<AirPressure, PortError>;
}

/// No barometer.
impl Barometer for () {
    const FITTED: bool = false;

    async fn read(&mut self) -> Result<AirPressure, PortError> {
        Err(PortError::Absent)
    }
}

/// Raw conversions of the analog inputs, 12 bit, right-aligned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AnalogFrame {
    /// Dividers of the four pressure sensors.
    pub fsr: PerArm<u16>,
    /// Pin of the battery voltage.
    pub battery_voltage: u16,
    /// Pin of the current sensor.
    pub battery_current: u16,
    /// Pin of the servo battery's voltage; anything where nothing is connected.
    pub servo_battery: u16,
}

/// The analog inputs.
pub trait Analog {
    /// Voltage at a pin for each count, V. What it means of the battery, the parameters say.
    fn volts_per_count(&self) -> f32;

    /// Converts all inputs once.
    ///
    /// # Errors
    /// A converter that does not finish.
    async fn read(&mut self) -> Result<AnalogFrame, PortError>;
}

/// The four motors.
pub trait Motors {
    /// Sends one command for each output: 0 stops, 0 < c <= 1 is the share of full drive. Returns when the frame began.
    async fn write(&mut self, commands: PerArm<f32>) -> Instant;
}

/// The four tendon servos.
pub trait Servos {
    /// Sets one pulse width for each servo, µs; 0 switches the servo's pulse off. Returns when the first pulses of these
    /// widths begin, mostly in the future: what is written takes effect with the next frame.
    async fn write(&mut self, pulses_us: PerArm<f32>) -> Instant;
}

/// A serial line towards the vehicle: the receiver's or the console's.
pub trait SerialInput {
    /// Waits for bytes and puts them at the start of `buffer`; returns how many, at the latest when the line idles. The
    /// future may be dropped before it is ready, and loses nothing then.
    ///
    /// # Errors
    /// A line error; the next call starts a new frame.
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError>;

    /// What is typed stays between both ends: a cable, and no radio.
    fn private(&self) -> bool {
        true
    }
}

/// The receiver's protocol: frames and counts out of the bytes of its line.
///
/// A read may end anywhere in a frame, and a late one may hold several frames with the pauses between them; but a pause
/// lies at the start of a read or between the whole frames that the read begins with, as [`SerialInput`] gives them. A
/// protocol whose frames are found by pauses (SBUS) cannot place one within a read that begins in mid-frame, as only the
/// read has a time: it publishes nothing then, rather than half of one frame with half of another.
pub trait RcDecoder {
    /// Takes bytes that were there at `at`; gives the state when they held at least one good frame of channels and
    /// the radio is not known to be lost.
    fn take(&mut self, bytes: &[u8], at: Instant) -> Option<RcState>;

    /// The line has failed at `at`: bytes are missing.
    fn broken(&mut self, at: Instant);
}

/// The protocol of a module of optical flow and range: what it sees out of the bytes of its line, however these are cut.
pub trait GroundDecoder {
    /// Takes bytes that were there at `at`; gives the newest flow and range when they held one.
    fn take(&mut self, bytes: &[u8], at: Instant) -> Option<GroundView>;

    /// The line has failed: bytes are missing.
    fn broken(&mut self);
}

/// A serial line from the vehicle: to the receiver, which carries telemetry to the pilot, or to the console.
pub trait SerialOutput {
    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// A line that does not take them.
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError>;

    /// Someone may be there. Where it is known that no one is, nothing needs to be made for the line.
    fn listens(&self) -> bool {
        true
    }
}

/// The independent watchdog.
pub trait Watchdog {
    /// Puts off the reset by the watchdog's period.
    fn feed(&mut self);
}

/// Memory that outlives a reset, though not a loss of power.
pub trait Retain {
    /// Keeps `words` as the second copy or the first. A reset in the midst of it may spoil this copy, never the other.
    fn keep(&mut self, second: bool, words: &Words);
}

/// What reading the stored parameters gave.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Loaded {
    /// Parameters taken over.
    pub taken: u16,
    /// Stored values that were left out: unknown here, or no longer allowed.
    pub refused: u16,
    /// The storage is damaged, or does not answer: what could not be read keeps its default.
    pub unreadable: bool,
    /// Whose data lie there instead of parameters, where that is another firmware; the defaults are in force.
    pub foreign: Option<&'static str>,
    /// MAVLink's key.
    pub signing: Stored,
}

/// Why parameters were not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StorageError {
    /// They do not fit.
    Full,
    /// The memory does not keep what is written to it, or does not answer.
    Broken,
}

/// Where parameters outlive power.
pub trait Storage {
    /// The parameters of this board when nothing is stored.
    fn defaults(&self) -> &'static Params {
        &Params::DEFAULT
    }

    /// Puts what is stored into `params`, which holds the defaults. Blank storage changes nothing and is no fault.
    async fn load(&mut self, params: &mut Params) -> Loaded;

    /// Stores every parameter that differs from its default, and nothing else; whatever was damaged before is gone then.
    /// May stall the processor for a second: only while the motors stand still.
    ///
    /// # Errors
    /// Storage that is full or broken. What was stored before may be lost.
    async fn save(&mut self, params: &Params) -> Result<(), StorageError>;

    /// Stores MAVLink's key, or that there is none, and leaves the stored parameters as they are. May stall the processor
    /// as [`Self::save`] does.
    ///
    /// # Errors
    /// Storage that is full, broken, or not readable: it keeps what it has then.
    async fn save_signing(&mut self, signing: Option<Record>) -> Result<(), StorageError>;
}

/// Longest text of what was read, bytes.
pub const READ: usize = 28;

/// One thing that the start-up looked at in the chip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Look {
    /// What.
    pub name: &'static str,
    /// What was read.
    pub read: String<READ>,
    /// What the firmware is made for.
    pub expected: &'static str,
    /// They go together.
    pub ok: bool,
    /// What this refuses where they do not; `None` where it can be flown with.
    pub inhibits: Option<ArmingInhibit>,
}

/// Most things that a start-up looks at.
pub const LOOKS: usize = 12;
/// What a start-up looked at.
pub type Looks = Vec<Look, LOOKS>;

/// The brown-out level could not be set: the chip keeps what it had.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotSet;

/// The chip itself, as the console sees it.
pub trait Chip {
    /// Restarts, motors stopped first. Does not return on a board.
    fn restart(&mut self);

    /// Restarts into the chip's own loader, motors stopped first. Does not return on a board.
    fn enter_loader(&mut self);

    /// Name of the board that the firmware was built for.
    fn board(&self) -> &'static str;

    /// What tells this image from every other: [`crate::image_id`] of its words.
    fn build(&self) -> u32;

    /// What the start-up looked at.
    fn looks(&self) -> &[Look];

    /// How deep its stack has been; `None` where that is not known.
    fn stack(&self) -> Option<StackUse> {
        None
    }

    /// The supply voltage below which the chip is held in reset, V, once [`Self::set_brown_out`] has been done.
    fn brown_out_volts(&self) -> f32;

    /// Sets the brown-out level for good: it outlives power and every firmware. In force from the next start on. May
    /// stall the processor for a second: only while the motors stand still.
    ///
    /// # Errors
    /// The chip did not take it.
    async fn set_brown_out(&mut self) -> Result<(), NotSet>;
}
