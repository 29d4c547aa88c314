//! Flash of an image by crate, from its symbols.
//!
//! A function counts for the crate that its name begins with, a generic's instance for the instantiating one. The linker
//! merges texts and constants and drops their names: those bytes are told by what they are.

use std::collections::BTreeMap;

use crate::Error;
use crate::boards::Board;
use crate::image::{Image, Section, Static};
use crate::sizes::Sizes;

/// Crates below this on every board are summed, bytes.
const SMALL: u64 = 2048;
/// Printable characters of constants without a crate, [`TEXT_MIN`] or more in a row.
const TEXTS: &str = "texts: parameters, console, MAVLink, panics";
/// Their other bytes.
const TABLES: &str = "tables and constants without a name";
/// Functions without a crate: the compiler's own, such as `memcpy`, and the start in assembly.
const ROUTINES: &str = "routines of the compiler and of the start";
const VECTORS: &str = "vector table";
/// Bytes between functions.
const PADDING: &str = "padding of code";
/// What has no crate, in the order of the table.
const WITHOUT_CRATE: [&str; 5] = [TEXTS, TABLES, ROUTINES, VECTORS, PADDING];
/// Shortest run of printable characters that counts as text.
const TEXT_MIN: usize = 4;

/// Bytes of flash by crate.
pub type Shares = BTreeMap<String, u64>;

/// The shares of `image`.
///
/// # Errors
/// They do not add up to the image.
pub fn shares(image: &Image, sizes: &Sizes) -> Result<Shares, Error> {
    let symbols = image.functions.iter().chain(&image.statics);
    let mut symbols: Vec<&Static> = symbols.filter(|symbol| symbol.size > 0).collect();
    // The longer of two at one address counts.
    symbols.sort_by_key(|symbol| (symbol.address, std::cmp::Reverse(symbol.size)));
    let mut shares = Shares::new();
    for section in image.sections.iter().filter(|section| section.in_image) {
        share(image, section, &symbols, &mut shares);
    }
    let sum: u64 = shares.values().sum();
    if sum == sizes.flash {
        Ok(shares)
    } else {
        Err(format!(
            "the crates' shares add up to {sum} bytes, the image has {}",
            sizes.flash
        )
        .into())
    }
}

fn share(image: &Image, section: &Section, symbols: &[&Static], shares: &mut Shares) {
    let mut give = |owner: &str, bytes: u64| {
        if bytes > 0 {
            *shares.entry(owner.to_owned()).or_default() += bytes;
        }
    };
    let mut give_nameless = |first: u64, beyond: u64| {
        let bytes = beyond - first;
        match section.name.as_str() {
            ".text" => give(PADDING, bytes),
            ".vector_table" => give(VECTORS, bytes),
            _ => {
                let texts = text_bytes(image.bytes(first, bytes)).min(bytes);
                give(TEXTS, texts);
                give(TABLES, bytes - texts);
            }
        }
    };
    let mut owned: Vec<(String, u64)> = Vec::new();
    let (mut next, end) = (section.address, section.address + section.size);
    for symbol in symbols {
        let first = symbol.address.clamp(next, end);
        let beyond = (symbol.address + symbol.size).clamp(first, end);
        if symbol.address >= section.address && beyond > first {
            give_nameless(next, first);
            match owner(&symbol.name) {
                Owner::Crate(name) => owned.push((name, beyond - first)),
                Owner::Constant => give_nameless(first, beyond),
                Owner::Routine => owned.push((ROUTINES.to_owned(), beyond - first)),
            }
            next = beyond;
        }
    }
    give_nameless(next, end);
    for (name, bytes) in owned {
        give(&name, bytes);
    }
}

/// Bytes in runs of at least [`TEXT_MIN`] printable characters.
fn text_bytes(bytes: &[u8]) -> u64 {
    let runs = bytes.split(|byte| !matches!(byte, b' '..=b'~' | b'\n' | 0xC2..));
    let texts = runs.filter(|run| run.len() >= TEXT_MIN);
    texts.map(|run| run.len() as u64).sum()
}

