//! A fall beside the pipe: the speed that a vehicle gains downwards while nothing carries it.
//!
//! The sink rate since take-off drifts with the accelerometer, so only what was gained lately counts.

use crate::contact::contact_force::{ContactForce, RESTING_FORCE};
use crate::maths::scalar::clamp;

/// Decay time of the gained speed, s: well beyond a fall, and 10 mg of bias come to 5 cm/s.
const MEMORY: f32 = 0.5;
/// Largest speed that counts, m/s.
const SPEED_MAX: f32 = 10.0;
/// Speed gained without support that is a fall, m/s: a set-down gains 0.2 over its last centimetre.
const FALL_SPEED: f32 = 0.25;

/// Downward speed gained lately.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fall {
    /// m/s, downwards positive.
    speed: f32,
    carried: bool,
}

impl Fall {
    /// One step of `dt` s at `down` m/s² along world down.
    pub fn step(&mut self, down: f32, contact_force: &ContactForce, dt: f32) {
        let gained = self.speed + (down - self.speed / MEMORY) * dt;
        self.speed = clamp(gained, -SPEED_MAX, SPEED_MAX);
        self.carried = contact_force.force() > RESTING_FORCE;
    }

    /// Downward speed gained lately, m/s, within ±10.
    pub fn speed(&self) -> f32 {
        self.speed
    }

    /// It falls, and nothing carries it.
    pub fn falls(&self) -> bool {
        !self.carried && self.speed > FALL_SPEED
    }
}
