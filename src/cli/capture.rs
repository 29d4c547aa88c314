//! `sophie capture`: which touches of the pipe are held.

use sophie_research::study::capture::{self, Outcome, Request, map, report};
use sophie_terminal::complain;

use super::PROGRAM;
use super::args::CaptureArgs;
use super::publish::Publisher;

/// Flies and writes the map. True when nothing was lost.
pub fn run(args: &CaptureArgs) -> Result<bool, String> {
    let publisher = Publisher::new(&args.out, ["capture.html", "capture.json"], args.json)?;
    let request = Request {
        count: args.touches,
        seed: args.seed,
        heading: args.heading.to_radians(),
        uncertain: args.uncertain,
    };
    publisher.say(&request.to_string());
    let flown = capture::fly(&request)?;
    let section = report::section(&flown, &request);
    publisher.show(1, &section);
    publisher.write(
        "Capture map",
        "Touches of the pipe, flown by the whole stack",
        &[section],
        report::json(&flown, &request),
    )?;
    let lost = map::count(&flown, Outcome::Lost);
    if lost > 0 {
        complain(PROGRAM, &format!("{lost} of {} touches lost", args.touches));
    }
    Ok(lost == 0)
}
