//! Static deflection of a soft arm under its rotor's thrust: Eq. 1 of the paper.
//!
//! Evaluated at 1 kHz by the tilt model, once at start-up by the gripper.
//!
//! α = α0 + K ((A1 + ρ A2) T + (B1 + ρ B2) T²) (P/P0)^C_P, in degrees, ρ in %, T in N.
//!
//! K is added: the literal equation (K = 1) gives a fifth of the tilts of the paper's Table III. α0 makes the arm level
//! at half throttle, as the paper's text demands. The battery's factor stays 1 in flight, where thrusts are compensated
//! already; only the printed [`Algorithm1`] uses it.

use crate::maths::scalar;
use crate::params::Params;

/// A1 of Table I, °/N.
pub const A1: f32 = 2.4387;
/// A2 of Table I, °/(N %).
pub const A2: f32 = -0.1997;
/// B1 of Table I, °/N².
pub const B1: f32 = -0.162;
/// B2 of Table I, °/(N² %).
pub const B2: f32 = 0.0151;

/// Largest tilt of the paper's static model, rad.
pub const VALID_TILT: f32 = scalar::deg(40.0);

/// Eq. 1 of one arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmModel {
    /// Tilt without thrust, rad.
    pub offset: f32,
    /// Linear coefficient, rad/N.
    pub linear: f32,
    /// Quadratic coefficient, rad/N².
    pub quadratic: f32,
}

impl ArmModel {
    /// Arm of infill `infill` (%) with gain `gain_k` on the elastic term, level at `level_thrust` (N).
    pub fn new(infill: f32, gain_k: f32, level_thrust: f32) -> Self {
        Self::with([A1, A2, B1, B2], infill, gain_k, level_thrust)
    }

    /// With own coefficients A1, A2, B1, B2 (°/N, °/(N %), °/N², °/(N² %)).
    pub fn with([a1, a2, b1, b2]: [f32; 4], infill: f32, gain_k: f32, level_thrust: f32) -> Self {
        let linear = scalar::deg(gain_k * (a1 + infill * a2));
        let quadratic = scalar::deg(gain_k * (b1 + infill * b2));
        let model = Self {
            offset: 0.0,
            linear,
            quadratic,
        };
        Self {
            offset: -model.elastic(level_thrust),
            ..model
        }
    }

    /// From the parameters.
    pub fn from_params(p: &Params) -> Self {
        let coefficients = [p.arm_a1, p.arm_a2, p.arm_b1, p.arm_b2];
        Self::with(coefficients, p.infill, p.gain_k, p.arm_level_share * p.thrust_max)
    }

    /// Elastic part of the tilt at `thrust` (N), rad.
    pub fn elastic(&self, thrust: f32) -> f32 {
        (self.linear + self.quadratic * thrust) * thrust
    }

    /// Tilt at `thrust` (N), rad.
    pub fn angle(&self, thrust: f32) -> f32 {
        self.offset + self.elastic(thrust)
    }

    /// Compliance dα/dT at `thrust` (N), rad/N.
    pub fn slope(&self, thrust: f32) -> f32 {
        self.linear + 2.0 * self.quadratic * thrust
    }
}

/// The paper's Algorithm 1, verbatim: tilt by the last step's thrust, 0 beyond 40°.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Algorithm1 {
    model: ArmModel,
    power_exponent: f32,
}

impl Algorithm1 {
    /// The algorithm for `model` with the battery exponent C_P.
    pub const fn new(model: ArmModel, power_exponent: f32) -> Self {
        Self {
            model,
            power_exponent,
        }
    }

