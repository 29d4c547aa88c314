//! The emulator's I2C interface with two additions:
//!
//! - spurious bus errors: as a master, F7 and H7 flag some while the transfer continues (ST's errata, "Spurious bus
//!   error detection in master mode");
//! - a data register that asks for its next byte as soon as the last one has moved on to the wire, and not only after its
//!   acknowledge (RM0433 §47.9.7, TXIS; ST's own driver flushes that byte after a missing acknowledge).

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::stm32h743::generated::i2c1::{Register, cr2, isr};
use rigless::soc::stm32h743::peripherals::i2c::I2c;
use rigless::time::EventId;

#[derive(Debug)]
pub struct EagerI2c {
    pub inner: I2c,
    /// One bus error in about this many bytes; 0: none.
    pub errors: u32,
    /// State of the generator that places them (Numerical Recipes' constants).
    state: u32,
    /// Bytes that the transfer will still ask for.
    left: u64,
}

impl EagerI2c {
    pub fn new(inner: I2c) -> Self {
        Self {
            inner,
            errors: 0,
            state: 1,
            left: 0,
        }
    }

    fn errs(&mut self) -> bool {
        self.state = self.state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        self.errors > 0 && (self.state >> 8).is_multiple_of(self.errors)
    }
}

impl Device for EagerI2c {
    type Register = Register;

    fn read(&mut self, r: Register, file: &mut RegisterFile, c: &mut DeviceContext<'_>) -> Option<u64> {
        self.inner.read(r, file, c)
    }

    fn write(&mut self, r: Register, value: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.inner.write(r, value, file, c);
        match r {
            Register::Cr2 if cr2::START.is_set(value) => self.left = cr2::NBYTES.get(value),
            Register::Txdr => {
                self.left = self.left.saturating_sub(1);
                let status = file.get(Register::Isr);
                if self.left > 0 && isr::TXE.is_set(status) {
                    file.set(Register::Isr, isr::TXIS.set(status, 1));
                    // Without effect but that the interface looks at its flags.
                    self.inner.write(Register::Pecr, 0, file, c);
                }
            }
            _ => {}
        }
    }

    fn on_event(&mut self, event: EventId, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        if self.errs() {
            file.set(Register::Isr, isr::BERR.set(file.get(Register::Isr), 1));
        }
        self.inner.on_event(event, file, c);
    }

    fn on_clock(&mut self, hz: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.inner.on_clock(hz, file, c);
    }

    fn reset(&mut self) {
        self.left = 0;
        self.inner.reset();
    }

    fn reset_line(&mut self, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.inner.reset_line(file, c);
    }
}
