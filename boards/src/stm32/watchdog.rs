//! The independent watchdog.

use embassy_stm32::Peri;
use embassy_stm32::pac::DBGMCU;
#[cfg(not(family = "h7"))]
use embassy_stm32::pac::IWDG;
#[cfg(family = "h7")]
use embassy_stm32::pac::IWDG1 as IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_stm32::wdg::{IndependentWatchdog, Instance};
use embassy_time::Timer;
use sophie_tasks::ports::Watchdog;

/// Time without food after which the board is reset, µs. Its clock has 17 to 47 kHz on the F4 and F7 and 29.7 to 33.6 kHz
/// on the H7 (datasheets, LSI) where 32 are meant: 0.20 to 0.56 s, and 0.29 to 0.32 s. The supervisor is written for the
/// shortest.
const PERIOD_US: u32 = 300_000;
/// The same in the watchdog's own counts: prescaler, and reload value at 32 kHz.
const SHORT: (Pr, u16) = (Pr::DIVIDE_BY4, 2399);
/// While parameters are stored: 22 s at the fastest clock. Two sectors of the H7 take 8 s at the worst (datasheet,
/// 128 KiB), two of the F4 1.6 s (16 KiB).
const LONG: (Pr, u16) = (Pr::DIVIDE_BY256, 0xFFF);

/// Starts the watchdog with what it has after a reset, its longest count at its fastest clock: 0.35 to 0.96 s. For the
/// start itself; [`Dog`]'s first food gives it its period.
///
/// In an image for development a debugger that halts the core halts the watchdog too. In one that flies it does not: a
/// halted core stops the motors' frames, and the watchdog the rest.
pub fn start() {
    #[cfg(feature = "trace")]
    stop_with_core();
    IWDG.kr().write(|w| w.set_key(Key::START));
}

/// The watchdog stands still while a probe has halted the core.
pub fn stop_with_core() {
    #[cfg(family = "h7")]
    DBGMCU.apb4fzr1().modify(|w| w.set_iwdg1(true));
    #[cfg(not(family = "h7"))]
    DBGMCU.apb1fzr().modify(|w| w.set_iwdg(true));
}

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

/// Makes the watchdog wait for some twenty seconds, or for its usual time again, and feeds it.
pub async fn be_patient(patient: bool) {
    let (prescaler, reload) = if patient { LONG } else { SHORT };
    // Whole: the supervisor's feeding would close the registers between the key and the values.
    critical_section::with(|_| {
        IWDG.kr().write(|w| w.set_key(Key::ENABLE));
        IWDG.pr().write(|w| w.set_pr(prescaler));
        IWDG.rlr().write(|w| w.set_rl(reload));
    });
    // The values cross over to the watchdog's own clock: 0.2 ms. They count from the next food on.
    for _ in 0..20 {
        Timer::after_micros(100).await;
        let status = IWDG.sr().read();
        if !status.pvu() && !status.rvu() {
            break;
        }
    }
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
