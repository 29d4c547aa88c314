//! All transcendental functions of the control laws.
//!
//! With `std` in scope `x.sin()` differs between host and board, so the laws call these by path. `sin`, `cos` and
//! `atan2` are micromath's (absolute errors 1.1e-3, 1.1e-3 and 2.8e-3 rad), for occasional use; steps use branch-free
//! sines of limited range. Micromath's roots would be off by up to 6 %.

use micromath::F32Ext;

/// π as `f32`.
pub const PI: f32 = core::f32::consts::PI;
/// Standard gravity, m/s².
pub const GRAVITY: f32 = 9.806_65;

/// Sine of `x` rad.
#[inline]
pub fn sin(x: f32) -> f32 {
    F32Ext::sin(x)
}

/// Cosine of `x` rad.
#[inline]
pub fn cos(x: f32) -> f32 {
    F32Ext::cos(x)
}

/// Angle of the point (`x`, `y`) from the x axis, rad in (-π, π].
#[inline]
pub fn atan2(y: f32, x: f32) -> f32 {
    F32Ext::atan2(y, x)
}

/// Arc sine of `x`, rad; `x` is limited to [-1, 1].
#[inline]
pub fn asin(x: f32) -> f32 {
    let x = clamp(x, -1.0, 1.0);
    atan2(x, sqrt(1.0 - x * x))
}

/// Tangent of `x` rad for |x| <= 1.2, by a continued fraction (relative error below 2e-6), for filter design: 1 - cos
/// of a small angle would drown in micromath's error.
#[inline]
pub fn tan(x: f32) -> f32 {
    let x2 = x * x;
    x / (1.0 - x2 / (3.0 - x2 / (5.0 - x2 / (7.0 - x2 / (9.0 - x2 / 11.0)))))
}

/// Sine and cosine of `x` rad for |x| <= 0.7, the range of the arm's model: absolute errors below 5e-7 and 7e-6.
/// Minimax polynomials; the sine's slope at 0 is exact.
#[inline(always)]
pub fn sin_cos_small(x: f32) -> (f32, f32) {
    let x2 = x * x;
    (
        x + x * x2 * (-0.166_642_66 + 0.008_190_507 * x2),
        1.0 + x2 * (-0.499_859_78 + 0.040_733_44 * x2),
    )
}

/// Sine and cosine of `x` rad for |x| <= π/2: absolute errors below 1.2e-4 and 9e-6; a sensor resolves 0.1°.
#[inline(always)]
pub fn sin_cos_quarter(x: f32) -> (f32, f32) {
    let x2 = x * x;
    (
        x + x * x2 * (-0.166_078_62 + 0.007_633_773_4 * x2),
        1.0 + x2 * (-0.499_935_63 + x2 * (0.041_507_067 - 0.001_275_752 * x2)),
    )
}

/// 1/√x for positive finite `x`, relative error below 8e-7; 0 otherwise, so that dividing by a vanishing norm gives 0.
#[inline]
pub fn inv_sqrt(x: f32) -> f32 {
    let y = inv_sqrt_normal(x);
    if x > 2.0 * f32::MIN_POSITIVE && x < f32::MAX {
        y
    } else {
        0.0
    }
}

/// 1/√x for finite `x` above 2.4e-38, of which the half is normal too, relative error below 8e-7; arbitrary or NaN
/// otherwise.
///
/// Bit-level guess, a Newton step with fitted constants (Moroz et al., error 6.5e-4), and a plain Newton step.
#[inline(always)]
pub fn inv_sqrt_normal(x: f32) -> f32 {
    inv_sqrt_of_twice(0.5 * x)
}

/// 1/√(2 x), as [`inv_sqrt_normal`]: of half the number the root takes a product less.
#[inline(always)]
pub fn inv_sqrt_of_twice(x: f32) -> f32 {
    let y = f32::from_bits(0x5edf_fff9u32.wrapping_sub(x.to_bits() >> 1));
    let y = y * (2.0 * 0.703_952_25) * (0.5 * 2.389_244_6 - x * y * y);
    y * (1.5 - x * y * y)
}

/// √x; 0 for zero, negative and non-finite `x`.
#[inline]
pub fn sqrt(x: f32) -> f32 {
    if x < f32::MAX { x * inv_sqrt(x) } else { 0.0 }
}

/// `x` limited to [`low`, `high`]; `low` for a NaN. With constant limits each select is one instruction on an M7;
/// `f32::clamp` calls a library on a core without VMINNM.
#[inline(always)]
pub fn clamp(x: f32, low: f32, high: f32) -> f32 {
    let x = if x > low { x } else { low };
    if x < high { x } else { high }
}

/// `x` limited to [-`limit`, `limit`]; -`limit` for a NaN.
#[inline(always)]
pub fn clamp_abs(x: f32, limit: f32) -> f32 {
    clamp(x, -limit, limit)
}

/// Moves `from` towards `to` by at most `step` (>= 0).
#[inline]
pub fn slew(from: f32, to: f32, step: f32) -> f32 {
    from + clamp_abs(to - from, step)
}

