//! A fake bus with up to two BNO055: registers, pages, boot and mode times, failures.

use std::cell::RefCell;
use std::rc::Rc;

use embassy_time::{Duration, Instant, Timer};
use embedded_hal::i2c::{self, ErrorKind, NoAcknowledgeSource, Operation};
use embedded_hal_async::i2c::I2c;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    None,
    /// No acknowledge.
    Missing,
    /// Clock held.
    Stretched,
    /// All bytes read as this.
    Reads(u8),
}

/// What the bus sees of the byte that resets a chip: it resets in each case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnReset {
    Acknowledged,
    /// The chip is gone before its acknowledge.
    Refused,
    /// Clock held from that byte on, for this time.
    Held(Duration),
}

pub struct Chip {
    pub address: u8,
    pub failure: Failure,
    pub on_reset: OnReset,
    /// Clock held after each byte, µs.
    pub stretch: u64,
    pub resets: u32,
    held_until: Instant,
    pub pages: [[u8; 128]; 2],
    /// Every write: page, register, value.
    pub writes: Vec<(u8, u8, u8)>,
    pub transactions: u32,
    pub violations: Vec<String>,
    boots_until: Instant,
    switches_until: Instant,
    /// Gravity vector, counts.
    pub gravity: [i16; 3],
    pub calibration: u8,
    pub status: u8,
}

impl Chip {
    pub fn new(address: u8) -> Rc<RefCell<Self>> {
        let mut chip = Self {
            address,
            failure: Failure::None,
            on_reset: OnReset::Acknowledged,
            stretch: 0,
            resets: 0,
            held_until: Instant::MIN,
            pages: [[0; 128]; 2],
            writes: Vec::new(),
            transactions: 0,
            violations: Vec::new(),
            boots_until: Instant::from_ticks(0),
            switches_until: Instant::from_ticks(0),
            gravity: [0, 0, 981],
            calibration: 0x30,
            status: 5,
        };
        chip.reset();
        Rc::new(RefCell::new(chip))
    }

    /// Power-on values; no answer for 650 ms.
    pub fn reset(&mut self) {
        self.pages = [[0; 128]; 2];
        let p0 = &mut self.pages[0];
        for (register, value) in [
            (0x00, 0xA0),
            (0x01, 0xFB),
            (0x02, 0x32),
            (0x03, 0x0F),
            (0x3B, 0x80),
            (0x41, 0x24),
        ] {
            p0[register] = value;
        }
        self.boots_until = Instant::now() + Duration::from_millis(650);
    }

    fn page(&self) -> u8 {
        self.pages[0][0x07] & 1
    }

    fn read(&self, register: u8) -> u8 {
        let p0 = &self.pages[0];
        let fused = p0[0x3D] & 0x0F >= 0x08 && Instant::now() >= self.switches_until;
        let [x, y, z] = self.gravity.map(i16::to_le_bytes);
        match (self.page(), register) {
            (_, 0x07) => self.page(),
            (0, 0x2E..=0x33) if fused => [x, y, z].concat()[usize::from(register - 0x2E)],
            (0, 0x35) if fused => self.calibration,
            (0, 0x39) => {
                if fused {
                    self.status
                } else {
                    0
                }
            }
            (page, register) => self.pages[usize::from(page)][usize::from(register & 0x7F)],
        }
    }

    fn transfer(&mut self, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        let refused = |source| BusError(ErrorKind::NoAcknowledge(source));
        if self.failure == Failure::Missing || Instant::now() < self.boots_until {
            return Err(refused(NoAcknowledgeSource::Address));
        }
        let mut register = 0u8;
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    if let [first, data @ ..] = &**bytes {
                        register = *first;
                        for &value in data {
                            if !self.write(register, value) {
                                return Err(refused(NoAcknowledgeSource::Data));
                            }
                            register = register.wrapping_add(1);
                        }
                    }
                }
                Operation::Read(bytes) => {
                    for byte in bytes.iter_mut() {
                        *byte = match self.failure {
                            Failure::Reads(value) => value,
                            _ => self.read(register),
                        };
                        register = register.wrapping_add(1);
                    }
                }
            }
        }
        Ok(())
    }

    /// False: not acknowledged.
    fn write(&mut self, register: u8, value: u8) -> bool {
        let now = Instant::now();
        if now < self.switches_until {
            self.violations
                .push(format!("write to 0x{register:02X} while the mode switches"));
        }
        self.writes.push((self.page(), register, value));
        if register == 0x07 {
            self.pages[0][0x07] = value;
            return true;
        }
        let page = self.page();
        let configures = self.pages[0][0x3D] & 0x0F == 0;
        if (page, register) == (0, 0x3F) && value & 0x20 != 0 && configures {
            self.resets += 1;
            self.reset();
            if let OnReset::Held(time) = self.on_reset {
                self.held_until = now + time;
            }
            return self.on_reset == OnReset::Acknowledged;
        }
        if page == 0 && register == 0x3D {
            let to_config = value & 0x0F == 0;
            self.switches_until = now + Duration::from_millis(if to_config { 19 } else { 7 });
        } else if page == 0 && !configures {
            // §3.3: all but the mode and the interrupts.
            self.violations
                .push(format!("0x{register:02X} written outside the configuration mode"));
            return true;
        }
        if !(page == 0 && register <= 0x06) {
            self.pages[usize::from(page)][usize::from(register)] = value;
        }
        true
    }
}

pub struct Bus(pub Vec<Rc<RefCell<Chip>>>);

#[derive(Debug)]
pub struct BusError(ErrorKind);

impl BusError {
    pub fn of(kind: ErrorKind) -> Self {
        Self(kind)
    }
}

impl i2c::Error for BusError {
    fn kind(&self) -> ErrorKind {
        self.0
    }
}

impl i2c::ErrorType for Bus {
    type Error = BusError;
}

impl I2c for Bus {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        let nobody = BusError(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address));
        let Some(chip) = self.0.iter().find(|c| c.borrow().address == address) else {
            Timer::after_micros(30).await;
            return Err(nobody);
        };
        chip.borrow_mut().transactions += 1;
        if self.0.iter().any(|c| c.borrow().held_until > Instant::now()) {
            // As the board's bus finds it when it frees the lines.
            Timer::after_millis(1).await;
            return Err(BusError(ErrorKind::Bus));
        }
        let failure = chip.borrow().failure;
        if failure == Failure::Stretched {
            core::future::pending::<()>().await;
        }
        // 22.5 µs per byte: 400 kHz.
        let bytes: usize = operations
            .iter()
            .map(|o| {
                1 + match o {
                    Operation::Read(b) => b.len(),
                    Operation::Write(b) => b.len(),
                }
            })
            .sum();
        let stretch = chip.borrow().stretch;
        Timer::after_micros(bytes as u64 * (45 + 2 * stretch) / 2).await;
        let result = chip.borrow_mut().transfer(operations);
        if chip.borrow().held_until > Instant::now() {
            core::future::pending::<()>().await;
        }
        result
    }
}