    /// Tilt (rad) by the last step's thrust (N) and power ratio P/P0. The printed guard makes it jump by 40°, on one
    /// side.
    pub fn angle(&self, last_thrust: f32, power_ratio: f32) -> f32 {
        let factor = scalar::pow_near_one(power_ratio, self.power_exponent);
        let tilt = self.model.offset + self.model.elastic(last_thrust) * factor;
        if tilt > VALID_TILT { 0.0 } else { tilt }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn degrees(x: f32) -> f32 {
        scalar::to_deg(x)
    }

    #[test]
    fn equation_1_by_hand() {
        // ρ 6.9 %, K 1, 4 N: (2.4387 - 1.37793)·4 + (-0.162 + 0.10419)·16 = 4.24308 - 0.92496 = 3.31812°.
        let m = ArmModel::new(6.9, 1.0, 0.0);
        assert!((degrees(m.angle(4.0)) - 3.318_12).abs() < 1e-4);
        // Slope: 1.06077 - 0.11562·4 = 0.59829 °/N.
        assert!((degrees(m.slope(4.0)) - 0.598_29).abs() < 1e-4);
    }

    #[test]
    fn table_3_follows_from_the_default_gain() {
        // T1 8.28 N and T3 1.77 N: the table's 26.6, 21.3 and 16.8° within 1.5 %.
        for (infill, printed) in [(6.0, 26.6), (8.0, 21.3), (10.0, 16.8)] {
            let m = ArmModel::new(infill, 7.75, 4.15);
            let difference = degrees(m.angle(8.28) - m.angle(1.77));
            assert!(
                (difference / printed - 1.0).abs() < 0.015,
                "{infill}: {difference}"
            );
        }
    }

    #[test]
    fn the_parameters_are_table_1_until_somebody_fits_an_arm() {
        let p = Params::default();
        assert!(ArmModel::from_params(&p) == ArmModel::new(6.9, 7.75, 0.5 * p.thrust_max));
        let own = Params {
            arm_a1: 3.0,
            arm_a2: 0.0,
            arm_b1: -0.1,
            arm_b2: 0.0,
            gain_k: 1.0,
            ..p
        };
        // 3·5 - 0.1·25 = 12.5° at any infill.
        let m = ArmModel::from_params(&own);
        assert!((degrees(m.angle(5.0) - m.angle(0.0)) - 12.5).abs() < 1e-4);
    }

    #[test]
    fn arms_are_level_at_half_throttle_and_droop_at_idle() {
        let m = ArmModel::from_params(&Params::default());
        assert!(m.angle(4.15).abs() < 1e-6);
        assert!((degrees(m.angle(0.0)) + 26.4).abs() < 0.1);
        assert!(m.angle(8.0) > 0.0);
    }

    #[test]
    fn algorithm_1_drops_to_zero_beyond_40_degrees() {
        let a = Algorithm1::new(
            ArmModel {
                offset: 0.0,
                linear: scalar::deg(10.0),
                quadratic: 0.0,
            },
            1.7,
        );
        assert!((degrees(a.angle(3.9, 1.0)) - 39.0).abs() < 1e-3);
        assert!(a.angle(4.1, 1.0).abs() < 1e-9);
        // The guard is one-sided.
        assert!((degrees(a.angle(-4.1, 1.0)) + 41.0).abs() < 1e-3);
        // A weak battery bends less: 0.8^1.7 = 0.68432.
        assert!((degrees(a.angle(3.0, 0.8)) - 30.0 * 0.684_32).abs() < 1e-2);
    }

    proptest! {
        #[test]
        fn the_slope_is_the_derivative(infill in 4.0f32..10.0, k in 1.0f32..8.4, t in 0.1f32..8.0) {
            let m = ArmModel::new(infill, k, 4.15);
            let h = 0.05;
            let central = (m.angle(t + h) - m.angle(t - h)) / (2.0 * h);
            prop_assert!((central - m.slope(t)).abs() < 1e-4);
        }

        #[test]
        fn more_infill_bends_less(a in 4.0f32..10.0, b in 4.0f32..10.0, t in 0.1f32..8.0) {
            let (soft, stiff) = if a < b { (a, b) } else { (b, a) };
            let e = |infill| ArmModel::new(infill, 7.75, 4.15).elastic(t);
            prop_assert!(e(soft) >= e(stiff) - 1e-6);
        }
    }
}
