//! The working copy of the parameters.

use sophie_control::params::{ParamInfo, Params, RENAMED, Renamed};

use super::Console;
use super::nearest::nearest;
use crate::storage::parameters::{Allowed, Shown, Unit, parse_value};
use sophie_control::maths::decimal::Decimal;
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    pub(super) async fn list(&mut self, part: &str) {
        let mut count = 0;
        let old = |row: &ParamInfo| RENAMED.iter().any(|r| r.new == row.name && r.old.contains(part));
        for row in Params::TABLE {
            if !row.name.contains(part) && !old(row) {
                continue;
            }
            count += 1;
            self.row(row).await;
        }
        if count == 0 {
            self.out
                .line(format_args!("no parameter has '{part}' in its name"))
                .await;
        }
    }

    /// Prints one parameter: change mark, name, value, allowed range.
    async fn row(&mut self, row: &ParamInfo) {
        let value = self.value(row);
        let mark = if same(value, self.default(row)) { ' ' } else { '*' };
        let (name, value, allowed) = (row.name, Decimal(value), Allowed(row));
        self.out
            .line(format_args!("{mark} {name:16} {value:<9} {allowed:#}"))
            .await;
    }

    pub(super) async fn get(&mut self, name: &str) {
        let Some(Found { row, .. }) = self.find(name).await else {
            return;
        };
        self.row(row).await;
        let default = Shown(row, self.default(row));
        self.out.line(format_args!("  default {default}")).await;
    }

    pub(super) async fn set(&mut self, name: &str, text: &str) {
        let Some(Found { row, renamed }) = self.find(name).await else {
            return;
        };
        let (name, allowed) = (row.name, Allowed(row));
        let Some(value) = parse_value(row, renamed, text) else {
            let kind = if row.has_names() { "value" } else { "number" };
            return self
                .out
                .line(format_args!("'{text}' is not a {kind}; {name} takes {allowed}"))
                .await;
        };
        self.put(row, value).await;
    }

    pub(super) async fn reset(&mut self, name: &str) {
        let Some(Found { row, .. }) = self.find(name).await else {
            return;
        };
        self.put(row, self.default(row)).await;
    }

    pub(super) async fn put(&mut self, row: &ParamInfo, value: f32) {
        let old = self.value(row);
        let (name, unit) = (row.name, Unit(row.unit));
        let (old, shown) = (Shown(row, old), Shown(row, value));
        match self.params.set(name, value) {
            Ok(()) => {
                let force = if same(value, self.links.params.get(name).unwrap_or(value)) {
                    "as in force"
                } else {
                    "in force after save"
                };
                self.out
                    .line(format_args!("{name} {old} -> {shown}{unit}, {force}"))
                    .await;
            }
            Err(_) => {
                let allowed = Allowed(row);
                self.out
                    .line(format_args!("{name} cannot be {shown}; it takes {allowed}"))
                    .await;
            }
        }
    }

    /// Lists the changes that `save` would store.
    pub(super) async fn changes(&mut self) {
        let mut count = 0;
        for row in Params::TABLE {
            let (old, new) = (self.links.params.get(row.name), self.value(row));
            let old = old.unwrap_or(row.default);
            if same(old, new) {
                continue;
            }
            count += 1;
            let (name, unit) = (row.name, Unit(row.unit));
            let (old, new) = (Shown(row, old), Shown(row, new));
            self.out.line(format_args!("{name} {old} -> {new}{unit}")).await;
        }
        match count {
            0 => self.out.line(format_args!("no changes")).await,
            1 => self.out.line(format_args!("1 change, in force after save")).await,
            _ => {
                self.out
                    .line(format_args!("{count} changes, in force after save"))
                    .await;
            }
        }
    }

    /// Parameters that differ from those in force.
    pub(super) fn changed(&self) -> usize {
        let force = |row: &ParamInfo| self.links.params.get(row.name).unwrap_or(row.default);
        let differs = |row: &&ParamInfo| !same(force(row), self.value(row));
        Params::TABLE.iter().filter(differs).count()
    }

    /// Default of the parameter on this board.
    fn default(&self, row: &ParamInfo) -> f32 {
        self.storage.defaults().get(row.name).unwrap_or(row.default)
    }

    fn value(&self, row: &ParamInfo) -> f32 {
        self.params.get(row.name).unwrap_or(row.default)
    }

    /// Finds the parameter `name`, or prints that it is unknown. A former name is accepted, with a line that gives the
    /// new one.
    async fn find(&mut self, name: &str) -> Option<Found> {
        let renamed = Renamed::find(name);
        let row = Params::row(renamed.map_or(name, |renamed| renamed.new));
        if let (Some(row), Some(Renamed { old, unit, .. })) = (row, renamed) {
            let (new, new_unit) = (row.name, Unit(row.unit));
            if *unit == row.unit {
                self.out.line(format_args!("{old} is {new} now")).await;
            } else {
                let unit = Unit(unit);
                self.out
                    .line(format_args!("{old} in{unit} is {new} in{new_unit} now"))
                    .await;
            }
        }
        if row.is_none() {
            match nearest(name, Params::TABLE.iter().map(|row| row.name)) {
                Some(other) => {
                    self.out
                        .line(format_args!("no parameter '{name}'; did you mean '{other}'?"))
                        .await;
                }
                None => {
                    self.out
                        .line(format_args!("no parameter '{name}'; 'list' shows them all"))
                        .await;
                }
            }
        }
        row.map(|row| Found { row, renamed })
    }
}

/// Result of a look-up by name.
struct Found {
    row: &'static ParamInfo,
    /// Entry of the former name, if that was used.
    renamed: Option<&'static Renamed>,
}

/// Bitwise equality.
fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits()
}
