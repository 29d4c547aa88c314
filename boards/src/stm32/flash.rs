//! The chip's flash for parameters, placed by the memory map (`_params_start`, `_params_end`).
//!
//! Erasing and writing block for up to a few seconds: on the H7, running from its other bank, only the background, on
//! the F4 everything. A restart follows.

use embassy_stm32::Peri;
use embassy_stm32::flash::{Blocking, Error, FLASH_BASE, Flash, WRITE_SIZE};
use embassy_stm32::peripherals::FLASH;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};

#[cfg(family = "h7")]
use super::flash_ecc as ecc;

/// Parameter flash in sectors of `SECTOR` bytes.
pub struct ParamFlash<const SECTOR: usize> {
    flash: Flash<'static, Blocking>,
    /// Offset in the flash.
    start: u32,
    length: u32,
}

impl<const SECTOR: usize> ParamFlash<SECTOR> {
    /// The sectors of the memory map.
    pub fn new(flash: Peri<'static, FLASH>) -> Self {
        unsafe extern "C" {
            static _params_start: u8;
            static _params_end: u8;
        }
        let (start, end) = (&raw const _params_start as u32, &raw const _params_end as u32);
        Self {
            flash: Flash::new_blocking(flash),
            start: start - FLASH_BASE as u32,
            length: end - start,
        }
    }

    fn place(&self, offset: u32, length: usize) -> Result<u32, NorFlashErrorKind> {
        u32::try_from(length)
            .ok()
            .and_then(|length| offset.checked_add(length))
            .filter(|&end| end <= self.length)
            .map(|_| self.start + offset)
            .ok_or(NorFlashErrorKind::OutOfBounds)
    }
}

/// Runs `change`, which writes or erases `length` bytes at `place`; no cache keeps old data.
#[cfg(family = "f4")]
fn uncached<T>(_place: u32, _length: usize, change: impl FnOnce() -> T) -> T {
    super::accelerator::uncached(change)
}

/// As on the F4.
#[cfg(not(family = "f4"))]
fn uncached<T>(place: u32, length: usize, change: impl FnOnce() -> T) -> T {
    let result = change();
    crate::cortex_m::forget_cached(FLASH_BASE + place as usize, length);
    result
}

fn kind(error: Error) -> NorFlashErrorKind {
    match error {
        Error::Size => NorFlashErrorKind::OutOfBounds,
        Error::Unaligned => NorFlashErrorKind::NotAligned,
        _ => NorFlashErrorKind::Other,
    }
}

impl<const SECTOR: usize> ErrorType for ParamFlash<SECTOR> {
    type Error = NorFlashErrorKind;
}

impl<const SECTOR: usize> ReadNorFlash for ParamFlash<SECTOR> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let place = self.place(offset, bytes.len())?;
        let read = || self.flash.blocking_read(place, bytes);
        #[cfg(family = "h7")]
        let done = ecc::read(read).ok_or(NorFlashErrorKind::Other)?;
        #[cfg(not(family = "h7"))]
        let done = { read }();
        done.map_err(kind)
    }

    fn capacity(&self) -> usize {
        self.length as usize
    }
}

impl<const SECTOR: usize> NorFlash for ParamFlash<SECTOR> {
    const WRITE_SIZE: usize = WRITE_SIZE;
    const ERASE_SIZE: usize = SECTOR;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        let length = to.checked_sub(from).ok_or(NorFlashErrorKind::OutOfBounds)?;
        let place = self.place(from, length as usize)?;
        #[cfg(family = "h7")]
        ecc::forget_errors();
        uncached(place, length as usize, || {
            self.flash.blocking_erase(place, place + length)
        })
        .map_err(kind)
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let place = self.place(offset, bytes.len())?;
        #[cfg(family = "h7")]
        ecc::forget_errors();
        uncached(place, bytes.len(), || self.flash.blocking_write(place, bytes)).map_err(kind)
    }
}
