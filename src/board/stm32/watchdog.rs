//! The independent watchdog.

use embassy_stm32::Peri;
use embassy_stm32::wdg::{IndependentWatchdog, Instance};
use sophie_tasks::ports::Watchdog;

/// Time without food after which the board is reset, µs. Its clock is only good to about -15 and +45 % (datasheets,
/// LSI): 0.2 to 0.35 s, within the 0.2 to 0.5 s that the supervisor is written for.
const PERIOD_US: u32 = 300_000;

/// The watchdog, running.
pub struct Dog<T: Instance + 'static>(IndependentWatchdog<'static, T>);

impl<T: Instance + 'static> Dog<T> {
    /// Starts the watchdog; nothing can stop it again.
    pub fn start(instance: Peri<'static, T>) -> Self {
        let mut dog = IndependentWatchdog::new(instance, PERIOD_US);
        dog.unleash();
        Self(dog)
    }
}

impl<T: Instance + 'static> Watchdog for Dog<T> {
    fn feed(&mut self) {
        self.0.pet();
    }
}
