//! Load on the body and its acceleration, both in body axes at the body's origin.

use glam::DVec3;

/// Load at the origin, body axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Force, N.
    pub force: DVec3,
    /// Moment, N·m.
    pub moment: DVec3,
}

impl Load {
    /// Adds a force (N) with its moment (N·m) about the origin.
    pub fn add(&mut self, force: DVec3, moment: DVec3) {
        self.force += force;
        self.moment += moment;
    }
}

/// Accelerations of the body.
#[derive(Clone, Copy, Debug)]
pub struct Acceleration {
    /// Linear acceleration of the body's origin, m/s², body.
    pub linear: DVec3,
    /// Angular acceleration, rad/s², body.
    pub angular: DVec3,
}

impl Acceleration {
    /// Of a body that cannot move.
    pub const ZERO: Self = Self {
        linear: DVec3::ZERO,
        angular: DVec3::ZERO,
    };
}
