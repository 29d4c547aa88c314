//! Tilt of each arm: Eq. 1 at the low-passed thrust, plus a slow bias from the arm's own sensor.
//!
//! [`TiltModel::step`] runs at 1 kHz (N, s), [`TiltModel::correct`] at 100 Hz (rad, tip up positive). A missed reading
//! keeps the bias.
//!
//! The sensor only moves the bias, which corrects the model: in the allocation its noise and latency would cost more
//! than its angle brings.

use core::f32::consts::TAU;

use crate::allocation::arm_deflection::{ArmModel, VALID_TILT};
use crate::allocation::least_thrust::least_thrust;
use crate::allocation::wrench::PerArm;
use crate::maths::filter::LowPass;
use crate::params::Params;

/// Lag of arm and sensor behind the thrust beyond the motor's, s (assumed).
const ARM_LAG: f32 = 0.05;
/// Thrust below which the bias is frozen, N: the tips may rest on the ground.
const LEARN_THRUST: f32 = 2.2;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Arm {
    thrust: LowPass,
    lagged: LowPass,
    bias: f32,
    tilt: f32,
    /// T dα/dT: tilt by a relative change of thrust once the arm has followed, rad.
    follow: f32,
}

/// Tilt of the four arms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltModel {
    model: ArmModel,
    cutoff: f32,
    lag_rate: f32,
    bias_gain: f32,
    bias_max: f32,
    arms: PerArm<Arm>,
    fault: bool,
}

impl TiltModel {
    /// Arms at idle thrust without bias.
    pub fn new(p: &Params) -> Self {
        let model = ArmModel::from_params(p);
        let thrust = least_thrust(p);
        let arm = Arm {
            thrust: LowPass::at(thrust),
            lagged: LowPass::at(thrust),
            bias: 0.0,
            tilt: model.angle(thrust),
            follow: thrust * model.slope(thrust),
        };
        Self {
            model,
            cutoff: TAU * p.tilt_cutoff,
            lag_rate: 1.0 / (p.motor_tau + ARM_LAG),
            bias_gain: p.tilt_bias_gain,
            bias_max: p.tilt_bias_max,
            arms: [arm; 4],
            fault: false,
        }
    }

    /// One step of `dt` s with the last thrusts (N); non-finite ones change nothing.
    #[inline(always)]
    pub fn step(&mut self, commanded: &PerArm<f32>, dt: f32) {
        if !commanded.iter().sum::<f32>().is_finite() {
            return;
        }
        let model = self.model;
        let (gain, lag_gain) = (LowPass::gain(self.cutoff, dt), LowPass::gain(self.lag_rate, dt));
        let mut doubtful: f32 = 0.0;
        for (arm, thrust) in self.arms.iter_mut().zip(commanded) {
            let thrust = arm.thrust.blend(*thrust, gain);
            arm.lagged.blend(thrust, lag_gain);
            let tilt = model.angle(thrust) + arm.bias;
            // Outside the model's range the last valid tilt is held and a fault reported.
            let valid = tilt.abs() <= VALID_TILT;
            arm.tilt = if valid { tilt } else { arm.tilt };
            arm.follow = thrust * model.slope(thrust);
            let unknown = if valid { 0.0 } else { thrust };
            doubtful = if unknown > doubtful { unknown } else { doubtful };
        }
        self.fault = doubtful > LEARN_THRUST;
    }

    /// Takes a tilt (rad) of the sensor of `arm` (0 to 3), at 100 Hz, while the arm hangs free.
    #[inline(always)]
    pub fn correct(&mut self, arm: usize, measured: f32) {
        let Some(arm) = self.arms.get_mut(arm) else {
            return;
        };
        let felt = arm.lagged.value();
        let gain = if felt > LEARN_THRUST { self.bias_gain } else { 0.0 };
        let bias = arm.bias + gain * (measured - self.model.angle(felt) - arm.bias);
        // A glitch, beyond the limit or NaN, is ignored.
        arm.bias = if bias.abs() <= self.bias_max {
            bias
        } else {
            arm.bias
        };
    }

    /// The static model.
    pub const fn model(&self) -> &ArmModel {
        &self.model
    }

    /// Low-passed thrust of each rotor, N, >= 0.
    #[inline]
    pub fn thrusts(&self) -> PerArm<f32> {
        self.each(|arm| arm.thrust.value())
    }

    /// Tilt of each arm, rad, tip up positive, within ±[`VALID_TILT`].
    #[inline]
    pub fn tilt(&self) -> PerArm<f32> {
        self.each(|arm| arm.tilt)
    }

