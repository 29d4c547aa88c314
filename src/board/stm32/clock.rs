//! Starts the chip's clocks and the clock of embassy-time on top of them.

use embassy_stm32::pac::timer::{TimGp32, regs::SrGp16};
use embassy_stm32::{Config, Peripherals};

/// Starts the clocks as `config` says. `timer` is the one that embassy-time counts with. Called once.
pub fn start(config: Config, timer: TimGp32) -> Peripherals {
    critical_section::with(|_| {
        let peripherals = embassy_stm32::init(config);
        // embassy-stm32 loads the timer by an update event while counter and compare values are all zero, at which the
        // compare flags rise. Its interrupt would count half a turn of 65.5 ms that never was; from then on, an instant
        // asked for between each half turn and its interrupt would lie 65.5 ms before the one asked for just before.
        timer.sr().write_value(SrGp16(0));
        peripherals
    })
}
