//! Sensors of the vehicle. Units are SI unless noted.

use embassy_time::{Duration, Instant};
use sophie_control::allocation::wrench::PerArm;
use sophie_control::chain::ImuReading;
use sophie_control::maths::vector::Vec3;
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_control::navigation::flow_range_sample::GroundView;

use crate::error::PortError;

/// Largest number of samples in one batch of an inertial sensor.
pub const IMU_BATCH: usize = 8;

/// Limit of one read of the inertial sensor; a longer one is dropped and repeated.
pub const IMU_SILENCE: Duration = Duration::from_millis(3);
/// Limit of one reading of the barometer: most of a period, after which the next one begins.
pub const BAROMETER_READING: Duration = Duration::from_millis(36);

/// The vehicle's inertial sensor.
pub trait Imu {
    /// One batch of samples: no larger than the driver needs, since each read copies it.
    type Batch: AsRef<[ImuReading]>;

    /// Samples per second: a whole multiple of 1 kHz within 2 %, for which the filters are designed.
    fn rate_hz(&self) -> f32;

    /// Waits for data-ready and reads every sample since the last call, oldest first. The future is dropped when
    /// the part stays silent for [`IMU_SILENCE`], and the call made again: it must be safe to drop.
    ///
    /// # Errors
    /// A silent or garbled sensor.
    async fn read(&mut self) -> Result<Self::Batch, PortError>;

    /// Time at which the newest sample was ready in the part: its data-ready edge, not the end of the transfer. While
    /// the line is silent, the time of the request.
    fn ready_at(&self) -> Instant;

    /// The data-ready line is silent for good, or again and again, and the samples are read by the clock. A port
    /// without such a line returns false.
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
    /// False for a board without a barometer, which spawns no task for it.
    const FITTED: bool;

    /// Measures once, within [`BAROMETER_READING`]; holds no bus while it waits.
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
    /// Pin of the servo battery's voltage; arbitrary if not connected.
    pub servo_battery: u16,
}

/// The analog inputs.
pub trait Analog {
    /// Voltage at a pin per count, V. The parameters convert it to the battery's voltage.
    fn volts_per_count(&self) -> f32;

    /// Converts all inputs once.
    ///
    /// # Errors
    /// A converter that does not finish.
    async fn read(&mut self) -> Result<AnalogFrame, PortError>;
}

/// Decoder of an optical-flow and range module: extracts measurements from the bytes of its line, however these are
/// split.
pub trait GroundDecoder {
    /// Takes bytes received at `at`; returns the newest flow and range if the bytes completed one.
    fn take(&mut self, bytes: &[u8], at: Instant) -> Option<GroundView>;

    /// The line failed: bytes are missing.
    fn broken(&mut self);
}
