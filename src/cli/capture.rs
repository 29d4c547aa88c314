//! `sophie capture`: which touches of the pipe are held.

use std::time::Instant;

use sophie_paper::study::capture::{self, Outcome, map, report};
use sophie_paper::{page, text};
use sophie_report::terminal::complain;
use sophie_report::terminal::console::{self, Console};
use sophie_report::terminal::output::OutDir;

use super::PROGRAM;
use super::args::CaptureArgs;

const FILES: [&str; 2] = ["capture.html", "capture.json"];

/// Flies and writes the map. True when nothing was lost.
pub fn run(args: &CaptureArgs) -> Result<bool, String> {
    let out = OutDir::prepare(&args.out, &FILES)?;
    let console = Console::new(args.json);
    console.say(&format!(
        "{} touches of the pipe from seed {}",
        args.touches, args.seed
    ));
    let started = Instant::now();
    let flown = capture::fly(args.touches, args.seed, args.heading.to_radians())?;
    let section = report::section(&flown, args.seed);
    for line in text::lines(1, &section) {
        console.say(&line);
    }
    let results = report::json(&flown, args.seed);
    let sections = [section];
    let page = page::html(
        "Capture map",
        "Touches of the pipe, flown by the whole stack",
        &sections,
    );
    let files = [page.into_bytes(), results.clone().into_bytes()];
    let written = out.write(&FILES.into_iter().zip(files).collect::<Vec<_>>())?;
    console.say("");
    console.say(&format!(
        "{:.0} s, written: {}",
        started.elapsed().as_secs_f64(),
        written.join("  ")
    ));
    if args.json {
        console::print(results.trim_end())?;
    }
    console.end()?;
    let lost = map::count(&flown, Outcome::Lost);
    if lost > 0 {
        complain(PROGRAM, &format!("{lost} of {} touches lost", args.touches));
    }
    Ok(lost == 0)
}
