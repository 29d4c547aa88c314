//! The vector table: what the core reads before the first instruction, and what it jumps to ever after.

use crate::Error;
use crate::boards::Board;
use crate::image::Image;

/// Words of the table before the first interrupt: stack pointer and fifteen exceptions.
const EXCEPTIONS: usize = 16;

/// Checks the table; returns how many of its interrupts have a handler of their own.
///
/// # Errors
/// What is wrong with it.
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
        // 0 marks what the architecture or the chip reserves.
        if vector != 0 && (vector & 1 == 0 || !code.contains(&u64::from(vector))) {
            return Err(format!("vector {number} is {vector:#010x}: no code").into());
        }
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

fn expect(what: &str, found: Option<&u32>, expected: u64) -> Result<(), Error> {
    match found {
        Some(&found) if u64::from(found) == expected => Ok(()),
        Some(found) => Err(format!("{what}: {found:#010x} instead of {expected:#010x}").into()),
        None => Err(format!("{what}: missing").into()),
    }
}
