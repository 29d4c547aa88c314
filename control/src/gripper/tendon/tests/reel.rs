//! Angle, force and pulse of a reel, and the largest force.

use proptest::prelude::*;

use super::*;
use crate::maths::scalar;

#[test]
fn a_tilt_that_is_wrong_leaves_the_force_within_the_limit() {
    let p = params();
    let limit = ForceLimit::from_params(&p);
    // 2.452 N m on 15 mm are 163.47 N; 8000 N/m over 25 mm · 12.7 mrad and 15 mm · 5 mrad are 3.14 N.
    assert!(
        close(limit.force, 163.467, 1e-2) && close(limit.asked, 160.327, 1e-2),
        "{limit:?}"
    );
    let reel = Reel::from_params(&p, 0);
    let (tilt, mounting) = (-1.2, scalar::deg(0.5));
    let mut drive = TendonDrive::new();
    for _ in 0..400 {
        drive.step(&reel, 1e4, Some(tilt - mounting), 0.02);
    }
    let force = reel.force(drive.angle(), tilt);
    assert!((limit.asked..limit.force).contains(&force), "{force}");
    // A stiff tendon keeps half.
    let stiff = ForceLimit::from_params(&Params {
        tendon_stiffness: 1e5,
        servo_torque_max: 0.5,
        ..p
    });
    assert!(close(stiff.asked, 0.5 * stiff.force, 1e-3), "{stiff:?}");
}

#[test]
fn the_reel_by_hand() {
    let reel = Reel::from_params(&params(), 0);
    // 0.025·(0.4 + 1.0) = 35 mm, 80 N stretch 10 mm: 45 mm on 15 mm are 3 rad.
    assert!(close(reel.angle(80.0, -1.0), 3.0, 1e-4));
    assert!(close(reel.force(3.0, -1.0), 80.0, 0.01));
    // 3/4.71 of 1900 µs above 550 µs.
    assert!(close(reel.pulse(3.0), 1760.2, 0.1));
    // A drooping arm is slack, a flying one up to the reference.
    assert!(reel.force(0.0, -0.46) == 0.0 && reel.force(0.0, 0.39) == 0.0);
    assert!(reel.force(0.0, 0.41) > 0.0);
    assert!(close(reel.angle(160.0, -2.5), 4.71, 1e-6));
}

#[test]
fn each_servo_has_its_own_pulses_trim_and_slew() {
    let p = Params {
        servo_trim_2: -20.0,
        servo_release_3: 2300.0,
        servo_full_3: 700.0,
        servo_trim_3: 10.0,
        servo_slew_4: 3.0,
        ..params()
    };
    let [one, two, mirrored, slow] = Reel::all(&p);
    assert!(close(one.pulse(0.0), 550.0, 1e-3) && close(one.pulse(4.71), 2450.0, 1e-3));
    assert!(close(two.pulse(0.0), 530.0, 1e-3) && close(two.pulse(4.71), 2430.0, 1e-3));
    assert!(close(mirrored.pulse(0.0), 2310.0, 1e-3) && close(mirrored.pulse(4.71), 710.0, 1e-3));
    assert!(close(mirrored.pulse(2.355), 1510.0, 1e-3));
    assert!(close(slow.speed(0.0), 2.7, 1e-5) && close(one.speed(0.0), 5.544, 1e-5));
}

#[test]
fn a_travel_of_nothing_cannot_be_configured() {
    for (release, full, taken) in [
        (550.0, 550.0, 750.0),
        (2450.0, 2450.0, 2250.0),
        (1600.0, 1600.0, 1400.0),
        (1500.0, 1510.0, 1700.0),
        (1500.0, 1490.0, 1300.0),
        // No room on its side.
        (2440.0, 2450.0, 2240.0),
        (560.0, 550.0, 760.0),
    ] {
        let p = Params {
            servo_release_1: release,
            servo_full_1: full,
            ..params()
        };
        let reel = Reel::from_params(&p, 0);
        assert!(close(reel.pulse(0.0), release, 1e-3), "{release} {full}");
        assert!(
            close(reel.pulse(4.71), taken, 1e-3),
            "{release} {full}: {}",
            reel.pulse(4.71)
        );
    }
}

#[test]
fn a_weak_servo_caps_the_force_and_says_so() {
    let paper = ForceLimit::from_params(&params());
    assert!(!paper.capped_by_servo && close(paper.force, 2.452 / 0.015, 1e-3));
    // 0.85·0.922 N·m on 15 mm.
    let weak = ForceLimit::from_params(&Params {
        servo_stall: 0.922,
        ..params()
    });
    assert!(weak.capped_by_servo && close(weak.force, 52.25, 0.01));
}

proptest! {
    #[test]
    fn angle_and_force_undo_each_other(force in 0.0f32..160.0, tilt in -1.5f32..0.3) {
        let reel = Reel::from_params(&params(), 0);
        prop_assert!(close(reel.force(reel.angle(force, tilt), tilt), force, 0.05));
    }

    #[test]
    fn no_pulses_in_the_table_s_ranges_make_a_bad_reel(
        release in 550.0f32..=2450.0, full in 550.0f32..=2450.0, trim in -50.0f32..=50.0, angle in 0.0f32..=4.71,
    ) {
        let p = Params { servo_release_1: release, servo_full_1: full, servo_trim_1: trim, ..params() };
        let reel = Reel::from_params(&p, 0);
        let pulse = reel.pulse(angle);
        prop_assert!((500.0..=2500.0).contains(&pulse));
        prop_assert!(close(reel.angle_of(pulse), angle, 0.01));
        prop_assert!((reel.pulse(4.71) - reel.pulse(0.0)).abs() >= SPAN_MIN_US - 1e-3);
    }
}
