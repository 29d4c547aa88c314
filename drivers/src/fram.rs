//! FRAM on SPI with 32 KiB or more and two-byte addresses, up to 20 MHz, mode 0 or 3; no erase, no wait. Parts: Cypress
//! (Ramtron) FM25V02, FM25V02A, FM25V05 and Fujitsu MB85RS256B, MB85RS256TY, MB85RS512T, which differ only in identity.
//! Sources: Cypress datasheet 001-90865, the tables of ArduPilot (`AP_RAMTRON`) and Betaflight's family.
//!
//! Emulates NOR flash (an erase fills a page with 0xFF) for the parameter store.

use core::fmt;

use embedded_hal_async::spi::SpiDevice;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

use crate::fault::{Fault, report};

/// Bytes used, as of the smallest part.
pub const CAPACITY: u32 = 32 * 1024;
/// Emulated page; the store rotates over eight.
pub const PAGE: usize = 4096;
const CHUNK: usize = 64;
const HEAD: usize = 3;

/// Sets the write enable latch, which each write clears.
const WREN: u8 = 0x06;
const RDSR: u8 = 0x05;
const WRSR: u8 = 0x01;
const READ: u8 = 0x03;
const WRITE: u8 = 0x02;
const RDID: u8 = 0x9F;
/// Identity prefix of Ramtron, now Cypress: JEDEC continuation codes and maker; product and revision follow.
const RAMTRON: [u8; 7] = [0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0xC2];
/// V family with 256 and 512 Kbit. Larger ones need three-byte addresses.
const RAMTRON_PARTS: [u8; 2] = [0x22, 0x23];
/// Identity prefix of Fujitsu: maker and continuation code; two bytes of product follow.
const FUJITSU: [u8; 2] = [0x04, 0x7F];
/// MB85RS256TY, MB85RS256B, MB85RS512T.
const FUJITSU_PARTS: [[u8; 2]; 3] = [[0x25, 0x03], [0x05, 0x09], [0x26, 0x03]];
/// Write protection: pin enable and both block bits.
const PROTECTION: u8 = 0x8C;

/// Failure of a read or write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FramFault {
    /// Fault of the part.
    Chip(Fault),
    /// Address beyond the end, or an erase of less than a page.
    OutOfBounds,
}

impl fmt::Display for FramFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Chip(fault) => fault.fmt(f),
            Self::OutOfBounds => f.write_str("address out of bounds"),
        }
    }
}

impl From<Fault> for FramFault {
    fn from(fault: Fault) -> Self {
        Self::Chip(fault)
    }
}

impl NorFlashError for FramFault {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Chip(_) => NorFlashErrorKind::Other,
            Self::OutOfBounds => NorFlashErrorKind::OutOfBounds,
        }
    }
}

/// Driver of an FRAM on SPI device `S`. Transfers use a buffer in this struct: where DMA does not reach every memory,
/// the board places the driver.
pub struct Fram<S> {
    spi: S,
    buffer: [u8; HEAD + CHUNK],
    ready: bool,
}

impl<S: SpiDevice> Fram<S> {
    /// Without bus access until [`Fram::init`] or the first access.
    pub const fn new(spi: S) -> Self {
        Self {
            spi,
            buffer: [0; HEAD + CHUNK],
            ready: false,
        }
    }

    /// Checks the identity and clears write protection. Every access calls it until it has succeeded.
    ///
    /// # Errors
    /// [`Fault::Identity`] for another chip or none, [`Fault::Configuration`] if the protection stays, [`Fault::Bus`].
    pub async fn init(&mut self) -> Result<(), Fault> {
        if self.ready {
            return Ok(());
        }
        let result = self.bring_up().await;
        if let Err(fault) = &result {
            report("FRAM", fault);
        }
        self.ready = result.is_ok();
        result
    }

    async fn bring_up(&mut self) -> Result<(), Fault> {
        let [_, answer @ ..] = self.exchange([RDID, 0, 0, 0, 0, 0, 0, 0, 0, 0]).await?;
        identify(answer)?;
        if self.protection().await? != 0 {
            self.exchange([WREN]).await?;
            self.exchange([WRSR, 0]).await?;
        }
        match self.protection().await? {
            0 => Ok(()),
            found => Err(Fault::Configuration {
                bank: 0,
                register: RDSR,
                expected: 0,
                found,
            }),
        }
    }

