//! FRAM on SPI with 32 KiB or more under addresses of two bytes, up to 20 MHz, mode 0 or 3: no erase and no waiting. The
//! parts are Cypress (Ramtron) FM25V02, FM25V02A, FM25V05 and Fujitsu MB85RS256B, MB85RS256TY, MB85RS512T, which differ
//! in their identities alone. Facts are those of Cypress' datasheet 001-90865 and of the tables of ArduPilot
//! (`AP_RAMTRON`) and Betaflight's family.
//!
//! It serves as NOR flash, so that the parameter store is the same on every board: an erase fills a page with 0xFF.

use core::fmt;

use embedded_hal_async::spi::SpiDevice;
use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

use crate::fault::{Fault, report};

/// Bytes that are used: those of the smallest part.
pub const CAPACITY: u32 = 32 * 1024;
/// Bytes of a page. The part has none: eight of them let the store go round.
pub const PAGE: usize = 4096;
/// Most data bytes of one transfer.
const CHUNK: usize = 64;
/// Opcode and address.
const HEAD: usize = 3;

/// Sets the write enable latch; the end of each write clears it.
const WREN: u8 = 0x06;
/// Reads the status register.
const RDSR: u8 = 0x05;
/// Writes the status register.
const WRSR: u8 = 0x01;
/// Reads memory.
const READ: u8 = 0x03;
/// Writes memory.
const WRITE: u8 = 0x02;
/// Reads the identity.
const RDID: u8 = 0x9F;
/// How the identity of a Ramtron, today Cypress, begins: JEDEC continuation codes and the maker. Then the product, then
/// its revision.
const RAMTRON: [u8; 7] = [0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0x7F, 0xC2];
/// Its products: F-RAM of the V family with 256 and 512 Kbit. Larger ones want an address of three bytes.
const RAMTRON_PARTS: [u8; 2] = [0x22, 0x23];
/// How that of a Fujitsu begins: the maker and a continuation code. Then the product, in two bytes.
const FUJITSU: [u8; 2] = [0x04, 0x7F];
/// Its products: MB85RS256TY, MB85RS256B, MB85RS512T.
const FUJITSU_PARTS: [[u8; 2]; 3] = [[0x25, 0x03], [0x05, 0x09], [0x26, 0x03]];
/// Write protection in the status register: pin enable and both block bits.
const PROTECTION: u8 = 0x8C;

/// What a read or write of the FRAM met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FramFault {
    /// The part.
    Chip(Fault),
    /// An address behind its end, or an erase of less than a page.
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

/// The driver of an FRAM behind SPI device `S`.
///
/// All bytes travel through a buffer in this struct, so that it lies where its owner puts it: a board whose
/// DMA cannot reach every memory places the driver, not the stack.
pub struct Fram<S> {
    spi: S,
    buffer: [u8; HEAD + CHUNK],
    ready: bool,
}

impl<S: SpiDevice> Fram<S> {
    /// A driver; nothing happens on the bus before [`Fram::init`] or the first access.
    pub const fn new(spi: S) -> Self {
        Self {
            spi,
            buffer: [0; HEAD + CHUNK],
            ready: false,
        }
    }

    /// Checks the identity and takes off write protection. Every access does so until it has succeeded once.
    ///
    /// # Errors
    /// [`Fault::Identity`] when another chip answers or none, [`Fault::Configuration`] when the protection stays,
    /// [`Fault::Bus`].
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

    /// One transaction; gives what came back.
    async fn exchange<const N: usize>(&mut self, bytes: [u8; N]) -> Result<[u8; N], Fault> {
        let transfer = self.buffer.first_chunk_mut::<N>().ok_or(Fault::Bus)?;
        *transfer = bytes;
        self.spi
            .transfer_in_place(transfer)
            .await
            .map_err(|_| Fault::Bus)?;
        Ok(*transfer)
    }

    /// Writes at most [`CHUNK`] bytes.
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

/// Sees that an identity is that of a part with which this driver works.
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

/// The part of `buffer` for a transfer of `length` data bytes, with opcode and address at its start.
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
