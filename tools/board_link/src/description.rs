//! Description of a board's parameters: units, ranges, choices and defaults, by MAVLink's component metadata.
//!
//! A board with this program's table of parameters has this program's description. One with another table, of another
//! release, is asked for its own.

use std::fmt;
use std::io::Read;

use lzma_rust2::XzReader;
use serde::Deserialize;
use sophie_control::maths::decimal::Decimal;
use sophie_mavlink::services::files::{GENERAL, PARAMETER};
use sophie_tasks::storage::parameters::table_id;

use crate::Failure;
use crate::vehicle::{Identity, Vehicle};

/// COMP_METADATA_TYPE_PARAMETER.
const PARAMETER_TYPE: u32 = 1;
/// Scheme of the metadata's own files.
const SCHEME: &str = "mftp:///";
/// Largest description, bytes: thirty times this program's.
const LARGEST: u64 = 1 << 20;
/// Most choices that are listed by name, as at the console.
const MOST_NAMED: usize = 8;

/// A parameter, as the board's firmware describes it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Described {
    name: String,
    #[serde(default)]
    units: String,
    #[serde(default)]
    min: Option<f32>,
    #[serde(default)]
    max: Option<f32>,
    #[serde(default)]
    default: Option<f32>,
    #[serde(default)]
    values: Vec<Choice>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
struct Choice {
    value: f32,
    /// Its name, or its number.
    description: String,
}

/// A firmware's parameters, in the order of its table.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    rows: Vec<Described>,
    /// It is of another table than this program's.
    pub foreign: bool,
}

#[derive(Deserialize)]
struct General {
    #[serde(rename = "metadataTypes")]
    types: Vec<Metadata>,
}

#[derive(Deserialize)]
struct Metadata {
    r#type: u32,
    uri: String,
}

#[derive(Deserialize)]
struct File {
    parameters: Vec<Described>,
}

impl Description {
    /// The description of `vehicle`'s parameters; `None` if its table is another than this program's and it has no
    /// description, or none that can be read.
    ///
    /// # Errors
    /// The line is lost, the vehicle falls silent, or Ctrl-C.
    pub fn of(vehicle: &mut Vehicle, identity: &Identity) -> Result<Option<Self>, Failure> {
        if identity.table == table_id() {
            return Ok(Self::own());
        }
        let Some(path) = vehicle.file(GENERAL.path)?.and_then(|general| path(&general)) else {
            return Ok(None);
        };
        let packed = vehicle.file(&path)?;
        Ok(packed.and_then(|packed| Self::read(&packed, true)))
    }

    /// This program's.
    pub(crate) fn own() -> Option<Self> {
        Self::read(PARAMETER.bytes, false)
    }

    fn read(packed: &[u8], foreign: bool) -> Option<Self> {
        let mut text = String::new();
        XzReader::new(packed, false)
            .take(LARGEST)
            .read_to_string(&mut text)
            .ok()?;
        Self::parse(&text, foreign)
    }

    pub(crate) fn parse(text: &str, foreign: bool) -> Option<Self> {
        let mut rows = serde_json::from_str::<File>(text).ok()?.parameters;
        rows.retain(Described::is_plain);
        Some(Self { rows, foreign })
    }

    /// The parameter `name`.
    pub fn row(&self, name: &str) -> Option<&Described> {
        self.rows.iter().find(|row| row.name == name)
    }

    /// Place of `name` in the table; a name that the table lacks is behind the last.
    pub fn place(&self, name: &str) -> usize {
        let place = self.rows.iter().position(|row| row.name == name);
        place.unwrap_or(self.rows.len())
    }
}

