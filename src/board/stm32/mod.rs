//! What the STM32 boards share: the ports of `sophie_tasks` over embassy-stm32's drivers, generic over the instance.

#[cfg_attr(feature = "matek-h743", path = "adc_h7.rs")]
#[cfg_attr(not(feature = "matek-h743"), path = "adc_f4.rs")]
mod adc;
mod analog;
mod clock;
mod data_ready;
mod escs;
#[cfg(not(feature = "cuav-v5"))]
mod flash;
#[cfg(feature = "matek-h743")]
mod flash_ecc;
mod i2c_bus;
mod lights;
mod reset;
mod serial;
#[cfg(feature = "cuav-v5")]
mod servo_pairs;
#[cfg(not(feature = "cuav-v5"))]
mod servos;
#[cfg(feature = "cuav-v5")]
mod small_timer;
mod spi;
mod storage;
#[cfg(feature = "cuav-v5")]
mod tone;
mod watchdog;

pub use analog::{AnalogInputs, BatteryScale};
pub use clock::start;
pub use data_ready::{ReadyLine, ReadyStamp};
pub use escs::{EscTimer, pull_low};
#[cfg(not(feature = "cuav-v5"))]
pub use flash::ParamFlash;
pub use i2c_bus::{ArmBus, BusParts, i2c_config};
pub use lights::{Lamp, Lights};
pub use reset::take_reset_cause;
pub use serial::{ConsoleInput, ConsoleOutput, ReceiverLine, TelemetryLine, console_lines, receiver_line};
#[cfg(feature = "cuav-v5")]
pub use servo_pairs::ServoPairs;
#[cfg(not(feature = "cuav-v5"))]
pub use servos::ServoTimer;
#[cfg(feature = "cuav-v5")]
pub use spi::PlainChip;
pub use spi::{DmaChip, Selected, spi_config};
pub use storage::BoardStorage;
#[cfg(feature = "cuav-v5")]
pub use tone::Tone;
pub use watchdog::Dog;

/// A buffer that DMA moves in bursts of up to 16 bytes: a burst must not cross a 1 KiB boundary.
#[repr(C, align(32))]
pub struct Aligned<T>(pub T);
