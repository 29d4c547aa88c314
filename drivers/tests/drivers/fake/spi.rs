//! A fake InvenSense part on SPI: banks, read-only registers, reset values, data-ready, self-test, failures.

use std::cell::RefCell;
use std::rc::Rc;

use embassy_time::{Instant, Timer};
use embedded_hal::spi::{self, Operation};
use embedded_hal_async::spi::SpiDevice;
use sophie_ports::data_ready;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Icm42688p,
    Icm20689,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    None,
    /// MISO held low.
    Zeros,
    /// MISO held high, or no part fitted.
    Ones,
    Bus,
    /// No sample, by line or status.
    Mute,
    /// Data-ready line cut; the part still samples.
    LineCut,
    Frozen,
}

/// State of the part, shared by bus and data-ready line.
pub struct Part {
    pub kind: Kind,
    pub failure: Failure,
    /// Another identity than the kind's.
    pub identity: Option<u8>,
    pub banks: [[u8; 128]; 5],
    bank: u8,
    /// Registers that ignore writes.
    pub deaf: Vec<(u8, u8)>,
    /// Writes except bank selects: bank, register, value.
    pub writes: Vec<(u8, u8, u8)>,
    /// Transaction lengths, bytes.
    pub transactions: Vec<usize>,
    /// Breaches of the datasheet.
    pub violations: Vec<String>,
    /// Angular rate (°/s), specific force (g), part's axes.
    pub gyro: [f32; 3],
    pub accel: [f32; 3],
    /// Self-test response over the factory's, per axis: gyro, then accel.
    pub health: [f32; 6],
    noise: u32,
    /// Clock error, µs added to each period.
    pub skew: i64,
    /// Last status read, µs; a later sample sets its bit.
    status_read: u64,
    /// Samples read, by the number of their period.
    pub samples: Vec<u64>,
    powered_at: Instant,
    busy_until: Instant,
}

/// Factory codes: 1.01^(code - 1) times 2620 counts.
pub const CODES: [u8; 6] = [90, 100, 110, 60, 70, 80];

impl Part {
    pub fn new(kind: Kind) -> Rc<RefCell<Self>> {
        let mut part = Self {
            kind,
            failure: Failure::None,
            identity: None,
            banks: [[0; 128]; 5],
            bank: 0,
            deaf: Vec::new(),
            writes: Vec::new(),
            transactions: Vec::new(),
            violations: Vec::new(),
            gyro: [0.0; 3],
            accel: [0.0, 0.0, 1.0],
            health: [1.0; 6],
            noise: 1,
            skew: 0,
            status_read: 0,
            samples: Vec::new(),
            powered_at: Instant::from_ticks(0),
            busy_until: Instant::from_ticks(0),
        };
        part.reset();
        Rc::new(RefCell::new(part))
    }

    pub fn reset(&mut self) {
        self.banks = [[0; 128]; 5];
        self.bank = 0;
        match self.kind {
            Kind::Icm42688p => {
                let b0 = &mut self.banks[0];
                for (register, value) in [
                    (0x13, 0x05),
                    (0x1D, 0x80),
                    (0x2D, 0x10),
                    (0x4C, 0x30),
                    (0x4D, 0x91),
                    (0x4F, 0x06),
                    (0x50, 0x06),
                    (0x51, 0x16),
                    (0x52, 0x11),
                    (0x53, 0x0D),
                    (0x64, 0x10),
                    (0x65, 0x10),
                    (0x75, 0x47),
                ] {
                    b0[register] = value;
                }
                for (register, value) in [(0x0B, 0xA0), (0x0C, 0x0D), (0x0D, 0xAA), (0x0E, 0x80)] {
                    self.banks[1][register] = value;
                }
                for (register, value) in [(0x03, 0x30), (0x04, 0x40), (0x05, 0x62)] {
                    self.banks[2][register] = value;
                }
                self.banks[1][0x5F..0x62].copy_from_slice(&CODES[..3]);
                self.banks[2][0x3B..0x3E].copy_from_slice(&CODES[3..]);
            }
            Kind::Icm20689 => {
                let b0 = &mut self.banks[0];
                b0[0x6B] = 0x40;
                b0[0x75] = 0x98;
                b0[0x00..0x03].copy_from_slice(&CODES[..3]);
                b0[0x0D..0x10].copy_from_slice(&CODES[3..]);
            }
        }
        if let Some(identity) = self.identity {
            self.banks[0][0x75] = identity;
        }
    }

