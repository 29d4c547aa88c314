//! NOR flash in memory: bits change only from 1 to 0, pages are erased whole, power can fail within a step.

use std::cell::RefCell;
use std::rc::Rc;

use embedded_storage_async::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// Contents and history of the flash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cells {
    /// Contents.
    pub bytes: Vec<u8>,
    /// Words written since their erase: a 32-byte word with its checksum takes one write.
    written: Vec<bool>,
    /// Words written plus pages erased.
    pub steps: usize,
    /// Pages erased.
    pub erases: usize,
    /// Reads so far.
    pub reads: usize,
    /// The step within which power is cut.
    pub cut_at: Option<usize>,
    /// Power is off.
    pub dead: bool,
    /// Bits stuck at 1.
    pub stuck: Option<usize>,
    /// Violations of the flash's rules.
    pub violations: Vec<String>,
}

/// Flash with words of `WRITE` and pages of `PAGE` bytes.
#[derive(Clone)]
pub struct Flash<const WRITE: usize, const PAGE: usize>(pub Rc<RefCell<Cells>>);

/// Power cut or forbidden access.
#[derive(Debug, PartialEq, Eq)]
pub struct FlashError;

impl NorFlashError for FlashError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl<const WRITE: usize, const PAGE: usize> Flash<WRITE, PAGE> {
    /// An erased flash of this many pages.
    pub fn blank(pages: usize) -> Self {
        Self::holding(vec![0xFF; pages * PAGE])
    }

    /// A flash with these contents.
    pub fn holding(bytes: Vec<u8>) -> Self {
        let written = bytes
            .chunks(WRITE)
            .map(|word| word.iter().any(|b| *b != 0xFF))
            .collect();
        Self(Rc::new(RefCell::new(Cells {
            bytes,
            written,
            steps: 0,
            erases: 0,
            reads: 0,
            cut_at: None,
            dead: false,
            stuck: None,
            violations: Vec::new(),
        })))
    }

    /// A powered copy with the same contents.
    pub fn copy(&self) -> Self {
        let cells = Cells {
            cut_at: None,
            dead: false,
            ..self.0.borrow().clone()
        };
        Self(Rc::new(RefCell::new(cells)))
    }

    /// The whole address range.
    pub fn range(&self) -> std::ops::Range<u32> {
        0..self.0.borrow().bytes.len() as u32
    }
}

impl<const WRITE: usize, const PAGE: usize> ErrorType for Flash<WRITE, PAGE> {
    type Error = FlashError;
}

impl<const WRITE: usize, const PAGE: usize> ReadNorFlash for Flash<WRITE, PAGE> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashError> {
        let mut cells = self.0.borrow_mut();
        cells.reads += 1;
        if cells.dead {
            return Err(FlashError);
        }
        let start = offset as usize;
        bytes.copy_from_slice(&cells.bytes[start..start + bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.borrow().bytes.len()
    }
}

impl<const WRITE: usize, const PAGE: usize> NorFlash for Flash<WRITE, PAGE> {
    const WRITE_SIZE: usize = WRITE;
    const ERASE_SIZE: usize = PAGE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashError> {
        let mut cells = self.0.borrow_mut();
        let (from, to) = (from as usize, to as usize);
        assert!(from.is_multiple_of(PAGE) && to.is_multiple_of(PAGE) && to <= cells.bytes.len());
        for page in (from..to).step_by(PAGE) {
            let cut = cells.cut_at == Some(cells.steps);
            if cells.dead {
                return Err(FlashError);
            }
            cells.steps += 1;
            cells.erases += 1;
            let end = if cut { page + PAGE / 2 } else { page + PAGE };
            cells.bytes[page..end].fill(0xFF);
            cells.written[page / WRITE..end / WRITE].fill(false);
            if cut {
                cells.dead = true;
                return Err(FlashError);
            }
        }
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashError> {
        let mut cells = self.0.borrow_mut();
        let start = offset as usize;
        assert!(start.is_multiple_of(WRITE) && bytes.len().is_multiple_of(WRITE));
        for (i, word) in bytes.chunks(WRITE).enumerate() {
            if cells.dead {
                return Err(FlashError);
            }
            let at = start + i * WRITE;
            // A cut write programs half of the bits.
            let cut = cells.cut_at == Some(cells.steps);
            cells.steps += 1;
            if WRITE > 8 && cells.written[at / WRITE] {
                cells.violations.push(format!("word {at} written twice"));
            }
            cells.written[at / WRITE] = true;
            let stuck = cells.stuck;
            for (k, byte) in word.iter().enumerate() {
                let keep = if cut { 0x0F } else { 0x00 };
                let keep = if stuck == Some(at + k) { 0xFF } else { keep };
                cells.bytes[at + k] &= byte | keep;
            }
            if cut {
                cells.dead = true;
                return Err(FlashError);
            }
        }
        Ok(())
    }
}
