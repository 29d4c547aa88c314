//! Lights and buzzer.

use embassy_stm32::Peri;
use embassy_stm32::gpio::{Flex, Level, Pin, Speed};

/// A switchable device.
pub trait Switch {
    /// Switches on or off.
    fn set(&mut self, on: bool);
}

/// A device switched by a pin.
pub struct Lamp {
    pin: Flex<'static>,
    on: Level,
}

impl Lamp {
    /// A device, off, that is on while `pin` is at `on`.
    pub fn new(pin: Peri<'static, impl Pin>, on: Level) -> Self {
        let off = if on == Level::High {
            Level::Low
        } else {
            Level::High
        };
        let mut pin = Flex::new(pin);
        pin.set_level(off);
        pin.set_as_output(Speed::Low);
        Self { pin, on }
    }

    /// A device, off, that is on while `pin` is low; off, the pin floats and takes 5 V.
    pub fn open_drain(pin: Peri<'static, impl Pin>) -> Self {
        let mut pin = Flex::new(pin);
        pin.set_level(Level::High);
        pin.set_as_input_output(Speed::Low);
        let on = Level::Low;
        Self { pin, on }
    }
}

impl Switch for Lamp {
    fn set(&mut self, on: bool) {
        self.pin.set_level(Level::from(on == (self.on == Level::High)));
    }
}

/// Two lights, and a buzzer on a pin or tone.
pub struct Lights<B> {
    /// State light.
    pub state: Lamp,
    /// Fault light.
    pub fault: Lamp,
    /// Buzzer.
    pub buzzer: B,
}

impl<B: Switch> Lights<B> {
    /// Switches all three.
    pub fn show(&mut self, state: bool, fault: bool, buzzer: bool) {
        self.state.set(state);
        self.fault.set(fault);
        self.buzzer.set(buzzer);
    }
}
