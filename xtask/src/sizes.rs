//! Flash and RAM of firmware against limits and ceilings.

use std::collections::BTreeMap;
use std::fs;

use serde::{Deserialize, Serialize};

use crate::boards::Board;
use crate::image::Image;
use crate::{Error, build};

/// Of any board, bytes: five eighths of the smallest chip's flash, the F405's 1 MiB. It was 512 KiB until the position, its
/// sources' trust and the barometer had filled these.
const FLASH_LIMIT: u64 = 640 * 1024;
/// Static, of any board, bytes.
const RAM_LIMIT: u64 = 64 * 1024;

/// With the ceilings, between two marks.
const PAGE: &str = "docs/boards.md";
const BEGIN: &str = "<!-- sizes: written by `cargo xtask sizes --tighten` -->";
const END: &str = "<!-- sizes end -->";

/// Sizes of an image, bytes.
pub struct Sizes {
    /// Code, constants and initial values.
    pub flash: u64,
    /// Statics, including the tasks' futures.
    pub ram: u64,
    pub stack: u64,
}

impl Sizes {
    /// Sizes of `image`.
    ///
    /// # Errors
    /// It does not define its stack.
    pub fn of(image: &Image) -> Result<Self, Error> {
        let sum = |what: fn(&crate::image::Section) -> bool| {
            image.sections.iter().filter(|s| what(s)).map(|s| s.size).sum()
        };
        Ok(Self {
            flash: sum(|s| s.in_image),
            // Initial values count twice: in flash and copied.
            ram: sum(|s| s.writable || !s.in_image),
            stack: image.symbol("_stack_start")? - image.symbol("_stack_end")?,
        })
    }
}

#[derive(Clone, Copy, Deserialize, Serialize)]
struct Ceiling {
    flash: u64,
    ram: u64,
}

pub fn print(rows: &[(&Board, Sizes)]) {
    println!("| board | flash, bytes | static RAM, bytes | stack, bytes |");
    println!("|---|---:|---:|---:|");
    for (board, s) in rows {
        println!("| {} | {} | {} | {} |", board.name, s.flash, s.ram, s.stack);
    }
    println!("| limit | {FLASH_LIMIT} | {RAM_LIMIT} | |");
}

/// Compares sizes with limits and `xtask/ceilings.toml`, and that with its table in `docs/boards.md`; `tighten` lowers
/// the ceilings and writes the table.
///
/// # Errors
/// What is too large or out of date, one per line.
pub fn compare(rows: &[(&Board, Sizes)], tighten: bool) -> Result<(), Error> {
    let path = build::root().join("xtask/ceilings.toml");
    let text = fs::read_to_string(&path)?;
    let mut ceilings: BTreeMap<String, Ceiling> = toml::from_str(&text)?;
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
    let page_path = build::root().join(PAGE);
    let page = fs::read_to_string(&page_path)?;
    let stacks: Vec<_> = rows.iter().map(|(board, s)| (board.name, s.stack)).collect();
    let updated = with_table(&page, &ceilings, &stacks)?;
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
    stacks: &[(&str, u64)],
) -> Result<String, Error> {
    let (head, rest) = page
        .split_once(BEGIN)
        .ok_or_else(|| format!("{PAGE} has no `{BEGIN}`"))?;
    let (_, tail) = rest
        .split_once(END)
        .ok_or_else(|| format!("{PAGE} has no `{END}`"))?;
    let mut table =
        String::from("\n| board | flash, KiB | static RAM, KiB | stack, KiB |\n|---|---:|---:|---:|\n");
    for &(name, stack) in stacks {
        let ceiling = ceilings.get(name).ok_or("a board without ceiling")?;
        table += &format!("{} {} |\n", row(name, ceiling), stack / 1024);
    }
    table += &format!("| limit | {} | {} | |\n", FLASH_LIMIT / 1024, RAM_LIMIT / 1024);
    Ok(format!("{head}{BEGIN}{table}{END}{tail}"))
}

/// Without the stack, which only an image knows.
fn row(name: &str, ceiling: &Ceiling) -> String {
    let (flash, ram) = (ceiling.flash / 1024, ceiling.ram / 1024);
    format!("| `{name}` | {flash} | {ram} |")
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
        };
        let ceilings = BTreeMap::from([("f405".to_string(), ceiling)]);
        let stacks = [("f405", 32 * 1024)];
        let once = with_table(&page, &ceilings, &stacks).unwrap();
        assert!(once.starts_with("before\n") && once.ends_with("\nafter\n") && !once.contains("old"));
        assert!(once.contains("| `f405` | 200 | 14 | 32 |"));
        assert_eq!(with_table(&once, &ceilings, &stacks).unwrap(), once);
        assert!(with_table("no marks", &ceilings, &stacks).is_err());
    }
}
