//! Motor command for a thrust (N) at the battery's voltage, 1 kHz; the voltage comes at 100 Hz.

use crate::allocation::motor_pulses::least_command;
use crate::allocation::wrench::PerArm;
use crate::maths::scalar;
use crate::params::Params;

/// T / T_max = f r² (q u² + (1 - q) u): thrust of the command u at the voltage V, of a rotor with the trim f.
///
/// r is the root of what the voltage makes of the thrust, [`voltage_ratio`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustCurve {
    quadratic: f32,
    /// For the root, of which numerator and divisor are half as large: (1 - q) / 4, and half the square of (1 - q) / 2.
    twice_max: f32,
    quarter_linear: f32,
    half_linear_square: f32,
    /// Command of a rotor that just turns, and half its share.
    least_command: f32,
    half_least: f32,
    /// One over each rotor's trim.
    per_trim: PerArm<f32>,
}

/// Least voltage ratio compensated.
const LEAST_RATIO: f32 = 0.5;
/// Keeps the root of a quadratic curve, a divisor, from 0: 1e-6 of the command.
const LEAST_SQUARE: f32 = 1e-12;
/// Least trim, so that it divides.
const LEAST_TRIM: f32 = 0.5;

/// Root of what the voltage makes of the thrust, (V/V0)^(p/2), at the voltage over nominal V/V0: V/V0 to the bit for the
/// default power p of 2. Relative error below 5e-5 for others.
pub fn voltage_ratio(over_nominal: f32, p: &Params) -> f32 {
    over_nominal * scalar::pow_near_one(over_nominal, 0.5 * p.thrust_volt_exp - 1.0)
}

impl ThrustCurve {
    /// Curve by the parameters.
    pub fn from_params(p: &Params) -> Self {
        let quadratic = scalar::clamp(p.thrust_curve, 0.0, 1.0);
        let half_linear = 0.5 * (1.0 - quadratic);
        let least_command = least_command(p);
        Self {
            quadratic,
            twice_max: 2.0 * p.thrust_max,
            quarter_linear: 0.5 * half_linear,
            half_linear_square: 0.5 * (half_linear * half_linear + LEAST_SQUARE),
            least_command,
            per_trim: [p.thrust_trim_1, p.thrust_trim_2, p.thrust_trim_3, p.thrust_trim_4]
                .map(|trim| 1.0 / scalar::clamp(trim, LEAST_TRIM, 2.0)),
            half_least: 0.5 * (quadratic * least_command + (1.0 - quadratic)) * least_command,
        }
    }

    /// Command 0..1 for `thrust` (N) of a rotor of trim 1 at the [`voltage_ratio`]; 0 for no thrust.
    pub fn command(&self, thrust: f32, ratio: f32) -> f32 {
        let stopped = Self {
            half_least: 0.0,
            per_trim: [1.0; 4],
            ..*self
        };
        let [command, ..] = stopped.commands(&[thrust; 4], ratio);
        command
    }

    /// Commands for the thrusts (N) of rotors that must turn, at the [`voltage_ratio`]: from [`least_command`] to 1,
    /// whatever is asked.
    #[inline(always)]
    pub fn commands(&self, thrusts: &PerArm<f32>, ratio: f32) -> PerArm<f32> {
        let ratio = scalar::clamp(ratio, LEAST_RATIO, 1.5);
        let half_per_newton = 1.0 / (self.twice_max * ratio * ratio);
        let [a, b, c, d] = *thrusts;
        let [e, f, g, h] = self.per_trim;
        [
            self.share_to_command(a * half_per_newton * e),
            self.share_to_command(b * half_per_newton * f),
            self.share_to_command(c * half_per_newton * g),
            self.share_to_command(d * half_per_newton * h),
        ]
    }

    /// Root of q u² + (1 - q) u = share of `half` the share, in a form that also holds for q = 0.
    #[inline(always)]
    fn share_to_command(&self, half: f32) -> f32 {
        let least = self.half_least;
        let half = if half > least { half } else { least };
        let square = self.half_linear_square + self.quadratic * half;
        let sum = self.quarter_linear + square * scalar::inv_sqrt_of_twice(square);
        let command = half / sum;
        if command < 1.0 { command } else { 1.0 }
    }

    /// Least command of a rotor that must turn.
    pub const fn least_command(&self) -> f32 {
        self.least_command
    }

