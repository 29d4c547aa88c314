//! What the commands that fly say, and the files that they leave behind.

pub mod check;
pub mod live;
pub mod result;

use sophie_sim::record::FlightRecord;
use sophie_terminal::console::{self, Console};
use sophie_terminal::output::OutDir;

use crate::summary::Summary;
use crate::{log, page};

/// The files of a report.
pub const FILES: [&str; 3] = ["report.html", "flight.mcap", "summary.json"];

/// What a command knows of a flight besides its record: one more file, which also stands under its name in the JSON
/// that is printed.
pub struct Besides {
    /// Name of the file without its ending, and of the field.
    pub name: &'static str,
    /// What it holds.
    pub value: serde_json::Value,
    /// Lines for the terminal.
    pub lines: Vec<String>,
}

/// Writes the report of `record` into `out` and shows it; `json`: prints the summary on stdout.
///
/// # Errors
/// One line: what could not be written, and why.
pub fn finish(
    record: &FlightRecord,
    besides: Option<&Besides>,
    out: &OutDir,
    console: &Console,
    json: bool,
) -> Result<(), String> {
    let summary = Summary::of(record).to_json();
    let mut files: Vec<(String, Vec<u8>)> = FILES
        .map(str::to_owned)
        .into_iter()
        .zip([
            page::html(record).into_bytes(),
            log::mcap(record)?,
            summary.clone().into_bytes(),
        ])
        .collect();
    if let Some(besides) = besides {
        let text = serde_json::to_string_pretty(&besides.value).unwrap_or_default() + "\n";
        files.push((format!("{}.json", besides.name), text.into_bytes()));
    }
    let written = out.write(&files)?;
    for line in result::tables(record) {
        console.say(&line);
    }
    console.say("");
    for line in besides.iter().flat_map(|b| &b.lines) {
        console.say(line);
    }
    console.say(&result::verdict(console, record));
    console.say(&format!("written: {}", written.join("  ")));
    if json {
        console::print(&printed(summary, besides))?;
    }
    console.end()
}

/// The JSON on stdout: the summary, with what is known besides in a field of its own.
fn printed(summary: String, besides: Option<&Besides>) -> String {
    let Some(besides) = besides else {
        return summary.trim_end().to_owned();
    };
    let mut all: serde_json::Map<String, serde_json::Value> =
        serde_json::from_str(&summary).unwrap_or_default();
    all.insert(besides.name.to_owned(), besides.value.clone());
    serde_json::to_string_pretty(&all).unwrap_or_default()
}
