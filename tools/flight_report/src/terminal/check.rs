//! The rows of a check, as a table and as JSON.

use serde::Serialize;
use sophie_sim::check::{Check, Row};

use sophie_terminal::table::{Align, Table};

/// The rows as a table, what to do about those that fail, and the verdict.
pub fn lines(check: &Check) -> Vec<String> {
    use Align::{Left, Right};
    let mut table = Table::new(&[
        ("row", Left),
        ("value", Right),
        ("limit", Left),
        ("verdict", Left),
    ]);
    for row in &check.rows {
        let verdict = if row.pass { "pass" } else { "FAIL" };
        table.row([
            row.name.clone(),
            row.shown(),
            row.limit_shown(),
            verdict.to_owned(),
        ]);
    }
    let mut lines = vec![String::new()];
    lines.extend(table.lines());
    lines.push(String::new());
    lines.extend(check.failing().map(|row| format!("{}: {}", row.name, row.advice)));
    let failing = check.failing().count();
    lines.push(if failing == 0 {
        "can fly".to_owned()
    } else {
        format!("CANNOT fly: {failing} of {} rows fail", check.rows.len())
    });
    lines
}

/// The whole object.
#[derive(Serialize)]
struct Whole<'a> {
    /// Name of the scenario.
    scenario: &'a str,
    /// Every row passes; the exit status is 0 exactly then.
    can_fly: bool,
    rows: Vec<RowFields<'a>>,
}

/// One row.
#[derive(Serialize)]
struct RowFields<'a> {
    name: &'a str,
    /// `null` if the vehicle has no such value.
    value: f64,
    unit: &'a str,
    limit: f64,
    /// `at least` or `at most`.
    bound: String,
    pass: bool,
    /// What to do; `null` for a row that passes.
    advice: Option<&'a str>,
}

impl<'a> From<&'a Row> for RowFields<'a> {
    fn from(row: &'a Row) -> Self {
        Self {
            name: &row.name,
            value: row.value,
            unit: row.unit,
            limit: row.limit.value(),
            bound: format!("at {}", row.limit.word()),
            pass: row.pass,
            advice: (!row.pass).then_some(&*row.advice),
        }
    }
}

/// The check as one JSON object; docs/design-check.md has its fields.
pub fn json(scenario: &str, check: &Check) -> String {
    let whole = Whole {
        scenario,
        can_fly: check.can_fly(),
        rows: check.rows.iter().map(RowFields::from).collect(),
    };
    serde_json::to_string_pretty(&whole).unwrap_or_default()
}
