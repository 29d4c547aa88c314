//! Rotational stability derivatives (Section IV-A of the paper): how much moment the bending arms add to a
//! commanded one. A commanded moment M becomes (1 - C) M once the arms have followed, so C < 0 helps and
//! C > 1 turns the moment round.
//!
//! All three come from one formula. Every rotor's thrust is moved from T by δ along the pattern p of the axis;
//! with the arms following by Eq. 1 the moment is M(T + δ p), on stiff and level arms it is M₀(δ p), and
//!
//!   C = 1 - (dM/dδ) / (dM₀/dδ)
//!
//! by finite differences of the static wrench. For this geometry that is in closed form
//!
//!   C_φ = 0                       the thrust stays perpendicular to its hinged arm, so its lever is constant;
//!   C_θ = 1 - d(T cos α)/dT       the lift lost to the lean;
//!   C_ψ = -χ (b/k_q) d(T sin α)/dT   the sideways thrust at ±b.
//!
//! The sine of [`math`](sophie_control::math) has a slope that is off by up to 1.4 % near zero, and so has C_ψ: for
//! study, not for the allocation, which takes its Jacobian in closed form.

use sophie_control::deflection::ArmModel;
use sophie_control::effectiveness::Geometry;
use sophie_control::wrench::{FORE, PerArm, SIDE, Wrench, YAW};

/// Step of the finite differences, N: wide against the rounding of `f32`. The five-point stencil is exact up to
/// the fourth power of the thrust; the rest is below 1 % of C_ψ.
const STEP: f32 = 1.0;

/// C_φ, C_θ and C_ψ of a vehicle that hovers; dimensionless.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivatives {
    /// Roll. Nil in this geometry.
    pub roll: f32,
    /// Pitch: a few hundredths around hover.
    pub pitch: f32,
    /// Yaw: negative for configuration B and positive for A at hover, 0.3 to 4.7 in size (infill 6-10 %, K 1-8.4).
    pub yaw: f32,
}

impl Derivatives {
    /// The derivatives with every rotor at the thrust `thrust` (N, >= 0).
    pub fn at(geometry: &Geometry, model: &ArmModel, thrust: f32) -> Self {
        let following = |thrusts: PerArm<f32>| geometry.wrench(&thrusts, &thrusts.map(|t| model.angle(t)));
        let stiff = |thrusts: PerArm<f32>| geometry.wrench(&thrusts, &[0.0; 4]);
        let derivative = |pattern: PerArm<f32>, moment: fn(Wrench) -> f32| {
            let slope = |wrench: &dyn Fn(PerArm<f32>) -> Wrench| {
                let swing = |step: f32| {
                    moment(wrench(pattern.map(|p| thrust + p * step)))
                        - moment(wrench(pattern.map(|p| thrust - p * step)))
                };
                (8.0 * swing(STEP) - swing(2.0 * STEP)) / (12.0 * STEP)
            };
            1.0 - slope(&following) / slope(&stiff)
        };
        Self {
            roll: derivative(SIDE, |w| w.roll),
            pitch: derivative(FORE, |w| w.pitch),
            yaw: derivative(YAW, |w| w.yaw),
        }
    }
}

/// C_ψ alone, dimensionless, with every rotor at the thrust `thrust` (N, >= 0).
pub fn yaw_derivative(geometry: &Geometry, model: &ArmModel, thrust: f32) -> f32 {
    Derivatives::at(geometry, model, thrust).yaw
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use sophie_control::params::Params;
    use sophie_control::wrench::Configuration;

    fn c(configuration: Configuration, infill: f32, gain_k: f32) -> f32 {
        let p = Params {
            infill,
            gain_k,
            ..Params::default()
        };
        yaw_derivative(
            &Geometry::from_params(&p, configuration),
            &ArmModel::from_params(&p),
            4.425,
        )
    }

    #[test]
    fn b_is_stable_and_a_is_not_as_the_paper_says() {
        for infill in [6.0, 6.9, 8.0, 10.0] {
            for k in [1.0, 5.03, 7.75, 8.4] {
                assert!(c(Configuration::B, infill, k) < 0.0 && c(Configuration::A, infill, k) > 0.0);
            }
        }
        // A truly reverses only where C > 1.
        assert!(c(Configuration::A, 6.9, 1.0) < 1.0 && c(Configuration::A, 6.9, 7.75) > 1.0);
    }

    #[test]
    fn by_hand_at_the_default() {
        // α(4.425) = 7.75·(1.06077·0.275 - 0.05781·(4.425² - 4.15²)) = 1.204° = 0.02102 rad;
        // slope 7.75·(1.06077 - 0.11562·4.425) = 4.256 °/N = 0.07428 rad/N;
        // d(T sin α)/dT = 0.02102 + 4.425·0.99978·0.07428 = 0.3496; times b/k_q = 11.125: 3.889.
        // The sine's slope near zero is 1.3 % short of that.
        assert!(
            (c(Configuration::B, 6.9, 7.75) + 3.889).abs() < 0.05,
            "{}",
            c(Configuration::B, 6.9, 7.75)
        );
    }

    #[test]
    fn the_general_formula_gives_the_closed_forms() {
        for configuration in [Configuration::A, Configuration::B] {
            for (infill, gain_k) in [(6.0, 7.75), (6.9, 5.03), (6.9, 7.75), (10.0, 1.0)] {
                for thrust in [2.5f32, 4.425, 6.0] {
                    let p = Params {
                        infill,
                        gain_k,
                        ..Params::default()
                    };
                    let (g, m) = (
                        Geometry::from_params(&p, configuration),
                        ArmModel::from_params(&p),
                    );
                    let c = Derivatives::at(&g, &m, thrust);
                    let (alpha, follow) = (m.angle(thrust), thrust * m.slope(thrust));
                    let lift = alpha.cos() - alpha.sin() * follow;
                    let lean = alpha.sin() + alpha.cos() * follow;
                    let yaw = -configuration.chi() * g.b / p.torque_ratio * lean;
                    let text =
                        std::format!("{configuration:?} {infill} {gain_k} {thrust}: {c:?} {lift} {yaw}");
                    assert!(c.roll.abs() < 1e-5, "{text}");
                    assert!((c.pitch - (1.0 - lift)).abs() < 0.01, "{text}");
                    assert!((c.yaw - yaw).abs() < 0.02 * yaw.abs(), "{text}");
                }
            }
        }
    }

    #[test]
    fn stiffer_arms_mean_a_smaller_derivative() {
        assert!(c(Configuration::B, 6.0, 7.75) < c(Configuration::B, 10.0, 7.75));
        assert!(c(Configuration::B, 6.0, 1.0) > -0.6 && c(Configuration::B, 10.0, 1.0) < -0.2);
    }
}
