//! The tendon's force that holds an arm on a pipe, body fixed: a slow pull on a well damped arm.

use glam::{DQuat, DVec3};

use super::super::contact::{BELLY_Z, Pipe, PipeShape, Pose};
use super::super::flexible::{Carrier, Drive, Flexible, Nearby};
use super::super::{GRAVITY, STEP};
use super::{BeamArm, BeamSpec};
use crate::plant::load::Acceleration;
use crate::plant::load::Load;

/// Rise of the force, N/s: the damped arm lags it by 0.05 s, 0.5 N.
const RISE: f64 = 10.0;
/// Beyond any tendon's, N.
const MOST: f64 = 400.0;
/// Deepest tilt of the search, rad.
const DEEPEST: f64 = -2.0;
/// Time to rest without a tendon, s.
const SETTLE: f64 = 1.0;
/// Damping ratio at which an arm comes to rest soon.
pub const DAMPING: f64 = 0.8;
const POSE: Pose = Pose {
    position: DVec3::ZERO,
    attitude: DQuat::IDENTITY,
    velocity: DVec3::ZERO,
    omega: DVec3::ZERO,
};
const BENCH: Carrier = Carrier {
    omega: DVec3::ZERO,
    gravity: DVec3::new(0.0, 0.0, GRAVITY),
    coupled: false,
};
const FIXED: Acceleration = Acceleration {
    linear: DVec3::ZERO,
    angular: DVec3::ZERO,
};

/// A pipe of `radius` m and coefficient of `friction` under a level belly on its crown, whose pads of 30 mm beside it are
/// 0.6 mm deep.
#[must_use]
pub fn pipe_under(radius: f64, friction: f64) -> Pipe {
    const PADS: (f64, f64) = (0.03, 0.6e-3);
    Pipe {
        north: 0.0,
        half_length: 1.0,
        east: 0.0,
        down: BELLY_Z + (radius * radius - PADS.0 * PADS.0).sqrt() - PADS.1,
        radius,
        friction,
        shape: PipeShape::STRAIGHT,
    }
}

/// An arm that a tendon pulls slowly.
#[derive(Clone, Debug)]
pub struct SlowArm {
    arm: BeamArm,
    lever: f64,
    thrust: f64,
    pipe: Option<Pipe>,
    /// Pressure at the sensor, Pa.
    pub pressure: f64,
}

impl SlowArm {
    /// Arm `index` (0 to 3) of `spec`, made with the ratio [`DAMPING`], at rest at `thrust` N over `pipe`, if any, with its
    /// tendon `lever` m from the neutral line.
    #[must_use]
    pub fn new(index: usize, spec: BeamSpec, lever: f64, thrust: f64, pipe: Option<Pipe>) -> Self {
        let mut arm = Self {
            arm: BeamArm::new(index, spec),
            lever,
            thrust,
            pipe,
            pressure: 0.0,
        };
        arm.hold(0.0, SETTLE);
        arm
    }

    /// Tilt of the tip, rad.
    #[must_use]
    pub fn tilt(&self) -> f64 {
        self.arm.tilt()
    }

    /// Pulls with `force` N for `seconds`.
    pub fn hold(&mut self, force: f64, seconds: f64) {
        for _ in 0..(seconds / STEP) as u32 {
            self.step(force);
        }
    }

    /// Least force (N) that presses with `target` Pa; `None` if no force does.
    #[must_use]
    pub fn pull_to(mut self, target: f64) -> Option<f64> {
        let mut force = 0.0;
        while self.pressure < target {
            if force > MOST || self.tilt() < DEEPEST {
                return None;
            }
            force += RISE * STEP;
            self.step(force);
        }
        Some(force)
    }

    fn step(&mut self, force: f64) {
        let nearby = Nearby {
            pipe: self.pipe,
            ..Nearby::default()
        };
        let drive = Drive {
            dt: STEP,
            thrust: self.thrust,
            tendon: -self.lever * force,
            ..Drive::default()
        };
        self.pressure = self.arm.touch(STEP, &POSE, &nearby, &mut Load::default());
        self.arm.drive(&drive, &BENCH, &mut Load::default());
        self.arm.advance(STEP, &FIXED, &BENCH);
    }
}
