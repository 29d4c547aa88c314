//! The `[params]` of a file: values for the flight stack's parameters, each checked against the table.

use std::path::Path;

use sophie_control::params::{ParamInfo, Params, Renamed};
use sophie_tasks::storage::parameters::Allowed;
use toml::de::{DeTable, DeValue};

use super::error::ScenarioError;
use super::source::{Result, Source, as_number, in_order, read_text};

/// A parameter with the value that a file gives it.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Its row of the table.
    pub row: &'static ParamInfo,
    /// Within the row's range, in the row's unit.
    pub value: f32,
}

/// Reads a parameter file: a scenario file that has nothing but `[params]`.
///
/// # Errors
/// One line: file, line, key, value, allowed values.
pub fn read(path: &Path) -> Result<Vec<Setting>> {
    let file = path.display().to_string();
    let text = read_text(path, &file)?;
    parse(&text, &file)
}

/// The same from its text; `file` is its name for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(text: &str, file: &str) -> Result<Vec<Setting>> {
    let source = Source { file, text };
    let root = source.document()?;
    let mut settings = None;
    for (name, span, value) in in_order(root.get_ref()) {
        match (name, value.get_ref()) {
            ("params", DeValue::Table(table)) => settings = Some(source.settings(table)?),
            ("params", _) => return Err(source.bad(name, value, "a table, written [params]")),
            _ => return Err(source.unknown(name, &span, value, ["params".to_owned()].into_iter())),
        }
    }
    settings.ok_or_else(|| ScenarioError::MissingKey {
        at: source.at(&(0..0)),
        key: "[params]".to_owned(),
        allowed: "a table of parameters, as 'sophie params dump' writes it".to_owned(),
    })
}

impl Source<'_> {
    /// The settings of a `[params]` table in the file's order. Old names are converted.
    pub(super) fn settings(&self, table: &DeTable<'_>) -> Result<Vec<Setting>> {
        let mut settings = Vec::new();
        for (name, span, value) in in_order(table) {
            let key = format!("params.{name}");
            let renamed = Renamed::find(name);
            if let Some(new) = renamed.map(|r| r.new).filter(|new| table.contains_key(*new)) {
                return Err(self.bad(&key, value, format!("one of the two, it is params.{new} now")));
            }
            let Some(row) = Params::row(renamed.map_or(name, |r| r.new)) else {
                let known = Params::TABLE.iter().map(|row| format!("params.{}", row.name));
                return Err(self.unknown(&key, &span, value, known));
            };
            let named = value.get_ref().as_str().and_then(|name| row.choice_named(name));
            let number = named
                .map(|choice| choice.value)
                .or(as_number(value).map(|n| n as f32));
            let number = match (renamed, named) {
                (Some(renamed), None) => number.map(|number| renamed.convert(number)),
                _ => number,
            };
            let Some(value) = number.filter(|number| row.allows(*number)) else {
                let now = renamed.map_or(String::new(), |r| format!(" as params.{}", r.new));
                return Err(self.bad(&key, value, format!("{}{now}", Allowed(row))));
            };
            settings.push(Setting { row, value });
        }
        Ok(settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        parse(text, "p.toml").expect_err(text).to_string()
    }

    #[test]
    fn a_file_of_parameters_is_read_like_that_of_a_scenario() {
        let text = "[params]\ninfill = 8 # %\nmotor_protocol = \"pwm\"\nsetpoint_cutoff = 10\n";
        let settings = parse(text, "p.toml").unwrap();
        let read: Vec<_> = settings.iter().map(|s| (s.row.name, s.value)).collect();
        let wanted = [
            ("infill", 8.0),
            ("motor_protocol", 400.0),
            ("setpoint_lpf_hz", Params::DEFAULT.setpoint_lpf_hz),
        ];
        assert_eq!(read, wanted);
        let scenario = super::super::Scenario::parse(text, "p.toml", &super::super::Overrides::default());
        let params = scenario.unwrap().params;
        for Setting { row, value } in settings {
            assert_eq!(params.get(row.name), Some(value), "{}", row.name);
        }
    }

    #[test]
    fn an_unknown_parameter_or_a_value_out_of_range_is_refused_with_its_line() {
        for (text, why) in [
            (
                "[params]\ninfil = 8",
                "p.toml:2: params.infil = 8: unknown key: nearest allowed params.infill",
            ),
            (
                "[params]\ninfill = 12",
                "p.toml:2: params.infill = 12: allowed 4 to 10 %",
            ),
            (
                "[params]\ninfill = \"stiff\"",
                "p.toml:2: params.infill = \"stiff\": allowed 4 to 10 %",
            ),
            (
                "[params]\ninfill = nan",
                "p.toml:2: params.infill = nan: allowed 4 to 10 %",
            ),
            ("[parms]\ninfill = 8", "unknown key: nearest allowed params"),
            (
                "params = 8",
                "p.toml:1: params = 8: allowed a table, written [params]",
            ),
            (
                "infill = 8",
                "p.toml:1: infill = 8: unknown key: nearest allowed params",
            ),
            ("", "p.toml:1: [params] is missing"),
            ("[params]\ninfill = 8\ninfill = 9", "p.toml:3: not valid TOML"),
        ] {
            let refusal = refusal(text);
            assert!(refusal.contains(why) && !refusal.contains('\n'), "{refusal}");
        }
    }
}
