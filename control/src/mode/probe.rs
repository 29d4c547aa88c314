//! The failsafe's probe: thrust is taken away where something seems to carry, to see whether it does.

use crate::math::clamp;
use crate::support::{HINT_FORCE, Support};

/// Fastest that the collective is taken away where something seems to carry the vehicle, share of the weight
/// per second. In free air the seeming support shrinks with it, and it comes back.
const PROBE_RATE: f32 = 0.5;

/// Share of the weight taken away to see whether something carries it, 0..1.
#[derive(Clone, Copy, Debug, Default)]
pub struct Probe(f32);

impl Probe {
    /// Takes thrust away while something seems to carry a vehicle in the failsafe, gives it back where nothing does.
    pub fn step(&mut self, failsafe: bool, support: &Support, dt: f32) {
        let hint = failsafe && support.force() > HINT_FORCE;
        let rate = match (hint, support.resting()) {
            (true, true) => 3.0 * PROBE_RATE,
            (true, false) => PROBE_RATE,
            (false, _) => -4.0 * PROBE_RATE,
        };
        self.0 = clamp(self.0 + rate * dt, 0.0, 1.0);
    }

    /// Share of the weight that is taken away now.
    pub fn share(&self) -> f32 {
        self.0
    }
}
