//! `sample BOARD --elf FILE [SCENARIO] [--seeds FIRST-LAST] [--speed SHARE]`: flies a scenario with each seed on the host and
//! with the image on the emulated board, and compares outcome and phases (`cargo xtask sample BOARD`).
//!
//! Exit status: 0 where all are alike without gaps of the emulation, 1 where not, 2 for bad input.

use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use sophie_emulator::bench::Setup;
use sophie_emulator::elf::Firmware;
use sophie_emulator::flight::{self, Flight};
use sophie_emulator::plan::Plan;
use sophie_emulator::terminal::Sockets;
use sophie_emulator::{arguments, boards, compare};
use sophie_sim::parallel;
use sophie_sim::record::{FlightRecord, Silent};
use sophie_sim::scenario::Scenario;
use sophie_terminal::complain;

const PROGRAM: &str = "sample";
/// Most seeds of one call: a mission takes minutes.
const SEEDS_MAX: u64 = 1000;

/// Flies a mission with some seeds on the host and on an emulated board.
#[derive(Parser)]
#[command(name = "sample", version)]
struct Args {
    /// Board: matek-h743 or f405.
    board: String,
    /// Scenario file; without one the default mission is flown.
    scenario: Option<PathBuf>,
    /// Image to fly, as `cargo xtask firmware BOARD` builds it.
    #[arg(long, value_name = "FILE")]
    elf: PathBuf,
    /// First and last seed.
    #[arg(long, value_name = "FIRST-LAST", default_value = "1-10", value_parser = seeds)]
    seeds: RangeInclusive<u64>,
    /// Instructions for each cycle of the core's clock, 0.25 to 1.
    #[arg(long, value_name = "SHARE", default_value_t = 1.0)]
    speed: f64,
}

fn seeds(text: &str) -> Result<RangeInclusive<u64>, String> {
    let allowed = || {
        format!("`{text}`: allowed are two numbers as 1-10, the first not larger, at most {SEEDS_MAX} seeds")
    };
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    match (first.parse::<u64>(), last.parse::<u64>()) {
        (Ok(first), Ok(last)) if first <= last && last - first < SEEDS_MAX => Ok(first..=last),
        _ => Err(allowed()),
    }
}

fn main() -> ExitCode {
    let args = match arguments::parse(PROGRAM) {
        Ok(args) => args,
        Err(status) => return status,
    };
    match run(&args) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(line) => {
            complain(PROGRAM, &line);
            ExitCode::from(2)
        }
    }
}

fn run(args: &Args) -> Result<bool, String> {
    let board = boards::find(&args.board)?;
    arguments::check_speed(args.speed)?;
    let scenarios = args
        .seeds
        .clone()
        .map(|seed| arguments::scenario(args.scenario.as_deref(), Some(seed)))
        .collect::<Result<Vec<_>, String>>()?;
    let firmware = Firmware::read(&args.elf, board)?;
    let results = parallel::each(&scenarios, |scenario| {
        let line = fly(&firmware, scenario, args.speed);
        match &line {
            Ok((_, text)) => println!("seed {}: {text}", scenario.seed),
            Err(why) => println!("seed {}: {why}", scenario.seed),
        }
        line
    });
    let alike = results.iter().filter(|r| matches!(r, Ok((true, _)))).count();
    println!(
        "{alike} of {} alike on the host and on {}",
        scenarios.len(),
        args.board
    );
    Ok(alike == scenarios.len())
}

/// Whether host and board flew alike, and both in one line.
fn fly(firmware: &Firmware, scenario: &Scenario, speed: f64) -> Result<(bool, String), String> {
    let host = sophie_sim::flight::fly(scenario, &mut Silent);
    let setup = Setup {
        speed,
        plan: Plan::default(),
        sockets: Sockets::default(),
    };
    let Flight { record, gaps, board } = flight::fly(firmware, scenario, setup, |_| (), &mut Silent)?;
    let alike = compare::alike(&host, &record) && gaps.is_empty();
    let missed: u32 = board.overruns.values().sum();
    let text = format!(
        "{}; host {}; board {}; {missed} missed deadlines, {} gaps",
        if alike { "alike" } else { "DIFFERENT" },
        shown(&host),
        shown(&record),
        gaps.len()
    );
    Ok((alike, text))
}

fn shown(record: &FlightRecord) -> String {
    let done = record.phases.iter().filter(|p| p.done).count();
    let time = record.sim_seconds;
    format!("{done} steps in {time:.1} s, {}", record.outcome.reason)
}

#[cfg(test)]
mod tests {
    use super::seeds;

    #[test]
    fn seeds_are_a_range_of_some() {
        assert_eq!(seeds("1-10"), Ok(1..=10));
        assert_eq!(seeds("7"), Ok(7..=7));
        for wrong in ["", "a", "3-1", "1-", "1-10-20", "0-1000", "-3"] {
            assert!(seeds(wrong).is_err(), "{wrong}");
        }
    }
}
