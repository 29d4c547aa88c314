//! Read-only view of flash.

use core::ops::Range;

use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// Reads before the contents count as noise: five times a full log's.
const READS_MAX: u16 = 20_000;
/// Zero bits of a set page mark (the map's rule).
const MARKED: u32 = 4;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Refused {
    /// Flash error.
    Flash,
    /// A write, or one read too many.
    NotAllowed,
}

impl NorFlashError for Refused {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

/// Lets the map read; erases happen in this view only.
pub(super) struct ReadOnly<'a, F> {
    flash: &'a mut F,
    range: Range<u32>,
    /// Erased pages, one bit each.
    erased: u32,
    reads: u16,
    end: u32,
}

impl<'a, F: NorFlash> ReadOnly<'a, F> {
    const PAGE: u32 = F::ERASE_SIZE as u32;
    const WORD: u32 = if F::WRITE_SIZE > F::READ_SIZE {
        F::WRITE_SIZE
    } else {
        F::READ_SIZE
    } as u32;

    pub(super) const fn new(flash: &'a mut F, range: Range<u32>) -> Self {
        Self {
            flash,
            range,
            erased: 0,
            reads: 0,
            end: 0,
        }
    }

    /// True if the range is blank, erased pages included.
    pub(super) async fn blank(&mut self, buffer: &mut [u8]) -> Result<bool, Refused> {
        self.erased = 0;
        self.all_ones(self.range.clone(), buffer).await
    }

    /// True if nothing is written behind the item read last, the newest valid one; data there are a newer, damaged
    /// item.
    pub(super) async fn blank_behind_last_read(&mut self, buffer: &mut [u8]) -> Result<bool, Refused> {
        let (end, start) = (self.end, self.range.start);
        let page = start + end.saturating_sub(start + 1) / Self::PAGE * Self::PAGE;
        if !self.all_ones(end..page + Self::PAGE - Self::WORD, buffer).await? {
            return Ok(false);
        }
        let next = if page + Self::PAGE < self.range.end {
            page + Self::PAGE
        } else {
            start
        };
        // A closed page is old, an unmarked one erased before use.
        let in_use =
            self.marked(next).await? && !self.marked(next + Self::PAGE - F::READ_SIZE as u32).await?;
        let inside = next + Self::WORD..next + Self::PAGE - Self::WORD;
        Ok(!in_use || self.all_ones(inside, buffer).await?)
    }

    async fn marked(&mut self, at: u32) -> Result<bool, Refused> {
        let mut mark = [0xFF; 32];
        let mark = mark.get_mut(..F::READ_SIZE).ok_or(Refused::NotAllowed)?;
        self.read(at, mark).await?;
        Ok(mark.iter().map(|byte| byte.count_zeros()).sum::<u32>() >= MARKED)
    }

    async fn all_ones(&mut self, range: Range<u32>, buffer: &mut [u8]) -> Result<bool, Refused> {
        let step = buffer.len() as u32;
        for at in range.clone().step_by(buffer.len()) {
            let length = step.min(range.end - at) as usize;
            let chunk = buffer.get_mut(..length).ok_or(Refused::NotAllowed)?;
            self.read(at, chunk).await?;
            if chunk.iter().any(|&byte| byte != 0xFF) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    const fn bit(&self, at: u32) -> Option<u32> {
        1u32.checked_shl(at.saturating_sub(self.range.start) / Self::PAGE)
    }
}

impl<F: NorFlash> ErrorType for ReadOnly<'_, F> {
    type Error = Refused;
}

impl<F: NorFlash> ReadNorFlash for ReadOnly<'_, F> {
    const READ_SIZE: usize = F::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Refused> {
        self.reads = self.reads.saturating_add(1);
        if self.reads > READS_MAX {
            return Err(Refused::NotAllowed);
        }
        self.flash.read(offset, bytes).await.map_err(|_| Refused::Flash)?;
        self.end = offset.saturating_add(bytes.len() as u32);
        if self.bit(offset).is_some_and(|bit| self.erased & bit != 0) {
            bytes.fill(0xFF);
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.flash.capacity()
    }
}

impl<F: NorFlash> NorFlash for ReadOnly<'_, F> {
    const WRITE_SIZE: usize = F::WRITE_SIZE;
    const ERASE_SIZE: usize = F::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Refused> {
        for page in (from..to).step_by(F::ERASE_SIZE) {
            self.erased |= self.bit(page).ok_or(Refused::NotAllowed)?;
        }
        Ok(())
    }

    async fn write(&mut self, _offset: u32, _bytes: &[u8]) -> Result<(), Refused> {
        Err(Refused::NotAllowed)
    }
}
