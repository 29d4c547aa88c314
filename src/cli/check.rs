//! `sophie check`: whether a vehicle can fly its mission.

use sophie_report::terminal::check;
use sophie_report::terminal::console::{self, Console};
use sophie_report::terminal::result;
use sophie_sim::check::Check;

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
    if args.json {
        console::print(&check::json(&scenario.name, &found))?;
    }
    console.end()?;
    Ok(found.can_fly())
}
