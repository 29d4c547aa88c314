//! Settings of the chip and the greatest depth of its stack, row by row.

use core::fmt::Write;

use heapless::String;
use sophie_mavlink::Row;
use sophie_ports::chip::Chip;
use sophie_ports::chip_check::{ChipCheck, REVISION};

/// Number of rows.
pub fn rows(chip: &impl Chip) -> u8 {
    let stack = if chip.stack().is_some() { 2 } else { 0 };
    chip.checks().len().min(200) as u8 + stack
}

/// Check `number`, from 0; the stack's are the last two.
pub fn check(chip: &impl Chip, number: u8) -> Option<ChipCheck> {
    let number = usize::from(number);
    if let Some(check) = chip.checks().get(number) {
        return Some(check.clone());
    }
    let used = chip.stack()?;
    match number.checked_sub(chip.checks().len())? {
        0 => Some(used.at_start()),
        1 => Some(used.in_flight()),
        _ => None,
    }
}

/// Text of the chip's revision, zeros behind it; all zeros if the board does not read one.
pub fn revision(chip: &impl Chip) -> [u8; 24] {
    let mut text = [0; 24];
    let mut checks = chip.checks().iter();
    if let Some(check) = checks.find(|check| check.name == REVISION) {
        text.iter_mut()
            .zip(check.read.bytes())
            .for_each(|(to, from)| *to = from);
    }
    text
}

/// The check as a row of a report.
pub fn row(check: &ChipCheck) -> Row {
    let mut found = String::new();
    let ChipCheck { read, expected, .. } = check;
    let _ = write!(found, "{read}; expected {expected}");
    Row {
        name: check.name,
        passed: check.ok,
        inhibits: check.inhibits.into_iter().collect(),
        found,
    }
}