/// `base` (limited to [0.3, 3]) to the power `exponent` (|exponent| <= 2.5), relative error below 5e-5, for the paper's
/// (P/P0)^C_P; micromath's `powf` is too coarse.
pub fn pow_near_one(base: f32, exponent: f32) -> f32 {
    let base = clamp(base, 0.3, 3.0);
    // ln x = 2 artanh((x - 1) / (x + 1)).
    let z = (base - 1.0) / (base + 1.0);
    let z2 = z * z;
    let series = 1.0
        + z2 * (1.0 / 3.0 + z2 * (0.2 + z2 * (1.0 / 7.0 + z2 * (1.0 / 9.0 + z2 * (1.0 / 11.0 + z2 / 13.0)))));
    // exp(y) = exp(y/8)^8, the inner one by its series.
    let y = exponent * 2.0 * z * series * 0.125;
    let e = 1.0 + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * (1.0 / 24.0 + y * (1.0 / 120.0 + y / 720.0)))));
    let e2 = e * e;
    let e4 = e2 * e2;
    e4 * e4
}

/// Angle `x` folded into [-π, π), for |x| up to a few turns.
#[inline]
pub fn wrap_pi(x: f32) -> f32 {
    let turns = (x + PI) * (0.5 / PI);
    // Truncation towards zero, corrected for negative values: `floor` is not in core.
    let whole = turns as i32 as f32;
    let floor = if whole > turns { whole - 1.0 } else { whole };
    x - floor * (2.0 * PI)
}

/// Degrees to radians.
#[inline]
pub const fn deg(x: f32) -> f32 {
    x * (PI / 180.0)
}

/// Radians to degrees.
#[inline]
pub const fn to_deg(x: f32) -> f32 {
    x * (180.0 / PI)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    fn close(a: f32, b: f32, tolerance: f32) -> bool {
        (a - b).abs() <= tolerance
    }

    #[test]
    fn roots_match_the_standard_library() {
        for i in 0..4000 {
            let x = f32::exp(-20.0 + 0.01 * i as f32);
            assert!(close(inv_sqrt(x) * f32::sqrt(x), 1.0, 8e-7), "{x}");
            assert!(close(sqrt(x) / f32::sqrt(x), 1.0, 9e-7), "{x}");
        }
        assert!(sqrt(0.0) == 0.0 && sqrt(-1.0) == 0.0 && sqrt(f32::NAN).is_finite());
        assert!(inv_sqrt(f32::INFINITY) == 0.0);
    }

    #[test]
    fn the_inverse_root_keeps_its_error_over_a_whole_period_of_its_guess() {
        // The guess repeats with every factor of 4: every seventh of the 2^24 floats of 1..4.
        for bits in (1.0f32.to_bits()..4.0f32.to_bits()).step_by(7) {
            let x = f32::from_bits(bits);
            let exact = 1.0 / f64::sqrt(f64::from(x));
            let error = (f64::from(inv_sqrt_normal(x)) / exact - 1.0).abs();
            assert!(error < 8e-7, "{x}: {error}");
        }
    }

    /// Worst absolute errors of a sine and cosine over ±`range` rad.
    fn worst(function: fn(f32) -> (f32, f32), range: f32) -> (f64, f64) {
        (-100_000..=100_000).fold((0.0, 0.0), |(sine, cosine), i| {
            let x = range * i as f32 * 1e-5;
            let (s, c) = function(x);
            let x = f64::from(x);
            (
                f64::max(sine, (f64::from(s) - x.sin()).abs()),
                f64::max(cosine, (f64::from(c) - x.cos()).abs()),
            )
        })
    }

    #[test]
    fn sines_of_every_step_keep_their_errors_over_their_whole_range() {
        let (s, c) = worst(sin_cos_small, 0.7);
        assert!(s < 5e-7 && c < 7e-6, "{s} {c}");
        let (s, c) = worst(sin_cos_quarter, PI / 2.0);
        assert!(s < 1.2e-4 && c < 9e-6, "{s} {c}");
        // The replaced functions.
        let (s, c) = worst(|x| (sin(x), cos(x)), PI / 2.0);
        assert!(s > 9e-4 && c > 9e-4, "{s} {c}");
    }

    #[test]
    fn tangent_is_accurate_where_filters_are_designed() {
        for i in -120..=120 {
            let x = i as f32 * 0.01;
            let exact = f64::tan(f64::from(x));
            assert!(
                (f64::from(tan(x)) - exact).abs() <= 2e-6 * exact.abs() + 1e-9,
                "{x}"
            );
        }
    }

    #[test]
    fn arc_sine_is_within_its_stated_error() {
        for i in -100..=100 {
            let x = i as f32 * 0.01;
            assert!(close(asin(x), f32::asin(x), 3.5e-3), "{x}");
        }
        assert!(close(asin(7.0), PI / 2.0, 3.5e-3));
    }

    #[test]
    fn power_is_accurate_around_one() {
        for i in 0..=270 {
            let base = 0.3 + 0.01 * i as f32;
            for c in [-2.5f32, -1.0, 0.0, 1.0, 1.6, 1.7, 1.8, 2.5] {
                let exact = f64::from(base).powf(f64::from(c));
                let error = (f64::from(pow_near_one(base, c)) / exact - 1.0).abs();
                assert!(error < 5e-5, "{base}^{c}: {error}");
            }
        }
    }

    #[test]
    fn clamp_stops_a_nan() {
        assert!(clamp(f32::NAN, -1.0, 2.0) == -1.0);
        assert!(clamp(3.0, -1.0, 2.0) == 2.0 && clamp(-3.0, -1.0, 2.0) == -1.0);
    }

    #[test]
    fn angles_wrap_into_one_turn() {
        for i in -1000..1000 {
            let x = i as f32 * 0.01;
            let w = wrap_pi(x);
            assert!((-PI - 1e-4..PI + 1e-4).contains(&w), "{x} -> {w}");
            assert!(close(f32::sin(w), f32::sin(x), 1e-4));
        }
    }
}
