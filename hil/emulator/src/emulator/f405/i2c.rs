//! The emulator's I2C interface, without acknowledge for the last byte of a DMA read. The part's DMA controller signals
//! that byte (RM0090 §27.3.7, bit LAST); otherwise the emulator reads one byte too many.

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::Width;
use rigless::soc::stm32f427::generated::i2c3::{Register, cr1, cr2, sr2};
use rigless::soc::stm32f427::peripherals::i2c::I2c;
use rigless::time::{EventId, VirtualNanos};

#[derive(Debug)]
pub struct DmaI2c {
    pub inner: I2c,
    /// Register of the DMA stream's remaining count.
    remaining: u64,
    ends: Vec<EventId>,
}

impl DmaI2c {
    pub fn new(inner: I2c, remaining: u64) -> Self {
        Self {
            inner,
            remaining,
            ends: Vec::new(),
        }
    }
}

impl Device for DmaI2c {
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
        let control = file.get(Register::Cr2);
        let receiving = !sr2::TRA.is_set(file.get(Register::Sr2));
        if receiving && cr2::DMAEN.is_set(control) && cr2::LAST.is_set(control) {
            self.ends.push(event);
            c.read_from(self.remaining, Width::W32, 0);
        } else {
            self.inner.on_event(event, file, c);
        }
    }

    fn on_access(&mut self, _: u64, remaining: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        let control = file.get(Register::Cr1);
        if remaining & 0xFFFF == 1 {
            file.set(Register::Cr1, cr1::ACK.set(control, 0));
        }
        for event in std::mem::take(&mut self.ends) {
            self.inner.on_event(event, file, c);
        }
        let acknowledge = cr1::ACK.get(control);
        file.set(Register::Cr1, cr1::ACK.set(file.get(Register::Cr1), acknowledge));
    }

    fn on_clock(&mut self, hz: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.inner.on_clock(hz, file, c);
    }

    fn reset(&mut self) {
        self.ends.clear();
        self.inner.reset();
    }

    fn reset_line(&mut self, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.ends.clear();
        self.inner.reset_line(file, c);
    }
}
