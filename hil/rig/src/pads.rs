//! Pads as the builder's hand meets them: plain pins, beside and below the drivers that own them.
//!
//! Jumpers run between pads that fly anyway, so that every board has them. What listens is a servo's pad, taken from its
//! timer for as long as the test runs.

use embassy_stm32::pac;
use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::gpio::vals::{Moder, Pupdr};

use crate::cycles;

/// A pad and its pin.
#[derive(Clone, Copy)]
pub struct Pad {
    /// What is printed on the board or its connector, with the pin.
    pub name: &'static str,
    port: Gpio,
    pin: usize,
}

/// What a board's tests have to know of it besides its drivers.
pub struct Wiring {
    /// Clock of the core, Hz.
    pub core_hz: u32,
    /// Motor 1, and the pad it is joined to.
    pub motor: [Pad; 2],
    /// Servo 1, and the pad it is joined to.
    pub servo: [Pad; 2],
    /// The receiver's line: out, and the input it is joined to.
    pub receiver: [Pad; 2],
    /// The pressure sensor's input that gets half the supply, and its number, 0 to 3.
    pub divider: (Pad, usize),
}

const fn pad(name: &'static str, port: Gpio, pin: usize) -> Pad {
    Pad { name, port, pin }
}

/// The wiring of the board that was built.
#[cfg(feature = "matek-h743")]
pub const WIRING: Wiring = Wiring {
    core_hz: 400_000_000,
    motor: [pad("S7 (PD12)", pac::GPIOD, 12), pad("S5 (PA2)", pac::GPIOA, 2)],
    servo: [pad("S3 (PA0)", pac::GPIOA, 0), pad("S6 (PA3)", pac::GPIOA, 3)],
    receiver: [pad("TX6 (PC6)", pac::GPIOC, 6), pad("RX6 (PC7)", pac::GPIOC, 7)],
    divider: (pad("RSSI (PC5)", pac::GPIOC, 5), 2),
};

/// The wiring of the board that was built.
#[cfg(feature = "cuav-v5")]
pub const WIRING: Wiring = Wiring {
    core_hz: 216_000_000,
    motor: [
        pad("AUX 4 (PE9)", pac::GPIOE, 9),
        pad("AUX 7 (PH6)", pac::GPIOH, 6),
    ],
    servo: [
        pad("AUX 5 (PD13)", pac::GPIOD, 13),
        pad("AUX 8 (PH9)", pac::GPIOH, 9),
    ],
    receiver: [
        pad("TELEM2 TX (PD8)", pac::GPIOD, 8),
        pad("TELEM2 RX (PD9)", pac::GPIOD, 9),
    ],
    divider: (pad("RSSI (PB0)", pac::GPIOB, 0), 2),
};

/// The wiring of the board that was built.
#[cfg(feature = "f405")]
pub const WIRING: Wiring = Wiring {
    core_hz: 168_000_000,
    motor: [pad("PC6", pac::GPIOC, 6), pad("PB14", pac::GPIOB, 14)],
    servo: [pad("PB6", pac::GPIOB, 6), pad("PB15", pac::GPIOB, 15)],
    receiver: [pad("PA9", pac::GPIOA, 9), pad("PA10", pac::GPIOA, 10)],
    divider: (pad("PC1", pac::GPIOC, 1), 1),
};

/// How a pad was before it was taken; given back when dropped.
pub struct Taken {
    pad: Pad,
    mode: Moder,
    pull: Pupdr,
}

impl Pad {
    /// Takes the pad from whatever drives it; it floats.
    pub fn take(self) -> Taken {
        let taken = Taken {
            pad: self,
            mode: self.port.moder().read().moder(self.pin),
            pull: self.port.pupdr().read().pupdr(self.pin),
        };
        taken.listen(Pupdr::FLOATING);
        taken
    }

    /// A peripheral drives or reads the pad: what the board's own file says of it is true.
    pub fn serves_a_peripheral(self) -> bool {
        self.port.moder().read().moder(self.pin) == Moder::ALTERNATE
    }

    /// Level at the pad.
    pub fn is_high(self) -> bool {
        self.port.idr().read().idr(self.pin).to_bits() != 0
    }
}

impl Taken {
    /// Makes the pad an input with a pull.
    pub fn listen(&self, pull: Pupdr) {
        let Pad { port, pin, .. } = self.pad;
        port.moder().modify(|w| w.set_moder(pin, Moder::INPUT));
        port.pupdr().modify(|w| w.set_pupdr(pin, pull));
    }

    /// Drives the pad.
    pub fn drive(&self, high: bool) {
        let Pad { port, pin, .. } = self.pad;
        port.bsrr().write(|w| {
            if high {
                w.set_bs(pin, true);
            } else {
                w.set_br(pin, true);
            }
        });
        port.moder().modify(|w| w.set_moder(pin, Moder::OUTPUT));
    }
}

impl Drop for Taken {
    fn drop(&mut self) {
        let Pad { port, pin, .. } = self.pad;
        port.pupdr().modify(|w| w.set_pupdr(pin, self.pull));
        port.moder().modify(|w| w.set_moder(pin, self.mode));
    }
}

/// The first pad reaches the second one: that follows it, against its own pull, both ways.
pub fn joined([from, to]: [Pad; 2]) -> bool {
    let (driver, listener) = (from.take(), to.take());
    let follows = |high| {
        listener.listen(if high { Pupdr::PULL_DOWN } else { Pupdr::PULL_UP });
        driver.drive(high);
        // A pull of 40 kOhm on a lead takes some microseconds.
        settle(50);
        to.is_high() == high
    };
    follows(true) && follows(false)
}

/// Waits for `us` µs without yielding.
pub fn settle(us: u32) {
    let start = cycles::now();
    while cycles::now().wrapping_sub(start) < us * (WIRING.core_hz / 1_000_000) {}
}
