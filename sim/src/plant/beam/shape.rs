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

/// Largest angle of the series in [`sin_cos`], rad: half of it leaves errors below the last bit.
const LARGEST: f64 = 1.6;
/// Of sin x / x and of cos x in x², from the second term.
const SINE: [f64; 7] = reciprocal_factorials(3);
const COSINE: [f64; 8] = reciprocal_factorials(2);

/// ∓1/n!, alternating, for n from `first` in steps of two.
const fn reciprocal_factorials<const N: usize>(first: u32) -> [f64; N] {
    let mut terms = [0.0; N];
    let (mut term, mut n, mut i) = (1.0, 1, 0);
    while i < N {
        while n <= first + 2 * i as u32 {
            term /= n as f64;
            n += 1;
        }
        terms[i] = if i % 2 == 0 { -term } else { term };
        i += 1;
    }
    terms
}

/// Sines and cosines of a pair of angles, rad: two sums side by side take a third of two calls of `libm`, of which an arm
/// needs 6 to 15 a step. Series at half the angle, then sin 2h = 2 sin h cos h and cos 2h = 1 - 2 sin² h; the error is
/// below 5e-16.
#[inline]
pub fn sin_cos(angles: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    // A NaN goes to `libm` too.
    if !angles.iter().all(|angle| angle.abs() <= LARGEST) {
        let [(sin_0, cos_0), (sin_1, cos_1)] = angles.map(libm::sincos);
        return ([sin_0, sin_1], [cos_0, cos_1]);
    }
    let half = angles.map(|angle| 0.5 * angle);
    let square = half.map(|h| h * h);
    let series = |terms: &[f64]| {
        let mut sum = [0.0; 2];
        for term in terms.iter().rev() {
            sum = [0, 1].map(|i| (sum[i] + term) * square[i]);
        }
        sum
    };
    let (sine, cosine) = (series(&SINE), series(&COSINE));
    let sine = [0, 1].map(|i| half[i] + half[i] * sine[i]);
    (
        [0, 1].map(|i| 2.0 * sine[i] * (1.0 + cosine[i])),
        [0, 1].map(|i| 1.0 - 2.0 * sine[i] * sine[i]),
    )
}

/// Points at the shares `ends` of the length, ascending, of an arm with shape `q` (rad) and its `rate` (rad/s). Inlined,
/// as ends are constants, and what a caller does not read costs nothing.
#[inline(always)]
pub fn points<const N: usize>(q: &PerTerm, rate: &PerTerm, ends: [f64; N]) -> [Point; N] {
    let (mut point, mut start) = (Point::default(), 0.0);
    let mut points = [point; N];
    for (place, end) in points.iter_mut().zip(ends) {
        let weight = 0.5 * (end - start) * ARM_LENGTH;
        let shares = GAUSS.map(|share| start + share * (end - start));
        let (sin, cos) = sin_cos(shares.map(|xi| slope(q, xi)));
        for (i, xi) in shares.into_iter().enumerate() {
            let (sin, cos) = (weight * sin[i], weight * cos[i]);
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
        *place = point;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_are_those_of_libm_to_the_last_bits() {
        for i in -40_000..=40_000 {
            let angles = [f64::from(i) * 4e-5, f64::from(i) * -5e-5];
            let (sin, cos) = sin_cos(angles);
            for (k, angle) in angles.into_iter().enumerate() {
                let (wanted_sin, wanted_cos) = libm::sincos(angle);
                assert!(
                    (sin[k] - wanted_sin).abs() < 5e-16 && (cos[k] - wanted_cos).abs() < 5e-16,
                    "{angle}"
                );
            }
        }
        assert!(sin_cos([f64::NAN, 0.0]).0[0].is_nan());
    }
}
