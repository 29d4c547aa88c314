//! The independent watchdog.

use embassy_stm32::Peri;
use embassy_stm32::pac::DBGMCU;
#[cfg(not(family = "h7"))]
use embassy_stm32::pac::IWDG;
#[cfg(family = "h7")]
use embassy_stm32::pac::IWDG1 as IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
#[cfg(not(family = "h7"))]
use embassy_stm32::peripherals::IWDG as DogPeripheral;
#[cfg(family = "h7")]
use embassy_stm32::peripherals::IWDG1 as DogPeripheral;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_time::Timer;
use sophie_ports::chip::Watchdog;

/// Watchdog time-out, µs, at its nominal clock of 32 kHz. Actual: 17 to 47 kHz on F4 and F7, 29.7 to 33.6 kHz on the H7
/// (datasheets, LSI), so 0.20 to 0.56 s and 0.29 to 0.32 s. The supervisor is designed for the shortest.
const PERIOD_US: u32 = 300_000;
/// In counts: prescaler and reload value.
const SHORT: (Pr, u16) = (Pr::DIVIDE_BY4, 2399);
/// While parameters are stored: 22 s at the fastest clock. Two sectors take up to 8 s on the H7 (datasheet, 128 KiB),
/// 1.6 s on the F4 (16 KiB).
const LONG: (Pr, u16) = (Pr::DIVIDE_BY256, 0xFFF);

/// Starts the watchdog with its reset values (longest count, smallest prescaler): 0.35 to 0.96 s, until [`WatchdogPort`]'s first
/// feed sets the period.
///
/// A debugger that halts the core also halts the watchdog in a development image only. In a flight image a halted core
/// stops the motors' frames, and the watchdog resets the chip.
pub fn start() {
    #[cfg(feature = "trace")]
    stop_with_core();
    IWDG.kr().write(|w| w.set_key(Key::START));
}

/// Stops the watchdog while a probe halts the core.
pub fn stop_with_core() {
    #[cfg(family = "h7")]
    DBGMCU.apb4fzr1().modify(|w| w.set_iwdg1(true));
    #[cfg(not(family = "h7"))]
    DBGMCU.apb1fzr().modify(|w| w.set_iwdg(true));
}

/// The running watchdog.
pub struct WatchdogPort(IndependentWatchdog<'static, DogPeripheral>);

impl WatchdogPort {
    /// Starts the watchdog for good.
    pub fn start(instance: Peri<'static, DogPeripheral>) -> Self {
        let mut dog = IndependentWatchdog::new(instance, PERIOD_US);
        dog.unleash();
        Self(dog)
    }
}

impl Watchdog for WatchdogPort {
    fn feed(&mut self) {
        self.0.pet();
    }
}

/// Sets the time-out to at least 22 s, or back to normal, and feeds.
pub async fn be_patient(patient: bool) {
    let (prescaler, reload) = if patient { LONG } else { SHORT };
    // Atomic: the supervisor's feed would lock the registers.
    critical_section::with(|_| {
        IWDG.kr().write(|w| w.set_key(Key::ENABLE));
        IWDG.pr().write(|w| w.set_pr(prescaler));
        IWDG.rlr().write(|w| w.set_rl(reload));
    });
    // In 0.2 ms the values reach the watchdog's clock, for the next feed.
    for _ in 0..20 {
        Timer::after_micros(100).await;
        let status = IWDG.sr().read();
        if !status.pvu() && !status.rvu() {
            break;
        }
    }
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