    fn on(&self) -> bool {
        let b0 = &self.banks[0];
        match self.kind {
            Kind::Icm42688p => b0[0x4E] & 0x0F == 0x0F,
            Kind::Icm20689 => b0[0x6B] & 0xC0 == 0 && b0[0x6C] == 0,
        }
    }

    fn newest(&self) -> Option<u64> {
        self.period().map(|period| Instant::now().as_micros() / period)
    }

    /// Reading clears it.
    fn status(&mut self) -> u8 {
        let now = Instant::now().as_micros();
        let last = std::mem::replace(&mut self.status_read, now);
        let ready = self.period().is_some_and(|period| now / period > last / period);
        match self.kind {
            Kind::Icm42688p => u8::from(ready) << 3,
            Kind::Icm20689 => u8::from(ready),
        }
    }

    /// Data-ready period, µs; `None` without pulses.
    fn pulses(&self) -> Option<u64> {
        self.period().filter(|_| self.failure != Failure::LineCut)
    }

    /// Sample period, µs; `None` without samples.
    pub fn period(&self) -> Option<u64> {
        let b0 = &self.banks[0];
        if !self.on() || self.failure == Failure::Mute {
            return None;
        }
        let nominal: Option<u64> = match self.kind {
            Kind::Icm42688p if b0[0x65] & 0x08 != 0 => match b0[0x4F] & 0x0F {
                3 => Some(125),
                4 => Some(250),
                5 => Some(500),
                6 => Some(1000),
                _ => None,
            },
            Kind::Icm20689 if b0[0x38] & 0x01 != 0 => match b0[0x1A] & 0x07 {
                0 | 7 => Some(125),
                _ => Some(1000 * (1 + u64::from(b0[0x19]))),
            },
            _ => None,
        };
        nominal?.checked_add_signed(self.skew)
    }

    fn convert(&mut self) {
        if self.failure == Failure::Frozen || !self.on() {
            return;
        }
        let b0 = &self.banks[0];
        let (gyro_scale, accel_scale, actuated) = match self.kind {
            Kind::Icm42688p => {
                let st = b0[0x70];
                let accel = if st & 0x40 != 0 { st >> 3 & 7 } else { 0 };
                (
                    16.384 * f32::from(1u16 << (b0[0x4F] >> 5)),
                    2048.0 * f32::from(1u16 << (b0[0x50] >> 5)),
                    [st & 7, accel],
                )
            }
            Kind::Icm20689 => {
                let reversed = |v: u8| (v >> 7 & 1) | (v >> 5 & 2) | (v >> 3 & 4);
                (
                    131.072 / f32::from(1u16 << (b0[0x1B] >> 3 & 3)),
                    16384.0 / f32::from(1u16 << (b0[0x1C] >> 3 & 3)),
                    [reversed(b0[0x1B]), reversed(b0[0x1C])],
                )
            }
        };
        let mut counts = [0i16; 6];
        for axis in 0..3 {
            for (sensor, value, scale, full) in [
                (0, self.gyro[axis], gyro_scale, 131.072),
                (1, self.accel[axis], accel_scale, 16384.0),
            ] {
                let index = 3 * sensor + axis;
                // Small deterministic noise, -2..=1 counts.
                self.noise = self.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let mut c = value * scale + (self.noise >> 30) as f32 - 2.0;
                if actuated[sensor] >> axis & 1 == 1 {
                    // Counts at the test's range, scaled to the present one.
                    let response = 2620.0 * 1.01f32.powi(i32::from(CODES[index]) - 1);
                    c += self.health[index] * response * scale / full;
                }
                counts[index] = c.clamp(-32768.0, 32767.0) as i16;
            }
        }
        let [gx, gy, gz, ax, ay, az] = counts;
        let (start, words) = match self.kind {
            Kind::Icm42688p => (0x1D, [1325, ax, ay, az, gx, gy, gz]),
            Kind::Icm20689 => (0x3B, [ax, ay, az, 3268, gx, gy, gz]),
        };
        for (pair, word) in self.banks[0][start..start + 14].chunks_mut(2).zip(words) {
            pair.copy_from_slice(&word.to_be_bytes());
        }
    }

    fn read(&mut self, register: u8) -> u8 {
        let bank = if register == 0x76 { 0 } else { self.bank };
        let status = if self.kind == Kind::Icm42688p { 0x2D } else { 0x3A };
        if (bank, register) == (0, status) {
            return self.status();
        }
        self.banks[usize::from(bank)][usize::from(register)]
    }

