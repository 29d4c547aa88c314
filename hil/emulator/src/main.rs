//! `sophie-emulator`: flies a scenario with the image of an emulated board. `cargo xtask bench` builds both and calls
//! it.
//!
//! Exit status: 0 when the mission was accomplished without gaps of the emulation, 1 when not, 2 for bad input. Without a
//! pilot no mission is flown.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::{Parser, ValueEnum};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use sophie_emulator::closed_loop::Setup;
use sophie_emulator::compare;
use sophie_emulator::elf::Firmware;
use sophie_emulator::flight::{self, Flight};
use sophie_emulator::log::Line;
use sophie_emulator::plan::{Plan, Trouble};
use sophie_emulator::silicon;
use sophie_emulator::terminal::{Sockets, Terminal};
use sophie_emulator::wires::{BoardFault, Gap};
use sophie_emulator::{arguments, board_kind};
use sophie_flight_report::terminal::live::Lines;
use sophie_flight_report::terminal::{Attachment, FILES, finish, result};
use sophie_sim::record::Silent;
use sophie_sim::scenario::Scenario;
use sophie_terminal::complain;
use sophie_terminal::console::{self, Console};
use sophie_terminal::output::OutDir;

const PROGRAM: &str = "bench";
/// The decoded log, and the log as written by the firmware.
const LOG_FILES: [&str; 2] = ["log.txt", "log.bin"];
/// Prefixes of log lines too frequent for a terminal.
const EACH_SECOND: [&str; 2] = ["timing ", "trace "];
/// Exit status after a second Ctrl-C, as a shell gives it.
const INTERRUPTED: i32 = 130;

/// Who flies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Pilot {
    /// The vehicle stands on the ground, the transmitter is off.
    None,
}

/// Flies a mission with the image that is flashed, on an emulated board.
#[derive(Parser)]
#[command(name = "bench", version)]
struct Args {
    /// Board: matek-h743 or f405.
    board: String,
    /// Scenario file; without one the default mission is flown.
    scenario: Option<PathBuf>,
    /// Image to fly, as `cargo xtask firmware BOARD` builds it.
    #[arg(long, value_name = "FILE")]
    elf: PathBuf,
    /// Seed of every random number.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Directory for report.html, flight.mcap, summary.json, bench.json, log.txt and log.bin.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Instructions for each cycle of the core's clock, 0.25 to 1: a real core manages fewer than one at times.
    #[arg(
        long,
        value_name = "SHARE",
        default_value_t = 1.0,
        allow_negative_numbers = true
    )]
    speed: f64,
    /// Put the board's console on this port of 127.0.0.1.
    #[arg(long, value_name = "PORT")]
    console: Option<u16>,
    /// Put what the board sends to its receiver on this port of 127.0.0.1.
    #[arg(long, value_name = "PORT")]
    telemetry: Option<u16>,
    /// Put the board's MAVLink line on this port of 127.0.0.1.
    #[arg(long, value_name = "PORT")]
    mavlink: Option<u16>,
    /// Start with the option bytes of a new chip, without a brown-out level.
    #[arg(long)]
    factory: bool,
    /// Who flies: none waits on the ground without a transmitter until Ctrl-C, and leaves no report.
    #[arg(long, value_name = "none", conflicts_with_all = ["json", "out"])]
    pilot: Option<Pilot>,
    /// Print the result as JSON on stdout, everything else on stderr.
    #[arg(long)]
    json: bool,
}

fn main() -> ExitCode {
    arguments::serve(PROGRAM, run)
}

fn run(args: &Args) -> Result<bool, String> {
    let board = board_kind::find(&args.board)?;
    arguments::check_speed(args.speed)?;
    let scenario = arguments::scenario(args.scenario.as_deref(), args.seed)?;
    let firmware = Firmware::read(&args.elf, board)?;
    let listen = |option, port: Option<u16>| port.map(|port| Terminal::listen(option, port)).transpose();
    let sockets = Sockets {
        console: listen("--console", args.console)?,
        telemetry: listen("--telemetry", args.telemetry)?,
        mavlink: listen("--mavlink", args.mavlink)?,
    };
    let factory = args
        .factory
        .then_some((0, Trouble::Board(BoardFault::FactoryOptions)));
    let setup = Setup {
        speed: args.speed,
        plan: Plan::new(factory),
        sockets,
    };
    match args.pilot {
        Some(Pilot::None) => stand(args, &firmware, &scenario, setup),
        None => fly(args, &firmware, &scenario, setup),
    }
}

fn introduce(args: &Args, console: &Console) {
    console.say(&format!(
        "{} on an emulated {}, {} instructions a cycle",
        args.elf.display(),
        args.board,
        args.speed
    ));
}

/// Keeps the board running on the ground until Ctrl-C.
fn stand(args: &Args, firmware: &Firmware, scenario: &Scenario, setup: Setup) -> Result<bool, String> {
    let console = Console::new(args.json);
    introduce(args, &console);
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the first signal finds the flag down.
        let caught = flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&stop))
            .and_then(|_| flag::register(signal, Arc::clone(&stop)));
        caught.map_err(|why| format!("Ctrl-C cannot be caught: {why}"))?;
    }
    console.say("waits until Ctrl-C");
    let stood = flight::stand(
        firmware,
        scenario,
        setup,
        None,
        |line| show(&console, line),
        || stop.load(Ordering::Relaxed),
    )?;
    complain_of(&stood.gaps);
    Ok(stood.gaps.is_empty())
}

