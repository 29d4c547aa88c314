//! Side of a resting vehicle on which the crown of the pipe lies.
//!
//! Upright beside the crown the vehicle stands on one pad: the rotors' roll moment M and collective T balance the
//! weight W at the offset y = -M / (W - T), positive to the right of the crown.

use crate::contact::contact_force::ContactForce;
use crate::maths::scalar::clamp;

/// Time constant of the offset, s.
const SMOOTHING: f32 = 0.3;
/// Least load on the pipe for which the offset is computed, N.
const LOAD_MIN: f32 = 3.0;
/// Largest plausible offset, m, and the least that is displayed.
const OFFSET_MAX: f32 = 0.2;
const OFFSET_SHOWN: f32 = 0.015;

/// Side of the vehicle on which the crown is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrownSide {
    /// To its left.
    Left,
    /// To its right.
    Right,
}

/// Offset of the vehicle from the crown, m, right positive.
#[derive(Clone, Copy, Debug, Default)]
pub struct CrownOffset(f32);

impl CrownOffset {
    /// One step of `dt` s with the rotors' `lift` along body -z, N, and `roll_moment`, right side down positive, N m.
    pub fn step(&mut self, lift: f32, roll_moment: f32, contact_force: &ContactForce, dt: f32) {
        let load = contact_force.weight() - lift;
        let offset = -roll_moment / load;
        if !contact_force.resting() || load < LOAD_MIN || !offset.is_finite() {
            self.0 = 0.0;
            return;
        }
        let goal = clamp(offset, -OFFSET_MAX, OFFSET_MAX);
        self.0 += (goal - self.0) * dt / (dt + SMOOTHING);
    }

    /// The side, if the offset is large enough to be displayed.
    pub fn side(self) -> Option<CrownSide> {
        if self.0 > OFFSET_SHOWN {
            Some(CrownSide::Left)
        } else if self.0 < -OFFSET_SHOWN {
            Some(CrownSide::Right)
        } else {
            None
        }
    }
}
