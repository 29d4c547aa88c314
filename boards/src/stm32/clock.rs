//! From the reset to running clocks: outputs and watchdog first, so that nothing spins and nothing hangs while the
//! chip waits for its crystal and its PLLs.

use core::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use embassy_stm32::pac::RCC;
use embassy_stm32::pac::timer::{TimGp32, regs::SrGp16};
use embassy_stm32::{Config, Peripherals, rcc};

use super::watchdog;
use crate::cortex_m::retained;

/// Message of the next start after one that hung in starting its clocks.
const STUCK: &str = "the clocks did not start: a PLL does not lock, or the core's supply does not settle";

/// The clock of embassy-time counts: before it does, its registers must not be read.
static COUNTING: AtomicBool = AtomicBool::new(false);

/// Clock of the bus that the flash is on, Hz; 0 before the clocks run.
static BUS: AtomicU32 = AtomicU32::new(0);

/// Clock of the bus that the flash is on, Hz.
pub fn bus_hz() -> u32 {
    BUS.load(Ordering::Relaxed)
}

/// Time since the clocks run, µs; 0 before.
pub fn micros() -> u64 {
    if COUNTING.load(Ordering::Relaxed) {
        embassy_time::Instant::now().as_micros()
    } else {
        0
    }
}

/// Gives the outputs their first levels and starts the watchdog, then the clocks as `config` says. `timer` is the one that
/// embassy-time counts with. A crystal that never starts and a PLL that never locks end by the watchdog, and the next start
/// says which. Called once.
pub fn start(config: Config, timer: TimGp32, first_levels: fn()) -> Peripherals {
    first_levels();
    watchdog::start();
    if let Some(crystal) = config.rcc.hse {
        start_crystal(crystal.freq.0 / 1_000_000);
    }
    retained::leave(format_args!("{STUCK}"));
    let peripherals = critical_section::with(|_| {
        let peripherals = embassy_stm32::init(config);
        // embassy-stm32 loads the timer by an update event while counter and compare values are all zero, at which the
        // compare flags rise. Its interrupt would count half a turn of 65.5 ms that never was; from then on, an instant
        // asked for between each half turn and its interrupt would lie 65.5 ms before the one asked for just before.
        timer.sr().write_value(SrGp16(0));
        peripherals
    });
    let bus = rcc::clocks(&peripherals.RCC).hclk1.to_hertz();
    BUS.store(bus.map_or(0, |hz| hz.0), Ordering::Relaxed);
    COUNTING.store(true, Ordering::Relaxed);
    retained::forget();
    peripherals
}

/// Starts the crystal of `mhz` MHz, before embassy-stm32 does it without a word. The watchdog bounds the wait.
fn start_crystal(mhz: u32) {
    retained::leave(format_args!("the {mhz} MHz crystal does not start"));
    RCC.cr().modify(|w| w.set_hseon(true));
    while !RCC.cr().read().hserdy() {}
}
