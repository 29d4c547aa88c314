//! The guard against damaged flash words of an H7: `boards/src/stm32/flash_ecc.rs`. Power loss during a save leaves an
//! uncorrectable word, whose reading is a bus fault at every later start; without the guard an image flies until then.

use crate::Error;
use crate::boards::Board;
use crate::image::Image;

/// In its mangled name; never inlined.
const GUARD: [&str; 2] = ["flash_ecc", "begin_guard"];

/// Whether the image needs the guard.
///
/// # Errors
/// It needs the guard and has none.
pub fn check(board: &Board, image: &Image) -> Result<bool, Error> {
    let in_flash = image.symbols.contains_key("_params_start");
    if !(in_flash && board.probe_rs_chip.starts_with("STM32H7")) {
        return Ok(false);
    }
    if image
        .symbols
        .keys()
        .any(|name| GUARD.iter().all(|part| name.contains(part)))
    {
        return Ok(true);
    }
    Err(format!(
        "{} ({}) reads its parameters without the guard against damaged flash (boards/src/stm32/flash_ecc.rs): a word that \
         power failed in would end every start",
        board.name, board.probe_rs_chip
    )
    .into())
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::boards::BOARDS;

    fn image(symbols: &[&str]) -> Image {
        Image {
            symbols: symbols
                .iter()
                .map(|name| (name.to_string(), 0))
                .collect::<HashMap<_, _>>(),
            ..Image::default()
        }
    }

    #[test]
    fn an_h7_that_stores_in_flash_is_refused_without_the_guard() {
        let guard = "_ZN13sophie_boards5stm329flash_ecc11begin_guard17h0123456789abcdefE";
        for board in &BOARDS {
            let h7 = board.name == "matek-h743";
            assert_eq!(
                check(board, &image(&["_params_start"])).is_err(),
                h7,
                "{}",
                board.name
            );
            assert_eq!(
                check(board, &image(&["_params_start", guard])).unwrap(),
                h7,
                "{}",
                board.name
            );
            assert!(!check(board, &image(&["main"])).unwrap(), "{}", board.name);
        }
    }
}