    /// T dα/dT of each arm, rad: tilt by a relative change of thrust.
    #[inline]
    pub fn follow(&self) -> PerArm<f32> {
        self.each(|arm| arm.follow)
    }

    /// Bias of each arm, rad, tip up positive, within the parameters' limit.
    #[inline]
    pub fn bias(&self) -> PerArm<f32> {
        self.each(|arm| arm.bias)
    }

    /// By reference: by value would copy the arms.
    #[inline(always)]
    fn each(&self, what: impl Fn(&Arm) -> f32) -> PerArm<f32> {
        let [first, second, third, fourth] = &self.arms;
        [what(first), what(second), what(third), what(fourth)]
    }

    /// A flying arm is outside the model's range: its last valid tilt is held.
    pub const fn fault(&self) -> bool {
        self.fault
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::scalar;

    fn correct(t: &mut TiltModel, measured: PerArm<f32>) {
        for (arm, measured) in measured.into_iter().enumerate() {
            t.correct(arm, measured);
        }
    }

    fn settled(thrust: f32) -> TiltModel {
        let mut t = TiltModel::new(&Params::default());
        for _ in 0..3000 {
            t.step(&[thrust; 4], 1e-3);
        }
        t
    }

    #[test]
    fn it_settles_on_equation_1() {
        let t = settled(5.0);
        assert!((t.tilt()[2] - t.model().angle(5.0)).abs() < 1e-4);
    }

    #[test]
    fn the_bias_takes_up_an_arm_that_hangs_three_degrees_lower() {
        let mut t = settled(4.4);
        let truth = t.model().angle(4.4) - scalar::deg(3.0);
        for _ in 0..300 {
            correct(&mut t, [truth, f32::INFINITY, f32::NAN, truth]);
            t.step(&[4.4; 4], 1e-2);
        }
        let tilt = t.tilt();
        assert!((tilt[0] - truth).abs() < 2e-3 && (tilt[3] - truth).abs() < 2e-3);
        assert!(t.bias()[1].abs() < 1e-9 && t.bias()[2].abs() < 1e-9);
    }

    #[test]
    fn an_arm_beyond_40_degrees_is_held_and_reported() {
        let p = Params {
            infill: 4.0,
            gain_k: 10.0,
            thrust_max: 5.0,
            ..Params::default()
        };
        let mut t = TiltModel::new(&p);
        let mut last = t.tilt()[0];
        for i in 0..6000 {
            t.step(&[i as f32 * 2e-3; 4], 1e-3);
            assert!((t.tilt()[0] - last).abs() < 0.01 && t.tilt()[0].abs() <= VALID_TILT);
            last = t.tilt()[0];
        }
        let mut soft = TiltModel {
            model: ArmModel {
                offset: 0.0,
                linear: 0.2,
                quadratic: 0.0,
            },
            ..t
        };
        for _ in 0..3000 {
            soft.step(&[8.0; 4], 1e-3);
        }
        assert!(soft.fault());
    }

    #[test]
    fn whether_it_learns_is_up_to_the_thrust_that_the_arm_has_felt() {
        // Spooling up, the arm still hangs.
        let mut t = settled(0.25);
        while t.thrusts()[0] < LEARN_THRUST + 0.2 {
            t.step(&[6.0; 4], 1e-3);
        }
        assert!(t.arms[0].lagged.value() < LEARN_THRUST);
        correct(&mut t, [0.1; 4]);
        assert!(t.bias() == [0.0; 4], "{:?}", t.bias());
        // Spooling down, the arm still bent.
        let mut t = settled(6.0);
        while t.thrusts()[0] > LEARN_THRUST - 0.2 {
            t.step(&[0.25; 4], 1e-3);
        }
        let felt = t.arms[0].lagged.value();
        assert!(felt > LEARN_THRUST);
        let truth = t.model().angle(felt) + 0.05;
        correct(&mut t, [truth; 4]);
        assert!(t.bias().iter().all(|b| *b > 0.0), "{:?}", t.bias());
    }

    #[test]
    fn a_bias_stays_within_its_limit_and_a_glitch_moves_nothing() {
        let limit = Params::default().tilt_bias_max;
        let mut t = settled(4.4);
        for _ in 0..3000 {
            correct(&mut t, [1.5, -1.5, f32::INFINITY, 1e30]);
        }
        let [up, down, silent, glitch] = t.bias();
        assert!(up <= limit && up > limit - 0.04 && down >= -limit && down < 0.04 - limit);
        assert!(silent == 0.0 && glitch == 0.0);
    }

    #[test]
    fn nothing_is_learnt_on_the_ground() {
        let mut t = settled(0.25);
        correct(&mut t, [0.1; 4]);
        assert!(t.bias() == [0.0; 4]);
    }
}