    /// Thrust (N) of `command` at the [`voltage_ratio`] `ratio`, of a rotor of trim 1.
    pub fn thrust(&self, command: f32, ratio: f32) -> f32 {
        let u = scalar::clamp(command, 0.0, 1.0);
        let (max, linear) = (0.5 * self.twice_max, 4.0 * self.quarter_linear);
        max * ratio * ratio * (self.quadratic * u + linear) * u
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn full_command_is_full_thrust_and_none_is_none() {
        let c = ThrustCurve::from_params(&Params::default());
        assert!((c.command(8.3, 1.0) - 1.0).abs() < 1e-6 && c.command(0.0, 1.0) == 0.0);
        // q 0.75, share 0.5: 0.75 u² + 0.25 u = 0.5 gives u = 0.66667.
        assert!((c.command(4.15, 1.0) - 2.0 / 3.0).abs() < 1e-5);
        assert!(c.command(f32::NAN, 1.0) == 0.0 && c.command(4.0, f32::NAN).is_finite());
    }

    #[test]
    fn the_root_keeps_its_error_over_all_curves_and_thrusts() {
        for q in 0..=100 {
            let q = q as f32 * 0.01;
            let c = ThrustCurve::from_params(&Params {
                thrust_curve: q,
                ..Params::default()
            });
            for share in 0..=1000 {
                let thrust = 8.3 * share as f32 * 1e-3;
                let (share, q) = (f64::from(thrust) / f64::from(8.3f32), f64::from(q));
                let (linear, root) = (1.0 - q, ((1.0 - q).powi(2) + 4.0 * q * share).sqrt());
                let exact = if share > 0.0 {
                    2.0 * share / (linear + root)
                } else {
                    0.0
                };
                let error = (f64::from(c.command(thrust, 1.0)) - exact).abs();
                assert!(error < 2e-6, "{q} {share}: {error}");
            }
        }
    }

    #[test]
    fn a_weaker_rotor_gets_more_command_and_gives_the_same_thrust() {
        let p = Params {
            thrust_trim_1: 0.95,
            thrust_trim_3: 1.05,
            ..Params::default()
        };
        let plain = ThrustCurve::from_params(&Params::default());
        let [weak, mean, strong, last] = ThrustCurve::from_params(&p).commands(&[4.4; 4], 1.02);
        assert_eq!((mean, last), (plain.command(4.4, 1.02), plain.command(4.4, 1.02)));
        for (command, trim) in [(weak, 0.95), (strong, 1.05)] {
            let given = trim * plain.thrust(command, 1.02);
            assert!((given - 4.4).abs() < 1e-4, "{trim}: {given}");
        }
        assert!(weak > mean && strong < mean);
    }

    #[test]
    fn the_default_trims_and_power_change_no_bit() {
        let c = ThrustCurve::from_params(&Params::default());
        for volts in 0..=800 {
            let ratio = (10.4 + 0.01 * volts as f32) / 14.8;
            assert_eq!(
                voltage_ratio(ratio, &Params::default()).to_bits(),
                ratio.to_bits()
            );
            let thrusts = [0.3, 2.2, 4.4, 8.1];
            let half_per_newton = 1.0 / (c.twice_max * ratio * ratio);
            let before = thrusts.map(|thrust: f32| c.share_to_command(thrust * half_per_newton));
            assert_eq!(c.commands(&thrusts, ratio), before, "{ratio}");
        }
    }

    #[test]
    fn the_voltage_acts_by_its_power() {
        let p = Params {
            thrust_volt_exp: 1.6,
            ..Params::default()
        };
        for over in [0.75f32, 0.9, 1.0, 1.13] {
            let thrust = voltage_ratio(over, &p).powi(2);
            assert!((thrust / over.powf(1.6) - 1.0).abs() < 1e-4, "{over}: {thrust}");
        }
    }

    proptest! {
        #[test]
        fn command_undoes_thrust(q in 0.0f32..1.0, u in 0.0f32..1.0, ratio in 0.7f32..1.2) {
            let c = ThrustCurve::from_params(&Params { thrust_curve: q, ..Params::default() });
            prop_assert!((c.command(c.thrust(u, ratio), ratio) - u).abs() < 1e-3);
        }

        #[test]
        fn more_thrust_needs_more_command(t in 0.0f32..8.0, more in 0.01f32..0.3, ratio in 0.8f32..1.2) {
            let c = ThrustCurve::from_params(&Params::default());
            prop_assert!(c.command(t + more, ratio) >= c.command(t, ratio));
            prop_assert!(c.command(t, ratio) >= c.command(t, ratio + 0.1));
        }
    }
}
