//! Parameters in flash as the console's `save` writes them, made by the firmware's own code.

use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use sophie_control::params::Params;
use sophie_drivers::param_store::ParamStore;
use sophie_ports::storage::Storage;

use crate::board_kind::Kind;

/// Erased flash with words of `WORD` bytes and sectors of `SECTOR`.
struct Sectors<const WORD: usize, const SECTOR: usize>(Vec<u8>);

impl<const WORD: usize, const SECTOR: usize> ErrorType for Sectors<WORD, SECTOR> {
    type Error = NorFlashErrorKind;
}

impl<const WORD: usize, const SECTOR: usize> Sectors<WORD, SECTOR> {
    fn part(&mut self, offset: u32, length: usize) -> Result<&mut [u8], NorFlashErrorKind> {
        let start = offset as usize;
        self.0
            .get_mut(start..start + length)
            .ok_or(NorFlashErrorKind::OutOfBounds)
    }
}

impl<const WORD: usize, const SECTOR: usize> ReadNorFlash for Sectors<WORD, SECTOR> {
    const READ_SIZE: usize = 1;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        bytes.copy_from_slice(self.part(offset, bytes.len())?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.0.len()
    }
}

impl<const WORD: usize, const SECTOR: usize> NorFlash for Sectors<WORD, SECTOR> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = SECTOR;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.part(from, (to - from) as usize)?.fill(0xFF);
        Ok(())
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        self.part(offset, bytes.len())?.copy_from_slice(bytes);
        Ok(())
    }
}

/// The `length` bytes of a board's parameter sectors after a save of `params`.
///
/// # Errors
/// One line: they do not fit.
pub fn sectors(board: Kind, length: usize, params: &Params) -> Result<Vec<u8>, String> {
    match board {
        Kind::MatekH743 => saved::<32, 0x2_0000>(length, params),
        Kind::F405 => saved::<4, 0x4000>(length, params),
    }
}

fn saved<const WORD: usize, const SECTOR: usize>(length: usize, params: &Params) -> Result<Vec<u8>, String> {
    let mut store = ParamStore::new(
        Sectors::<WORD, SECTOR>(vec![0xFF; length]),
        0..u32::try_from(length).unwrap_or(0),
    );
    block_on(store.save(params))
        .map_err(|e| format!("the parameters cannot be stored in {length} bytes: {e:?}"))?;
    Ok(store.release().0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loaded<const WORD: usize, const SECTOR: usize>(bytes: Vec<u8>) -> Params {
        let all = 0..bytes.len() as u32;
        let mut params = Params::default();
        block_on(ParamStore::new(Sectors::<WORD, SECTOR>(bytes), all).load(&mut params));
        params
    }

    #[test]
    fn saved_parameters_are_loaded() {
        let params = Params {
            rate_pitch_p: 11.0,
            ..Params::default()
        };
        let bytes = sectors(Kind::MatekH743, 0x4_0000, &params).unwrap();
        assert_eq!(loaded::<32, 0x2_0000>(bytes), params);
        let bytes = sectors(Kind::F405, 0x8000, &params).unwrap();
        assert_eq!(loaded::<4, 0x4000>(bytes), params);
        assert!(sectors(Kind::F405, 100, &params).is_err());
    }
}
