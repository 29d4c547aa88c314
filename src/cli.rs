//! The `sophie` command line.
//!
//! Exit status: 0 when the mission was accomplished, the vehicle can fly, the log was read or the board obeyed; 1 when
//! the mission was not accomplished, the vehicle cannot fly or the board refused; 2 when the mission could not be
//! flown, read or reported.

mod args;
mod builder;
mod capture;
mod check;
mod fit_lag;
mod fit_thrust;
mod interrupt;
mod key;
mod live;
mod operate;
mod publish;
mod recording;
mod study;
mod timing;
mod unknown;
mod vehicles;

use std::process::ExitCode;

use sophie_flight_report::terminal::{finish, live::watch, result};
use sophie_sim::check::Check;
use sophie_sim::flight::fly;
use sophie_sim::record::FlightRecord;
use sophie_sim::scenario::Scenario;
use sophie_terminal::complain;
use sophie_terminal::console::{self, Console};
use sophie_terminal::output::OutDir;

use self::args::{FlyArgs, Study, Task};

/// The mission was not accomplished.
const FAILED: u8 = 1;
/// Bad input, or the results could not be written.
const REFUSED: u8 = 2;
/// Program name at the start of every error line.
const PROGRAM: &str = "sophie";

/// Runs the command line of this process.
pub fn main() -> ExitCode {
    let task = match args::parse() {
        Ok(task) => task,
        Err(message) => return message.show(),
    };
    let done = match task {
        Task::Fly(args) if args.live.wanted => live::run(&args),
        Task::Fly(args) => run(&args),
        Task::Check(args) => check::run(&args),
        Task::Bringup(args) => return operate::bringup(&args),
        Task::Params(args) => return operate::params(&args),
        Task::Capture(args) => capture::run(&args),
        Task::Study(Study::Vehicles(args)) => vehicles::run(&args),
        Task::Study(Study::Unknown(args)) => unknown::run(&args),
        Task::Paper(args) => study::paper(&args),
        Task::FitArm(args) => study::fit_arm(&args),
        Task::FitThrust(args) => fit_thrust::run(&args),
        Task::FitLag(args) => fit_lag::run(&args),
        Task::FitTendon(args) => study::fit_tendon_steps(&args),
        Task::Timing(args) => timing::run(&args).map(|()| true),
        Task::Recording(args) => recording::run(&args).map(|()| true),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(FAILED),
        Err(line) => refuse(&line),
    }
}

fn run(args: &FlyArgs) -> Result<bool, String> {
    let scenario = args.mission.scenario()?;
    let out = args.report_directory()?;
    let console = Console::new(args.json);
    introduce(&scenario, &console);
    let record = watch(&console, |observer| fly(&scenario, observer));
    report(&record, out.as_ref(), &console, args.json)
}

/// Prints the planned flight, and warns if the design check fails.
fn introduce(scenario: &Scenario, console: &Console) {
    console.say(&result::intro(scenario));
    // Flown anyway: a study may examine how it fails.
    for row in Check::of(scenario).failing() {
        complain(PROGRAM, &format!("check: {}: {}", row.shortfall(), row.advice));
    }
}

/// Writes the report into `out`, if any, and shows it. True when the mission was accomplished.
fn report(
    record: &FlightRecord,
    out: Option<&OutDir>,
    console: &Console,
    json: bool,
) -> Result<bool, String> {
    finish(record, None, out, console, json)?;
    if !record.outcome.accomplished {
        let reason = console::one_line(&record.outcome.reason);
        complain(PROGRAM, &format!("not accomplished: {reason}"));
    }
    Ok(record.outcome.accomplished)
}

fn refuse(line: &str) -> ExitCode {
    complain(PROGRAM, line);
    ExitCode::from(REFUSED)
}
