//! Parameters of a board: written to a file, compared with a file, and set from a file.
//!
//! The file is the `[params]` of a scenario. It has numbers with up to nine digits: a difference in the last digit does
//! not count.

use std::fmt::Write;

use sophie_control::arming::ArmingInhibit;
use sophie_control::maths::decimal::Decimal;
use sophie_sim::scenario::settings::Setting;

use crate::Failure;
use crate::description::Description;
use crate::vehicle::{Identity, Values, Vehicle};

/// Relative rounding error of a number on its way through a file: twice the last bit of 24.
const LAST_DIGIT: f32 = 2.0 * f32::EPSILON;

/// A board's parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Listed {
    /// Firmware and image of the board.
    pub identity: Identity,
    /// Its values, those that will be in force after a restart.
    pub values: Values,
    /// What its firmware says of them; `None`: its table is another than this program's, and it says nothing.
    pub description: Option<Description>,
}

impl Listed {
    /// Asks `vehicle`.
    ///
    /// # Errors
    /// One line: the line is lost, the vehicle falls silent, is another one, or Ctrl-C.
    pub fn of(vehicle: &mut Vehicle) -> Result<Self, Failure> {
        let identity = vehicle.identity()?;
        Ok(Self {
            description: Description::of(vehicle, &identity)?,
            values: vehicle.values()?,
            identity,
        })
    }

    /// A line for who must know that the board's table of parameters is another than this program's.
    pub fn foreign(&self) -> Option<String> {
        let says = match &self.description {
            Some(description) if !description.foreign => return None,
            Some(_) => "units, ranges and defaults are by its own description",
            None => "it has no description that can be read, so units, ranges and defaults are not known",
        };
        Some(format!("{}; {says}", self.other_table()))
    }

    fn other_table(&self) -> String {
        let version = &self.identity.version;
        format!("SOPHIE {version} there has another table of parameters than this program")
    }

    /// A parameter file with all values of the board.
    pub fn text(&self) -> String {
        let Identity {
            board,
            version,
            image,
            table,
            ..
        } = &self.identity;
        let mut rows: Vec<(&str, f32)> = self
            .values
            .0
            .iter()
            .map(|(name, value)| (&**name, *value))
            .collect();
        let described = |name: &str| self.description.as_ref().and_then(|all| all.row(name));
        rows.retain(|(name, _)| is_key(name));
        if let Some(description) = &self.description {
            rows.sort_by_key(|(name, _)| description.place(name));
        }
        let mut text = format!(
            "# Parameters of SOPHIE {version} on {board}, build {image:08x}, {} parameters, table {table:08x}.\n\
             # By `sophie params dump`; `sophie params load` sets them. What a file leaves out stays as it is.\n[params]\n",
            rows.len()
        );
        for (name, number) in rows {
            let row = described(name);
            let value = match row.and_then(|row| row.choice(number)) {
                Some(named) => format!("\"{named}\""),
                None => Decimal(number).to_string(),
            };
            let line = format!("{name} = {value}");
            let _ = match row {
                Some(row) => {
                    let changed = row.is_changed(number);
                    let mark = if changed { "; not the default" } else { "" };
                    writeln!(text, "{line:34} # {row}{mark}")
                }
                None => writeln!(text, "{line}"),
            };
        }
        text
    }

    /// The differences between file and board, in the file's order.
    ///
    /// # Errors
    /// One line: a parameter of the file is another quantity at the board, or it cannot be known whether it is.
    pub fn differences(&self, settings: &[Setting]) -> Result<Vec<Difference>, String> {
        let Some(description) = &self.description else {
            let version = &self.identity.version;
            return Err(format!(
                "{} and no description that can be read: use the `sophie` of {version}",
                self.other_table()
            ));
        };
        for Setting { row, .. } in settings {
            let unit = if row.unit == "1" { "" } else { row.unit };
            let described = description.row(row.name);
            if let Some(other) = described.map(|row| row.unit()).filter(|other| *other != unit) {
                let [theirs, ours] = [other, unit].map(|unit| if unit.is_empty() { "1" } else { unit });
                return Err(format!(
                    "{}: its unit is {theirs} at the board, {ours} in the file",
                    row.name
                ));
            }
        }
        let all = settings.iter().map(|setting| Difference {
            setting: *setting,
            board: self.values.get(setting.row.name),
        });
        let differs = |it: &Difference| !it.board.is_some_and(|board| same(board, it.setting.value));
        Ok(all.filter(differs).collect())
    }