    fn write(&mut self, register: u8, value: u8) {
        let now = Instant::now();
        if now < self.busy_until {
            self.violations
                .push(format!("write to 0x{register:02X} during a reset"));
            return;
        }
        if self.kind == Kind::Icm42688p {
            if now.duration_since(self.powered_at).as_micros() < 200 && self.on() {
                self.violations
                    .push(format!("write to 0x{register:02X} within 200 µs of power-on"));
            }
            if register == 0x76 {
                self.bank = value & 7;
                return;
            }
            // Allowed by §12.9 with the sensors on, and the self-test's register.
            let allowed = self.bank == 0 && matches!(register, 0x11 | 0x4E | 0x4F | 0x50 | 0x70);
            if self.on() && !allowed {
                self.violations.push(format!(
                    "bank {} 0x{register:02X} changed while the sensors are on",
                    self.bank
                ));
            }
        }
        self.writes.push((self.bank, register, value));
        let reset = match self.kind {
            Kind::Icm42688p => self.bank == 0 && register == 0x11 && value & 1 != 0,
            Kind::Icm20689 => register == 0x6B && value & 0x80 != 0,
        };
        if reset {
            let deaf = self.deaf.contains(&(0, register));
            if !deaf {
                self.reset();
                self.busy_until = now + embassy_time::Duration::from_millis(1);
            }
            return;
        }
        let read_only = register == 0x75 || self.deaf.contains(&(self.bank, register));
        if !read_only {
            let was_on = self.on();
            self.banks[usize::from(self.bank)][usize::from(register)] = value;
            if self.on() && !was_on {
                self.powered_at = now;
            }
        }
    }
}

pub struct Bus(pub Rc<RefCell<Part>>);

pub struct DataReady(pub Rc<RefCell<Part>>);

#[derive(Debug)]
pub struct BusError;

impl spi::Error for BusError {
    fn kind(&self) -> spi::ErrorKind {
        spi::ErrorKind::Other
    }
}

impl spi::ErrorType for Bus {
    type Error = BusError;
}

impl SpiDevice for Bus {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), BusError> {
        // 2 µs overhead and 1 µs per byte (8 MHz): a transaction can be dropped half way.
        let length: usize = operations
            .iter()
            .map(|o| match o {
                Operation::Read(b) => b.len(),
                Operation::Write(b) => b.len(),
                Operation::Transfer(r, w) => r.len().max(w.len()),
                Operation::TransferInPlace(b) => b.len(),
                Operation::DelayNs(_) => 0,
            })
            .sum();
        Timer::after_micros(2 + length as u64).await;
        let mut part = self.0.borrow_mut();
        part.transactions.push(length);
        if part.failure == Failure::Bus {
            return Err(BusError);
        }
        let mut address = None;
        let mut exchange = |part: &mut Part, byte: u8| -> u8 {
            let answer = match address {
                None => {
                    if byte & 0x7F == if part.kind == Kind::Icm42688p { 0x1D } else { 0x3B } {
                        part.convert();
                        let newest = part.newest();
                        part.samples.extend(newest);
                    }
                    address = Some(byte);
                    0
                }
                Some(a) if a & 0x80 != 0 => {
                    address = Some((a + 1) | 0x80);
                    part.read(a & 0x7F)
                }
                Some(a) => {
                    // Single writes only (DS-000347 §9.6).
                    part.write(a, byte);
                    0
                }
            };
            match part.failure {
                Failure::Zeros => 0x00,
                Failure::Ones => 0xFF,
                _ => answer,
            }
        };
        for operation in operations {
            match operation {
                Operation::TransferInPlace(bytes) => {
                    bytes.iter_mut().for_each(|b| *b = exchange(&mut part, *b))
                }
                Operation::Write(bytes) => bytes.iter().for_each(|&b| {
                    let _ = exchange(&mut part, b);
                }),
                Operation::Read(bytes) => bytes.iter_mut().for_each(|b| *b = exchange(&mut part, 0)),
                Operation::Transfer(..) | Operation::DelayNs(_) => unimplemented!("no driver here uses it"),
            }
        }
        Ok(())
    }
}

impl data_ready::DataReady for DataReady {
    async fn next(&mut self) -> Instant {
        loop {
            let period = self.0.borrow().pulses();
            let Some(period) = period else {
                Timer::after_micros(100).await;
                continue;
            };
            let now = Instant::now().as_micros();
            let at = Instant::from_micros((now / period + 1) * period);
            Timer::at(at).await;
            if self.0.borrow().pulses().is_some() {
                return at;
            }
        }
    }
}
