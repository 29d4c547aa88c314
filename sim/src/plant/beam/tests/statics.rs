//! The bent shape at rest.

use super::*;
use crate::plant::contact::ARM_LENGTH;

fn thrust(thrust: f64) -> Drive {
    Drive {
        thrust,
        ..Drive::default()
    }
}

fn tendon(moment: f64) -> Drive {
    Drive {
        tendon: moment,
        ..Drive::default()
    }
}

#[test]
fn a_uniform_beam_bends_under_each_load_as_the_books_say() {
    // 1 °/N: EI = L²/2A = 0.9076 N·m². A follower force F tilts the tip by F L²/2EI, a moment M by M L/EI: exact for a
    // moment, to 1 % up to 30° for a force (an elastica's tip turns a little less).
    let spec = uniform(1.0, 0.15);
    let stiffness = spec.bending_stiffness();
    assert!((stiffness - 0.907_7).abs() < 1e-3, "{stiffness}");
    for force in [-8.0, -1.0, 1.0, 8.0] {
        let arm = settled(spec, &thrust(force));
        let book = force * ARM_LENGTH * ARM_LENGTH / (2.0 * stiffness);
        assert!(
            (arm.tilt() / book - 1.0).abs() < 5e-3,
            "{force}: {} {book}",
            arm.tilt()
        );
        // Slope proportional to ξ - ξ²/2.
        let [q1, q2] = arm.shape();
        assert!((q2 / q1 + 0.5).abs() < 1e-2, "{force}: {q1} {q2}");
    }
    for moment in [-4.0, -0.5, 0.5] {
        let arm = settled(spec, &tendon(moment));
        let book = moment * ARM_LENGTH / stiffness;
        let [q1, q2] = arm.shape();
        assert!(
            (q1 / book - 1.0).abs() < 1e-6 && q2.abs() < 1e-6,
            "{moment}: {q1} {q2}"
        );
    }
}

#[test]
fn a_tendon_bends_a_uniform_beam_twice_as_much_as_a_thrust_of_the_same_moment() {
    let spec = uniform(1.0, 0.15);
    let by_thrust = settled(spec, &thrust(1.0)).tilt();
    let by_tendon = settled(spec, &tendon(ARM_LENGTH)).tilt();
    assert!(
        (by_tendon / by_thrust - 2.0).abs() < 1e-3,
        "{}",
        by_tendon / by_thrust
    );
}

#[test]
fn a_taper_moves_the_ratio_of_tendon_to_thrust_and_keeps_equation_1() {
    // ∫ 1/e over ∫ (1 - ξ)/e with e = 1 - (1 - τ) ξ: 2.26, 2.58 and 1.79; two terms meet them within 3 %.
    for (taper, ratio) in [(0.5, 2.259), (0.25, 2.577), (2.0, 1.794)] {
        let equation = uniform_print(1.0);
        let masses = Masses::of(&BodySpec::default());
        let spec = BeamSpec::tapered(&equation, masses, 0.15, taper);
        let by_thrust = settled(spec, &thrust(1.0)).tilt();
        let by_tendon = settled(spec, &tendon(ARM_LENGTH)).tilt();
        assert!(
            (by_thrust / equation.static_tilt(1.0) - 1.0).abs() < 1e-3,
            "{taper}: {by_thrust}"
        );
        assert!(
            (by_tendon / by_thrust / ratio - 1.0).abs() < 0.031,
            "{taper}: {}",
            by_tendon / by_thrust
        );
    }
}

#[test]
fn the_tip_follows_equation_1_under_thrust_alone() {
    // Weight included: the arm rests on a level bench. Largest differences, degrees, to 6 and to 7 N.
    for (infill, to_6, to_7) in [
        (6.0, 0.3, 0.5),
        (6.9, 0.25, 0.25),
        (8.0, 0.2, 0.25),
        (10.0, 0.02, 0.02),
    ] {
        let equation = equation_1(infill);
        for newtons in 0..=7 {
            let force = f64::from(newtons);
            let arm = settled(built(infill), &thrust(force));
            let error = (arm.tilt() - equation.static_tilt(force)).to_degrees();
            let allowed = if newtons <= 6 { to_6 } else { to_7 };
            assert!(error.abs() <= allowed, "{infill} % {force} N: {error}");
        }
    }
}

#[test]
fn a_tendon_bends_a_free_arm_by_two_levers_over_its_length_of_a_thrust() {
    // ρ 6.9 below rest: 8.22 °/N by thrust, 2h/L of it by a tendon at h = 15 mm: 1.385 °/N.
    let spec = built(6.9);
    let at = |force: f64| settled(spec, &tendon(-super::super::TENDON_LEVER * force)).tilt();
    let per_newton = (at(10.0) - at(20.0)).to_degrees() / 10.0;
    assert!((per_newton - 1.385).abs() < 5e-3, "{per_newton}");
}

#[test]
fn sections_and_their_moments_are_each_other_s_inverse() {
    let spec = built(6.9);
    for i in -40..=60 {
        let moment = 0.03 * f64::from(i);
        let h = 1e-6;
        let slope =
            (spec.moment(spec.curvature(moment) + h) - spec.moment(spec.curvature(moment) - h)) / (2.0 * h);
        assert!(
            (spec.moment(spec.curvature(moment)) - moment).abs() < 1e-9,
            "{moment}"
        );
        assert!(slope > 0.0, "{moment}");
    }
}

#[test]
fn a_weight_on_the_tip_bends_a_straight_arm_as_a_thrust_down_and_a_bent_one_less() {
    let rest = |spec: BeamSpec, weight: f64, moment: f64| {
        let mut arm = BeamArm::new(0, spec);
        arm.hang(weight);
        for _ in 0..20_000 {
            step(&mut arm, &tendon(moment));
        }
        arm.tilt()
    };
    // 0.2 °/N: nearly straight.
    let stiff = uniform(0.2, 0.8);
    let (hung, pushed) = (rest(stiff, 2.0, 0.0), rest(stiff, 0.0, 0.0));
    let thrust = {
        let mut arm = BeamArm::new(0, stiff);
        for _ in 0..20_000 {
            step(&mut arm, &thrust(-2.0));
        }
        arm.tilt()
    };
    assert!((hung - thrust).abs() < 1e-4 && hung < pushed, "{hung} {thrust}");
    // Bent to an arc of 0.9 rad: a weight's lever is 2 (sin α/α - (1 - cos α)/α²) of the straight arm's, 0.806.
    let soft = uniform(8.0, 0.8);
    let stiffness = soft.bending_stiffness() / 0.178;
    let moment = -0.9 * stiffness;
    let (bent, more) = (rest(soft, 0.0, moment), rest(soft, 0.2, moment));
    let straight = 0.2 * 0.178 / 2.0 / stiffness;
    assert!(
        (bent + 0.9).abs() < 1e-3 && ((bent - more) / straight / 0.806 - 1.0).abs() < 0.03,
        "{bent} {more} {straight}"
    );
}
