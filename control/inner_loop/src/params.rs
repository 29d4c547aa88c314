//! Every number that a pilot or builder may change, in one `table`: name, unit, range, default, source.

mod choices;
mod names;
mod table;

use core::cmp::Ordering;

pub use self::choices::{
    ArmBusSpeed, ArmSign, FlowMounting, FlowPort, ImuAccelRange, ImuGyroRange, ImuMounting, ImuRate,
    MotorMap, MotorProtocol, RcProtocol, ServoMarks,
};
pub use self::names::{NAME_MAX, RENAMED, Renamed, check_names};
pub use self::table::Params;
use self::table::{DOCS, ROWS};
use crate::maths::vector::Vec3;

/// One row of the parameter table.
#[derive(Clone, Copy, Debug)]
pub struct ParamInfo {
    /// Name, as in scenario files and on the console.
    pub name: &'static str,
    /// Unit in which the value is given; `1` for a pure number.
    pub unit: &'static str,
    /// Smallest value allowed.
    pub min: f32,
    /// Largest value allowed.
    pub max: f32,
    /// The only values allowed, ascending; empty where every value of the range is.
    pub choices: &'static [Choice],
    /// Value of a fresh board, where the board itself has no other.
    pub default: f32,
}

/// One value of an enumerated parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Its number: what is stored, and what a table of numbers shows.
    pub value: f32,
    /// Its name; empty where the number with its unit says all.
    pub name: &'static str,
}

impl Choice {
    /// True for its number, exactly.
    fn is(&self, value: f32) -> bool {
        self.value.partial_cmp(&value) == Some(Ordering::Equal)
    }
}

/// Why a parameter was not set.
#[derive(Clone, Copy, Debug)]
pub enum ParamError {
    /// No parameter has this name.
    Unknown,
    /// The value is not finite, outside `min..=max` or none of the choices of this row.
    NotAllowed(&'static ParamInfo),
}

impl ParamInfo {
    /// Its meaning and the source of its default, for documentation; an image does not use it.
    pub fn doc(&self) -> &'static str {
        let place = ROWS.iter().position(|row| row.name == self.name);
        place
            .and_then(|place| DOCS.get(place))
            .copied()
            .unwrap_or_default()
    }

    /// True for a finite value of the range, and where there are choices for one of them.
    pub fn allows(&self, value: f32) -> bool {
        (self.min..=self.max).contains(&value) && (self.choices.is_empty() || self.choice(value).is_some())
    }

    /// The choice with this number.
    pub fn choice(&self, value: f32) -> Option<&'static Choice> {
        self.choices.iter().find(|choice| choice.is(value))
    }

    /// True where a value may also be given by its name.
    pub fn has_names(&self) -> bool {
        self.choices.iter().any(|choice| !choice.name.is_empty())
    }

    /// The choice with this name.
    pub fn choice_named(&self, name: &str) -> Option<&'static Choice> {
        let named = |choice: &&Choice| !name.is_empty() && choice.name == name;
        self.choices.iter().find(named)
    }
}

/// Where in the table the parameter called `name` stands.
fn find(name: &str) -> Option<(usize, &'static ParamInfo)> {
    ROWS.iter().enumerate().find(|(_, row)| row.name == name)
}

impl Params {
    /// Lens of the flow module from the centre of mass, m, body.
    pub fn flow_lens(&self) -> Vec3 {
        Vec3::new(self.flow_x, self.flow_y, self.flow_z)
    }

    /// The table's row of the parameter called `name`.
    pub fn row(name: &str) -> Option<&'static ParamInfo> {
        find(name).map(|(_, row)| row)
    }

    /// The value of the parameter called `name`.
    pub fn get(&self, name: &str) -> Option<f32> {
        let (at, _) = find(name)?;
        self.values().get(at).copied()
    }

    /// Sets the parameter called `name`.
    ///
    /// # Errors
    /// An unknown name, or a value that is not finite, out of its range or none of the choices; nothing is changed then.
    pub fn set(&mut self, name: &str, value: f32) -> Result<(), ParamError> {
        let (at, row) = find(name).ok_or(ParamError::Unknown)?;
        if !row.allows(value) {
            return Err(ParamError::NotAllowed(row));
        }
        self.put(at, value).ok_or(ParamError::NotAllowed(row))
    }
}

impl PartialEq for Params {
    fn eq(&self, other: &Self) -> bool {
        self.values() == other.values()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_default_lies_in_its_range_and_can_be_set() {
        for row in Params::TABLE {
            let mut p = Params::default();
            assert!(p.get(row.name) == Some(row.default), "{}", row.name);
            assert!(p.set(row.name, row.default).is_ok(), "{}", row.name);
            assert!(
                p.set(row.name, row.max).is_ok() && p.get(row.name) == Some(row.max),
                "{}",
                row.name
            );
            assert!(
                p.set(row.name, row.min).is_ok() && p.get(row.name) == Some(row.min),
                "{}",
                row.name
            );
        }
    }

    #[test]
    fn a_bad_value_changes_nothing() {
        let mut p = Params::default();
        for bad in [f32::NAN, f32::INFINITY, -1.0, 11.0, 3.9] {
            assert!(
                matches!(p.set("infill", bad), Err(ParamError::NotAllowed(row)) if row.name == "infill"),
                "{bad}"
            );
        }
        assert!(matches!(p.set("infil", 6.0), Err(ParamError::Unknown)));
        for bad in [126.0, 200.0, 599.0] {
            let refused = p.set("motor_protocol", bad);
            assert!(matches!(refused, Err(ParamError::NotAllowed(_))), "{bad}");
        }
        assert!(p == Params::default());
    }
}
