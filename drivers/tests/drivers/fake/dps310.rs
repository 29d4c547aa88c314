//! A fake DPS310 on I2C: registers, times, the fuse that some parts have, failures.

use std::cell::RefCell;
use std::rc::Rc;

use embassy_time::{Duration, Instant, Timer};
use embedded_hal::i2c::{ErrorKind, ErrorType, NoAcknowledgeSource, Operation};
use embedded_hal_async::i2c::I2c;

use super::i2c::BusError;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    None,
    /// No acknowledge.
    Missing,
    /// Clock held.
    Stretched,
    /// It takes commands and never ends a measurement.
    Mute,
    /// It ignores writes to its settings.
    Deaf,
    /// It resets and does not acknowledge the byte that says so.
    RefusesReset,
}

pub struct Chip {
    pub failure: Failure,
    pub registers: [u8; 128],
    /// Raw values of 24 bits that the next measurements give.
    pub pressure: i32,
    pub temperature: i32,
    /// Added to the pressure with each measurement: a real part has noise.
    pub noise: i32,
    /// Every write: register, value.
    pub writes: Vec<(u8, u8)>,
    pub transactions: u32,
    boots_until: Instant,
    measured: Option<(Instant, u8)>,
    /// The fuse's correction was made in its order.
    pub corrected: bool,
}

impl Chip {
    /// With the coefficients `coefficients` from 0x10 on.
    pub fn new(coefficients: [u8; 18]) -> Rc<RefCell<Self>> {
        let mut registers = [0; 128];
        registers[0x0D] = 0x10;
        registers[0x10..0x22].copy_from_slice(&coefficients);
        registers[0x28] = 0x80;
        Rc::new(RefCell::new(Self {
            failure: Failure::None,
            registers,
            pressure: 0,
            temperature: 0,
            noise: 1,
            writes: Vec::new(),
            transactions: 0,
            boots_until: Instant::MIN,
            measured: None,
            corrected: false,
        }))
    }

    fn read(&mut self, register: u8) -> u8 {
        let now = Instant::now();
        if register == 0x08 {
            let boots = if now < self.boots_until { 0 } else { 0xC0 };
            let ready = self
                .measured
                .filter(|(at, _)| *at <= now)
                .map_or(0, |(_, bit)| bit);
            return boots | ready;
        }
        let [_, p2, p1, p0] = self.pressure.to_be_bytes();
        let [_, t2, t1, t0] = self.temperature.to_be_bytes();
        match register {
            0x00..=0x02 => {
                self.measured = None;
                [p2, p1, p0][usize::from(register)]
            }
            0x03..=0x05 => {
                self.measured = None;
                [t2, t1, t0][usize::from(register - 3)]
            }
            _ => self.registers[usize::from(register & 0x7F)],
        }
    }

    fn write(&mut self, register: u8, value: u8) {
        self.writes.push((register, value));
        let now = Instant::now();
        match (register, value) {
            (0x0C, 0x09) => {
                self.boots_until = now + Duration::from_millis(40);
                for settings in 0x06..=0x09 {
                    self.registers[settings] = 0;
                }
                self.corrected = false;
            }
            (0x62, 0x02) => self.corrected = self.registers[0x0E] == 0xA5 && self.registers[0x0F] == 0x96,
            (0x08, command) if self.failure != Failure::Mute => {
                let (us, bit) = if command == 1 {
                    (14_800, 0x10)
                } else {
                    (8_400, 0x20)
                };
                if command == 1 {
                    self.pressure += self.noise;
                    self.noise = -self.noise;
                }
                self.measured = Some((now + Duration::from_micros(us), bit));
            }
            (0x06..=0x09, _) if self.failure == Failure::Deaf => {}
            _ => self.registers[usize::from(register & 0x7F)] = value,
        }
    }
}

pub struct Bus(pub Rc<RefCell<Chip>>);

impl ErrorType for Bus {
    type Error = BusError;
}

impl I2c for Bus {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        let failure = self.0.borrow().failure;
        self.0.borrow_mut().transactions += 1;
        if failure == Failure::Stretched {
            core::future::pending::<()>().await;
        }
        Timer::after_micros(200).await;
        if failure == Failure::Missing || address != 0x76 {
            return Err(BusError::of(ErrorKind::NoAcknowledge(
                NoAcknowledgeSource::Address,
            )));
        }
        let mut chip = self.0.borrow_mut();
        let mut register = 0;
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    register = bytes[0];
                    for value in &bytes[1..] {
                        chip.write(register, *value);
                    }
                    if failure == Failure::RefusesReset && register == 0x0C {
                        return Err(BusError::of(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data)));
                    }
                }
                Operation::Read(bytes) => {
                    for byte in bytes.iter_mut() {
                        *byte = chip.read(register);
                        register += 1;
                    }
                }
            }
        }
        Ok(())
    }
}
