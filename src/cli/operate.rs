//! `sophie bringup` and `sophie params`: operations at a board.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use sophie_board_link::parameters::{self, Difference, Listed};
use sophie_board_link::vehicle::Vehicle;
use sophie_board_link::{Failure, file};
use sophie_sim::scenario::settings::{self, Setting};
use sophie_terminal::{complain, console};

use super::args::{BringupArgs, ParamsArgs, ParamsVerb};
use super::builder::Terminal;
use super::interrupt::on_ctrl_c;
use super::{FAILED, PROGRAM, REFUSED};

/// Leads through the set-up of a vehicle.
pub fn bringup(args: &BringupArgs) -> ExitCode {
    let walked = on_ctrl_c().map_err(Failure::Input).and_then(|stop| {
        let mut vehicle = args.line.vehicle(&args.port, Arc::clone(&stop))?;
        let mut user = Terminal::new(stop);
        sophie_bringup::run(&mut vehicle, &mut user, &args.protocol, &args.again)
    });
    status(walked)
}

/// Writes, compares or sets a board's parameters.
pub fn params(args: &ParamsArgs) -> ExitCode {
    let done = match args.verb {
        ParamsVerb::Dump => dump(args).map(|()| true),
        // Status 1 is reserved for a difference.
        ParamsVerb::Diff => diff(args).map_err(|failure| Failure::Input(failure.to_string())),
        ParamsVerb::Load => load(args).map(|()| true),
    };
    status(done)
}

/// The exit status, after printing the reason.
fn status(done: Result<bool, Failure>) -> ExitCode {
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(FAILED),
        Err(failure) => {
            complain(PROGRAM, &failure.to_string());
            ExitCode::from(match failure {
                Failure::Input(_) => REFUSED,
                Failure::Board(_) | Failure::Stopped(_) => FAILED,
            })
        }
    }
}

fn vehicle(args: &ParamsArgs) -> Result<Vehicle, Failure> {
    let stop = on_ctrl_c().map_err(Failure::Input)?;
    args.line.vehicle(&args.port, stop)
}

/// The parameters of the board; a line on stderr if their table is another than this program's.
fn listed(vehicle: &mut Vehicle) -> Result<Listed, Failure> {
    let listed = Listed::of(vehicle)?;
    if let Some(line) = listed.foreign() {
        note(vehicle, &line);
    }
    Ok(listed)
}

fn note(vehicle: &Vehicle, line: &str) {
    complain(PROGRAM, &format!("{}: {line}", vehicle.port()));
}

fn dump(args: &ParamsArgs) -> Result<(), Failure> {
    let mut vehicle = vehicle(args)?;
    let listed = listed(&mut vehicle)?;
    if parameters::waits_for_restart(&mut vehicle)? {
        note(&vehicle, "what is stored there is in force after a restart");
    }
    let text = listed.text();
    if args.file == Path::new("-") {
        return console::print(text.trim_end()).map_err(Failure::Input);
    }
    file::replace(&args.file, &text)?;
    say(&format!(
        "written: {}, {} parameters",
        args.file.display(),
        listed.values.0.len()
    ))
}

fn diff(args: &ParamsArgs) -> Result<bool, Failure> {
    let settings = read(&args.file)?;
    let mut vehicle = vehicle(args)?;
    let different = listed(&mut vehicle)?.differences(&settings);
    let different = different.map_err(|why| Failure::Input(format!("{}: {why}", vehicle.port())))?;
    let lines: Vec<String> = different.iter().map(Difference::text).collect();
    if !lines.is_empty() {
        say(&lines.join("\n"))?;
    }
    Ok(different.is_empty())
}

fn load(args: &ParamsArgs) -> Result<(), Failure> {
    let settings = read(&args.file)?;
    let mut vehicle = vehicle(args)?;
    parameters::load(&mut vehicle, &settings, &mut |line| {
        // If stdout is closed, the board must still be set completely.
        let _ = console::print(line);
    })
}

/// The parameters of the file, all validated.
fn read(file: &Path) -> Result<Vec<Setting>, Failure> {
    settings::read(file).map_err(|error| Failure::Input(error.to_string()))
}

fn say(line: &str) -> Result<(), Failure> {
    console::print(line).map_err(Failure::Input)
}
