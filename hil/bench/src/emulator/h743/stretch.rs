//! An I2C interface whose chips hold the clock, which the emulator's cannot.

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::stm32h743::generated::i2c1::Register;
use rigless::soc::stm32h743::peripherals::i2c::I2c;
use rigless::time::{EventId, VirtualNanos};

/// The interface: what ends on the wire ends later by the time that a chip holds the clock.
#[derive(Debug)]
pub struct StretchedI2c {
    /// The emulator's.
    pub inner: I2c,
    /// How long a chip holds the clock low after each byte, ns.
    pub hold: u64,
    /// The end of a hold, and what then ends on the wire.
    held: Option<(EventId, EventId)>,
}

impl StretchedI2c {
    /// `inner`, with chips that hold nothing.
    pub fn new(inner: I2c) -> Self {
        Self {
            inner,
            hold: 0,
            held: None,
        }
    }
}

impl Device for StretchedI2c {
    type Register = Register;

    fn read(&mut self, r: Register, file: &mut RegisterFile, c: &mut DeviceContext<'_>) -> Option<u64> {
        self.inner.read(r, file, c)
    }

    fn peek(&self, r: Register, file: &RegisterFile, now: VirtualNanos) -> Option<u64> {
        self.inner.peek(r, file, now)
    }

    fn write(&mut self, r: Register, value: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.inner.write(r, value, file, c);
    }

    fn on_event(&mut self, event: EventId, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        match self.held {
            Some((end, byte)) if end == event => {
                self.held = None;
                self.inner.on_event(byte, file, c);
            }
            None if self.hold > 0 => {
                let end = c.schedule(VirtualNanos(c.now().0 + self.hold));
                self.held = Some((end, event));
            }
            _ => self.inner.on_event(event, file, c),
        }
    }

    fn on_clock(&mut self, hz: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.inner.on_clock(hz, file, c);
    }

    fn reset(&mut self) {
        self.held = None;
        self.inner.reset();
    }

    fn reset_line(&mut self, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.held = None;
        self.inner.reset_line(file, c);
    }
}
