//! Arguments of the binaries, with complaints of one line, and what they have in common.

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;
use sophie_sim::scenario::{Overrides, Scenario};
use sophie_terminal::complain;

use crate::{SPEEDS, flyable};

/// The arguments of `program`.
///
/// # Errors
/// The exit status after help, the version or a complaint.
pub fn parse<A: Parser>(program: &str) -> Result<A, ExitCode> {
    A::try_parse().map_err(|error| {
        if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
        let text = error.render().to_string();
        // The error precedes the first empty line.
        let lines: Vec<&str> = text
            .lines()
            .map(str::trim)
            .take_while(|l| !l.is_empty())
            .collect();
        complain(program, lines.join(" ").trim_start_matches("error: "));
        ExitCode::from(2)
    })
}

/// Checks a `--speed`.
///
/// # Errors
/// One line: the speed, and what is allowed.
pub fn check_speed(speed: f64) -> Result<(), String> {
    let (low, high) = (SPEEDS.start(), SPEEDS.end());
    SPEEDS
        .contains(&speed)
        .then_some(())
        .ok_or_else(|| format!("--speed {speed}: allowed is {low} to {high}"))
}

/// The scenario in the file, or the default mission, with `seed` where there is one.
///
/// # Errors
/// One line: what is wrong with it, or why an image cannot fly it.
pub fn scenario(file: Option<&Path>, seed: Option<u64>) -> Result<Scenario, String> {
    let overrides = Overrides {
        seed,
        ..Overrides::default()
    };
    let scenario = match file {
        Some(path) => Scenario::load(path, &overrides).map_err(|e| e.to_string())?,
        None => Scenario::default_mission_with(&overrides),
    };
    flyable::check(&scenario)?;
    Ok(scenario)
}
