//! Pins that switch supplies or keep other chips quiet: set once, before any sensor is spoken to.

use embassy_stm32::Peri;
use embassy_stm32::gpio::{AnyPin, Level, Output, Speed};

/// Holds `pin` at `level` for good: it is leaked, since a pin that is dropped floats again.
pub fn hold(pin: Peri<'static, AnyPin>, level: Level) {
    core::mem::forget(Output::new(pin, level, Speed::Low));
}
