//! Flights of the firmware images on the emulated boards. Common behaviour is tested on one board; flights of the F405
//! take half the time.
//!
//! Images are named by `SOPHIE_ELF` (matek-h743) and `SOPHIE_ELF_F405`, or built.

#![allow(missing_docs)]

mod arm_buses;
mod bringup;
mod builder;
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
mod stack;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use sophie_control::params::ServoMarks;
use sophie_emulator::board_kind;
use sophie_emulator::closed_loop::Setup;
use sophie_emulator::elf::Firmware;
use sophie_emulator::flight::{self, Flight};
use sophie_emulator::plan::{Plan, Trouble};
use sophie_emulator::terminal::Sockets;
use sophie_sim::record::{Sample, Silent};
use sophie_sim::scenario::{Overrides, Scenario, Step};

/// May never miss a deadline.
const FLIGHT_LEVEL: [&str; 5] = ["imu", "estimator", "control", "mixer", "motors"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap()
}

/// The image that `variable` names, or a built one.
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

fn image() -> &'static Path {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    IMAGE.get_or_init(|| image_of("matek-h743", "SOPHIE_ELF"))
}

fn small_image() -> &'static Path {
    static IMAGE: OnceLock<PathBuf> = OnceLock::new();
    IMAGE.get_or_init(|| image_of("f405", "SOPHIE_ELF_F405"))
}

fn scenario(name: &str) -> Scenario {
    let path = root().join("tests/scenarios").join(name);
    Scenario::load(&path, &Overrides::default()).unwrap()
}

/// Time at which a hover has been in the air for a second, s.
const AIRBORNE: f64 = 7.5;

fn hover(seconds: f64) -> Scenario {
    Scenario {
        time_limit: seconds,
        ..scenario("hover.toml")
    }
}

/// The shortest flight with landing, 3 s in the air for a fault.
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

/// With a vehicle whose servos have not been calibrated.
fn unmarked(mut scenario: Scenario) -> Scenario {
    scenario.params.servo_marks = ServoMarks::None;
    scenario
}

/// On the H743; `troubles` with times in s.
fn fly(scenario: &Scenario, speed: f64, troubles: &[(f64, Trouble)]) -> Flight {
    let firmware = Firmware::read(image(), board_kind::find("matek-h743").unwrap()).unwrap();
    fly_image(&firmware, scenario, speed, troubles)
}

/// On the F405.
fn fly_small(scenario: &Scenario, troubles: &[(f64, Trouble)]) -> Flight {
    let firmware = Firmware::read(small_image(), board_kind::find("f405").unwrap()).unwrap();
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

fn log(flight: &Flight) -> String {
    let lines = flight.board.lines.iter();
    lines.map(|line| format!("{line}\n")).collect()
}

/// Time (s) of the first line with `text` from `from` s on.
fn logged_at(flight: &Flight, from: f64, text: &str) -> Option<f64> {
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

/// False if the flight ended before.
fn stopped(flight: &Flight, from: f64, to: f64) -> bool {
    samples(flight, from, to).count() > 5 && samples(flight, from, to).all(|s| s.thrust_asked == [0.0; 4])
}

fn running(flight: &Flight, from: f64, to: f64) -> bool {
    samples(flight, from, to).all(|s| s.thrust_asked.iter().all(|t| *t > 0.0))
}
