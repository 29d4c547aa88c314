//! The inertial sensor's data-ready line, stamped in its interrupt: a task that runs late does not move the sample.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_stm32::exti::ExtiInput;
use embassy_stm32::interrupt::typelevel::{Handler, Interrupt};
use embassy_stm32::mode::Async;
use embassy_time::{Duration, Instant};
use sophie_drivers::data_ready::DataReady;

/// The lowest 32 bits of the clock at the last interrupt, µs.
static RISEN: AtomicU32 = AtomicU32::new(0);

/// Stamps the interrupt. To be bound before the driver's own handler.
pub struct ReadyStamp;

impl<I: Interrupt> Handler<I> for ReadyStamp {
    unsafe fn on_interrupt() {
        RISEN.store(Instant::now().as_ticks() as u32, Ordering::Relaxed);
    }
}

/// The line.
pub struct ReadyLine(pub ExtiInput<'static, Async>);

impl DataReady for ReadyLine {
    async fn next(&mut self) -> Instant {
        self.0.wait_for_rising_edge().await;
        let now = Instant::now();
        let age = (now.as_ticks() as u32).wrapping_sub(RISEN.load(Ordering::Relaxed));
        now.checked_sub(Duration::from_ticks(age.into())).unwrap_or(now)
    }
}
