//! Flash and RAM of firmware against limits and ceilings.

use std::collections::BTreeMap;
use std::fs;

use serde::{Deserialize, Serialize};

use crate::boards::{Bank, Board};
use crate::image::Image;
use crate::{Error, build};

/// Of any board, bytes: half of the smallest chip's flash, the F405's 1 MiB.
const FLASH_LIMIT: u64 = 512 * 1024;
/// The stack may be used up to this share, parts of its size, as the firmware warns (`ports/src/stack_use.rs`).
const STACK_LIMIT: [u64; 2] = [3, 4];

/// With the ceilings, between two marks.
const PAGE: &str = "docs/boards.md";
const BEGIN: &str = "<!-- sizes: written by `cargo xtask sizes --tighten` -->";
const END: &str = "<!-- sizes end -->";

/// Sizes of an image, bytes.
#[derive(Default)]
pub struct Sizes {
    /// Code, constants and initial values.
    pub flash: u64,
    /// Statics, including the tasks' futures.
    pub ram: u64,
    /// Memory available to the statics.
    pub ram_limit: u64,
    pub stack: u64,
    /// Depth of the USB handlers, which the bench's flights do not reach.
    pub usb: u64,
}

impl Sizes {
    /// Sizes of `image`.
    ///
    /// # Errors
    /// It does not define its stack, its statics lie in no memory of the board, or its USB handlers are not found.
    pub fn of(board: &Board, image: &Image) -> Result<Self, Error> {
        let sum = |what: fn(&crate::image::Section) -> bool| {
            image.sections.iter().filter(|s| what(s)).map(|s| s.size).sum()
        };
        Ok(Self {
            flash: sum(|s| s.in_image),
            // Initial values count twice: in flash and copied.
            ram: sum(|s| s.writable || !s.in_image),
            ram_limit: ram_limit(board, image)?,
            stack: stack(image)?,
            usb: crate::stack::usb(image)?,
        })
    }
}

/// Size of the stack, bytes.
///
/// # Errors
/// `image` does not define it.
pub fn stack(image: &Image) -> Result<u64, Error> {
    Ok(image.symbol("_stack_start")? - image.symbol("_stack_end")?)
}

/// Size of the memory of the statics, less the stack if both share it.
fn ram_limit(board: &Board, image: &Image) -> Result<u64, Error> {
    let (statics, end, start) = (
        image.symbol("__sbss")?,
        image.symbol("_stack_end")?,
        image.symbol("_stack_start")?,
    );
    let within = |bank: &&Bank| (bank.start..bank.end).contains(&statics);
    let bank = board.banks.iter().find(within);
    let bank = bank.ok_or_else(|| format!("{}: no memory at {statics:#010x}", board.name))?;
    let stack = if (bank.start..bank.end).contains(&end) {
        start - end
    } else {
        0
    };
    Ok(bank.end - bank.start - stack)
}

#[derive(Clone, Copy, Deserialize, Serialize)]
struct Ceiling {
    flash: u64,
    ram: u64,
    /// Most of the stack that the bench's flights may use: measured there, and not lowered by a build.
    stack: u64,
    /// Most that USB's handlers may add.
    usb: u64,
}

pub fn print(rows: &[(&Board, Sizes)]) {
    println!("bytes of flash (of {FLASH_LIMIT}), static RAM, stack, and of the stack by USB's handlers");
    println!("| board | flash | RAM | of | stack | USB |");
    println!("|---|---:|---:|---:|---:|---:|");
    for (board, s) in rows {
        let Sizes {
            flash,
            ram,
            ram_limit,
            stack,
            usb,
        } = s;
        println!(
            "| {} | {flash} | {ram} | {ram_limit} | {stack} | {usb} |",
            board.name
        );
    }
}

