//! Where the beam of the range meets a surface.

use crate::maths::vector::Vec3;

/// Where the beam of a range has met what is below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeHit {
    /// In the estimate's axes, m; `None` where nothing was within reach.
    pub point: Option<Vec3>,
    /// Counts the ranges.
    pub count: u8,
    /// Since it was measured, s.
    pub age: f32,
}

impl Default for RangeHit {
    /// None yet.
    fn default() -> Self {
        Self {
            point: None,
            count: 0,
            age: f32::MAX,
        }
    }
}
