//! Twist of an arm about its own axis, by the rotor's gyroscopic moment.
//!
//! One coordinate: the angle φ of motor and propeller about the tip's tangent. A positive twist leans the thrust along
//! the axis about which the tip tilts up: forward on the left, backward on the right.

use super::super::contact::ARM_LENGTH;

/// Motor and propeller about an axis across their own, kg·m² (derived, 40 %: 55 g of motor 15 mm and 12 g of propeller 28
/// mm above the neutral line, with their own inertias).
pub const BLOCK_INERTIA: f64 = 4.5e-5;
/// Torsional over bending stiffness, G J / E I: a square section of ν = 0.5, J/I = 1.687, G/E = 1/3 (derived).
pub const STIFFNESS_RATIO: f64 = 0.562;

/// Of one arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwistSpec {
    /// Stiffness, N·m/rad.
    pub stiffness: f64,
    /// Damping, N·m·s/rad.
    pub damping: f64,
}

impl TwistSpec {
    /// Of an arm with bending stiffness `bending` (N·m²) that carries a motor of inertia `block` (kg·m²), damped by the
    /// ratio `zeta`.
    #[must_use]
    pub fn of(bending: f64, block: f64, zeta: f64) -> Self {
        let stiffness = STIFFNESS_RATIO * bending / ARM_LENGTH;
        Self {
            stiffness,
            damping: 2.0 * zeta * (stiffness * block).sqrt(),
        }
    }
}
