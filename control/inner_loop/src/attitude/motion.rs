//! Motion of the body, as the attitude estimate hands it on.

use crate::maths::scalar::{self, GRAVITY, deg};
use crate::maths::vector::{Quat, Vec3};

/// Estimated motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Body to world.
    pub q: Quat,
    /// Angular rate, rad/s, body.
    pub rate: Vec3,
    /// Specific force, m/s², body.
    pub accel: Vec3,
    /// True once calibration at rest has ended.
    pub calibrated: bool,
}

/// Largest angle between gravity and the attitude at rest, rad: an accelerometer's bias of 60 mg is 3.4°, and arms sway.
const UNSEEN_LEAN: f32 = deg(10.0);
/// Specific force at which the accelerometer gives the direction of down, share of gravity.
const RESTING_FORCE: core::ops::RangeInclusive<f32> = 0.8..=1.2;

impl Motion {
    /// The accelerometer at rest contradicts the attitude: the gyro's bias has stepped, or the vehicle has turned faster than
    /// the gyro reads.
    pub fn leans_unseen(&self) -> bool {
        let force = self.accel.norm();
        let along = -self.accel.dot(self.q.down_in_body());
        RESTING_FORCE.contains(&(force / GRAVITY)) && along < force * scalar::cos(UNSEEN_LEAN)
    }
}
