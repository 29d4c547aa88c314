//! Interface of an allocation law, and the limits around it.

use sophie_control::allocation::arm_tilt::TiltModel;
use sophie_control::allocation::mixer::{Allocation, Conditions, Limits, Mix, Split};
use sophie_control::allocation::wrench::{PerArm, Wrench};
use sophie_control::chain::MixingStep;
use sophie_control::params::Params;

/// Inputs of a law.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// Modelled arm tilt and low-passed thrusts.
    pub tilt: &'a TiltModel,
    /// Yaw is demanded, and thrust suffices for it.
    pub yaw: bool,
    /// Root of the largest thrust over that of the parameters, 0.5..1.25.
    pub thrust_ratio: f32,
}

/// Splits a wrench into patterns of thrust.
pub trait Law {
    /// Patterns for the wrench `w` (N, N·m, finite), and the share of yaw with authority.
    fn split(&self, w: Wrench, s: &Situation<'_>) -> Split;

    /// Takes the sent thrusts (N) of a step of `dt` s.
    fn follow(&mut self, _thrusts: &PerArm<f32>, _dt: f32) {}
}

/// Adds limits and tilt model of the allocation that flies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithLimits<L> {
    law: L,
    limits: Limits,
    tilt: TiltModel,
}

impl<L> WithLimits<L> {
    /// The allocation by `law` with idle rotors.
    pub fn new(law: L, p: &Params) -> Self {
        Self {
            law,
            limits: Limits::new(p),
            tilt: TiltModel::new(p),
        }
    }
}

impl<L: Law> Allocation for WithLimits<L> {
    fn allocate(&mut self, w: &Wrench, c: Conditions) -> Mix {
        if !w.is_finite() {
            return self.limits.at_idle();
        }
        let situation = Situation {
            tilt: &self.tilt,
            yaw: self.limits.open_yaw(self.tilt.thrusts()) && c.yaw,
            thrust_ratio: Limits::thrust_ratio(c.thrust_ratio),
        };
        let split = self.law.split(*w, &situation);
        self.limits.give(split, situation.yaw, situation.thrust_ratio)
    }

    fn at_idle(&self) -> Mix {
        self.limits.at_idle()
    }

    fn follow(&mut self, thrusts: &PerArm<f32>, dt: f32) {
        self.tilt.step(thrusts, dt);
        self.law.follow(thrusts, dt);
    }

    fn tilt(&self) -> &TiltModel {
        &self.tilt
    }

    fn tilt_mut(&mut self) -> &mut TiltModel {
        &mut self.tilt
    }
}

impl<L: Law> MixingStep for WithLimits<L> {}
