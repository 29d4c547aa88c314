//! The `sophie` command line.
//!
//! Exit status: 0 when the mission was accomplished, 1 when it was not, 2 when it could not be flown or
//! reported.

mod args;
mod console;
mod live;
mod output;
mod result;
mod study;
pub mod table;

use std::process::ExitCode;

use sophie_hil::flight::fly;
use sophie_hil::record::FlightRecord;
use sophie_hil::scenario::Scenario;

use self::args::{FlyArgs, Task};
use self::console::Console;
use self::output::OutDir;
use crate::report::{self, summary::Summary};

/// The mission was not accomplished.
const FAILED: u8 = 1;
/// The files of a report.
const FILES: [&str; 3] = ["report.html", "flight.mcap", "summary.json"];
/// Bad input, or the results could not be written.
const REFUSED: u8 = 2;

/// Runs the command line of this process.
pub fn main() -> ExitCode {
    let task = match args::parse() {
        Ok(task) => task,
        Err(message) => return message.show(),
    };
    let done = match task {
        Task::Fly(args) => run(&args),
        Task::Paper(args) => study::paper(&args),
        Task::FitArm(args) => study::fit_arm(&args),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(FAILED),
        Err(line) => refuse(&line),
    }
}

fn run(args: &FlyArgs) -> Result<bool, String> {
    let scenario = match &args.scenario {
        Some(path) => Scenario::load(path, &args.overrides()).map_err(|e| e.to_string())?,
        None => Scenario::default_mission_with(&args.overrides()),
    };
    // Before the flight, so that a bad directory is told at once.
    let out = OutDir::prepare(&args.out, &FILES)?;
    let console = Console::new(args.json);
    console.say(&result::intro(&scenario));
    let record = console.watch(|observer| fly(&scenario, observer));
    finish(&record, &out, &console, args.json)
}

fn finish(record: &FlightRecord, out: &OutDir, console: &Console, json: bool) -> Result<bool, String> {
    let summary = Summary::of(record).to_json();
    let contents = [
        report::page::html(record).into_bytes(),
        report::log::mcap(record)?,
        summary.clone().into_bytes(),
    ];
    let files: Vec<_> = FILES.into_iter().zip(contents).collect();
    let written = out.write(&files)?;
    for line in result::tables(record) {
        console.say(&line);
    }
    console.say("");
    console.say(&console.verdict(record));
    console.say(&format!("written: {}", written.join("  ")));
    if json {
        console::print(summary.trim_end())?;
    }
    console.end()?;
    if !record.outcome.accomplished {
        eprintln_safely(&format!(
            "sophie: not accomplished: {}",
            console::one_line(&record.outcome.reason)
        ));
    }
    Ok(record.outcome.accomplished)
}

fn refuse(line: &str) -> ExitCode {
    eprintln_safely(&format!("sophie: {}", console::one_line(line)));
    ExitCode::from(REFUSED)
}

/// One line on stderr; a closed stderr is nobody's concern.
fn eprintln_safely(line: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{line}");
}
