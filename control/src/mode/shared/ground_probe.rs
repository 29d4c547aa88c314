//! The failsafe's probe: reduces thrust where something seems to carry the vehicle.

use crate::contact::contact_force::{HINT_FORCE, Support};
use crate::maths::scalar::clamp;

/// Fastest reduction of the collective, share of the weight per second. In free air the apparent support shrinks with
/// it, and the thrust returns.
const PROBE_RATE: f32 = 0.5;

/// Share of the weight removed, 0..1.
#[derive(Clone, Copy, Debug, Default)]
pub struct Probe(f32);

impl Probe {
    pub fn step(&mut self, failsafe: bool, support: &Support, dt: f32) {
        let hint = failsafe && support.force() > HINT_FORCE;
        let rate = match (hint, support.resting()) {
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