    /// Why the board does not take `difference`, as far as that can be known before.
    fn refuses(&self, difference: &Difference) -> Option<String> {
        let Setting { row, value } = difference.setting;
        if difference.board.is_none() {
            return Some(difference.text());
        }
        let described = self.description.as_ref()?.row(row.name)?;
        let (name, value) = (row.name, Decimal(value));
        (!described.allows(difference.setting.value))
            .then(|| format!("{name} cannot be {value} there; it takes {described}"))
    }
}

/// A name can stand in a file as it is.
fn is_key(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    !name.is_empty() && name.chars().all(plain)
}

/// A parameter whose value in the file differs from the board's.
#[derive(Clone, Debug)]
pub struct Difference {
    /// Value in the file.
    pub setting: Setting,
    /// Value on the board; `None` if its firmware lacks the parameter.
    pub board: Option<f32>,
}

impl Difference {
    /// `infill 6.9 -> 8 %`: from the board's to the file's.
    pub fn text(&self) -> String {
        let row = self.setting.row;
        let new = Decimal(self.setting.value);
        let name = row.choice(self.setting.value).map_or("", |choice| choice.name);
        let mut text = match self.board {
            Some(old) => format!("{} {} -> {new}", row.name, Decimal(old)),
            None => format!(
                "{}: the board has no such parameter, the file has {new}",
                row.name
            ),
        };
        for behind in [name, if row.unit == "1" { "" } else { row.unit }] {
            if !behind.is_empty() {
                let _ = write!(text, " {behind}");
            }
        }
        text
    }
}

/// The same number but for its last digit.
fn same(a: f32, b: f32) -> bool {
    (a - b).abs() <= LAST_DIGIT * a.abs().max(b.abs())
}

/// True if the board has stored values that are in force only after a restart.
///
/// # Errors
/// As [`Vehicle::arming`].
pub fn waits_for_restart(vehicle: &mut Vehicle) -> Result<bool, Failure> {
    Ok(vehicle.arming()?.contains(&ArmingInhibit::Stored))
}

/// Sets the parameters that differ, stores them, restarts the board, and compares those in force then. `say` gets a line
/// for each step.
///
/// # Errors
/// One line: the value that the board refused (those before it are then put back), or the value that it has instead.
pub fn load(vehicle: &mut Vehicle, settings: &[Setting], say: &mut dyn FnMut(&str)) -> Result<(), Failure> {
    let port = vehicle.port();
    let failed = |why: String| Failure::Board(format!("{port}: {why}"));
    let before = Listed::of(vehicle)?;
    let different = before.differences(settings).map_err(failed)?;
    if let Some(why) = different.iter().find_map(|difference| before.refuses(difference)) {
        return Err(failed(why));
    }
    if different.is_empty() && !waits_for_restart(vehicle)? {
        say(&format!("nothing to change: all {} are in force", settings.len()));
        return Ok(());
    }
    for difference in &different {
        say(&difference.text());
    }
    for (done, difference) in different.iter().enumerate() {
        if let Err(why) = set(vehicle, difference) {
            return Err(put_back(vehicle, &different[..=done], why));
        }
    }
    // The values are at the board: those in force are still compared.
    vehicle.see_it_through();
    if let Err(why) = vehicle.store_and_restart() {
        return Err(put_back(vehicle, &different, why));
    }
    say("saved; the board has restarted");
    let now = Listed::of(vehicle)?.differences(settings).map_err(failed)?;
    if let Some(other) = now.first() {
        return Err(failed(format!("read back after the restart: {}", other.text())));
    }
    say(&format!("all {} are in force", settings.len()));
    Ok(())
}

fn set(vehicle: &mut Vehicle, difference: &Difference) -> Result<(), Failure> {
    let Setting { row, value } = difference.setting;
    let now = vehicle.set(row.name, value)?;
    if same(now, value) {
        return Ok(());
    }
    Err(vehicle.refused(&format!("the board refused {}", difference.text())))
}

/// Puts the old values back, as far as the line allows; `why` is the reason for not saving.
fn put_back(vehicle: &mut Vehicle, different: &[Difference], why: Failure) -> Failure {
    // Ctrl-C is obeyed once.
    vehicle.see_it_through();
    let mut olds = different
        .iter()
        .filter_map(|it| Some((it.setting.row.name, it.board?)));
    // The first that fails is the last: a silent board is not waited for again.
    let back = olds.all(|(name, old)| vehicle.set(name, old).is_ok_and(|now| same(now, old)));
    let end = if back {
        "nothing is saved"
    } else {
        "the board may store what was set until then: load again"
    };
    match why {
        Failure::Stopped(line) => Failure::Stopped(format!("{line}; {end}")),
        Failure::Board(line) => Failure::Board(format!("{line}; {end}")),
        why @ Failure::Input(_) => why,
    }
}

#[cfg(test)]
mod tests {
    use sophie_control::params::Params;
    use sophie_sim::scenario::settings;

