//! The board that is built for, and what it hands to the tasks.

// One line a board. Exactly one holds: the build script has seen to it.
#[cfg_attr(feature = "matek-h743", path = "matek_h743.rs")]
#[cfg_attr(feature = "cuav-v5", path = "cuav_v5.rs")]
#[cfg_attr(feature = "f405", path = "f405.rs")]
mod chosen;

#[cfg(not(family = "f4"))]
pub(crate) use chosen::DATA_CACHE;
pub use chosen::{
    AnalogPort, ArmsPort, ImuPort, LightsPort, MotorsPort, NAME, ServosPort, StoragePort, WIRING,
    WatchdogPort, start_levels, stop_motors, take,
};
use sophie_control::params::Params;
use sophie_tasks::ports::Loaded;

use crate::stm32::{ConsoleInput, ConsoleOutput, ReceiverLine, TelemetryLine, ThisChip};

/// What a board hands to the tasks.
pub struct Board {
    /// The vehicle's inertial sensor.
    pub imu: ImuPort,
    /// The arms' inertial sensors.
    pub arms: ArmsPort,
    /// Pressure sensors and battery.
    pub analog: AnalogPort,
    /// The motors.
    pub motors: MotorsPort,
    /// The tendon servos.
    pub servos: ServosPort,
    /// From the receiver.
    pub receiver: ReceiverLine,
    /// To the receiver.
    pub telemetry: TelemetryLine,
    /// From the console.
    pub console_input: ConsoleInput,
    /// To the console.
    pub console_output: ConsoleOutput,
    /// The watchdog, running.
    pub watchdog: WatchdogPort,
    /// Lights and buzzer.
    pub lights: LightsPort,
    /// Where parameters are stored.
    pub storage: StoragePort,
    /// The parameters as which the ports were built: what was stored, or the defaults.
    pub params: Params,
    /// What reading them gave.
    pub loaded: Loaded,
    /// The chip itself.
    pub chip: ThisChip,
}
