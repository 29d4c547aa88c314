//! A fake FM25V02A on SPI, or what replaces it.

use std::cell::RefCell;
use std::rc::Rc;

use embassy_time::Timer;
use embedded_hal::spi::{ErrorType, Operation};
use embedded_hal_async::spi::SpiDevice;

use super::spi::BusError;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Answer {
    /// A sound part.
    #[default]
    Sound,
    /// Always this byte: an undriven line.
    Only(u8),
    Bus,
    Deaf,
}

pub struct Chip {
    pub answer: Answer,
    pub identity: [u8; 9],
    pub cells: Vec<u8>,
    /// WPEN, BP1, BP0 and the latch; bit 6 reads as 1.
    pub status: u8,
    /// Bytes of every transaction from the controller.
    pub sent: Vec<Vec<u8>>,
}

impl Chip {
    pub fn new() -> Rc<RefCell<Self>> {
        Rc::new(RefCell::new(Self {
            answer: Answer::Sound,
            identity: [0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0xC2, 0x22, 0x08],
            cells: vec![0xFF; 32 * 1024],
            status: 0x40,
            sent: Vec::new(),
        }))
    }

    /// One transaction, from select to deselect; returns the part's bytes.
    fn transfer(&mut self, sent: &[u8]) -> Vec<u8> {
        let mut answer = vec![0; sent.len()];
        let latched = self.status & 0x02 != 0;
        // 15 address bits.
        let address = |i: usize| (usize::from(u16::from_be_bytes([sent[1], sent[2]])) + i) & 0x7FFF;
        match sent[0] {
            0x06 => self.status |= 0x02,
            0x05 => answer[1..].fill(self.status),
            0x01 => {
                if latched {
                    self.status = 0x40 | (sent[1] & 0x8C);
                }
                self.status &= !0x02;
            }
            0x03 => {
                for (i, slot) in answer[3..].iter_mut().enumerate() {
                    *slot = self.cells[address(i)];
                }
            }
            0x02 => {
                // With both block bits the whole array is protected.
                if latched && self.status & 0x0C == 0 && self.answer != Answer::Deaf {
                    for (i, byte) in sent[3..].iter().enumerate() {
                        self.cells[address(i)] = *byte;
                    }
                }
                self.status &= !0x02;
            }
            0x9F => {
                for (slot, byte) in answer[1..].iter_mut().zip(self.identity) {
                    *slot = byte;
                }
            }
            _ => (),
        }
        answer
    }
}

pub struct Bus(pub Rc<RefCell<Chip>>);

impl ErrorType for Bus {
    type Error = BusError;
}

impl SpiDevice for Bus {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), BusError> {
        let [Operation::TransferInPlace(bytes)] = operations else {
            unimplemented!("no driver here uses it")
        };
        Timer::after_micros(2 + bytes.len() as u64).await;
        let mut chip = self.0.borrow_mut();
        chip.sent.push(bytes.to_vec());
        match chip.answer {
            Answer::Bus => return Err(BusError),
            Answer::Only(byte) => bytes.fill(byte),
            Answer::Sound | Answer::Deaf => {
                let answer = chip.transfer(bytes);
                bytes.copy_from_slice(&answer);
            }
        }
        Ok(())
    }
}