    use super::*;

    /// A board of this program's table with `values`, whose description is `description`.
    fn board(values: Values, description: Option<Description>) -> Listed {
        Listed {
            identity: Identity {
                board: "matek-h743".to_owned(),
                version: "0.1.0".to_owned(),
                chip: String::new(),
                image: 0x1234_ABCD,
                table: 0x5678,
            },
            values,
            description,
        }
    }

    fn defaults() -> Values {
        let rows = Params::TABLE.iter();
        Values(rows.map(|row| (row.name.to_owned(), row.default)).collect())
    }

    #[test]
    fn a_dump_is_read_back_as_what_was_dumped() {
        let listed = board(defaults(), Description::own());
        let text = listed.text();
        let read = settings::parse(&text, "dump.toml").unwrap();
        assert_eq!(read.len(), Params::TABLE.len());
        assert!(listed.differences(&read).unwrap().is_empty());
        assert!(text.contains("motor_protocol = \"dshot300\""), "{text}");
        assert!(!text.contains("not the default"), "{text}");
        assert!(text.lines().all(|line| line.len() <= 160), "{text}");
        let rows = text.lines().skip(3).zip(Params::TABLE);
        assert!(
            rows.into_iter()
                .all(|(line, row)| line.starts_with(&format!("{} = ", row.name)))
        );
        let other = settings::parse("[params]\ninfill = 8\nmotor_protocol = \"pwm\"\n", "p.toml").unwrap();
        let differences = listed.differences(&other).unwrap();
        let texts: Vec<String> = differences.iter().map(Difference::text).collect();
        assert_eq!(texts, ["infill 6.9 -> 8 %", "motor_protocol 300 -> 400 pwm"]);
        let mut changed = defaults();
        changed.0.insert("infill".to_owned(), 8.0);
        let text = board(changed, Description::own()).text();
        assert!(text.contains("# 4 to 10 %; not the default\n"), "{text}");
    }

    #[test]
    fn a_neighbour_in_the_last_bit_is_the_same_and_the_next_digit_is_not() {
        let file = settings::parse("[params]\ninertia_pitch = 0.04356\n", "p.toml").unwrap();
        for (value, differs) in [
            (0.04356, 0),
            (f32::from_bits(0.04356_f32.to_bits() + 1), 0),
            (0.043_560_1, 1),
        ] {
            let values = Values([("inertia_pitch".to_owned(), value)].into());
            let listed = board(values, Description::own());
            assert_eq!(listed.differences(&file).unwrap().len(), differs, "{value}");
        }
        let absent = board(Values::default(), Description::own());
        let difference = absent.differences(&file).unwrap().remove(0);
        let why = "inertia_pitch: the board has no such parameter, the file has 0.04356 kg m2";
        assert_eq!(absent.refuses(&difference).as_deref(), Some(why));
    }

    #[test]
    fn a_board_of_another_table_is_dumped_and_takes_what_it_describes() {
        let file = settings::parse("[params]\ninfill = 8\n", "p.toml").unwrap();
        let mut values = defaults();
        values.0.insert("old_gain".to_owned(), 3.0);
        values.0.insert("broken\nname".to_owned(), 1.0);
        // Without a description: values alone.
        let unknown = board(values.clone(), None);
        let text = unknown.text();
        assert!(
            text.contains("\ninfill = 6.9\n") && text.contains("\nold_gain = 3\n"),
            "{text}"
        );
        assert!(!text.contains("broken"), "{text}");
        let why = unknown.differences(&file).unwrap_err();
        assert!(why.ends_with("use the `sophie` of 0.1.0"), "{why}");
        assert!(unknown.foreign().unwrap().contains("are not known"));
        // With its own.
        let described = |infill: &str| {
            let json = format!(
                r#"{{"parameters":[{{"name":"old_gain","min":0,"max":5,"default":2,"units":"1/s"}},{{"name":"infill",{infill}}}]}}"#
            );
            board(values.clone(), Description::parse(&json, true))
        };
        let listed = described(r#""min":4,"max":7,"units":"%""#);
        let text = listed.text();
        assert!(
            text.contains("# 0 to 5 1/s; not the default\ninfill = 6.9 "),
            "{text}"
        );
        assert!(listed.foreign().unwrap().contains("by its own description"));
        let difference = listed.differences(&file).unwrap().remove(0);
        let why = "infill cannot be 8 there; it takes 4 to 7 %";
        assert_eq!(listed.refuses(&difference).as_deref(), Some(why));
        let why = described(r#""min":0,"max":1"#).differences(&file).unwrap_err();
        assert_eq!(why, "infill: its unit is 1 at the board, % in the file");
        assert_eq!(board(defaults(), Description::own()).foreign(), None);
    }
}
