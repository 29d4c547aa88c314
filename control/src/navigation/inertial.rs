//! Input of the position estimator from the attitude estimate.

use crate::maths::vector::{Quat, Vec3};

/// Longest step, s: after a longer gap in the inertial samples the estimate restarts.
pub const STEP_MAX: f32 = 0.05;

/// Attitude and specific force at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inertial {
    /// When it was measured, µs.
    pub at_us: u64,
    /// Body to world.
    pub q: Quat,
    /// Specific force, m/s², body.
    pub accel: Vec3,
}
