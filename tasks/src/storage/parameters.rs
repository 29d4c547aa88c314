//! Parameters at start-up (defaults, overlaid with the stored ones), and their display.

use core::fmt;

use sophie_control::arming::ArmingInhibit;
use sophie_control::params::{ParamInfo, Params, Renamed};

use crate::links::Links;
use sophie_control::maths::decimal::{self, Decimal};
use sophie_ports::storage::{Loaded, Storage};

/// Parameters in force and the result of reading them. Called once, before [`Links::new`].
pub async fn load(storage: &mut impl Storage) -> (Params, Loaded) {
    let mut params = *storage.defaults();
    let loaded = storage.load(&mut params).await;
    (params, loaded)
}

/// Refuses arming if the storage is unreadable. Rejected values are replaced by their defaults.
pub fn report(links: &Links, loaded: Loaded) {
    let foreign = loaded.foreign.is_some();
    links.report(ArmingInhibit::StorageUnreadable, loaded.unreadable && !foreign);
    links.report(ArmingInhibit::StorageForeign, foreign);
}

/// Identifier of the parameter table: a hash of names, units, ranges and defaults of all rows.
pub fn table_id() -> u32 {
    let words = Params::TABLE.iter().flat_map(|row| {
        let text = row.name.bytes().chain(row.unit.bytes()).map(u32::from);
        let numbers = [row.min, row.max, row.default].map(f32::to_bits);
        text.chain(numbers)
    });
    sophie_image_id::of(words)
}

/// Most choices that are listed by name: a line has 80 characters.
const MOST_NAMED: usize = 8;

/// Allowed values of a parameter: "4 to 10 %", "one of 0 crsf, 1 sbus", or short (`{:#}`) "crsf, sbus"; of many
/// choices the first, the last, and the count if they only have numbers.
#[derive(Clone, Copy, Debug)]
pub struct Allowed<'a>(pub &'a ParamInfo);

impl fmt::Display for Allowed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = self.0;
        if row.choices.is_empty() {
            write!(f, "{} to {}", Decimal(row.min), Decimal(row.max))?;
        } else if row.choices.len() > MOST_NAMED {
            if !row.has_names() {
                write!(f, "one of {}, ", row.choices.len())?;
            }
            write!(f, "{} to {}", Shown(row, row.min), Shown(row, row.max))?;
        } else {
            f.write_str(if f.alternate() { "" } else { "one of " })?;
            for (i, choice) in row.choices.iter().enumerate() {
                f.write_str(if i == 0 { "" } else { ", " })?;
                if f.alternate() && !choice.name.is_empty() {
                    f.write_str(choice.name)?;
                } else {
                    Shown(row, choice.value).fmt(f)?;
                }
            }
        }
        Unit(row.unit).fmt(f)
    }
}

/// The value of `text` for `row`: a number (under an old name in its old unit) or a choice's name; `None` for anything
/// else. The range is not checked.
pub(crate) fn parse_value(row: &ParamInfo, renamed: Option<&Renamed>, text: &str) -> Option<f32> {
    if let Some(choice) = row.choice_named(text) {
        return Some(choice.value);
    }
    let number = decimal::parse(text)?;
    Some(renamed.map_or(number, |renamed| renamed.convert(number)))
}

/// A value with its choice's name, if any.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a>(pub &'a ParamInfo, pub f32);

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let &Self(row, value) = self;
        match row.choice(value).map_or("", |choice| choice.name) {
            "" => write!(f, "{}", Decimal(value)),
            name => write!(f, "{} {name}", Decimal(value)),
        }
    }
}

/// A unit behind its value, if any.
#[derive(Clone, Copy, Debug)]
pub struct Unit(pub &'static str);

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            "1" => Ok(()),
            unit => write!(f, " {unit}"),
        }
    }
}
