//! `chain BOARD ELF [STEPS]`: hovers the image on the emulated board and counts instructions of STEPS control steps, by
//! part and function (`cargo xtask chain BOARD`).
//!
//! Exit status: 0 when counted, 1 when the flight ended early, 2 for bad input.

use std::path::Path;
use std::process::ExitCode;

use sophie_emulator::board_kind;
use sophie_emulator::chain::{Functions, Window};
use sophie_emulator::closed_loop::Setup;
use sophie_emulator::elf::Firmware;
use sophie_emulator::flight::{self, Flight};
use sophie_emulator::plan::Plan;
use sophie_emulator::terminal::Sockets;
use sophie_sim::record::Silent;
use sophie_sim::scenario::{Overrides, Scenario, Step};

/// Hover, ms since power-on.
const HOVERS: u64 = 7500;
/// Default and most steps: the emulator stops at each instruction.
const STEPS: usize = 100;
const STEPS_MAX: usize = 2000;
const SEED: u64 = 1;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match count(&arguments) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(line) => {
            eprintln!("chain: {line}");
            ExitCode::from(2)
        }
    }
}

fn count(arguments: &[String]) -> Result<bool, String> {
    let [board, elf, rest @ ..] = arguments else {
        return Err("say `chain BOARD ELF`, with a number of steps behind it or none".to_owned());
    };
    let steps = match rest {
        [] => STEPS,
        [steps] => steps
            .parse()
            .ok()
            .filter(|steps| (1..=STEPS_MAX).contains(steps))
            .ok_or_else(|| format!("{steps} steps: allowed is 1 to {STEPS_MAX}"))?,
        [_, second, ..] => {
            return Err(format!(
                "`{second}` is not understood: allowed is one number of steps"
            ));
        }
    };
    let mut firmware = Firmware::read(Path::new(elf), board_kind::find(board)?)?;
    firmware.count = Some(Window {
        from_ms: HOVERS,
        steps,
    });
    let flight = fly(&firmware, steps)?;
    let counted = &flight.board.run.counted;
    print!("{}", counted.tables(&Functions::read(&firmware.bytes)?));
    let latency = flight.board.run.latency_us;
    println!(
        "\ndata-ready to the first edge of the motor frame: {:.1} us, at most {:.1}",
        latency.mean(),
        latency.worst
    );
    if counted.steps.len() < steps {
        eprintln!("chain: {} of {steps} steps came", counted.steps.len());
    }
    Ok(counted.steps.len() == steps && flight.gaps.is_empty())
}

fn fly(firmware: &Firmware, steps: usize) -> Result<Flight, String> {
    let overrides = Overrides {
        seed: Some(SEED),
        ..Overrides::default()
    };
    let scenario = Scenario {
        time_limit: (HOVERS + steps as u64 + 100) as f64 * 1e-3,
        steps: vec![
            Step::Arm,
            Step::TakeOff { height: 2.0 },
            Step::Hover { seconds: 5.0 },
        ],
        ..Scenario::default_mission_with(&overrides)
    };
    let setup = Setup {
        speed: 1.0,
        plan: Plan::default(),
        sockets: Sockets::default(),
    };
    flight::fly(firmware, &scenario, setup, |_| (), &mut Silent)
}
