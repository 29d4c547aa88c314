//! Pins that hold a level: of the motors and whatever a floating line would move, sound or switch, from the first
//! instructions on; and those that switch supplies or keep other chips quiet.

use embassy_stm32::Peri;
use embassy_stm32::gpio::{AnyPin, Level, Output, Speed};
use embassy_stm32::pac;
use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::gpio::vals::Moder;

/// Ports A to H in the clock controller.
const PORTS: u32 = 0xFF;

/// Holds `pin` at `level` for good: it is leaked, since a pin that is dropped floats again.
pub fn hold(pin: Peri<'static, AnyPin>, level: Level) {
    core::mem::forget(Output::new(pin, level, Speed::Low));
}

/// Makes pins of a port outputs at `level`, whatever drove them: the first act of a start, before the clocks run, and for
/// the motors the last resort of a fault handler.
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

/// Gives every port its clock, which a port that is written to before the start has none of.
fn clock_ports() {
    let bus = pac::RCC;
    #[cfg(family = "h7")]
    let clocks = bus.ahb4enr();
    #[cfg(not(family = "h7"))]
    let clocks = bus.ahb1enr();
    clocks.modify(|w| w.0 |= PORTS);
    // The clock is there two cycles after the write (RM0090 §7.2.14, RM0433 §8.5.10): this read takes them.
    let _ = clocks.read();
}
