//! The vehicle in hover and at full thrust.

use sophie_control::allocation::effectiveness::{Effectiveness, Geometry};
use sophie_control::allocation::wrench::PerArm;

use crate::plant::GRAVITY;
use crate::plant::beam::BeamSpec;
use crate::plant::contact::{ARM_LENGTH, ARM_X};
use crate::plant::hinged::link::ArmSpec;
use crate::scenario::{Scenario, Vehicle};

/// Bisection steps for the hover thrust: to 1e-6 of the largest.
const HALVINGS: u32 = 20;
/// Difference of thrust for an arm's compliance, N.
const THRUST_STEP: f64 = 1e-3;
/// Limit of the stack's small-angle sines, rad.
const TILT_MAX: f64 = 0.7;

/// The vehicle of a scenario.
#[derive(Clone, Debug)]
pub struct Built {
    arms: PerArm<ArmSpec>,
    beams: PerArm<BeamSpec>,
    geometry: Geometry,
    chi: f64,
    /// Weight, N.
    pub weight: f64,
    /// Thrust of a rotor in hover, N; with level arms if full thrust cannot carry the vehicle.
    pub hover: f64,
}

impl Built {
    /// The vehicle of `scenario`.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let v: &Vehicle = &scenario.vehicle;
        let chi = f64::from(v.configuration.chi());
        let mut built = Self {
            arms: std::array::from_fn(|arm| scenario.arm_spec(arm)),
            beams: std::array::from_fn(|arm| scenario.beam_spec(arm)),
            geometry: Geometry::new(
                ARM_LENGTH as f32,
                ARM_X as f32,
                (chi * v.rotor.torque_ratio) as f32,
            ),
            chi,
            weight: v.body.mass * GRAVITY,
            hover: 0.25 * v.body.mass * GRAVITY,
        };
        if let Some(thrust) = built.thrust_of(built.weight, v.rotor.thrust_max) {
            built.hover = thrust;
        }
        built
    }

    /// Lift of four rotors at `thrust` N each, N: Σ T cos α(T).
    #[must_use]
    pub fn lift(&self, thrust: f64) -> f64 {
        self.arms
            .iter()
            .map(|arm| thrust * libm::cos(arm.static_tilt(thrust)))
            .sum()
    }

    /// Thrust in N, at most `most`; `None` if no thrust suffices.
    fn thrust_of(&self, lift: f64, most: f64) -> Option<f64> {
        let (mut low, mut high) = (0.0, most);
        if self.lift(high) < lift {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.lift(middle) < lift {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(high)
    }

    /// Yaw moment per newton of differential thrust with settled arms, m, from the stack's effectiveness; positive as
    /// the configuration expects, k_q for stiff arms.
    #[must_use]
    pub fn yaw_effect(&self, thrust: f64) -> PerArm<f64> {
        let tilt = self.tilt(thrust);
        let follow = self.arms.map(|arm| {
            let slope = arm.static_tilt(thrust + THRUST_STEP) - arm.static_tilt(thrust - THRUST_STEP);
            (thrust * slope / (2.0 * THRUST_STEP)) as f32
        });
        Effectiveness::quasi_static(&self.geometry, &tilt, &follow)
            .yaw
            .map(|y| self.chi * f64::from(y))
    }

    /// C = 1 - y / k_q: below 0 bending arms amplify a yaw command, above 1 they reverse it.
    #[must_use]
    pub fn yaw_derivative(&self, thrust: f64) -> f64 {
        let effect = self.yaw_effect(thrust);
        let mean = 0.25 * effect.iter().sum::<f64>();
        1.0 - mean / f64::from(self.geometry.drag.abs())
    }

    /// Lowest bending mode of the softest arm in hover, body held, Hz.
    #[must_use]
    pub fn arm_mode(&self) -> f64 {
        let first = |beam: &BeamSpec| beam.modes(self.hover)[0];
        self.beams.iter().map(first).fold(f64::INFINITY, f64::min)
    }

    /// rad, limited to `TILT_MAX`.
    fn tilt(&self, thrust: f64) -> PerArm<f32> {
        self.arms
            .map(|arm| arm.static_tilt(thrust).clamp(-TILT_MAX, TILT_MAX) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sophie_control::allocation::wrench::Configuration;

    #[test]
    fn stiff_arms_have_the_stiff_frame_s_lift_and_yaw() {
        let mut s = Scenario::default_mission();
        // 0.1 deg/N at K 1, level at half thrust: nearly stiff.
        s.vehicle.arm_coefficients = [0.1, 0.0, 0.0, 0.0];
        s.vehicle.gain_k = 1.0;
        let built = Built::of(&s);
        assert!(
            (built.lift(5.0) / 20.0 - 1.0).abs() < 1e-5 && (built.hover - 0.25 * built.weight).abs() < 1e-4
        );
        // Remaining effect of bending: b T dα/dT = 0.178 · 4.43 · 0.001745 = 1.4 mm of 16.
        assert!(
            built.yaw_effect(4.43).iter().all(|y| (y - 0.0174).abs() < 2e-4),
            "{:?}",
            built.yaw_effect(4.43)
        );
    }

    #[test]
    fn the_derivative_has_the_paper_s_sign_and_the_mode_is_the_plant_s() {
        let mut s = Scenario::default_mission();
        let built = Built::of(&s);
        // By hand in the paper's study: -3.89 without the lean's effect on the drag.
        assert!(
            (built.yaw_derivative(4.425) + 3.89).abs() < 0.05,
            "{}",
            built.yaw_derivative(4.425)
        );
        assert!((built.arm_mode() - 5.0).abs() < 0.15, "{}", built.arm_mode());
        s.vehicle.configuration = Configuration::A;
        assert!(Built::of(&s).yaw_derivative(4.425) > 1.0);
    }
}