/// Path of the parameters' description in the list of the metadata's files.
fn path(general: &[u8]) -> Option<String> {
    let general: General = serde_json::from_slice(general).ok()?;
    let mut types = general.types.iter();
    let parameter = types.find(|metadata| metadata.r#type == PARAMETER_TYPE)?;
    parameter.uri.strip_prefix(SCHEME).map(ToOwned::to_owned)
}

impl Described {
    /// Its texts can stand in a parameter file.
    fn is_plain(&self) -> bool {
        let texts = [&self.name, &self.units].into_iter();
        let mut texts = texts.chain(self.values.iter().map(|choice| &choice.description));
        texts.all(|text| !text.contains(|c: char| c.is_control() || c == '"' || c == '\\'))
    }

    /// The unit; empty for a plain number.
    pub fn unit(&self) -> &str {
        &self.units
    }

    /// Name of the choice at `value`, if it has one.
    pub fn choice(&self, value: f32) -> Option<&str> {
        let choice = self.values.iter().find(|choice| is(choice.value, value))?;
        choice.name()
    }

    /// True unless `value` is its default. Where boards have defaults of their own, the description has none.
    pub fn is_changed(&self, value: f32) -> bool {
        self.default.is_some_and(|default| !is(default, value))
    }

    /// True if the board takes `value`.
    pub fn allows(&self, value: f32) -> bool {
        let above = self.min.is_none_or(|min| value >= min);
        let below = self.max.is_none_or(|max| value <= max);
        let chosen = self.values.is_empty() || self.values.iter().any(|choice| is(choice.value, value));
        above && below && chosen
    }
}

impl Choice {
    fn name(&self) -> Option<&str> {
        let number = self.description.parse::<f32>().is_ok();
        (!number).then_some(&*self.description)
    }
}

/// The allowed values with their unit: `4 to 10 %`, `crsf, sbus`, `one of 24, 1234 to 4321`.
impl fmt::Display for Described {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.values.as_slice(), self.min, self.max) {
            ([first, .., last], ..) if self.values.len() > MOST_NAMED => {
                let (first, last) = (&first.description, &last.description);
                write!(f, "one of {}, {first} to {last}", self.values.len())?;
            }
            ([], Some(min), Some(max)) => write!(f, "{} to {}", Decimal(min), Decimal(max))?,
            (choices, ..) => {
                let names: Vec<&str> = choices.iter().map(|choice| &*choice.description).collect();
                f.write_str(&names.join(", "))?;
            }
        }
        match &*self.units {
            "" => Ok(()),
            unit => write!(f, " {unit}"),
        }
    }
}

/// The same number: the file has as many digits as say it.
fn is(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits()
}

#[cfg(test)]
mod tests {
    use sophie_control::params::Params;
    use sophie_tasks::storage::parameters::Allowed;

    use super::*;

    #[test]
    fn this_programs_description_is_that_of_its_table() {
        let own = Description::own().unwrap();
        assert_eq!(own.rows.len(), Params::TABLE.len());
        for (at, row) in Params::TABLE.iter().enumerate() {
            let described = own.row(row.name).unwrap();
            assert_eq!(own.place(row.name), at);
            assert!(
                described.allows(row.min) && described.allows(row.max),
                "{}",
                row.name
            );
            assert!(!described.allows(row.max * 1.01 + 1.0), "{}", row.name);
            assert!(!described.is_changed(row.default), "{}", row.name);
            let unit = if row.unit == "1" { "" } else { row.unit };
            assert_eq!(described.unit(), unit);
            let named = row.choice(row.max).map(|choice| choice.name);
            assert_eq!(described.choice(row.max), named.filter(|name| !name.is_empty()));
            let few = row.choices.len() <= MOST_NAMED;
            if few {
                assert_eq!(described.to_string(), format!("{:#}", Allowed(row)));
            }
        }
        assert_eq!(own.place("nothing"), Params::TABLE.len());
    }

    #[test]
    fn a_description_that_is_damaged_or_has_what_breaks_a_file_is_not_taken() {
        let mut damaged = PARAMETER.bytes.to_vec();
        let middle = damaged.len() / 2;
        damaged[middle] ^= 1;
        for bytes in [&damaged[..], &PARAMETER.bytes[..middle], b"", b"text"] {
            assert_eq!(Description::read(bytes, true), None);
        }
        let row = |name: &str| -> Described {
            serde_json::from_value(serde_json::json!({ "name": name, "type": "Float" })).unwrap()
        };
        assert!(row("infill").is_plain());
        for name in ["in\nfill", "in\"fill", "in\\fill"] {
            assert!(!row(name).is_plain(), "{name}");
        }
    }

    #[test]
    fn the_path_of_the_description_comes_from_the_list() {
        assert_eq!(path(GENERAL.bytes).as_deref(), Some(PARAMETER.path));
        for other in [
            &b"{}"[..],
            b"",
            br#"{"metadataTypes":[{"type":1,"uri":"https://a"}]}"#,
        ] {
            assert_eq!(path(other), None);
        }
    }
}
