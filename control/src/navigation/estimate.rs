//! Result of the position estimator.

use super::range_hit::RangeHit;
use crate::maths::vector::Vec3;

/// Position estimate by the newest fix and the inertial sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// In the sender's axes, m.
    pub position: Vec3,
    /// m/s.
    pub velocity: Vec3,
    /// Acceleration that rotors and gravity do not explain, m/s²: wind in free flight; in contact it contains the
    /// contact force.
    pub disturbance: Vec3,
    /// Yaw offset: heading in the sender's axes less that of the vehicle's attitude, rad.
    pub yaw_offset: f32,
    /// Age of the newest fused fix, s, below [`LOST_AGE`](super::fix_age::LOST_AGE); at least that of a height that is too old to
    /// give a position.
    pub age: f32,
    /// Age of the newest range, pose or rest that gave the height, s.
    pub height_age: f32,
    /// Levels of the surfaces below.
    pub levels: SurfaceLevels,
    /// The height is barometric, since neither range nor pose give it.
    pub by_pressure: bool,
    /// Counts the jumps of the position with the sender's origin.
    pub reset_count: u8,
    /// Newest hit of the range beam.
    pub range_hit: RangeHit,
}

/// Levels of the surfaces below that are known by the range, m down in the estimate's axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceLevels {
    /// Of the ground.
    pub ground: f32,
    /// Of the crown of a surface raised above the ground; `None` before one is met.
    pub raised: Option<f32>,
}

impl Estimate {
    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        let surface_point = self.range_hit.surface_point.unwrap_or_default();
        let sum = self.position + self.velocity + self.disturbance + surface_point;
        sum.is_finite()
            && (self.yaw_offset + self.age + self.height_age).is_finite()
            && !self.range_hit.age.is_nan()
    }
}
