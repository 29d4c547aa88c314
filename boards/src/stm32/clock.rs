//! From reset to running clocks and caches. Outputs and watchdog come first: nothing may spin or hang while crystal and PLLs
//! start.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_stm32::pac::RCC;
use embassy_stm32::pac::timer::{TimGp32, regs::SrGp16};
use embassy_stm32::{Config, Peripherals, rcc};

use super::watchdog;
use crate::cortex_m::retained;

const STUCK: &str = "the clocks did not start: a PLL does not lock, or the core's supply does not settle";

/// Set once embassy-time's clock runs: it must not be read before.
static COUNTING: AtomicBool = AtomicBool::new(false);

static BUS: AtomicU32 = AtomicU32::new(0);

/// Clock of the flash's bus, Hz.
pub fn bus_hz() -> u32 {
    BUS.load(Ordering::Relaxed)
}

/// Time since the clocks started, µs; 0 before.
pub fn micros() -> u64 {
    if COUNTING.load(Ordering::Relaxed) {
        embassy_time::Instant::now().as_micros()
    } else {
        0
    }
}

/// Starts the watchdog, then the clocks of `config`, then the caches; `timer` is embassy-time's. If the crystal or a PLL fails, the
/// watchdog resets, and the next start reports which. Called once.
pub fn start(config: Config, timer: TimGp32) -> Peripherals {
    watchdog::start();
    if let Some(crystal) = config.rcc.hse {
        start_crystal(crystal.freq.0 / 1_000_000);
    }
    retained::leave(format_args!("{STUCK}"));
    let peripherals = critical_section::with(|_| {
        let peripherals = embassy_stm32::init(config);
        // embassy-stm32 loads the timer by an update event while counter and compare values are zero, which raises the
        // compare flags. Their interrupt would count a half turn of 65.5 ms too many; from then on, between each half
        // turn and its interrupt, the time would be 65.5 ms early.
        timer.sr().write_value(SrGp16(0));
        peripherals
    });
    let bus = rcc::clocks(&peripherals.RCC).hclk1.to_hertz();
    BUS.store(bus.map_or(0, |hz| hz.0), Ordering::Relaxed);
    COUNTING.store(true, Ordering::Relaxed);
    retained::forget();
    #[cfg(family = "f4")]
    super::accelerator::enable();
    #[cfg(not(family = "f4"))]
    crate::cortex_m::enable_caches(crate::DATA_CACHE);
    peripherals
}

/// Starts the crystal before embassy-stm32, which would not report a failure. The watchdog bounds the wait.
fn start_crystal(mhz: u32) {
    retained::leave(format_args!("the {mhz} MHz crystal does not start"));
    RCC.cr().modify(|w| w.set_hseon(true));
    while !RCC.cr().read().hserdy() {}
}
