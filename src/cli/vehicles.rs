//! `sophie study vehicles`: how many of a varied family accomplish the mission.

use sophie_research::study::vehicles::{self, report};

use super::args::VehiclesArgs;
use super::publish::Publisher;

/// Flies and writes the family. Always true: a failed flight is a result.
pub fn run(args: &VehiclesArgs) -> Result<bool, String> {
    let publisher = Publisher::new(&args.out, ["vehicles.html", "vehicles.json"], args.json)?;
    publisher.say(&format!("{} vehicles from seed {}", args.count, args.seed));
    let flown = vehicles::fly(args.count, args.seed, args.spread)?;
    let section = report::section(&flown, args.seed, args.spread);
    publisher.show(1, &section);
    publisher.write(
        "Varied vehicles",
        "A family of vehicles, checked and flown by the whole stack",
        &[section],
        report::json(&flown, args.seed, args.spread),
    )?;
    Ok(true)
}
