//! The failsafe's probe: reduces thrust when something seems to carry the vehicle.

use crate::contact::contact_force::{ContactForce, HINT_FORCE};
use crate::maths::scalar::clamp;

/// Fastest reduction of the collective, share of the weight per second. In free air the apparent support shrinks with
/// it, and the thrust returns.
const PROBE_RATE: f32 = 0.5;

/// Share of the weight removed, 0..1.
#[derive(Clone, Copy, Debug, Default)]
pub struct GroundProbe(f32);

impl GroundProbe {
    pub fn step(&mut self, failsafe: bool, contact_force: &ContactForce, dt: f32) {
        let hint = failsafe && contact_force.force() > HINT_FORCE;
        let rate = match (hint, contact_force.resting()) {
            (true, true) => 3.0 * PROBE_RATE,
            (true, false) => PROBE_RATE,
            (false, _) => -4.0 * PROBE_RATE,
        };
        self.0 = clamp(self.0 + rate * dt, 0.0, 1.0);
    }

    pub fn share(&self) -> f32 {
        self.0
    }
}
