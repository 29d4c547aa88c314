//! Result of the position estimator.

use super::range_hit::RangeHit;
use crate::maths::vector::Vec3;

/// Where the vehicle is, as far as the newest fix and the inertial sensor say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// In the sender's axes, m.
    pub position: Vec3,
    /// m/s.
    pub velocity: Vec3,
    /// Acceleration that rotors and gravity do not explain, m/s²: wind. Touching something it is no wind.
    pub disturbance: Vec3,
    /// Heading in the sender's axes less that of the vehicle's attitude, rad.
    pub yaw_offset: f32,
    /// Age of the newest fix that was taken, s, below [`LOST_AGE`](super::fix_age::LOST_AGE).
    pub age: f32,
    /// The height is by the pressure of the air, since neither range nor pose give it.
    pub by_pressure: bool,
    /// Counts where the position has jumped with the sender's origin.
    pub reset_count: u8,
    /// Where the beam of the range falls.
    pub foot: RangeHit,
}

impl Estimate {
    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        let foot = self.foot.point.unwrap_or_default();
        let sum = self.position + self.velocity + self.disturbance + foot;
        sum.is_finite() && (self.yaw_offset + self.age).is_finite() && !self.foot.age.is_nan()
    }
}
