//! What a board's firmware takes of flash and RAM, against limits and ceilings.

use std::collections::BTreeMap;
use std::fs;

use serde::{Deserialize, Serialize};

use crate::boards::Board;
use crate::image::Image;
use crate::{Error, build};

/// Most flash on any board, bytes.
const FLASH_LIMIT: u64 = 256 * 1024;
/// Most static RAM on any board, bytes.
const RAM_LIMIT: u64 = 64 * 1024;

/// Sizes of one image, bytes.
pub struct Sizes {
    /// Code, constants and initial values.
    pub flash: u64,
    /// Statics, the futures of the tasks among them.
    pub ram: u64,
    /// Memory set aside for the stack.
    pub stack: u64,
}

impl Sizes {
    /// Sizes of `image`.
    ///
    /// # Errors
    /// The image does not say where its stack lies.
    pub fn of(image: &Image) -> Result<Self, Error> {
        let sum = |what: fn(&crate::image::Section) -> bool| {
            image.sections.iter().filter(|s| what(s)).map(|s| s.size).sum()
        };
        Ok(Self {
            flash: sum(|s| s.in_image),
            // Initial values count twice: they lie in flash and are copied.
            ram: sum(|s| s.writable || !s.in_image),
            stack: image.symbol("_stack_start")? - image.symbol("_stack_end")?,
        })
    }
}

/// The ceilings of one board.
#[derive(Clone, Copy, Deserialize, Serialize)]
struct Ceiling {
    flash: u64,
    ram: u64,
}

/// Prints the sizes as a table.
pub fn table(rows: &[(&Board, Sizes)]) {
    println!("| board | flash, bytes | static RAM, bytes | stack, bytes |");
    println!("|---|---:|---:|---:|");
    for (board, s) in rows {
        println!("| {} | {} | {} | {} |", board.name, s.flash, s.ram, s.stack);
    }
    println!("| limit | {FLASH_LIMIT} | {RAM_LIMIT} | |");
}

/// Compares with the limits and with `xtask/ceilings.toml`; lowers those if `tighten`.
///
/// # Errors
/// What is too large, each on its line.
pub fn compare(rows: &[(&Board, Sizes)], tighten: bool) -> Result<(), Error> {
    let path = build::root().join("xtask/ceilings.toml");
    let mut ceilings: BTreeMap<String, Ceiling> = toml::from_str(&fs::read_to_string(&path)?)?;
    let mut complaints = Vec::new();
    for (board, size) in rows {
        let limit = Ceiling {
            flash: FLASH_LIMIT,
            ram: RAM_LIMIT,
        };
        let ceiling = ceilings.entry(board.name.into()).or_insert(limit);
        if tighten {
            *ceiling = Ceiling {
                flash: ceiling.flash.min(rounded(size.flash)),
                ram: ceiling.ram.min(rounded(size.ram)),
            };
        }
        for (what, size, ceiling, limit) in [
            ("flash", size.flash, ceiling.flash, limit.flash),
            ("static RAM", size.ram, ceiling.ram, limit.ram),
        ] {
            if size > ceiling.min(limit) {
                complaints.push(format!(
                    "{}: {what} {size} bytes, ceiling {}",
                    board.name,
                    ceiling.min(limit)
                ));
            }
        }
    }
    if tighten {
        let head = "# Most that a board's firmware may take, bytes. `cargo xtask sizes` compares; `--tighten` lowers.\n";
        fs::write(&path, format!("{head}\n{}", toml::to_string(&ceilings)?))?;
    }
    if complaints.is_empty() {
        Ok(())
    } else {
        Err(complaints.join("\n").into())
    }
}

/// A few per cent of room, in whole KiB: compilers differ.
fn rounded(size: u64) -> u64 {
    (size + size / 32).next_multiple_of(1024)
}
