//! The emulator's I2C interface with two additions:
//!
//! - no acknowledge for the last byte of a DMA read. The part's DMA controller signals that byte (RM0090 §27.3.7, bit
//!   LAST); otherwise the emulator reads one byte too many;
//! - a stop takes a bit's time, for which its bit stays set; whoever writes CR1 meanwhile risks a second stop or start
//!   (RM0090 §27.6.1, the note below the register), and fails the run.

use rigless::device::{Device, DeviceContext, RegisterFile};
use rigless::soc::Width;
use rigless::soc::stm32f427::generated::i2c3::{Register, ccr, cr1, cr2, sr2};
use rigless::soc::stm32f427::peripherals::i2c::I2c;
use rigless::soc::stm32f427::peripherals::rcc::HSI_HZ;
use rigless::time::{EventId, VirtualNanos};

/// A write to CR1 while a stop is pending.
const TOO_EARLY: &str =
    "written before the hardware has cleared STOP (RM0090 27.6.1): a second STOP or START is possible";

#[derive(Debug)]
pub struct DmaI2c {
    pub inner: I2c,
    /// Register of the DMA stream's remaining count.
    remaining: u64,
    ends: Vec<EventId>,
    hz: u64,
    /// CR1 as the part left it.
    control: u64,
    /// End of the stop that is on the wire.
    stop: Option<EventId>,
}

impl DmaI2c {
    pub fn new(remaining: u64) -> Self {
        Self {
            inner: I2c::with_clock(HSI_HZ),
            remaining,
            ends: Vec::new(),
            hz: HSI_HZ,
            control: 0,
            stop: None,
        }
    }

    /// Keeps the bit of a stop that the emulator has carried out; `asked`: CR1 before that.
    fn follow_stop(&mut self, asked: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        let control = file.get(Register::Cr1);
        let done = cr1::STOP.is_set(asked) && !cr1::STOP.is_set(control) && cr1::PE.is_set(control);
        if done && self.stop.is_none() {
            file.set(Register::Cr1, cr1::STOP.set(control, 1));
            self.stop = Some(c.schedule(VirtualNanos(c.now().0 + self.bit(file))));
        }
        self.control = file.get(Register::Cr1);
    }

    /// Time of a bit, ns (RM0090 §27.6.8).
    fn bit(&self, file: &RegisterFile) -> u64 {
        let value = file.get(Register::Ccr);
        let parts = match (ccr::F_S.is_set(value), ccr::DUTY.is_set(value)) {
            (false, _) => 2,
            (true, false) => 3,
            (true, true) => 25,
        };
        parts * ccr::CCR.get(value) * 1_000_000_000 / self.hz.max(1)
    }

    fn forget(&mut self) {
        self.ends.clear();
        self.control = 0;
        self.stop = None;
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
        if r != Register::Cr1 {
            return self.inner.write(r, value, file, c);
        }
        // A reset is the way out of a stop that never comes.
        let runs = cr1::PE.is_set(value) && !cr1::SWRST.is_set(value);
        if !runs {
            self.stop = None;
        } else if cr1::STOP.is_set(self.control) {
            c.tell("CR1", TOO_EARLY);
        }
        self.inner.write(r, value, file, c);
        self.follow_stop(value, file, c);
    }

    fn on_event(&mut self, event: EventId, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        if self.stop == Some(event) {
            self.stop = None;
            file.set(Register::Cr1, cr1::STOP.set(file.get(Register::Cr1), 0));
            self.control = file.get(Register::Cr1);
            return;
        }
        let control = file.get(Register::Cr2);
        let receiving = !sr2::TRA.is_set(file.get(Register::Sr2));
        if receiving && cr2::DMAEN.is_set(control) && cr2::LAST.is_set(control) {
            self.ends.push(event);
            c.read_from(self.remaining, Width::W32, 0);
        } else {
            let asked = file.get(Register::Cr1);
            self.inner.on_event(event, file, c);
            self.follow_stop(asked, file, c);
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
        self.follow_stop(control, file, c);
    }

    fn on_clock(&mut self, hz: u64, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.hz = hz;
        self.inner.on_clock(hz, file, c);
    }

    fn reset(&mut self) {
        self.forget();
        self.inner.reset();
    }

    fn reset_line(&mut self, file: &mut RegisterFile, c: &mut DeviceContext<'_>) {
        self.forget();
        self.inner.reset_line(file, c);
    }
}