/// Whom a symbol's bytes belong to.
#[derive(Debug, PartialEq)]
enum Owner {
    Crate(String),
    /// A constant whose name the compiler has made up.
    Constant,
    Routine,
}

fn owner(symbol: &str) -> Owner {
    if symbol.starts_with(".Lanon.") || symbol.starts_with("anon.") {
        return Owner::Constant;
    }
    let name = rustc_demangle::try_demangle(symbol).map(|name| format!("{name:#}"));
    let owner = name.ok().and_then(|name| first_crate(&name).map(str::to_string));
    owner.map_or(Owner::Routine, Owner::Crate)
}

/// `<alpha::Type as beta::Trait>::function` is alpha's, `<u32 as beta::Trait>::function` is beta's.
fn first_crate(path: &str) -> Option<&str> {
    let mut rest = path;
    loop {
        rest = rest.trim_start_matches(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        let length = rest
            .bytes()
            .take_while(|b| b.is_ascii_alphanumeric() || *b == b'_')
            .count();
        let (word, behind) = rest.split_at(length);
        match word {
            "" => return None,
            "mut" | "const" | "dyn" | "as" => rest = behind,
            _ if behind.starts_with("::") => return Some(word),
            // A type of no crate.
            _ => rest = behind,
        }
    }
}

/// Table of all boards, the largest crate first.
pub fn print(boards: &[(&Board, Shares)]) {
    println!("{}", table(boards));
}

fn table(boards: &[(&Board, Shares)]) -> String {
    let mut crates: BTreeMap<&str, Vec<u64>> = BTreeMap::new();
    for (nth, (_, shares)) in boards.iter().enumerate() {
        for (name, bytes) in shares {
            crates.entry(name).or_insert_with(|| vec![0; boards.len()])[nth] = *bytes;
        }
    }
    let last = WITHOUT_CRATE.map(|name| (name.to_string(), crates.remove(name)));
    let mut rows: Vec<(String, Vec<u64>)> = Vec::new();
    let (mut small, mut sum) = (0, vec![0; boards.len()]);
    for (name, bytes) in crates {
        if bytes.iter().any(|b| *b >= SMALL) {
            rows.push((name.into(), bytes));
        } else {
            small += 1;
            sum.iter_mut().zip(&bytes).for_each(|(sum, b)| *sum += b);
        }
    }
    rows.sort_by_key(|(_, bytes)| std::cmp::Reverse(bytes.iter().copied().max()));
    rows.push((format!("{small} smaller crates"), sum));
    rows.extend(last.into_iter().filter_map(|(name, bytes)| Some((name, bytes?))));
    let total = (0..boards.len()).map(|nth| rows.iter().filter_map(|(_, bytes)| bytes.get(nth)).sum());
    rows.push(("image".into(), total.collect()));

    let names = boards.iter().map(|(board, _)| format!(" {} |", board.name));
    let mut table = format!("| flash by crate, bytes |{}\n|---|", names.collect::<String>());
    table += &"---:|".repeat(boards.len());
    for (name, bytes) in rows {
        let cells: String = bytes.iter().map(|bytes| format!(" {bytes} |")).collect();
        table += &format!("\n| {name} |{cells}");
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boards::BOARDS;
    use crate::image::Load;

    #[test]
    fn a_name_belongs_to_the_crate_that_it_begins_with() {
        for (name, owner) in [
            (
                "sophie_tasks::flight::imu::run::{closure#0}",
                Some("sophie_tasks"),
            ),
            (
                "<sophie_control::allocation::mixer::Mixer>::mix",
                Some("sophie_control"),
            ),
            (
                "<&mut embassy_sync::Watch<u32> as core::future::Future>::poll",
                Some("embassy_sync"),
            ),
            ("<u32 as core::fmt::Display>::fmt", Some("core")),
            ("<[u8; 4] as heapless::View>::view", Some("heapless")),
            ("core::ptr::drop_in_place::<sophie_boards::Board>", Some("core")),
            ("<dyn core::fmt::Write>::write_str", Some("core")),
            ("Reset", None),
            ("", None),
        ] {
            assert_eq!(first_crate(name), owner, "{name}");
        }
        assert_eq!(
            owner("_ZN13sophie_boards5stm325start17h0123456789abcdefE"),
            Owner::Crate("sophie_boards".to_owned())
        );
        assert_eq!(
            owner("_RNvNtCs1234_7mycrate3foo3bar"),
            Owner::Crate("mycrate".to_owned())
        );
        assert_eq!(owner(".Lanon.a78e62bea.1"), Owner::Constant);
        assert_eq!(owner("memcpy"), Owner::Routine);
        assert_eq!(text_bytes(b"\0\0infill\0abc\x01level 1\n\x02"), 6 + 8);
    }

    /// Code at 0x100 and constants at 0x200, 64 bytes each, and RAM.
    fn image() -> Image {
        let section = |name: &str, address, in_image| Section {
            name: name.into(),
            address,
            size: 64,
            in_image,
            writable: !in_image,
        };
        let symbol = |name: &str, address, size| Static {
            name: name.into(),
            address,
            size,
        };
        Image {
            entry: 0,
            sections: vec![
                section(".text", 0x100, true),
                section(".rodata", 0x200, true),
                section(".bss", 0x2000_0000, false),
            ],
            loads: vec![Load {
                address: 0x200,
                bytes: [&b"\0\0twelve bytes"[..], &[0; 50]].concat(),
            }],
            statics: vec![
                symbol(".Lanon.a78e62bea.1", 0x200, 24),
                symbol("_ZN5alpha4NAME17h0123456789abcdefE", 0x210, 24),
                symbol("_ZN4beta4POOL17h0123456789abcdefE", 0x2000_0000, 64),
            ],
            functions: vec![
                symbol("_ZN5alpha3run17h0123456789abcdefE", 0x104, 20),
                symbol("_ZN4beta5twice17h0123456789abcdefE", 0x104, 20),
                symbol("_ZN4beta3run17h0123456789abcdefE", 0x130, 8),
                symbol("memcpy", 0x138, 8),
            ],
            ..Image::default()
        }
    }

    #[test]
    fn every_byte_has_one_owner() {
        let sizes = |flash| Sizes {
            flash,
            ..Sizes::default()
        };
        let shares = shares(&image(), &sizes(128)).unwrap();
        // 4 before, 24 between; constants overlap by 8, and 24 follow them.
        let expected = [
            ("alpha", 20 + 16),
            ("beta", 8),
            (TEXTS, 12),
            (TABLES, 12 + 24),
            (ROUTINES, 8),
            (PADDING, 4 + 24),
        ];
        assert_eq!(
            shares,
            expected.map(|(name, bytes)| (name.to_string(), bytes)).into()
        );
        assert!(super::shares(&image(), &sizes(127)).is_err());
    }

    #[test]
    fn small_crates_are_one_row_and_columns_add_up() {
        let shares = |list: &[(&str, u64)]| list.iter().map(|(n, b)| (n.to_string(), *b)).collect();
        let one = shares(&[("tiny", 7), ("big", 5000), ("wee", SMALL - 1), (PADDING, 3)]);
        let other = shares(&[("tiny", 1), ("bigger", 9000), (TEXTS, 4)]);
        let table = table(&[(&BOARDS[0], one), (&BOARDS[2], other)]);
        let expected = "\
| flash by crate, bytes | matek-h743 | f405 |
|---|---:|---:|
| bigger | 0 | 9000 |
| big | 5000 | 0 |
| 2 smaller crates | 2054 | 1 |
| texts: parameters, console, MAVLink, panics | 0 | 4 |
| padding of code | 3 | 0 |
| image | 7057 | 9005 |";
        assert_eq!(table, expected);
    }
}
