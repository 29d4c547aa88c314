//! Detects a fall beside the pipe by the downward speed that the vehicle gains without support.
//!
//! The sink rate since take-off drifts with the accelerometer's bias, so only recently gained speed counts.

use crate::contact::contact_force::{ContactForce, RESTING_FORCE};
use crate::maths::scalar::clamp;

/// Decay time of the gained speed, s: much longer than a fall, while 10 mg of bias add up to 5 cm/s.
const MEMORY: f32 = 0.5;
/// Largest speed that counts, m/s.
const SPEED_MAX: f32 = 10.0;
/// Speed gained without support that indicates a fall, m/s: a set-down gains 0.2 over its last centimetre.
const FALL_SPEED: f32 = 0.25;

/// Recently gained downward speed.
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

    /// Recently gained downward speed, m/s, within ±10.
    pub fn speed(&self) -> f32 {
        self.speed
    }

    /// The vehicle falls without support.
    pub fn falls(&self) -> bool {
        !self.carried && self.speed > FALL_SPEED
    }
}
