//! `sophie fit-thrust`: static thrust from a table of scale readings, as lines for the console of the board.

use sophie_control::params::Params;
use sophie_fit::{thrust, thrust_data};
use sophie_terminal::complain;
use sophie_terminal::console::{self, Console};

use super::PROGRAM;
use super::args::FitThrustArgs;

/// Fits the table and prints the parameters.
pub fn run(args: &FitThrustArgs) -> Result<bool, String> {
    let file = console::one_line(&args.readings.display().to_string());
    let rows = thrust_data::load(&args.readings)?;
    let fit = thrust::fit(&rows, args.nominal).map_err(|why| format!("{file}: {why}"))?;
    let found = fit.parameters();
    for fitted in &found {
        let allowed = Params::row(fitted.name).filter(|row| !row.allows(fitted.value as f32));
        if let Some(row) = allowed {
            return Err(format!(
                "{file}: {} = {:.4}: allowed are {} to {} {}",
                fitted.name, fitted.value, row.min, row.max, row.unit
            )
            .trim_end()
            .to_owned());
        }
    }
    let console = Console::new(false);
    for fitted in &found {
        console.say(&format!(
            "{:<16} {:>7.4} +- {:.4} {}",
            fitted.name, fitted.value, fitted.half, fitted.unit
        ));
    }
    console.say(&format!(
        "95 % intervals, {} readings, the air of their day; the law is within {:.1} % of the commands",
        rows.len(),
        100.0 * fit.shape
    ));
    if fit.power.is_none() {
        console.say("thrust_volt_exp: not told by these voltages; all rotors at the same commands with a used battery tell it");
    }
    if fit.trims.is_none() {
        console.say("thrust_trim_1 to _4: not told; rows of each rotor alone tell them");
    }
    console.say("arm_level_share is a share of thrust_max: times old thrust_max over new, arms stay level where they are");
    console.say("");
    for fitted in &found {
        console.say(&format!("set {} {:.4}", fitted.name, fitted.value));
    }
    console.say("save");
    let (row, distance) = fit.worst;
    if let Some(scatter) = fit.scatter.filter(|scatter| *scatter > thrust::SCATTER_MAX) {
        let line = format!(
            "a reading scatters by {:.1} %: 1 to 2 % are usual",
            100.0 * scatter
        );
        complain(PROGRAM, &format!("warning: {file}: {line}"));
    }
    if distance.abs() > thrust::WORST_MAX {
        let line = format!("row {}: {:+.0} % beside the others", row + 1, 100.0 * distance);
        complain(PROGRAM, &format!("warning: {file}: {line}"));
    }
    console.end()?;
    Ok(true)
}
