//! A TOML text: its values, and the line of each for messages.

use core::ops::Range as Span;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{Place, ScenarioError};
use super::keys::Range;
use super::nearest::nearest;

/// Largest file, bytes: refuses devices and wrong files.
const MAX_BYTES: u64 = sophie_input::MIB;

pub(super) type Result<T> = core::result::Result<T, ScenarioError>;
pub(super) type Value<'a> = Spanned<DeValue<'a>>;

/// A text and its name in messages.
pub(super) struct Source<'a> {
    pub file: &'a str,
    pub text: &'a str,
}

impl Source<'_> {
    pub(super) fn at(&self, span: &Span<usize>) -> Place {
        let before = self.text.as_bytes().get(..span.start).unwrap_or_default();
        Place {
            file: self.file.to_owned(),
            line: 1 + before.iter().filter(|b| **b == b'\n').count(),
        }
    }

    pub(super) fn bad(&self, key: &str, value: &Value<'_>, allowed: impl Into<String>) -> ScenarioError {
        let span = value.span();
        ScenarioError::BadValue {
            at: self.at(&span),
            key: key.to_owned(),
            value: self.text.get(span).unwrap_or_default().to_owned(),
            allowed: allowed.into(),
        }
    }

    pub(super) fn unknown(
        &self,
        key: &str,
        span: &Span<usize>,
        value: &Value<'_>,
        known: impl Iterator<Item = String>,
    ) -> ScenarioError {
        let known: Vec<String> = known.collect();
        ScenarioError::UnknownKey {
            at: self.at(span),
            key: key.to_owned(),
            value: self.text.get(value.span()).unwrap_or_default().to_owned(),
            nearest: nearest(key, known.iter().map(String::as_str)),
        }
    }

    pub(super) fn document(&self) -> Result<Spanned<DeTable<'_>>> {
        DeTable::parse(self.text).map_err(|error| ScenarioError::Syntax {
            at: self.at(&error.span().unwrap_or_default()),
            message: error.message().to_owned(),
        })
    }

    /// A number within `range`, in SI.
    pub(super) fn number(&self, key: &str, value: &Value<'_>, range: &Range) -> Result<f64> {
        let si = as_number(value).and_then(|v| range.to_si(v));
        si.ok_or_else(|| self.bad(key, value, range.allowed()))
    }
}

/// The text of the file at `path`, which messages call `file`.
pub(super) fn read_text(path: &Path, file: &str) -> Result<String> {
    let unreadable = |why: String| ScenarioError::Unreadable {
        file: file.to_owned(),
        why,
    };
    let bytes = sophie_input::read(path, MAX_BYTES)
        .map_err(|why| unreadable(format!("{why}; allowed is a TOML file")))?;
    String::from_utf8(bytes).map_err(|error| {
        let good = error
            .as_bytes()
            .get(..error.utf8_error().valid_up_to())
            .unwrap_or_default();
        let line = 1 + good.iter().filter(|b| **b == b'\n').count();
        ScenarioError::NotText {
            at: Place {
                file: file.to_owned(),
                line,
            },
        }
    })
}

pub(super) fn table<'t, 'i>(root: &'t Spanned<DeTable<'i>>, name: &str) -> Option<&'t DeTable<'i>> {
    let (_, content) = root.get_ref().iter().find(|(key, _)| key.get_ref() == name)?;
    content.get_ref().as_table()
}

/// In the file's order: the first mistake is reported.
pub(super) fn in_order<'t, 'i>(table: &'t DeTable<'i>) -> Vec<(&'t str, Span<usize>, &'t Value<'i>)> {
    let mut entries: Vec<_> = table
        .iter()
        .map(|(k, v)| (k.get_ref().as_ref(), k.span(), v))
        .collect();
    entries.sort_by_key(|(_, span, _)| span.start);
    entries
}

pub(super) fn as_number(value: &Value<'_>) -> Option<f64> {
    match value.get_ref() {
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|v| v as f64),
        DeValue::Float(f) => f.as_str().parse().ok(),
        _ => None,
    }
}
