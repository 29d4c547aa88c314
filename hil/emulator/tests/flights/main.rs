//! Flights of the images that `cargo xtask firmware BOARD` builds, on the emulated boards.
//!
//! What is common to the boards is tried on one of them; the small one's flights take half the time of the other's.
//!
//! The images are taken from the variables `SOPHIE_ELF` (matek-h743) and `SOPHIE_ELF_F405`, or built.

#![allow(missing_docs)]

mod chain;
mod console;
mod determinism;
mod faults;
mod first_hour;
mod images;
mod mavlink;
mod missions;
mod outputs;
mod pads;
mod parameters;
mod pulses;
mod script;
mod silicon;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use sophie_emulator::bench::Setup;
use sophie_emulator::boards;
use sophie_emulator::elf::Firmware;
use sophie_emulator::flight::{self, Flight};
use sophie_emulator::plan::{Plan, Trouble};
use sophie_emulator::terminal::Sockets;
use sophie_sim::record::{Sample, Silent};
use sophie_sim::scenario::{Overrides, Scenario, Step};

/// Tasks of the flight level: none of them may ever miss a deadline.
const FLIGHT_LEVEL: [&str; 5] = ["imu", "estimator", "control", "mixer", "motors"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap()
}

/// The image of a board: what `variable` names, or built.
fn image_of(board: &str, variable: &str) -> PathBuf {
    if let Some(path) = std::env::var_os(variable) {
        return path.into();
    }
    let built = Command::new(env!("CARGO"))
        .args(["xtask", "firmware", board])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    let text = String::from_utf8(built.stdout).unwrap();
    text.lines().last().unwrap().into()
}

/// The image of the reference board.
fn image() -> &'static Path {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    IMAGE.get_or_init(|| image_of("matek-h743", "SOPHIE_ELF"))
}

/// The image of the small board.
fn small_image() -> &'static Path {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    IMAGE.get_or_init(|| image_of("f405", "SOPHIE_ELF_F405"))
}

fn scenario(name: &str) -> Scenario {
    let path = root().join("tests/scenarios").join(name);
    Scenario::load(&path, &Overrides::default()).unwrap()
}

/// In the air since a second of a hover.
const AIRBORNE: f64 = 7.5;

/// The hover, of at most `seconds` s.
fn hover(seconds: f64) -> Scenario {
    Scenario {
        time_limit: seconds,
        ..scenario("hover.toml")
    }
}

/// The shortest flight that ends on the ground by itself: up a metre, long enough in the air for what goes wrong, down.
fn hop() -> Scenario {
    Scenario {
        steps: vec![
            Step::Arm,
            Step::TakeOff { height: 1.0 },
            Step::Hover { seconds: 3.0 },
            Step::Land,
            Step::Disarm,
        ],
        ..scenario("hover.toml")
    }
}

/// Flies `scenario` on the reference board while `troubles` happen, each at its time in s.
fn fly(scenario: &Scenario, speed: f64, troubles: &[(f64, Trouble)]) -> Flight {
    let firmware = Firmware::read(image(), boards::find("matek-h743").unwrap()).unwrap();
    fly_image(&firmware, scenario, speed, troubles)
}

/// Flies `scenario` on the small board while `troubles` happen, each at its time in s.
fn fly_small(scenario: &Scenario, troubles: &[(f64, Trouble)]) -> Flight {
    let firmware = Firmware::read(small_image(), boards::find("f405").unwrap()).unwrap();
    fly_image(&firmware, scenario, 1.0, troubles)
}

fn fly_image(firmware: &Firmware, scenario: &Scenario, speed: f64, troubles: &[(f64, Trouble)]) -> Flight {
    let plan = Plan::new(troubles.iter().map(|(t, trouble)| ((t * 1e3) as u64, *trouble)));
    flight::fly(
        firmware,
        scenario,
        Setup {
            speed,
            plan,
            sockets: Sockets::default(),
        },
        |_| (),
        &mut Silent,
    )
    .unwrap()
}

/// The log, for the message of a failed assertion.
fn log(flight: &Flight) -> String {
    let lines = flight.board.lines.iter();
    lines.map(|line| format!("{line}\n")).collect()
}

/// Time in s of the first line at `from` s or later that contains `text`.
fn told(flight: &Flight, from: f64, text: &str) -> Option<f64> {
    let lines = flight.board.lines.iter();
    let mut times = lines
        .filter(|line| line.text.contains(text))
        .map(|line| line.ms as f64 * 1e-3);
    times.find(|t| *t >= from)
}

fn samples(flight: &Flight, from: f64, to: f64) -> impl Iterator<Item = &Sample> {
    let all = flight.record.samples.iter();
    all.filter(move |s| (from..to).contains(&s.t))
}

/// Every motor's pin says stop, throughout; false for a flight that ended before.
fn stopped(flight: &Flight, from: f64, to: f64) -> bool {
    samples(flight, from, to).count() > 5 && samples(flight, from, to).all(|s| s.thrust_asked == [0.0; 4])
}

/// Every motor's pin asks for thrust, throughout.
fn running(flight: &Flight, from: f64, to: f64) -> bool {
    samples(flight, from, to).all(|s| s.thrust_asked.iter().all(|t| *t > 0.0))
}
