//! An I2C interface with clock stretching, which the emulator lacks.

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::time::{EventId, VirtualNanos};

/// Delays ends of bytes while a chip stretches the clock.
#[derive(Debug)]
pub struct ClockStretch<D> {
    pub inner: D,
    /// Clock hold after each byte, ns.
    pub hold: u64,
    /// End of a hold, and the delayed end on the wire.
    held: Option<(EventId, EventId)>,
}

impl<D> ClockStretch<D> {
    pub fn new(inner: D) -> Self {
        Self {
            inner,
            hold: 0,
            held: None,
        }
    }
}

impl<D: Device> Device for ClockStretch<D> {
    type Register = D::Register;

    fn read(&mut self, r: D::Register, file: &mut RegisterFile, c: &mut DeviceContext<'_>) -> Option<u64> {
        self.inner.read(r, file, c)
    }

    fn peek(&self, r: D::Register, file: &RegisterFile, now: VirtualNanos) -> Option<u64> {
        self.inner.peek(r, file, now)
    }

    fn write(&mut self, r: D::Register, value: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
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

    fn on_access(&mut self, token: u64, value: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.inner.on_access(token, value, file, c);
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
