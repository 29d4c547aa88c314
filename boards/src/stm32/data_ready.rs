//! Data-ready line of the inertial sensor, stamped in its interrupt: a late task does not move the sample's time.
//!
//! The line stays enabled between samples: the HAL's set-up for each wait would add 80 instructions between sample and
//! motor frame.

use core::future::{Future, poll_fn};
use core::pin::pin;
use core::sync::atomic::{AtomicU32, Ordering};
use core::task::{Context, Poll, Waker};

use embassy_stm32::exti::ExtiInput;
use embassy_stm32::interrupt::typelevel::{Handler, Interrupt};
use embassy_stm32::mode::Async;
use embassy_stm32::pac::EXTI;
use embassy_stm32::pac::exti::regs::Lines;
use embassy_sync::waitqueue::AtomicWaker;
use embassy_time::{Duration, Instant};
use sophie_ports::data_ready::DataReady;

/// The lowest 32 bits of the clock at the last interrupt, µs.
static RISEN: AtomicU32 = AtomicU32::new(0);
static EDGES: AtomicU32 = AtomicU32::new(0);
static LINE: AtomicU32 = AtomicU32::new(0);
static WAITING: AtomicWaker = AtomicWaker::new();

/// Stamps and acknowledges the interrupt. Bound before the HAL's handler, which would disable the line.
pub struct ReadyStamp;

impl<I: Interrupt> Handler<I> for ReadyStamp {
    unsafe fn on_interrupt() {
        RISEN.store(Instant::now().as_ticks() as u32, Ordering::Relaxed);
        EXTI.pr(0).write_value(Lines(LINE.load(Ordering::Relaxed)));
        EDGES.fetch_add(1, Ordering::Relaxed);
        WAITING.wake();
    }
}

/// The data-ready line; only one exists.
pub struct ReadyLine {
    /// Kept to own pin and line.
    _input: ExtiInput<'static, Async>,
}

impl ReadyLine {
    /// The line on pin `number` of its port, read by `input`.
    pub fn new(mut input: ExtiInput<'static, Async>, number: u8) -> Self {
        // Leaves edge and port configured, the line disabled.
        let _ = pin!(input.wait_for_rising_edge()).poll(&mut Context::from_waker(Waker::noop()));
        LINE.store(1 << number, Ordering::Relaxed);
        Self { _input: input }
    }

    /// Enables a disabled line: at first, and after an edge between the handlers.
    fn enable() {
        let line = LINE.load(Ordering::Relaxed);
        if EXTI.imr(0).read().0 & line == 0 {
            critical_section::with(|_| EXTI.imr(0).modify(|enabled| enabled.0 |= line));
        }
    }
}

impl DataReady for ReadyLine {
    async fn next(&mut self) -> Instant {
        let seen = EDGES.load(Ordering::Relaxed);
        Self::enable();
        poll_fn(|cx| {
            WAITING.register(cx.waker());
            if EDGES.load(Ordering::Relaxed) == seen {
                Poll::Pending
            } else {
                Poll::Ready(())
            }
        })
        .await;
        let now = Instant::now();
        let age = (now.as_ticks() as u32).wrapping_sub(RISEN.load(Ordering::Relaxed));
        now.checked_sub(Duration::from_ticks(age.into())).unwrap_or(now)
    }
}
