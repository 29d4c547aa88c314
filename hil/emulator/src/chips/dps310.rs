//! The emulator's DPS310 with a resolution below its whole pascals, each 8 cm of air.

use rigless::chip::dps310::{Dps310, Sdo};
use rigless::chip::{Timeline, i2c};
use rigless::snapshot::store;
use rigless::time::EventId;
use serde::{Deserialize, Serialize};

/// Registers (§7): the first of the pressure's three bytes, and the one that commands a measurement, in which bit 0 is the pressure's.
const PSR_B2: u8 = 0x00;
const MEAS_CFG: u8 = 0x08;
const PRESSURE: u8 = 0x01;
/// Counts that a pascal takes off a result of 8 samples (table 9), by the coefficients of the emulator's part.
const COUNTS_PER_PASCAL: f64 = 7_864_320.0 / 52_113.0;
/// Time from the start of a measurement of 8 samples to the pressure that it reports, ms.
const FELT_AFTER: u8 = 14;

#[derive(Debug, Serialize, Deserialize)]
pub struct Barometer {
    inner: Dps310,
    /// Time until the present measurement samples the pressure, ms.
    due: u8,
    /// Fraction of a pascal that the inner part did not get.
    fraction: f64,
    /// The next byte is the register's address.
    addressed: bool,
    pointer: u8,
    /// The pressure's bytes as they are read.
    result: [u8; 3],
    /// Times at which a pressure was read, ns.
    pub read_at: Vec<u64>,
}

store!(Barometer);

impl Barometer {
    /// SDO low, as on the Matek.
    pub fn new() -> Self {
        Self {
            inner: Dps310::new(Sdo::Low),
            due: 0,
            fraction: 0.0,
            addressed: false,
            pointer: 0,
            result: [0; 3],
            read_at: Vec::new(),
        }
    }

    /// Each millisecond: pressure, Pa, and temperature, °C.
    pub fn feel(&mut self, pascal: f64, celsius: f64) {
        if self.due == 0 {
            return;
        }
        self.due -= 1;
        if self.due == 0 {
            self.fraction = pascal.rem_euclid(1.0);
            self.inner.set_pressure(pascal.floor().max(0.0) as u32);
            self.inner.set_temperature((celsius * 100.0).round() as i32);
        }
    }

    /// The pressure with its fraction: all bytes at once, as a carry may change the first.
    fn latch(&mut self, c: &mut Timeline<'_, '_>) {
        let [high, middle, low] = [(); 3].map(|()| i2c::Peer::read(&mut self.inner, false, c));
        let word = i32::from_be_bytes([high, middle, low, 0]) >> 8;
        let counts = (self.fraction * COUNTS_PER_PASCAL).round() as i32;
        let [_, high, middle, low] = (word - counts).to_be_bytes();
        self.result = [high, middle, low];
        self.read_at.push(c.now().0);
    }
}

impl i2c::Peer for Barometer {
    fn start(&mut self, address: u8, read: bool, c: &mut Timeline<'_, '_>) -> bool {
        self.addressed = !read;
        self.inner.start(address, read, c)
    }

    fn write(&mut self, byte: u8, c: &mut Timeline<'_, '_>) -> bool {
        if std::mem::take(&mut self.addressed) {
            self.pointer = byte;
        } else {
            if self.pointer == MEAS_CFG && byte & PRESSURE != 0 {
                self.due = FELT_AFTER;
            }
            self.pointer = self.pointer.wrapping_add(1);
        }
        self.inner.write(byte, c)
    }

    fn read(&mut self, last: bool, c: &mut Timeline<'_, '_>) -> u8 {
        let register = self.pointer;
        self.pointer = register.wrapping_add(1);
        if register == PSR_B2 {
            self.latch(c);
        }
        match self.result.get(usize::from(register)) {
            Some(byte) => *byte,
            None => self.inner.read(last, c),
        }
    }

    fn stop(&mut self, c: &mut Timeline<'_, '_>) {
        self.inner.stop(c);
    }

    fn on_event(&mut self, event: EventId, c: &mut Timeline<'_, '_>) {
        self.inner.on_event(event, c);
    }

    fn restarted(&mut self, c: &mut Timeline<'_, '_>) {
        self.inner.restarted(c);
    }
}
