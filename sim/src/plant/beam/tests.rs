//! Limit cases of the bending arm, each against a closed form or a law of conservation.

mod body;
mod contact;
mod motion;
mod statics;

use glam::DVec3;

use super::super::body::{Body, BodySpec};
use super::super::flexible::{Carrier, Drive, Flexible, Nearby};
use super::super::hinged::link::{ArmPrint, ArmSpec};
use super::super::{GRAVITY, STEP};
use super::{BeamArm, BeamSpec, Masses};
use crate::plant::load::Acceleration;
use crate::plant::load::Load;

/// Level, body still.
const BENCH: Carrier = Carrier {
    omega: DVec3::ZERO,
    gravity: DVec3::new(0.0, 0.0, GRAVITY),
    coupled: false,
};

/// Eq. 1 of an arm of `infill` %.
fn equation_1(infill: f64) -> ArmSpec {
    ArmSpec::new(infill, 7.75, 1.0, 0.0, 0.15)
}

/// Eq. 1 of an arm of constant stiffness that is straight at rest, `compliance` in °/N.
fn uniform_print(compliance: f64) -> ArmSpec {
    ArmSpec::of(&ArmPrint {
        coefficients: [compliance, 0.0, 0.0, 0.0],
        infill: 0.0,
        gain_k: 1.0,
        gain: 1.0,
        offset: 0.0,
        zeta: 0.15,
    })
    .level_at(0.0)
}

/// Its beam, without damping if `zeta` is 0.
fn uniform(compliance: f64, zeta: f64) -> BeamSpec {
    BeamSpec::of(&uniform_print(compliance), Masses::of(&BodySpec::default()), zeta)
}

fn built(infill: f64) -> BeamSpec {
    BeamSpec::of(&equation_1(infill), Masses::of(&BodySpec::default()), 0.15)
}

/// The printed arm of `infill` % without damping.
fn undamped(infill: f64) -> BeamSpec {
    BeamSpec::of(&equation_1(infill), Masses::of(&BodySpec::default()), 0.0)
}

/// One step on a body that cannot move.
fn step(arm: &mut BeamArm, drive: &Drive) {
    let drive = Drive { dt: STEP, ..*drive };
    arm.drive(&drive, &BENCH, &mut Load::default());
    let held = Acceleration {
        linear: DVec3::ZERO,
        angular: DVec3::ZERO,
    };
    arm.advance(STEP, &held, &BENCH);
}

/// The arm after it has come to rest under `drive`: heavily damped.
fn settled(spec: BeamSpec, drive: &Drive) -> BeamArm {
    let mut arm = BeamArm::new(2, spec);
    for _ in 0..8000 {
        step(&mut arm, drive);
        // Half of the motion is taken away every 2 ms: rest is the same.
        arm.rate = arm.rate.map(|rate| rate * 0.99);
    }
    assert!(arm.rate.iter().all(|rate| rate.abs() < 1e-6), "{:?}", arm.rate);
    arm
}
