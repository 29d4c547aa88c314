//! Turns between frames that share their down axis.

use super::scalar;
use super::vector::Vec3;

/// `v` turned about down by `angle`, rad, clockwise from above.
pub fn about_down(v: Vec3, angle: f32) -> Vec3 {
    let (sin, cos) = (scalar::sin(angle), scalar::cos(angle));
    Vec3::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos, v.z)
}
