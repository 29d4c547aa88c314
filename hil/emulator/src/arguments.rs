//! Command-line arguments that the binaries share. Each error is one line on stderr.

use std::path::Path;
use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;
use sophie_sim::scenario::{Overrides, Scenario};
use sophie_terminal::complain;

use crate::{SPEEDS, flyable};

/// Runs `program` with its arguments. Exit status: 0 where `run` gives true, 1 where false, 2 after a complaint.
pub fn serve<A: Parser>(program: &str, run: impl FnOnce(&A) -> Result<bool, String>) -> ExitCode {
    let args = match parse(program) {
        Ok(args) => args,
        Err(status) => return status,
    };
    match run(&args) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(line) => {
            complain(program, &line);
            ExitCode::from(2)
        }
    }
}

/// The arguments of `program`.
///
/// # Errors
/// The exit status after help, the version or a complaint.
fn parse<A: Parser>(program: &str) -> Result<A, ExitCode> {
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
/// One line: the speed and the allowed range.
pub fn check_speed(speed: f64) -> Result<(), String> {
    let (low, high) = (SPEEDS.start(), SPEEDS.end());
    SPEEDS
        .contains(&speed)
        .then_some(())
        .ok_or_else(|| format!("--speed {speed}: allowed is {low} to {high}"))
}

/// The scenario of the file, or the default mission without a file; `seed` replaces its seed.
///
/// # Errors
/// One line: the mistake in the file, or the setting that an image cannot fly.
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
