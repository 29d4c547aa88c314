//! Parsing of option values; a refusal names the allowed range.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use sophie_sim::scenario::keys::{self, Range};

/// A number within `range`; the refusal names the range with `unit`, which begins with a space.
pub(super) fn within<T: FromStr + PartialOrd + Display>(
    text: &str,
    range: &RangeInclusive<T>,
    unit: &str,
) -> Result<T, String> {
    let value = text.parse().ok().filter(|value| range.contains(value));
    value.ok_or_else(|| format!("allowed {} to {}{unit}", range.start(), range.end()))
}

/// A number within a scenario key's range, in SI units.
pub(super) fn number(text: &str, range: Range) -> Result<f64, String> {
    let value = text.parse().ok().and_then(|v| range.to_si(v));
    value.ok_or_else(|| format!("allowed {}", range.allowed()))
}

pub(super) fn seed(text: &str) -> Result<u64, String> {
    let seed = text.parse().ok().and_then(keys::seed);
    seed.ok_or_else(|| format!("allowed {}", keys::SEED_ALLOWED))
}

/// Refuses `count` seeds from `first` on if the last one is not allowed.
pub(super) fn seeds(first: u64, count: u64, of: &str) -> Result<(), String> {
    let last = first.saturating_add(count.saturating_sub(1));
    match keys::seed(last as f64) {
        Some(_) => Ok(()),
        None => Err(format!(
            "invalid value '{first}' for '--seed <N>': the last of {count} {of} has seed {last}: allowed {}",
            keys::SEED_ALLOWED
        )),
    }
}

/// One of the allowed words.
pub(super) fn word<'a>(text: &'a str, allowed: &[&str]) -> Result<&'a str, String> {
    if allowed.contains(&text) {
        Ok(text)
    } else {
        Err(format!("allowed {}", allowed.join(", ")))
    }
}
