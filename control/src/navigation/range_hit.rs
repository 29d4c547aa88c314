//! Intersection of the range beam with a surface.

use crate::maths::vector::Vec3;

/// Newest hit of the range beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeHit {
    /// Point of the hit in the estimate's axes, m; `None` with no target in reach.
    pub surface_point: Option<Vec3>,
    /// Counts the ranges.
    pub count: u8,
    /// Age of the measurement, s.
    pub age: f32,
}

impl Default for RangeHit {
    /// No range yet.
    fn default() -> Self {
        Self {
            surface_point: None,
            count: 0,
            age: f32::MAX,
        }
    }
}
