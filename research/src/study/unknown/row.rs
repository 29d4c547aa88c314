//! A flight as a row of a table: comma-separated values that DuckDB, Polars and spreadsheets read.
//!
//! The first columns are those of the command, the next of the flight; then every number that was drawn, in its key's unit,
//! and what the parameters assume of it.

use sophie_sim::scenario::Scenario;
use sophie_sim::scenario::draw::{self, Drawn};
use sophie_sim::scenario::uncertain::QUANTITIES;
use sophie_sim::streams::Streams;

use super::Request;
use super::class::Class;

/// Columns of a flight, after those of the command.
const FLIGHT: [&str; 7] = [
    "vehicle",
    "seed",
    "class",
    "accomplished",
    "seconds",
    "digest",
    "reason",
];
/// Begin of a column that has what the parameters assume of a number.
pub const ASSUMED: &str = "assumed.";

/// A flight, and the numbers drawn for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Number in the campaign, from 1.
    pub vehicle: u64,
    /// Of vehicle and flight.
    pub seed: u64,
    /// What became of it.
    pub class: Class,
    /// Every step of the mission was done.
    pub accomplished: bool,
    /// Simulated time, s; 0 without a flight.
    pub seconds: f64,
    /// Of the flight, as in `summary.json`; empty without one.
    pub digest: String,
    /// One line: what ended the flight.
    pub reason: String,
    /// Drawn and assumed numbers, in the order of [`names`].
    pub numbers: Vec<f64>,
}

impl Row {
    /// A vehicle that is not flown.
    #[must_use]
    pub fn grounded(vehicle: u64, seed: u64, scenario: &Scenario, drawn: &[Drawn]) -> Self {
        let mut numbers: Vec<f64> = drawn.iter().flat_map(Drawn::numbers).collect();
        numbers.extend(assumed(drawn).flat_map(|assumed| assumed(scenario)));
        Self {
            vehicle,
            seed,
            class: Class::Refused,
            accomplished: false,
            seconds: 0.0,
            digest: String::new(),
            reason: String::new(),
            numbers,
        }
    }

    /// The row as a line, with its end.
    #[must_use]
    pub fn line(&self, request: &Request) -> String {
        let mut cells: Vec<String> = request.words().into_iter().map(|(_, word)| word).collect();
        cells.extend([
            self.vehicle.to_string(),
            self.seed.to_string(),
            self.class.word().to_owned(),
            self.accomplished.to_string(),
            self.seconds.to_string(),
            self.digest.clone(),
            quoted(&self.reason),
        ]);
        cells.extend(self.numbers.iter().map(f64::to_string));
        cells.join(",") + "\n"
    }

    /// Reads a line's cells after those of the command; `None` if they are no row.
    fn of(cells: &[String]) -> Option<Self> {
        let (flight, numbers) = cells.split_at_checked(FLIGHT.len())?;
        let [vehicle, seed, class, accomplished, seconds, digest, reason] = flight else {
            return None;
        };
        Some(Self {
            vehicle: vehicle.parse().ok()?,
            seed: seed.parse().ok()?,
            class: Class::from_word(class)?,
            accomplished: accomplished.parse().ok()?,
            seconds: seconds.parse().ok()?,
            digest: digest.clone(),
            reason: reason.clone(),
            numbers: numbers
                .iter()
                .map(|cell| cell.parse().ok())
                .collect::<Option<_>>()?,
        })
    }
}

/// What the parameters assume of each drawn quantity that they know of.
fn assumed(drawn: &[Drawn]) -> impl Iterator<Item = fn(&Scenario) -> Vec<f64>> {
    QUANTITIES
        .iter()
        .filter(|quantity| drawn.iter().any(|drawn| drawn.key == quantity.key))
        .map(|quantity| quantity.assumed)
}

/// Names of a row's numbers.
#[must_use]
pub fn names() -> Vec<String> {
    let drawn = draw::draw(Streams::new(0));
    let nominal = Scenario::default_mission();
    let mut names: Vec<String> = drawn.iter().flat_map(Drawn::names).collect();
    for quantity in QUANTITIES.iter().filter(|q| drawn.iter().any(|d| d.key == q.key)) {
        let count = (quantity.assumed)(&nominal).len();
        let of_it = draw::names(quantity.key, count);
        names.extend(of_it.iter().map(|name| format!("{ASSUMED}{name}")));
    }
    names
}

/// The line that names the columns, with its end.
#[must_use]
pub fn header(request: &Request) -> String {
    let command = request.words().map(|(name, _)| name.to_owned());
    let flight = FLIGHT.map(str::to_owned);
    let all: Vec<String> = command.into_iter().chain(flight).chain(names()).collect();
    all.join(",") + "\n"
}

/// A row, and the words of its command in the order of [`Request::words`].
pub type Labelled = (Vec<String>, Row);

/// The rows of `text`, each with its command, and the bytes up to the end of the last whole one.
///
/// # Errors
/// The number of the line that is not a row, and why.
pub fn read(text: &str, header: &str) -> Result<(Vec<Labelled>, usize), String> {
    let command = header
        .split(',')
        .position(|name| name == FLIGHT[0])
        .unwrap_or_default();
    let columns = header.split(',').count();
    let Some(body) = text.strip_prefix(header) else {
        return Err("1: its columns are not those of this version".to_owned());
    };
    let mut rows = Vec::new();
    let mut end = header.len();
    for (line, number) in body.split_inclusive('\n').zip(2..) {
        // Torn by the end of its process.
        let Some(whole) = line.strip_suffix('\n') else {
            break;
        };
        let mut cells = cells(whole);
        let bad = || format!("{number}: no row of a flight");
        if cells.len() != columns {
            return Err(bad());
        }
        let flight = cells.split_off(command);
        rows.push((cells, Row::of(&flight).ok_or_else(bad)?));
        end += line.len();
    }
    Ok((rows, end))
}

/// In quotation marks, those within doubled.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// The cells of a line, without their quotation marks.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut cell, mut within) = (Vec::new(), String::new(), false);
    let mut rest = line.chars().peekable();
    while let Some(c) = rest.next() {
        match c {
            '"' if within && rest.next_if_eq(&'"').is_some() => cell.push('"'),
            '"' => within = !within,
            ',' if !within => cells.push(std::mem::take(&mut cell)),
            c => cell.push(c),
        }
    }
    cells.push(cell);
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_in_quotation_marks_is_one_cell() {
        let text = "arm 2 holds 700 N/m2, wanted 950; says \"PERCHED\"";
        assert_eq!(cells(&format!("1,{},2", quoted(text))), ["1", text, "2"]);
        assert_eq!(cells(","), ["", ""]);
    }
}
