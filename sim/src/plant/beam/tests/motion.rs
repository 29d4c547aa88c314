//! Modes and energy of one arm on a body that cannot move.

use super::*;

/// Zero crossings of `of` about its start's mean, Hz, over 10 s.
fn rings(arm: &mut BeamArm, drive: &Drive, of: impl Fn(&BeamArm) -> f64) -> f64 {
    let mut crossings = 0;
    for _ in 0..20_000 {
        let before = of(arm) > 0.0;
        step(arm, drive);
        crossings += i32::from(before != (of(arm) > 0.0));
    }
    f64::from(crossings) / 2.0 / 10.0
}

#[test]
fn the_first_mode_is_at_five_hertz_in_hover_with_table_2_s_masses() {
    let hover = Drive {
        thrust: 4.425,
        ..Drive::default()
    };
    let rest = settled(built(6.9), &hover).shape();
    let mut arm = BeamArm::new(2, undamped(6.9));
    // Nearly the first mode's shape: its own static one under a force.
    arm.bend([rest[0] + 0.02, rest[1] - 0.01]);
    let mean = rest[0] + rest[1];
    let hz = rings(&mut arm, &hover, |arm| arm.tilt() - mean);
    assert!((4.8..5.4).contains(&hz), "{hz}");
}

#[test]
fn both_modes_are_those_of_a_uniform_beam_with_a_tip_mass() {
    // Without tip the first two roots of cos λ cosh λ = -1 give 1.875² and 4.694² times √(EI/(m L³)). Two terms and
    // Lobatto's points meet the first within 2 %; with a tip mass much larger than the beam's, √(3 EI/(M L³)).
    let spec = uniform(1.0, 0.15);
    let stiffness = spec.bending_stiffness() / libm::pow(crate::plant::contact::ARM_LENGTH, 3.0);
    let only = |middle: f64, tip: f64| {
        let mut beam = uniform(1.0, 0.15);
        beam.masses = Masses {
            middle,
            tip,
            block: 1e-12,
        };
        beam.modes(0.0)
    };
    let [heavy, _] = only(1e-6, 1.0);
    let book = (3.0 * stiffness).sqrt() / std::f64::consts::TAU;
    assert!((heavy / book - 1.0).abs() < 1e-3, "{heavy} {book}");
    let [bare, _] = only(0.14 * 2.0 / 3.0, 0.14 / 6.0);
    let book = 1.875_1 * 1.875_1 * (stiffness / 0.14).sqrt() / std::f64::consts::TAU;
    assert!((bare / book - 1.0).abs() < 0.02, "{bare} {book}");
    // The tip's mass with the beam's 33/140.
    let [both, second] = spec.modes(0.0);
    let book = (3.0 * stiffness / (0.1 + 0.14 * 33.0 / 140.0)).sqrt() / std::f64::consts::TAU;
    assert!((both / book - 1.0).abs() < 0.02, "{both} {book}");
    assert!(second > 6.0 * both, "{second}");
}

#[test]
fn the_second_mode_of_the_printed_arm_is_between_30_and_50_hz() {
    let [first, second] = built(6.9).modes(4.425);
    assert!(
        (4.8..5.4).contains(&first) && (30.0..50.0).contains(&second),
        "{first} {second}"
    );
}

#[test]
fn both_modes_are_damped_by_the_stated_ratio() {
    // A free oscillation falls by exp(-2π ζ/√(1-ζ²)) a period: 0.385 at 0.15. Uniform, so that hover's tangent is rest's.
    let mut arm = BeamArm::new(2, uniform(6.0, 0.15));
    arm.bend([0.02, -0.01]);
    let (mut last, mut peaks) = (0.0, Vec::new());
    for _ in 0..3000 {
        let before = arm.tilt();
        step(&mut arm, &Drive::default());
        let speed = arm.tilt() - before;
        if last > 0.0 && speed <= 0.0 {
            peaks.push(before);
        }
        last = speed;
    }
    let ratio = peaks[2] / peaks[1];
    assert!((ratio / 0.385 - 1.0).abs() < 0.05, "{ratio} {peaks:?}");
}
