//! Test stand of a belly pad that is drawn along the pipe, as a builder draws it with a luggage scale.

use glam::DVec3;

use crate::plant::STEP;
use crate::plant::contact::BELLY;
use crate::plant::contact::friction::{Bristle, Friction};

/// Speed of the pull, m/s.
const SPEED: f64 = 0.02;
/// Time of the pull, s.
const SECONDS: f64 = 0.5;

/// Largest pull, N, of a pad under `load` N, and the one at the end, while it slides. A pipe has the coefficient
/// `friction` of sliding, and `static_share` times that of sticking.
#[must_use]
pub fn drawn(friction: f64, static_share: f64, load: f64) -> (f64, f64) {
    let friction = Friction {
        kinetic: friction,
        static_share,
    };
    let (mut bristle, slip) = (Bristle::default(), DVec3::new(SPEED, 0.0, 0.0));
    let (mut most, mut last) = (0.0_f64, 0.0);
    for _ in 0..(SECONDS / STEP) as u32 {
        last = -bristle.step(STEP, &BELLY, &friction, DVec3::Z, load, slip).x;
        most = most.max(last);
    }
    (most, last)
}
