//! Checks the vector table.

use crate::Error;
use crate::boards::Board;
use crate::image::Image;

/// Stack pointer and fifteen exceptions, words.
const EXCEPTIONS: usize = 16;

/// Vector table offset register (ARMv7-M, B3.2.5).
const VTOR: u32 = 0xE000_ED08;
/// Bytes of start-up within which it must be written: before any possible exception.
const AT_ONCE: u64 = 16;

/// Returns how many interrupts have their own handler.
///
/// # Errors
/// The table's fault.
pub fn check(board: &Board, image: &Image) -> Result<usize, Error> {
    let table = &image.vectors;
    if table.len() != EXCEPTIONS + board.interrupts {
        let (found, expected) = (table.len(), EXCEPTIONS + board.interrupts);
        return Err(format!(
            "the vector table has {found} entries, {} has {expected}",
            board.name
        )
        .into());
    }
    expect(
        "initial stack pointer",
        table.first(),
        image.symbol("_stack_start")? & !7,
    )?;
    expect("reset vector", table.get(1), image.symbol("Reset")? | 1)?;
    expect(
        "entry point",
        u32::try_from(image.entry).ok().as_ref(),
        image.symbol("Reset")? | 1,
    )?;
    expect("hard fault", table.get(3), image.symbol("HardFault")? | 1)?;

    let text = image
        .sections
        .iter()
        .find(|s| s.name == ".text")
        .ok_or("the image has no code")?;
    let code = text.address..text.address + text.size;
    for (number, &vector) in table.iter().enumerate().skip(1) {
        // 0 marks reserved vectors.
        if vector != 0 && (vector & 1 == 0 || !code.contains(&u64::from(vector))) {
            return Err(format!("vector {number} is {vector:#010x}: no code").into());
        }
    }

    if !takes_its_own(image)? {
        return Err(
            "start-up does not take the image's vector table (feature `set-vtor` of cortex-m-rt): left by the chip's USB \
             loader, it would go on with the loader's"
                .into(),
        );
    }

    let default = image.symbol("DefaultHandler")? as u32 | 1;
    let interrupts = table.get(EXCEPTIONS..).unwrap_or_default();
    for level in board.levels {
        let handler = image.symbol(level)? as u32 | 1;
        if handler == default || !interrupts.contains(&handler) {
            return Err(format!("the level on {level} has no vector").into());
        }
    }
    Ok(interrupts.iter().filter(|&&v| v != 0 && v != default).count())
}

/// Whether start-up begins with a store of the table's address to [`VTOR`]: `ldr rA, =VTOR; ldr rB, =table; str rB,
/// [rA]`.
fn takes_its_own(image: &Image) -> Result<bool, Error> {
    let reset = image.symbol("Reset")? & !1;
    let table = image.symbol("__vector_table")? as u32;
    let half = |at: u64| {
        let word = image.word(at & !3)?;
        Some(if at & 2 == 0 { word & 0xFFFF } else { word >> 16 })
    };
    // Register and word of a PC-relative load (encoding T1, ARMv7-M A7.7.44).
    let load = |at: u64| {
        let code = half(at).filter(|code| code >> 11 == 0b01001)?;
        let word = image.word(((at + 4) & !3) + 4 * u64::from(code & 0xFF))?;
        Some((code >> 8 & 7, word))
    };
    // Stored register and address register (encoding T1 without offset, A7.7.161).
    let store =
        |at: u64| Some(half(at).filter(|code| code >> 6 == 0b01_1000_0000)?).map(|c| (c & 7, c >> 3 & 7));
    let found = (reset..reset + AT_ONCE).step_by(2).any(|at| {
        let (Some(first), Some(second), Some((value, address))) = (load(at), load(at + 2), store(at + 4))
        else {
            return false;
        };
        first == (address, VTOR) && second == (value, table)
    });
    Ok(found)
}

fn expect(what: &str, found: Option<&u32>, expected: u64) -> Result<(), Error> {
    match found {
        Some(&found) if u64::from(found) == expected => Ok(()),
        Some(found) => Err(format!("{what}: {found:#010x} instead of {expected:#010x}").into()),
        None => Err(format!("{what}: missing").into()),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::image::Load;

    /// Starts with `code` at 0x0800_0102, followed by its words.
    fn starting_with(code: &[u16], words: &[u32]) -> Image {
        let halves = code.iter().flat_map(|half| half.to_le_bytes());
        let bytes = [0; 2].into_iter().chain(halves);
        let bytes = bytes
            .chain(words.iter().flat_map(|word| word.to_le_bytes()))
            .collect();
        let address = 0x0800_0100;
        Image {
            loads: vec![Load { address, bytes }],
            symbols: HashMap::from([
                ("Reset".to_string(), 0x0800_0103),
                ("__vector_table".to_string(), 0x0800_0000),
            ]),
            ..Image::default()
        }
    }

    #[test]
    fn start_up_that_leaves_the_table_of_another_is_found() {
        // ldr r0, [pc, #8]; ldr r1, [pc, #8]; str r1, [r0]; nop; nop; words from 0x0800_010C on.
        let code = [0x4802, 0x4902, 0x6001, 0xBF00, 0xBF00];
        let own = [VTOR, 0x0800_0000];
        assert!(takes_its_own(&starting_with(&code, &own)).unwrap());
        assert!(!takes_its_own(&starting_with(&code, &[VTOR, 0x1FFF_0000])).unwrap());
        assert!(!takes_its_own(&starting_with(&code, &[0xE000_ED88, 0x0800_0000])).unwrap());
        // Stored in reverse, loaded and not stored, neither.
        for code in [
            [0x4802, 0x4902, 0x6008, 0xBF00, 0xBF00],
            [0x4802, 0x4902, 0xBF00, 0xBF00, 0xBF00],
            [0xBF00; 5],
        ] {
            assert!(!takes_its_own(&starting_with(&code, &own)).unwrap(), "{code:x?}");
        }
    }
}
