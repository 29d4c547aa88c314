//! Positions of points on the bent arm, and their derivatives by the shape.
//!
//! In the arm's plane: `out` from the root, `up` from the neutral line at the root. r(ξ) = L ∫ (cos θ, sin θ) by Gauss's
//! two points on each piece. Derivatives are those of the sum, so that forces and energy agree exactly.

use super::super::contact::ARM_LENGTH;
use super::{PerTerm, TERMS};

/// Gauss's two points, from the start of a piece of length 1; each has half the weight.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// A point of the neutral line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Distance from the root, outward, m.
    pub out: f64,
    /// Height over the neutral line at the root, m.
    pub up: f64,
    /// ∂out/∂q, m.
    pub out_by: PerTerm,
    /// ∂up/∂q, m.
    pub up_by: PerTerm,
    /// Part of the acceleration along `out` and `up` that depends on rates alone, m/s².
    pub bias: (f64, f64),
}

/// Slope of the arm at ξ.
pub fn slope(q: &PerTerm, xi: f64) -> f64 {
    (q[0] + q[1] * xi) * xi
}

/// Points at the shares `ends` of the length, ascending, of an arm with shape `q` (rad) and its `rate` (rad/s).
pub fn points<const N: usize>(q: &PerTerm, rate: &PerTerm, ends: [f64; N]) -> [Point; N] {
    let (mut point, mut start) = (Point::default(), 0.0);
    ends.map(|end| {
        let weight = 0.5 * (end - start) * ARM_LENGTH;
        for share in GAUSS {
            let xi = start + share * (end - start);
            let (sin, cos) = libm::sincos(slope(q, xi));
            let (sin, cos) = (weight * sin, weight * cos);
            let turning = slope(rate, xi);
            let turning = turning * turning;
            point.out += cos;
            point.up += sin;
            let mut power = xi;
            for k in 0..TERMS {
                point.out_by[k] -= sin * power;
                point.up_by[k] += cos * power;
                power *= xi;
            }
            point.bias.0 -= cos * turning;
            point.bias.1 -= sin * turning;
        }
        start = end;
        point
    })
}
