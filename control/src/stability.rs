//! Rotational stability derivatives (Section IV-A of the paper): how much moment the bending arms add to a
//! commanded one. A commanded moment M becomes (1 - C) M once the arms have followed, so C < 0 helps and
//! C > 1 turns the moment round.

use crate::deflection::ArmModel;
use crate::effectiveness::{Effectiveness, Geometry};

/// C_φ, C_θ and C_ψ of a vehicle that hovers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivatives {
    /// Roll. Nil in this geometry: the thrust stays perpendicular to its arm, so its lever is constant.
    pub roll: f32,
    /// Pitch.
    pub pitch: f32,
    /// Yaw: -χ (b/k_q) d(T sin α)/dT.
    pub yaw: f32,
}

impl Derivatives {
    /// The derivatives with every rotor at the thrust `thrust` (N).
    pub fn at(geometry: &Geometry, model: &ArmModel, thrust: f32) -> Self {
        let e = Effectiveness::quasi_static(geometry, model, &[thrust; 4], &[model.angle(thrust); 4]);
        let [lift, ..] = e.lift;
        let [yaw, ..] = e.yaw;
        Self {
            roll: 0.0,
            pitch: 1.0 - lift,
            yaw: 1.0 - yaw / geometry.drag,
        }
    }
}

/// C_ψ alone.
pub fn yaw_derivative(geometry: &Geometry, model: &ArmModel, thrust: f32) -> f32 {
    Derivatives::at(geometry, model, thrust).yaw
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;
    use crate::wrench::Configuration;

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
        assert!(
            (c(Configuration::B, 6.9, 7.75) + 3.889).abs() < 0.03,
            "{}",
            c(Configuration::B, 6.9, 7.75)
        );
    }

    #[test]
    fn stiffer_arms_mean_a_smaller_derivative() {
        assert!(c(Configuration::B, 6.0, 7.75) < c(Configuration::B, 10.0, 7.75));
        assert!(c(Configuration::B, 6.0, 1.0) > -0.6 && c(Configuration::B, 10.0, 1.0) < -0.2);
    }
}
