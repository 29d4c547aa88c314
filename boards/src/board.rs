//! The selected board, and its ports for the tasks.

// One line per board; the build script ensures that exactly one applies.
#[cfg_attr(feature = "matek-h743", path = "matek_h743.rs")]
#[cfg_attr(feature = "cuav-v5", path = "cuav_v5.rs")]
#[cfg_attr(feature = "f405", path = "f405.rs")]
mod chosen;

#[cfg(not(family = "f4"))]
pub(crate) use chosen::DATA_CACHE;
pub(crate) use chosen::FIRST_LEVELS;
pub use chosen::{
    AnalogPort, ArmsPort, BarometerPort, ImuPort, LightsPort, MotorsPort, NAME, ServosPort, StoragePort,
    WIRING, start_levels, take,
};
use sophie_control::params::Params;
use sophie_ports::storage::Loaded;

use crate::stm32::{
    BufferedInput, BufferedOutput, GroundLine, ReceiverLine, TelemetryLine, ThisChip, UsbPort, WatchdogPort,
    drive,
};

/// The motors' pins low, whatever drives them: the last resort of a fault handler.
pub fn stop_motors() {
    drive(&chosen::MOTORS_LOW);
}

/// A board's ports for the tasks.
pub struct Board {
    /// The vehicle's inertial sensor.
    pub imu: ImuPort,
    /// The arms' inertial sensors.
    pub arms: ArmsPort,
    /// The barometer, or none.
    pub barometer: BarometerPort,
    /// Pressure sensors and battery.
    pub analog: AnalogPort,
    /// The motors.
    pub motors: MotorsPort,
    /// The tendon servos.
    pub servos: ServosPort,
    /// Receiver input.
    pub receiver: ReceiverLine,
    /// Receiver output.
    pub telemetry: TelemetryLine,
    /// Console input.
    pub console_input: BufferedInput,
    /// Console output.
    pub console_output: BufferedOutput,
    /// MAVLink input.
    pub mavlink_input: BufferedInput,
    /// MAVLink output.
    pub mavlink_output: BufferedOutput,
    /// Module of optical flow and range.
    pub ground: GroundLine,
    /// USB, for console and MAVLink.
    pub usb: UsbPort,
    /// The running watchdog.
    pub watchdog: WatchdogPort,
    /// Lights and buzzer.
    pub lights: LightsPort,
    /// Parameter storage.
    pub storage: StoragePort,
    /// Parameters of the ports: stored ones, or the defaults.
    pub params: Params,
    /// Result of reading them.
    pub loaded: Loaded,
    /// The chip.
    pub chip: ThisChip,
}
