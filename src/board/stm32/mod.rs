//! What the STM32 boards share: the ports of `sophie_tasks` over embassy-stm32's drivers, generic over the instance.

#[cfg_attr(feature = "matek-h743", path = "adc_h7.rs")]
#[cfg_attr(not(feature = "matek-h743"), path = "adc_f4.rs")]
mod adc;
mod analog;
mod escs;
mod lights;
mod reset;
mod serial;
#[cfg(feature = "cuav-v5")]
mod servo_pairs;
#[cfg(not(feature = "cuav-v5"))]
mod servos;
mod spi;
mod watchdog;

pub use adc::Converter;
pub use analog::{AnalogInputs, AnalogScale};
pub use escs::{EscBurst, EscTimer, Protocol, pull_low};
pub use lights::Lights;
pub use reset::take_reset_cause;
pub use serial::{ReceiverLine, TelemetryLine};
#[cfg(feature = "cuav-v5")]
pub use servo_pairs::ServoPairs;
#[cfg(not(feature = "cuav-v5"))]
pub use servos::ServoTimer;
pub use spi::Selected;
pub use watchdog::Dog;

/// A buffer that DMA moves in bursts of up to 16 bytes: a burst must not cross a 1 KiB boundary.
#[repr(C, align(32))]
pub struct Aligned<T>(pub T);
