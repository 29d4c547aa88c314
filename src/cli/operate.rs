//! `sophie bringup` and `sophie params`: operations at a board.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use sophie_board_link::parameters::{self, Difference};
use sophie_board_link::session::Session;
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

fn session(args: &ParamsArgs) -> Result<Session, Failure> {
    let stop = on_ctrl_c().map_err(Failure::Input)?;
    args.line.session(&args.port, stop)
}

fn dump(args: &ParamsArgs) -> Result<(), Failure> {
    let mut session = session(args)?;
    let rows = parameters::listed(&mut session)?;
    let unsaved = parameters::unsaved(&mut session)?;
    if let Some(line) = unsaved.first() {
        let more = unsaved.len();
        complain(
            PROGRAM,
            &format!(
                "{}: {more} of them not saved at the board yet: {line}",
                session.port()
            ),
        );
    }
    let text = parameters::text(&parameters::version(&mut session)?, &rows);
    if args.file == Path::new("-") {
        return console::print(text.trim_end()).map_err(Failure::Input);
    }
    file::replace(&args.file, &text)?;
    say(&format!(
        "written: {}, {} parameters",
        args.file.display(),
        rows.len()
    ))
}

fn diff(args: &ParamsArgs) -> Result<bool, Failure> {
    let settings = read(&args.file)?;
    let mut session = session(args)?;
    let rows = parameters::listed(&mut session)?;
    let different = parameters::differences(&settings, &rows);
    let lines: Vec<String> = different.iter().map(Difference::text).collect();
    if !lines.is_empty() {
        say(&lines.join("\n"))?;
    }
    Ok(different.is_empty())
}

fn load(args: &ParamsArgs) -> Result<(), Failure> {
    let settings = read(&args.file)?;
    let mut session = session(args)?;
    parameters::load(&mut session, &settings, &mut |line| {
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
