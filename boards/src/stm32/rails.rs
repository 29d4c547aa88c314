//! Pins at fixed levels: from the first instructions those of the motors and of whatever a floating line would move,
//! sound or switch; also switches of supplies and chips.

use embassy_stm32::Peri;
use embassy_stm32::gpio::{AnyPin, Level, Output, Speed};
use embassy_stm32::pac;
use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::gpio::vals::Moder;

const PORTS: u32 = 0xFF;

/// Holds `pin` at `level` permanently: a dropped pin would float.
pub fn hold(pin: Peri<'static, AnyPin>, level: Level) {
    core::mem::forget(Output::new(pin, level, Speed::Low));
}

/// Makes pins of a port outputs at `level`, whatever drove them: a start's first step, before the clocks run, and for
/// the motors a fault handler's last.
pub fn drive(port: Gpio, pins: &[usize], level: Level) {
    clock_ports();
    for &pin in pins {
        port.bsrr().write(|w| match level {
            Level::Low => w.set_br(pin, true),
            Level::High => w.set_bs(pin, true),
        });
        port.moder().modify(|w| w.set_moder(pin, Moder::OUTPUT));
    }
}

fn clock_ports() {
    let bus = pac::RCC;
    #[cfg(family = "h7")]
    let clocks = bus.ahb4enr();
    #[cfg(not(family = "h7"))]
    let clocks = bus.ahb1enr();
    clocks.modify(|w| w.0 |= PORTS);
    // Two cycles until the clock runs (RM0090 §7.2.14, RM0433 §8.5.10).
    let _ = clocks.read();
}
