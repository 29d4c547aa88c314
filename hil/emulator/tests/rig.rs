//! The tests of `hil/rig` on the emulated board: each passes on a sound rig and fails with its defect.

#![allow(missing_docs)]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use sophie_emulator::elf::Firmware;
use sophie_emulator::emulator::rig::{Defect, read, run};
use sophie_emulator::gaps;
use sophie_emulator::suite::{self, Test};

/// From `SOPHIE_RIG_ELF`, or built.
static IMAGE: LazyLock<(Firmware, Vec<Test>)> = LazyLock::new(|| {
    let path = std::env::var_os("SOPHIE_RIG_ELF").map_or_else(build, PathBuf::from);
    let image = read(&path).expect("the tests' image");
    let tests = suite::tests(&image).expect("its tests");
    (image, tests)
});

fn build() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let output = Command::new(env!("CARGO"))
        .current_dir(root)
        .args(["xtask", "rig", "matek-h743", "--wired", "--build"])
        .output()
        .expect("cargo runs");
    let printed = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{printed}");
    let printed = String::from_utf8_lossy(&output.stdout);
    PathBuf::from(printed.lines().last().expect("the path of the ELF"))
}

fn verdict(name: &str, defect: Defect) -> (Option<u32>, String) {
    let (image, tests) = &*IMAGE;
    let test = tests.iter().find(|test| test.name == name).expect(name);
    let ended = run(image, test, defect).expect(name);
    if defect == Defect::None {
        assert_eq!(
            gaps::not_allowed(&ended.gaps).unwrap(),
            Vec::<&_>::new(),
            "{name}"
        );
    }
    let last = ended.lines.last().map_or(String::new(), |line| line.text.clone());
    (ended.status, last)
}

/// Tests that fail with a defect, and part of their messages.
type Found = (Defect, &'static [(&'static str, &'static str)]);

const TRIED: [Found; 8] = [
    (
        Defect::Crystal,
        &[("t20_imu::samples_come_at_their_rate", "Hz instead of")],
    ),
    (
        Defect::NoImu,
        &[("t20_imu::it_answers_by_its_name_and_feels_gravity", "no sample")],
    ),
    (
        Defect::NoArm,
        &[(
            "t30_arms::every_sensor_that_is_plugged_in_feels_gravity",
            "not found: BNO055 of arm 3",
        )],
    ),
    (
        Defect::NoJumpers,
        &[
            (
                "t50_dshot::a_controller_would_read_every_frame",
                "not found: jumper",
            ),
            (
                "t51_servo::pulses_are_as_long_as_asked_and_as_often",
                "not found: jumper",
            ),
            ("t60_receiver::what_is_sent_is_received", "not found: jumper"),
        ],
    ),
    (
        Defect::Divider,
        &[(
            "t40_analog::half_the_supply_is_half_the_scale",
            "counts instead of",
        )],
    ),
    (
        Defect::Stalls,
        &[
            ("t10_timers::a_millisecond_lasts_a_millisecond", "us late"),
            (
                "t10_timers::the_flight_level_preempts_the_background",
                "beats in 100 ms",
            ),
            ("t40_analog::every_conversion_is_in_time", " us"),
        ],
    ),
    (
        Defect::Watchdog,
        &[(
            "t70_watchdog::it_resets_a_board_that_stands_still",
            "the watchdog never reset it",
        )],
    ),
    (
        Defect::Forgets,
        &[(
            "t80_storage::a_parameter_outlives_a_reset",
            "after the reset instead of",
        )],
    ),
];

/// Unaffected by any defect of the rig.
const WITHIN: [&str; 3] = [
    "t00_clock::the_core_runs_at_its_clock",
    "t00_clock::the_time_base_never_runs_back",
    "t11_copies::a_copy_is_exact_and_nothing_around_it_changes",
];

fn found(defect: Defect) {
    for (name, words) in TRIED.iter().filter(|(d, _)| *d == defect).flat_map(|(_, f)| *f) {
        let (status, printed) = verdict(name, Defect::None);
        assert_eq!(status, Some(0), "{name} on a sound rig: {printed}");
        let (status, printed) = verdict(name, defect);
        assert!(
            status.is_some_and(|s| s != 0),
            "{name} with {defect:?}: {status:?} {printed}"
        );
        assert!(printed.contains(words), "{name} with {defect:?}: {printed}");
    }
}

#[test]
fn no_test_is_left_out() {
    let mut tried: Vec<&str> = TRIED
        .iter()
        .flat_map(|(_, f)| f.iter().map(|(name, _)| *name))
        .chain(WITHIN)
        .collect();
    tried.sort_unstable();
    let tests: Vec<&str> = IMAGE.1.iter().map(|test| test.name.as_str()).collect();
    assert_eq!(tests, tried);
}

#[test]
fn the_clocks_keep_time() {
    for name in WITHIN {
        let (status, printed) = verdict(name, Defect::None);
        assert_eq!(status, Some(0), "{name}: {printed}");
    }
}

#[test]
fn a_wrong_crystal_is_found() {
    found(Defect::Crystal);
}

#[test]
fn a_silent_inertial_sensor_is_found() {
    found(Defect::NoImu);
}

#[test]
fn a_silent_arm_sensor_is_found() {
    found(Defect::NoArm);
}

#[test]
fn a_disconnected_line_is_found() {
    found(Defect::NoJumpers);
}

#[test]
fn a_wrong_voltage_is_found() {
    found(Defect::Divider);
}

#[test]
fn a_processor_that_stalls_is_found() {
    found(Defect::Stalls);
}

#[test]
fn a_dead_watchdog_is_found() {
    found(Defect::Watchdog);
}

#[test]
fn a_flash_that_forgets_is_found() {
    found(Defect::Forgets);
}
