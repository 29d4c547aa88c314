//! What outlives a reset: in memory that keeps it, and that neither the loading of the image nor start-up touches.

use crate::Error;
use crate::boards::Board;
use crate::image::Image;

/// Name of its section.
const SECTION: &str = ".retained";

/// Checks where it lies; returns its bytes.
///
/// # Errors
/// There is none, it lies elsewhere, or flashing would write it.
pub fn check(board: &Board, image: &Image) -> Result<u64, Error> {
    let section = image.sections.iter().find(|section| section.name == SECTION);
    let section = section.ok_or("the image has nothing that outlives a reset")?;
    let (start, end) = board.retained;
    let (first, beyond) = (section.address, section.address + section.size);
    if first < start || beyond > end {
        return Err(format!(
            "what outlives a reset lies at {first:#010x} to {beyond:#010x}, {} keeps {start:#010x} to {end:#010x}",
            board.name
        )
        .into());
    }
    if section.in_image {
        return Err("what outlives a reset has contents in the image".into());
    }
    // Start-up clears .bss and fills .data.
    for symbol in ["__sbss", "__ebss", "__sdata", "__edata"] {
        let at = image.symbol(symbol)?;
        if (first + 1..beyond).contains(&at) {
            return Err(format!("start-up writes what outlives a reset: `{symbol}` is {at:#010x}").into());
        }
    }
    Ok(section.size)
}
