//! What crosses between the emulated board and the world: plain data, whatever emulates the board.

use std::collections::BTreeMap;

use sophie_control::wrench::PerArm;

use crate::chain::Counted;
use crate::esc::EscStats;

/// What the world puts on the board's wires for the next millisecond.
#[derive(Clone, Debug, Default)]
pub struct Wires {
    /// Samples of the inertial sensor, evenly over the millisecond: body rate (rad/s), specific force (m/s²), both in
    /// body axes.
    pub imu: Vec<([f64; 3], [f64; 3])>,
    /// Gravity at each arm's sensor, m/s², in the arm's axes: forward, right, down.
    pub arms: PerArm<[f64; 3]>,
    /// Volts at the pads of pressure 1 to 4, the battery's voltage (V) and its current (A).
    pub analog: [f64; 6],
    /// Words from the radio's receiver, the parity on top where its line has one.
    pub receiver: Vec<u16>,
    /// Bytes that are typed at the console.
    pub console: Vec<u8>,
    /// What breaks or is mended now.
    pub faults: Vec<BoardFault>,
}

/// Something done to the board, from now on unless it says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardFault {
    /// The inertial sensor is unplugged (true) or plugged in again.
    ImuUnplugged(bool),
    /// The data-ready line of the inertial sensor is cut (true) or joined again; its bus is sound.
    DataReadyCut(bool),
    /// Bits flipped in the next word that the inertial sensor answers.
    ImuWord(u8),
    /// The pad that this pressure sensor, 0 to 3, hangs on has a divider of one to so many before its pin.
    PadDivider(usize, u32),
    /// The sensor of this arm, 0 to 3, is unplugged (true) or plugged in again.
    ArmUnplugged(usize, bool),
    /// The chips on this bus of the arms, 0 or 1, hold the clock low for so many µs after each byte; 0 is none.
    ClockHeld(usize, u32),
    /// The processor's supply breaks down (false), or is back.
    Supply(bool),
    /// The task of this name in `src/firmware/tasks.rs` is never run again: it hangs in what it awaits.
    TaskHung(&'static str),
    /// The task of this name calls itself without end as soon as it runs.
    StackOverflow(&'static str),
    /// The task of this name faults, as soon as it runs, at the priority of the hard fault's handler: the processor locks
    /// up (ARMv7-M B1.5.15), as by a fault within that handler.
    LockUp(&'static str),
    /// The flash that is kept for parameters is overwritten, as a program of another maker would.
    CorruptParameters,
    /// The flash that is kept for parameters begins as ArduPilot leaves it.
    ForeignParameters,
    /// The option bytes are those of a new chip: no brown-out level. To be done before the first instruction.
    FactoryOptions,
    /// The processor is one of the first revision.
    FirstRevision,
    /// The crystal does not start. To be done before the first instruction.
    NoCrystal,
    /// The core's PLL never locks. To be done before the first instruction.
    NoPll,
    /// The processor stands still (true) or runs again: only the watchdog is left.
    Hang(bool),
    /// The reset pin is pulled, once.
    ResetPin,
}

/// What the board did in the millisecond past.
#[derive(Clone, Debug, Default)]
pub struct Pins {
    /// Time since power-on, ms.
    pub ms: u64,
    /// Command of each motor as its controller decodes it, 0..1.
    pub motors: PerArm<f64>,
    /// Pulse of each servo, µs; 0 is none.
    pub servos: PerArm<f64>,
    /// Bytes to the radio's receiver.
    pub telemetry: Vec<u8>,
    /// Bytes that the console says.
    pub console: Vec<u8>,
    /// Bytes of the log, as they lie in the buffer that a probe reads.
    pub log: Vec<u8>,
    /// State light, fault light and buzzer: level of the pin.
    pub signals: [bool; 3],
    /// Restarts of the processor: when (ns since power-on) and why.
    pub resets: Vec<(u64, String)>,
}

/// What a run leaves behind.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// What the emulator could not do, or reported as done wrongly.
    pub gaps: Vec<Gap>,
    /// Instructions executed.
    pub instructions: u64,
    /// What each motor's controller heard.
    pub escs: PerArm<EscStats>,
    /// From data-ready to the first edge of the motor frame: count, mean and largest, µs.
    pub latency_us: Latency,
    /// What the motors' pins did when the processor stood still last.
    pub hung: Option<Hung>,
    /// Erases of each flash sector, by its first address.
    pub erases: BTreeMap<u64, u32>,
    /// What resets did to the outputs.
    pub outputs: Vec<Output>,
    /// Pulse of each servo at the end, µs; 0 is none.
    pub servos: PerArm<f64>,
    /// Digest of every edge at the motors' pins, every servo pulse and every telemetry byte.
    pub pins_digest: u64,
    /// Steps whose instructions were counted.
    pub counted: Counted,
}

/// An output of the board around its resets.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// What hangs on it.
    pub what: String,
    /// The processor's pin.
    pub pin: String,
    /// The processor itself pulls it up until the firmware drives it.
    pub pulled_up: bool,
    /// From each start of the processor until the firmware drives it, µs; `None` if it never did.
    pub after_us: Vec<Option<f64>>,
}

impl Output {
    /// The output at the first start.
    pub fn new(what: String, pin: impl std::fmt::Display) -> Self {
        Self {
            what,
            pin: pin.to_string(),
            pulled_up: false,
            after_us: vec![None],
        }
    }
}

/// The motors' pins while the processor stands still.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hung {
    /// From its stop to the last rising edge at any of them, µs; 0 without one.
    pub last_rise_us: f64,
    /// The pins that are high at the end.
    pub high: PerArm<bool>,
}

/// Statistics of a latency.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Latency {
    /// How many were measured.
    pub count: u64,
    /// Their sum, µs.
    pub sum: f64,
    /// The largest, µs.
    pub worst: f64,
}

impl Latency {
    /// Adds one, µs.
    pub fn add(&mut self, us: f64) {
        self.count += 1;
        self.sum += us;
        self.worst = self.worst.max(us);
    }

    /// Mean, µs.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.sum / self.count.max(1) as f64
    }
}

/// Something that the emulator cannot vouch for.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Gap {
    /// `unmapped`, `refused`, `unimplemented`, `undefined`, `unrouted`, `told` or `miswired`.
    pub kind: &'static str,
    /// Where: instance and register, an address, or a pin.
    pub at: String,
    /// What happened there.
    pub what: String,
}

/// FNV-1a.
#[derive(Clone, Copy, Debug)]
pub struct Digest(pub u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Adds a word.
    pub fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.byte(byte);
        }
    }

    /// Adds a byte.
    pub fn byte(&mut self, byte: u8) {
        self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }
}
