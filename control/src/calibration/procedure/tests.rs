extern crate std;
use std::vec::Vec;

use super::*;
use crate::maths::scalar::GRAVITY;
use crate::params::{ArmSign, ServoMarks};

const TICK_US: u64 = 20_000;

/// Runs one step with the same `readings` at 50 Hz, from `now` on.
fn run(procedure: &mut Procedure, now: &mut u64, step: Step, readings: &Readings) -> Result<Outcome, Unfit> {
    procedure.begin(step, *now).unwrap();
    loop {
        if let Some(finding) = procedure.sample(*now, readings, &Params::DEFAULT, &Params::DEFAULT) {
            assert_eq!(finding.step, step);
            return finding.result;
        }
        *now += TICK_US;
    }
}

fn step(calibration: Calibration, part: u32, number: u32, values: [f32; 2]) -> Step {
    Step::new(calibration, part, number, values).unwrap()
}

/// A vehicle at rest that reads `accel`, m/s².
fn at_rest(accel: Vec3) -> Readings {
    Readings {
        attitude: Some((
            0,
            Attitude {
                accel,
                ..Attitude::default()
            },
        )),
        ..Readings::default()
    }
}

fn named(outcome: Result<Outcome, Unfit>) -> Vec<(&'static str, f32)> {
    match outcome {
        Ok(Outcome::Done(changes)) => changes.into_iter().flatten().collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn six_sides_give_bias_and_scale_and_a_wrong_side_is_asked_again() {
    let (mut procedure, mut now) = (Procedure::new(), 0);
    // Reads 2 % too much, and 0.1 m/s² beside it along x.
    let read = |face: Face| at_rest(face.force() * 1.02 + Vec3::new(0.1, 0.0, 0.0));
    for (number, face) in (1..).zip(Face::ALL) {
        let asked = step(Calibration::Accel, 0, number, [0.0; 2]);
        if number == 3 {
            let wrong = run(&mut procedure, &mut now, asked, &read(Face::Back)).unwrap_err();
            assert_eq!(wrong.what, "gravity on this side");
        }
        let outcome = run(&mut procedure, &mut now, asked, &read(face));
        if number < 6 {
            assert_eq!(outcome, Ok(Outcome::Taken), "{number}");
        } else {
            let found = named(outcome);
            assert_eq!(found.first(), Some(&("accel_bias_x", 0.1)));
            assert_eq!(found.last(), Some(&("accel_scale_z", 1.02)));
            assert_eq!(found.len(), 6);
        }
    }
}

#[test]
fn a_step_wants_those_before_it_of_the_same_part_and_in_time() {
    let mut procedure = Procedure::new();
    let mut now = 0;
    let straight = Readings {
        tilts: [Some(0.02); 4],
        ..Readings::default()
    };
    let first = step(Calibration::Arm, 2, 1, [0.0; 2]);
    let second = step(Calibration::Arm, 2, 2, [0.0; 2]);
    assert_eq!(procedure.begin(second, now), Err(OutOfOrder));
    assert_eq!(
        run(&mut procedure, &mut now, first, &straight),
        Ok(Outcome::Taken)
    );
    // Another arm, then too late.
    assert_eq!(
        procedure.begin(step(Calibration::Arm, 3, 2, [0.0; 2]), now),
        Err(OutOfOrder)
    );
    assert_eq!(procedure.begin(second, now + KEPT_US + 1), Err(OutOfOrder));
    let bent = Readings {
        tilts: [Some(-0.38); 4],
        ..Readings::default()
    };
    // Bent up it reads less: the sensor is mounted in reverse, and the straight arm reads 0.02 the other way.
    let found = named(run(&mut procedure, &mut now, second, &bent));
    assert_eq!(
        found,
        [("arm_sign_2", ArmSign::Reversed.number()), ("arm_zero_2", -0.02)]
    );
    // Complete: its last step alone means nothing now.
    assert_eq!(procedure.begin(second, now), Err(OutOfOrder));
}

/// Loads over the sensor's area, Pa, in the order of the steps.
const LOADS: [f32; 7] = [0.0, 650.0, 950.0, 1350.0, 950.0, 650.0, 0.0];

/// Step `number` of sensor 3.
fn load(number: u8) -> Step {
    let newton = LOADS[usize::from(number) - 1] * Params::DEFAULT.fsr_area;
    step(Calibration::Fsr, 3, number.into(), [newton, 0.0])
}

fn pressing(pascal: f32) -> Readings {
    Readings {
        pressures: [None, None, Some(pascal), None],
        ..Readings::default()
    }
}

/// What a sensor of 0.8 of the conductance shows that begins at 200 Pa, with 5 % of hysteresis.
fn shown(number: u8) -> f32 {
    let side = if number <= 4 { 0.95 } else { 1.05 };
    let above = side * LOADS[usize::from(number) - 1] - 200.0;
    0.8 * if above > 0.0 { above } else { 0.0 }
}

#[test]
fn loads_up_and_down_give_the_line_and_the_hysteresis_of_one_sensor() {
    let (mut procedure, mut now) = (Procedure::new(), 0);
    assert_eq!(procedure.next(Calibration::Fsr, 2, now), 1);
    for number in 1..=6 {
        let outcome = run(&mut procedure, &mut now, load(number), &pressing(shown(number)));
        assert_eq!(outcome, Ok(Outcome::Taken), "{number}");
        assert_eq!(procedure.next(Calibration::Fsr, 2, now), number + 1);
        assert_eq!(procedure.next(Calibration::Fsr, 1, now), 1);
    }
    procedure.begin(load(7), now).unwrap();
    let finding = loop {
        if let Some(finding) = procedure.sample(now, &pressing(0.0), &Params::DEFAULT, &Params::DEFAULT) {
            break finding;
        }
        now += TICK_US;
    };
    // Between both branches: 0.8, from 200 Pa on.
    let found = named(finding.result);
    let [(trim, a), (zero, b)] = found.as_slice() else {
        panic!("{found:?}");
    };
    assert_eq!((*trim, *zero), ("fsr_trim_3", "fsr_zero_3"));
    assert!((a - 0.8).abs() < 1e-3 && (b + 200.0).abs() < 0.5, "{found:?}");
    let [error, hysteresis, empty, none] = finding.figures;
    assert!((hysteresis - 5.0).abs() < 0.01 && empty == 0.0 && none.is_nan());
    // Nothing scatters: what the loads do not show is left, 5 % of 950 Pa.
    assert!((error - 47.5).abs() < 0.5, "{error}");
}

#[test]
fn a_load_that_is_repeated_wants_those_after_it_again() {
    let (mut procedure, mut now) = (Procedure::new(), 0);
    for number in [1, 2, 3, 4, 3] {
        let outcome = run(&mut procedure, &mut now, load(number), &pressing(shown(number)));
        assert_eq!(outcome, Ok(Outcome::Taken), "{number}");
    }
    assert_eq!(procedure.begin(load(5), now), Err(OutOfOrder));
    assert_eq!(procedure.begin(load(4), now), Ok(()));
    // A silent sensor gives no samples, and a load that is not put on changes nothing.
    let silent = run(&mut procedure, &mut now, load(1), &Readings::default()).unwrap_err();
    assert_eq!((silent.what, silent.value), ("samples", 0.0));
    run(&mut procedure, &mut now, load(1), &pressing(0.0)).unwrap();
    let missing = run(&mut procedure, &mut now, load(2), &pressing(0.0)).unwrap_err();
    assert_eq!((missing.what, missing.value), ("reading of the load", 0.0));
}

#[test]
fn marks_of_a_servo_are_taken_without_its_trim_beside_those_of_others() {
    let mut procedure = Procedure::new();
    let mut in_force = Params::DEFAULT;
    in_force.set("servo_trim_2", 15.0).unwrap();
    let mut working = in_force;
    working
        .set("servo_marks", ServoMarks::None.with(0).number())
        .unwrap();
    procedure
        .begin(step(Calibration::Servo, 2, 1, [1015.0, 2015.0]), 7)
        .unwrap();
    let finding = procedure
        .sample(7, &Readings::default(), &in_force, &working)
        .unwrap();
    let marks = ServoMarks::None.with(0).with(1).number();
    assert_eq!(
        named(finding.result),
        [
            ("servo_release_2", 1000.0),
            ("servo_full_2", 2000.0),
            ("servo_marks", marks)
        ]
    );
    for (values, what) in [
        ([1000.0, 1150.0], "travel"),
        ([560.0, 2015.0], "pulse at release"),
        ([1000.0, 2470.0], "pulse at the full mark"),
    ] {
        procedure
            .begin(step(Calibration::Servo, 2, 1, values), 7)
            .unwrap();
        let finding = procedure
            .sample(7, &Readings::default(), &in_force, &working)
            .unwrap();
        assert_eq!(finding.result.unwrap_err().what, what);
    }
}

#[test]
fn three_sides_give_the_mounting_and_a_left_handed_three_does_not() {
    let (mut procedure, mut now) = (Procedure::new(), 0);
    // Turned by a quarter about the vertical: the nose lies where the board has its right side.
    let sides = [Face::Belly, Face::Right, Face::Tail];
    for (number, face) in (1..).zip(sides) {
        let asked = step(Calibration::Mounting, 0, number, [0.0; 2]);
        let outcome = run(&mut procedure, &mut now, asked, &at_rest(face.force()));
        if number == 3 {
            assert_eq!(
                named(outcome).first().map(|(name, _)| *name),
                Some("imu_mounting")
            );
        }
    }
    for (number, face) in (1..).zip([Face::Belly, Face::Right, Face::Nose]) {
        let asked = step(Calibration::Mounting, 0, number, [0.0; 2]);
        let outcome = run(&mut procedure, &mut now, asked, &at_rest(face.force()));
        if number == 3 {
            assert_eq!(outcome.unwrap_err().what, "three sides of one vehicle");
        }
    }
}

#[test]
fn no_step_is_made_of_other_numbers() {
    for (calibration, part, number, values) in [
        (Calibration::Gyro, 0, 2, [0.0; 2]),
        (Calibration::Gyro, 1, 1, [0.0; 2]),
        (Calibration::Arm, 0, 1, [0.0; 2]),
        (Calibration::Arm, 5, 1, [0.0; 2]),
        (Calibration::Accel, 0, 0, [0.0; 2]),
        (Calibration::Accel, 0, 300, [0.0; 2]),
        (Calibration::Battery, 0, 1, [f32::NAN; 2]),
        (Calibration::Battery, 0, 1, [0.0; 2]),
        (Calibration::Fsr, 1, 2, [0.0; 2]),
        (Calibration::Servo, 1, 1, [1000.0, f32::INFINITY]),
    ] {
        assert_eq!(Step::new(calibration, part, number, values), None);
    }
}

#[test]
fn a_cancelled_step_ends_without_a_result() {
    let mut procedure = Procedure::new();
    procedure
        .begin(step(Calibration::Gyro, 0, 1, [0.0; 2]), 0)
        .unwrap();
    assert_eq!(procedure.progress(1_250_000), 50);
    assert!(procedure.cancel());
    assert!(!procedure.cancel());
    let late = 60_000_000;
    assert_eq!(
        procedure.sample(
            late,
            &at_rest(Vec3::new(0.0, 0.0, -GRAVITY)),
            &Params::DEFAULT,
            &Params::DEFAULT
        ),
        None
    );
}
