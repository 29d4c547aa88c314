//! A closing arm that lays itself on the pipe.

use glam::{DQuat, DVec2};

use super::super::skin::{Bent, SkinPoint};
use super::super::{DEPTH, TENDON_LEVER};
use super::*;
use crate::plant::contact::{ARM_LENGTH, ARM_X, BELLY_Z, Pipe, PipeShape, Pose, UNDERSIDE_Z};

const LEVEL: Pose = Pose {
    position: DVec3::ZERO,
    attitude: DQuat::IDENTITY,
    velocity: DVec3::ZERO,
    omega: DVec3::ZERO,
};

fn bent(q: [f64; 2]) -> Bent {
    Bent {
        q,
        rate: [0.0; 2],
        x: ARM_X,
        side: 1.0,
    }
}

#[test]
fn the_points_paths_are_differentiated_right() {
    let skin_points = |q: [f64; 2]| -> Vec<SkinPoint> {
        let arm = bent(q);
        arm.underside().into_iter().chain([arm.tip()]).collect()
    };
    for q in [[0.0, 0.0], [-1.8, 0.4], [-0.5, -0.7], [0.3, 0.2]] {
        for term in 0..2 {
            let h = 1e-6;
            let (mut up, mut down) = (q, q);
            (up[term], down[term]) = (q[term] + h, q[term] - h);
            for ((skin_point, up), down) in skin_points(q).iter().zip(skin_points(up)).zip(skin_points(down))
            {
                let numeric = (up.place - down.place) / (2.0 * h);
                assert!(
                    (skin_point.by[term] - numeric).length() < 1e-8,
                    "{q:?} {term}: {} {numeric}",
                    skin_point.by[term]
                );
            }
        }
    }
}

#[test]
fn an_arm_bent_round_the_pipe_lies_on_it_with_its_underside() {
    // The underside's radius is the pipe's, the neutral line's 15 mm more; Gauss's points leave 0.05 mm.
    let radius = 0.15;
    let tilt = -ARM_LENGTH / (radius + DEPTH);
    assert!((tilt.to_degrees() + 61.8).abs() < 0.1, "{}", tilt.to_degrees());
    for skin_point in bent([tilt, 0.0]).underside() {
        let from_axis = DVec2::new(skin_point.place.y, skin_point.place.z - UNDERSIDE_Z - radius).length();
        assert!((from_axis - radius).abs() < 5e-5, "{from_axis}");
    }
}

/// Belly on the pipe's crown: pads 30 mm beside it, 0.6 mm deep.
fn pipe(diameter: f64) -> Pipe {
    let radius = 0.5 * diameter;
    Pipe {
        north: 0.0,
        half_length: 1.0,
        east: 0.0,
        down: BELLY_Z + (radius * radius - 0.03 * 0.03).sqrt() - 0.6e-3,
        radius,
        friction: 0.0,
        shape: PipeShape::STRAIGHT,
    }
}

/// Pressure (Pa) and tilt (°) of the printed arm at rest under a tendon of `force` N at the lever `lever` m.
fn pressed(diameter: f64, lever: f64, force: f64, thrust: f64) -> (f64, f64) {
    let mut arm = BeamArm::new(2, built(6.9));
    let nearby = Nearby {
        pipe: Some(pipe(diameter)),
        ..Nearby::default()
    };
    let (steps, mut pressure) = (10_000, 0.0);
    for i in 0..steps {
        let share = (f64::from(i) / 5000.0).min(1.0);
        pressure = arm.touch(STEP, &LEVEL, &nearby, &mut Load::default());
        let drive = Drive {
            thrust,
            tendon: -lever * force * share,
            ..Drive::default()
        };
        step(&mut arm, &drive);
        arm.rate = arm.rate.map(|rate| rate * 0.99);
    }
    (pressure, arm.tilt().to_degrees())
}

/// Force (N) for `target` Pa.
fn force_for(target: f64, diameter: f64, lever: f64, thrust: f64) -> f64 {
    let (mut low, mut high) = (5.0, 120.0);
    for _ in 0..14 {
        let middle = 0.5 * (low + high);
        if pressed(diameter, lever, middle, thrust).0 < target {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[test]
fn the_tendon_force_of_a_lying_arm_is_that_of_a_beam_of_many_terms() {
    // A beam of six terms with the same law on the same three stations, solved apart: 21.8 N with the rotor stopped and
    // 31.6 N at 2.5 N for 950 Pa with h = 25 mm, at -68° and -74°.
    for (thrust, force, tilt) in [(0.0, 21.8, -68.2), (2.5, 31.6, -74.1)] {
        let (pressure, angle) = pressed(0.30, 0.025, force, thrust);
        assert!(
            (pressure / 950.0 - 1.0).abs() < 0.03 && (angle - tilt).abs() < 0.7,
            "{thrust}: {pressure} {angle}"
        );
    }
}

#[test]
fn a_thrust_relieves_the_tendon_less_than_the_hinge_model_predicts() {
    // One hinge: L/h = 11.9 N/N at 15 mm. A beam: 0.55 of it.
    let per_thrust =
        (force_for(950.0, 0.30, TENDON_LEVER, 2.5) - force_for(950.0, 0.30, TENDON_LEVER, 0.0)) / 2.5;
    assert!((6.0..7.2).contains(&per_thrust), "{per_thrust}");
}
