//! `sophie capture`: which touches of the pipe are held.

use sophie_paper::study::capture::{self, Outcome, map, report};
use sophie_report::terminal::complain;

use super::PROGRAM;
use super::args::CaptureArgs;
use super::publish::Publisher;

/// Flies and writes the map. True when nothing was lost.
pub fn run(args: &CaptureArgs) -> Result<bool, String> {
    let publisher = Publisher::new(&args.out, ["capture.html", "capture.json"], args.json)?;
    publisher.say(&format!(
        "{} touches of the pipe from seed {}",
        args.touches, args.seed
    ));
    let flown = capture::fly(args.touches, args.seed, args.heading.to_radians())?;
    let section = report::section(&flown, args.seed);
    publisher.show(1, &section);
    publisher.write(
        "Capture map",
        "Touches of the pipe, flown by the whole stack",
        &[section],
        report::json(&flown, args.seed),
    )?;
    let lost = map::count(&flown, Outcome::Lost);
    if lost > 0 {
        complain(PROGRAM, &format!("{lost} of {} touches lost", args.touches));
    }
    Ok(lost == 0)
}