/// Flies the mission and reports it.
fn fly(args: &Args, firmware: &Firmware, scenario: &Scenario, setup: Setup) -> Result<bool, String> {
    let out = OutDir::prepare(&args.out, &[&FILES[..], &LOG_FILES].concat())?;
    let console = Console::new(args.json);
    console.say(&result::intro(scenario));
    introduce(args, &console);
    let flight = flight::fly(
        firmware,
        scenario,
        setup,
        |line| show(&console, line),
        &mut Lines::new(&console),
    )?;
    write(args, scenario, &flight, &out, &console)?;
    if !flight.record.outcome.accomplished {
        let reason = console::one_line(&flight.record.outcome.reason);
        complain(PROGRAM, &format!("not accomplished: {reason}"));
    }
    complain_of(&flight.gaps);
    Ok(flight.passed())
}

fn show(console: &Console, line: &Line) {
    if !EACH_SECOND.iter().any(|begin| line.text.starts_with(begin)) {
        console.say(&line.to_string());
    }
}

/// Writes the flight's files, and prints the result beside the host's flight.
fn write(
    args: &Args,
    scenario: &Scenario,
    flight: &Flight,
    out: &OutDir,
    console: &Console,
) -> Result<(), String> {
    // This takes a second, the emulation minutes.
    let host = sophie_sim::flight::fly(scenario, &mut Silent);
    let mut value = summary(args, flight);
    value["host"] = compare::value(&host);
    let attachment = Attachment {
        name: "bench",
        value,
        lines: [compare::lines(&host, &flight.record), lines(flight)].concat(),
    };
    let text: String = flight
        .board
        .lines
        .iter()
        .map(|line| format!("{line}\n"))
        .collect();
    let logs = [text.into_bytes(), flight.board.log.clone()];
    let logs: Vec<_> = LOG_FILES.into_iter().zip(logs).collect();
    let _ = out.write(&logs)?;
    finish(&flight.record, Some(&attachment), Some(out), console, args.json)?;
    Ok(())
}

fn complain_of(gaps: &[Gap]) {
    for gap in gaps {
        complain(
            PROGRAM,
            &format!(
                "the emulator cannot vouch for {} {}: {}: allowed is what hil/emulator/allowed_gaps.toml lists",
                gap.kind, gap.at, gap.what
            ),
        );
    }
}

/// Results of the emulation attachment the flight, as JSON.
fn summary(args: &Args, flight: &Flight) -> serde_json::Value {
    let board = &flight.board;
    let run = &board.run;
    let intervals = run.escs.iter().filter_map(|esc| esc.interval);
    let stack = silicon::stack_use(&board.lines);
    let longest = intervals.map(|[_, longest]| longest).max().unwrap_or(0);
    serde_json::json!({
        "board": args.board,
        "speed": args.speed,
        "passed": flight.passed(),
        "digest": format!("{:016x}", flight.digest()),
        "instructions": run.instructions,
        "motor_frames": run.escs.map(|esc| esc.frames),
        "motor_frames_bad": run.escs.map(|esc| esc.bad),
        "motor_frame_gap_max_us": longest as f64 * 1e-3,
        "latency_mean_us": run.latency_us.mean(),
        "latency_max_us": run.latency_us.worst,
        "arm_tilt_error_mean_deg": board.tilt_error.mean().map(f64::to_degrees),
        "arm_tilt_error_max_deg": board.tilt_error.mean().map(|_| board.tilt_error.worst.to_degrees()),
        "overruns": board.overruns,
        "flash_erases": run.erases.iter().map(|(sector, times)| (format!("{sector:#010x}"), times)).collect::<BTreeMap<_, _>>(),
        "resets": board.resets.iter().map(|(ms, why)| serde_json::json!({"t_s": ms * 1e-3, "cause": why})).collect::<Vec<_>>(),
        "silicon": silicon::rows(&board.lines),
        "stack_bytes": stack.map(|s| s.bytes),
        "stack_start": stack.map(|s| s.start),
        "stack_flight": stack.map(|s| s.flight),
        "log_lines": board.lines.len(),
        "log_malformed": board.malformed,
        "gaps_allowed": run.gaps.len() - flight.gaps.len(),
        "gaps": flight.gaps.iter().map(|g| serde_json::json!({"kind": g.kind, "at": g.at, "what": g.what})).collect::<Vec<_>>(),
    })
}

/// The same as lines of text.
fn lines(flight: &Flight) -> Vec<String> {
    let run = &flight.board.run;
    let frames: u64 = run.escs.iter().map(|esc| esc.frames).sum();
    let bad: u64 = run.escs.iter().map(|esc| esc.bad).sum();
    let tilt = flight.board.tilt_error;
    vec![
        String::new(),
        tilt.mean()
            .map_or("arm tilt: never in the air".to_owned(), |mean| {
                format!(
                    "arm tilt in flight, measured against the model: {:.1} deg off, at most {:.1}",
                    mean.to_degrees(),
                    tilt.worst.to_degrees()
                )
            }),
        format!(
            "motor frames: {frames} good, {bad} bad; from data-ready to their first edge {:.0} us, at most {:.0}",
            run.latency_us.mean(),
            run.latency_us.worst
        ),
        format!(
            "emulator: {} million instructions, {} gaps, {} resets; digest {:016x}",
            run.instructions / 1_000_000,
            run.gaps.len(),
            flight.board.resets.len(),
            flight.digest()
        ),
    ]
}
