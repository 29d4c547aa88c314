//! Pads as plain pins, for tests on a board that join some of them by jumpers.

use embassy_stm32::pac::gpio::Gpio;
use embassy_stm32::pac::gpio::vals::Moder;
pub use embassy_stm32::pac::gpio::vals::Pupdr;

/// A pad and its pin.
#[derive(Clone, Copy)]
pub struct Pad {
    /// Label on board or connector, with the pin.
    pub name: &'static str,
    port: Gpio,
    pin: usize,
}

/// Needs of a board's tests besides its drivers.
pub struct Wiring {
    /// Core clock, Hz.
    pub core_hz: u32,
    /// Motor 1, and the pad joined to it.
    pub motor: [Pad; 2],
    /// Servo 1, and the pad joined to it.
    pub servo: [Pad; 2],
    /// Receiver output, and the input joined to it.
    pub receiver: [Pad; 2],
    /// Pressure input at half the supply, and its number, 0 to 3.
    pub divider: (Pad, usize),
}

/// Pad `name` on `pin` of `port`.
pub const fn pad(name: &'static str, port: Gpio, pin: usize) -> Pad {
    Pad { name, port, pin }
}

/// A taken pad; dropping it restores its former state.
pub struct Taken {
    pad: Pad,
    mode: Moder,
    pull: Pupdr,
}

impl Pad {
    /// Takes the pad from its driver; it floats.
    pub fn take(self) -> Taken {
        let taken = Taken {
            pad: self,
            mode: self.port.moder().read().moder(self.pin),
            pull: self.port.pupdr().read().pupdr(self.pin),
        };
        taken.listen(Pupdr::FLOATING);
        taken
    }

    /// True if a peripheral uses the pad, as the board's file states.
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
