//! `sophie check`: whether a vehicle can fly its mission.

use sophie_flight_report::terminal::check;
use sophie_flight_report::terminal::result;
use sophie_sim::check::Check;
use sophie_terminal::console::{self, Console};

use super::args::CheckArgs;

/// Checks the vehicle and shows the rows. True when it can fly.
pub fn run(args: &CheckArgs) -> Result<bool, String> {
    let scenario = args.mission.scenario()?;
    let console = Console::new(args.json);
    let found = Check::of(&scenario);
    console.say(&result::intro(&scenario));
    for line in check::lines(&found) {
        console.say(&line);
    }
    for line in result::differences(&scenario) {
        console.say(&line);
    }
    if args.json {
        console::print(&check::json(&scenario.name, &found))?;
    }
    console.end()?;
    Ok(found.can_fly())
}
