//! The boards. Everything that is specific to a chip, and every line of unsafe code, is in here.
//!
//! A board is one file: clocks, pins, DMA streams and timers, claimed with `assign_resources`, and [`Board`]'s ports
//! built from them. [`stm32`] has what several boards share, [`cortex_m`] what all do: both go by the chip's family and
//! never by the board. The memory maps are in `memory/`. Nothing outside names a chip.

#![allow(
    unsafe_code,
    reason = "registers, vectors and linker symbols; each use has its reason beside it"
)]

pub mod cortex_m;
pub mod stm32;

// One line a board. Exactly one holds: the build script has seen to it (selection.rs).
#[cfg_attr(feature = "matek-h743", path = "matek_h743.rs")]
#[cfg_attr(feature = "cuav-v5", path = "cuav_v5.rs")]
#[cfg_attr(feature = "f405", path = "f405.rs")]
mod chosen;

pub use chosen::{
    AnalogPort, ArmsPort, ImuPort, LightsPort, MotorsPort, NAME, ServosPort, StoragePort, WatchdogPort,
    start_levels, stop_motors, take,
};
pub use cortex_m::Restarter;
pub use cortex_m::retained::ResetCause;
use sophie_control::params::Params;
use sophie_tasks::ports::{Loaded, Storage};
pub use stm32::{ConsoleInput, ConsoleOutput, ReceiverLine, TelemetryLine, take_reset_cause};

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
}

/// The defaults with what is stored in their place. The first thing that a board does: the ports are built by it, and
/// the motors' pins are held low until then.
async fn load(storage: &mut impl Storage) -> (Params, Loaded) {
    let mut params = *storage.defaults();
    let loaded = storage.load(&mut params).await;
    (params, loaded)
}
