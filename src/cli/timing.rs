//! `sophie timing`: timing of a board's log.

use sophie_terminal::output::OutDir;
use sophie_terminal::{complain, console};
use sophie_timing::analyse::analyse;
use sophie_timing::capture::Capture;
use sophie_timing::replay::Replay;
use sophie_timing::{csv, page, table};

use super::PROGRAM;
use super::args::TimingArgs;

const FILES: [&str; 2] = ["timing.html", "timing.csv"];

/// Reads the log and shows it.
pub fn run(args: &TimingArgs) -> Result<(), String> {
    let capture = Capture::read(&args.capture, args.elf.as_deref())?;
    let out = OutDir::prepare(&args.out, &FILES)?;
    for line in capture.notes.iter().chain(&capture.incomplete) {
        complain(PROGRAM, line);
    }
    let replay = Replay::of(&capture.trace);
    let mut tables = table::tables(&capture, &replay);
    if args.analyse {
        tables += &analyse(&capture, &replay);
    }
    let page = page::html(&capture, &replay, &tables);
    let contents = [page, csv::csv(&capture, &replay)].map(String::into_bytes);
    let files: Vec<_> = FILES.into_iter().zip(contents).collect();
    let written = out.write(&files)?;
    console::print(&format!("{tables}\nwritten: {}", written.join("  ")))
}
