//! Terminal output of commands that fly, and their files.

pub mod check;
pub mod live;
pub mod result;
pub mod tally;

use sophie_sim::record::FlightRecord;
use sophie_terminal::console::{self, Console};
use sophie_terminal::output::OutDir;

use crate::summary::Summary;
use crate::{log, page};

/// The files of a report.
pub const FILES: [&str; 3] = ["report.html", "flight.mcap", "summary.json"];

/// A value of the command beside the flight's record: a further file, and a field of the same name in the printed JSON.
pub struct Attachment {
    /// Name of the file without its ending, and of the field.
    pub name: &'static str,
    /// Its content.
    pub value: serde_json::Value,
    /// Lines for the terminal.
    pub lines: Vec<String>,
}

/// Shows the report of `record` and writes its files into `out`, if any; `json` prints the summary on stdout.
///
/// # Errors
/// One line: the file that cannot be written, and the reason.
pub fn finish(
    record: &FlightRecord,
    attachment: Option<&Attachment>,
    out: Option<&OutDir>,
    console: &Console,
    json: bool,
) -> Result<(), String> {
    let summary = Summary::of(record).to_json();
    let written = match out {
        Some(out) => out.write(&files(record, &summary, attachment)?)?,
        None => Vec::new(),
    };
    for line in result::tables(record) {
        console.say(&line);
    }
    console.say("");
    for line in attachment.iter().flat_map(|b| &b.lines) {
        console.say(line);
    }
    console.say(&result::judged(record));
    console.say(&result::verdict(console, record));
    if !written.is_empty() {
        console.say(&format!("written: {}", written.join("  ")));
    }
    if json {
        console::print(&printed(summary, attachment))?;
    }
    console.end()
}

/// Names and contents of the files. Page and log cost as much as the flight.
fn files(
    record: &FlightRecord,
    summary: &str,
    attachment: Option<&Attachment>,
) -> Result<Vec<(String, Vec<u8>)>, String> {
    let contents = [
        page::html(record).into_bytes(),
        log::mcap(record)?,
        summary.as_bytes().to_vec(),
    ];
    let mut files: Vec<(String, Vec<u8>)> = FILES.map(str::to_owned).into_iter().zip(contents).collect();
    if let Some(attachment) = attachment {
        let text = serde_json::to_string_pretty(&attachment.value).unwrap_or_default() + "\n";
        files.push((format!("{}.json", attachment.name), text.into_bytes()));
    }
    Ok(files)
}

/// The JSON on stdout: the summary, and the additional value in a field of its own.
fn printed(summary: String, attachment: Option<&Attachment>) -> String {
    let Some(attachment) = attachment else {
        return summary.trim_end().to_owned();
    };
    let mut all: serde_json::Map<String, serde_json::Value> =
        serde_json::from_str(&summary).unwrap_or_default();
    all.insert(attachment.name.to_owned(), attachment.value.clone());
    serde_json::to_string_pretty(&all).unwrap_or_default()
}