    async fn protection(&mut self) -> Result<u8, Fault> {
        let [_, status] = self.exchange([RDSR, 0]).await?;
        Ok(status & PROTECTION)
    }

    async fn exchange<const N: usize>(&mut self, bytes: [u8; N]) -> Result<[u8; N], Fault> {
        let transfer = self.buffer.first_chunk_mut::<N>().ok_or(Fault::Bus)?;
        *transfer = bytes;
        self.spi
            .transfer_in_place(transfer)
            .await
            .map_err(|_| Fault::Bus)?;
        Ok(*transfer)
    }

    async fn write_chunk(&mut self, at: u32, bytes: &[u8]) -> Result<(), FramFault> {
        self.exchange([WREN]).await?;
        let Some(transfer) = head(&mut self.buffer, WRITE, at, bytes.len()) else {
            return Err(FramFault::OutOfBounds);
        };
        for (slot, byte) in transfer.iter_mut().skip(HEAD).zip(bytes) {
            *slot = *byte;
        }
        let sent = self.spi.transfer_in_place(transfer).await;
        sent.map_err(|_| Fault::Bus.into())
    }
}

impl<S: SpiDevice> ErrorType for Fram<S> {
    type Error = FramFault;
}

impl<S: SpiDevice> ReadNorFlash for Fram<S> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FramFault> {
        within(offset, bytes.len())?;
        self.init().await?;
        for (chunk, at) in bytes.chunks_mut(CHUNK).zip((offset..).step_by(CHUNK)) {
            let Some(transfer) = head(&mut self.buffer, READ, at, chunk.len()) else {
                return Err(FramFault::OutOfBounds);
            };
            self.spi
                .transfer_in_place(transfer)
                .await
                .map_err(|_| Fault::Bus)?;
            for (slot, byte) in chunk.iter_mut().zip(transfer.iter().skip(HEAD)) {
                *slot = *byte;
            }
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        CAPACITY as usize
    }
}

impl<S: SpiDevice> NorFlash for Fram<S> {
    const WRITE_SIZE: usize = 1;
    const ERASE_SIZE: usize = PAGE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), FramFault> {
        let page = PAGE as u32;
        if from > to || !from.is_multiple_of(page) || !to.is_multiple_of(page) {
            return Err(FramFault::OutOfBounds);
        }
        within(from, (to - from) as usize)?;
        self.init().await?;
        for at in (from..to).step_by(CHUNK) {
            self.write_chunk(at, &[0xFF; CHUNK]).await?;
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FramFault> {
        within(offset, bytes.len())?;
        self.init().await?;
        for (chunk, at) in bytes.chunks(CHUNK).zip((offset..).step_by(CHUNK)) {
            self.write_chunk(at, chunk).await?;
        }
        Ok(())
    }
}

fn identify(answer: [u8; 9]) -> Result<(), Fault> {
    let agree = |expected: &[u8], found: &[u8]| {
        let mut pairs = expected.iter().copied().zip(found.iter().copied());
        match pairs.find(|(expected, found)| expected != found) {
            Some((expected, found)) => Err(Fault::Identity { expected, found }),
            None => Ok(()),
        }
    };
    let [maker, code, first, second, ..] = answer;
    if maker == FUJITSU[0] {
        agree(&FUJITSU, &[maker, code])?;
        if FUJITSU_PARTS.contains(&[first, second]) {
            return Ok(());
        }
        return agree(&FUJITSU_PARTS[0], &[first, second]);
    }
    agree(&RAMTRON, &answer)?;
    let [.., product, _] = answer;
    if RAMTRON_PARTS.contains(&product) {
        return Ok(());
    }
    agree(&RAMTRON_PARTS, &[product])
}

/// Room for `length` data bytes after opcode and address.
fn head(buffer: &mut [u8; HEAD + CHUNK], opcode: u8, at: u32, length: usize) -> Option<&mut [u8]> {
    let [high, low] = u16::try_from(at).ok()?.to_be_bytes();
    let transfer = buffer.get_mut(..HEAD + length)?;
    *transfer.first_chunk_mut()? = [opcode, high, low];
    Some(transfer)
}

fn within(offset: u32, length: usize) -> Result<(), FramFault> {
    let left = CAPACITY
        .checked_sub(offset)
        .is_some_and(|left| length <= left as usize);
    if left { Ok(()) } else { Err(FramFault::OutOfBounds) }
}