/// Compares sizes with limits and `xtask/ceilings.toml`, and that with its table in `docs/boards.md`; `tighten` lowers
/// the ceilings and writes the table.
///
/// # Errors
/// Each size above its limit and each outdated entry, one per line.
pub fn compare(rows: &[(&Board, Sizes)], tighten: bool) -> Result<(), Error> {
    let path = build::root().join("xtask/ceilings.toml");
    let text = fs::read_to_string(&path)?;
    let mut ceilings: BTreeMap<String, Ceiling> = toml::from_str(&text)?;
    let mut complaints = Vec::new();
    for (board, size) in rows {
        let [share, parts] = STACK_LIMIT;
        let limit = Ceiling {
            flash: FLASH_LIMIT,
            ram: size.ram_limit,
            stack: size.stack / parts * share,
            usb: size.stack / parts * share,
        };
        let ceiling = ceilings.entry(board.name.into()).or_insert(limit);
        if tighten {
            ceiling.flash = ceiling.flash.min(rounded(size.flash));
            ceiling.ram = ceiling.ram.min(rounded(size.ram));
            ceiling.usb = ceiling.usb.min(rounded(size.usb));
        }
        for (what, size, ceiling, limit) in [
            ("flash", size.flash, ceiling.flash, limit.flash),
            ("static RAM", size.ram, ceiling.ram, limit.ram),
            ("stack of USB's handlers", size.usb, ceiling.usb, limit.usb),
            (
                "stack of the bench's flights with USB's handlers",
                ceiling.stack + ceiling.usb,
                limit.stack,
                limit.stack,
            ),
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
    let page_path = build::root().join(PAGE);
    let page = fs::read_to_string(&page_path)?;
    let sizes: Vec<_> = rows.iter().map(|(board, sizes)| (board.name, sizes)).collect();
    let updated = with_table(&page, &ceilings, &sizes)?;
    if tighten {
        // Keeps the comment above the ceilings.
        let head: String = text
            .lines()
            .take_while(|line| line.starts_with('#'))
            .map(|line| format!("{line}\n"))
            .collect();
        fs::write(&path, format!("{head}\n{}", toml::to_string(&ceilings)?))?;
        fs::write(&page_path, updated)?;
    } else if updated != page {
        complaints.push(format!(
            "{PAGE}: its table is not that of xtask/ceilings.toml; `cargo xtask sizes --tighten` writes it"
        ));
    }
    if complaints.is_empty() {
        Ok(())
    } else {
        Err(complaints.join("\n").into())
    }
}

fn with_table(
    page: &str,
    ceilings: &BTreeMap<String, Ceiling>,
    sizes: &[(&str, &Sizes)],
) -> Result<String, Error> {
    let (head, rest) = page
        .split_once(BEGIN)
        .ok_or_else(|| format!("{PAGE} has no `{BEGIN}`"))?;
    let (_, tail) = rest
        .split_once(END)
        .ok_or_else(|| format!("{PAGE} has no `{END}`"))?;
    let mut table = String::from(
        "\n| board | flash, KiB | static RAM, KiB | stack in use, KiB | and by USB | limit of static RAM | of the stack in use \
         |\n|---|---:|---:|---:|---:|---:|---:|\n",
    );
    for &(name, sizes) in sizes {
        let ceiling = ceilings.get(name).ok_or("a board without ceiling")?;
        let [share, parts] = STACK_LIMIT;
        table += &format!(
            "{} {} | {} of {} |\n",
            row(name, ceiling),
            sizes.ram_limit / 1024,
            sizes.stack / parts * share / 1024,
            sizes.stack / 1024,
        );
    }
    table += &format!("| limit | {} | | | | | |\n", FLASH_LIMIT / 1024);
    Ok(format!("{head}{BEGIN}{table}{END}{tail}"))
}

/// Table row, without the columns that need an image.
fn row(name: &str, ceiling: &Ceiling) -> String {
    let &Ceiling {
        flash,
        ram,
        stack,
        usb,
    } = ceiling;
    let [flash, ram, stack, usb] = [flash, ram, stack, usb].map(|bytes| bytes / 1024);
    format!("| `{name}` | {flash} | {ram} | {stack} | {usb} |")
}

/// A margin of a few per cent, in whole KiB: compilers differ.
fn rounded(size: u64) -> u64 {
    (size + size / 32).next_multiple_of(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_shows_the_ceilings_that_are_compared_with() {
        let read = |name| fs::read_to_string(build::root().join(name)).unwrap();
        let ceilings: BTreeMap<String, Ceiling> = toml::from_str(&read("xtask/ceilings.toml")).unwrap();
        let page = read(PAGE);
        for (name, ceiling) in &ceilings {
            let row = row(name, ceiling);
            assert!(
                page.contains(&row),
                "{PAGE}: no row `{row}`; `cargo xtask sizes --tighten` writes it"
            );
        }
    }

    #[test]
    fn the_table_is_replaced_and_nothing_else() {
        let page = format!("before\n{BEGIN}old{END}\nafter\n");
        let ceiling = Ceiling {
            flash: 200 * 1024,
            ram: 14 * 1024,
            stack: 20 * 1024,
            usb: 2048,
        };
        let ceilings = BTreeMap::from([("f405".to_string(), ceiling)]);
        let sizes = Sizes {
            ram_limit: 127 * 1024,
            stack: 64 * 1024,
            ..Sizes::default()
        };
        let sizes = [("f405", &sizes)];
        let once = with_table(&page, &ceilings, &sizes).unwrap();
        assert!(once.starts_with("before\n") && once.ends_with("\nafter\n") && !once.contains("old"));
        assert!(once.contains("| `f405` | 200 | 14 | 20 | 2 | 127 | 48 of 64 |"));
        assert_eq!(with_table(&once, &ceilings, &sizes).unwrap(), once);
        assert!(with_table("no marks", &ceilings, &sizes).is_err());
    }
}
