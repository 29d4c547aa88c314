//! A fake MS5611 on SPI, or what replaces it.

use std::cell::RefCell;
use std::rc::Rc;

use embassy_time::{Duration, Instant, Timer};
use embedded_hal::spi::{ErrorType, Operation};
use embedded_hal_async::spi::SpiDevice;

use super::spi::BusError;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    None,
    /// Always this byte: an undriven line.
    Only(u8),
    Bus,
}

pub struct Chip {
    pub failure: Failure,
    pub prom: [u16; 8],
    /// What conversions of pressure and temperature give.
    pub counts: [u32; 2],
    /// Added to the pressure with each conversion.
    pub noise: i32,
    pub commands: u32,
    converts: Option<(Instant, usize)>,
}

impl Chip {
    pub fn new(prom: [u16; 8], counts: [u32; 2]) -> Rc<RefCell<Self>> {
        Rc::new(RefCell::new(Self {
            failure: Failure::None,
            prom,
            counts,
            noise: 400,
            commands: 0,
            converts: None,
        }))
    }

    fn answer(&mut self, command: u8) -> [u8; 3] {
        self.commands += 1;
        let now = Instant::now();
        match command {
            0x48 | 0x58 => {
                let which = usize::from(command == 0x58);
                self.converts = Some((now + Duration::from_micros(9_040), which));
                [0; 3]
            }
            0xA0..=0xAE => {
                let [high, low] = self.prom[usize::from(command - 0xA0) / 2].to_be_bytes();
                [high, low, 0]
            }
            0x00 => {
                // Too early it gives zero.
                let Some((_, which)) = self.converts.take().filter(|(at, _)| *at <= now) else {
                    return [0; 3];
                };
                if which == 0 {
                    self.counts[0] = self.counts[0].wrapping_add_signed(self.noise);
                    self.noise = -self.noise;
                }
                let [_, a, b, c] = self.counts[which].to_be_bytes();
                [a, b, c]
            }
            _ => [0; 3],
        }
    }
}

pub struct Bus(pub Rc<RefCell<Chip>>);

impl ErrorType for Bus {
    type Error = BusError;
}

impl SpiDevice for Bus {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), BusError> {
        Timer::after_micros(5).await;
        let mut chip = self.0.borrow_mut();
        if chip.failure == Failure::Bus {
            return Err(BusError);
        }
        let mut answer = [0; 3];
        for operation in operations {
            match operation {
                Operation::Write(bytes) => answer = chip.answer(bytes[0]),
                Operation::Read(bytes) => {
                    for (byte, value) in bytes.iter_mut().zip(answer) {
                        *byte = match chip.failure {
                            Failure::Only(only) => only,
                            _ => value,
                        };
                    }
                }
                _ => panic!("only writes and reads"),
            }
        }
        Ok(())
    }
}
