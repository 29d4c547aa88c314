//! Intersection of the range beam with a surface.

use crate::maths::vector::Vec3;

/// Newest hit of the range beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeHit {
    /// Point of the hit in the estimate's axes, m; `None` with no target in reach.
    pub surface_point: Option<Vec3>,
    /// Place of the lens then, m.
    pub lens: Vec3,
    /// Direction of the beam, of length 1.
    pub beam: Vec3,
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
            lens: Vec3::ZERO,
            beam: Vec3::new(0.0, 0.0, 1.0),
            count: 0,
            age: f32::MAX,
        }
    }
}
