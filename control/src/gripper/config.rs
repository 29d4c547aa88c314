//! Configuration of the gripper.

use crate::deflection::ArmModel;
use crate::grip::GripDemand;
use crate::math;
use crate::params::Params;
use crate::tendon::ForceLimit;

/// Gains, rates and limits, derived from the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Gains of the pressure loop, N/Pa, N/(Pa s) and N s/Pa.
    pub(super) p: f32,
    pub(super) i: f32,
    pub(super) d: f32,
    /// Rise of the force that bends a free arm at the approach speed, N/s.
    pub(super) approach_rate: f32,
    /// Fall of the force on release, N/s.
    pub(super) release_rate: f32,
    /// Largest force, N.
    pub(super) limit: f32,
    /// Tendon force that a rotor's thrust relieves, N/N.
    pub(super) per_thrust: f32,
    /// Tilt that a free arm loses for tendon force, rad/N.
    pub(super) bend_per_force: f32,
    pub(super) demand: GripDemand,
}

impl Config {
    /// Configuration from the parameters.
    pub fn from_params(p: &Params) -> Self {
        // The tendon's moment h F bends like the thrust F h/d; below level thrust the arm is linear.
        let compliance = math::clamp(ArmModel::from_params(p).slope(0.0), 1e-3, 10.0);
        let bend_per_force = compliance * p.tendon_lever / p.arm_d;
        let limit = ForceLimit::from_params(p).asked;
        Self {
            p: p.clamp_p,
            i: p.clamp_i,
            d: p.clamp_d,
            approach_rate: math::clamp(p.clamp_approach / bend_per_force, 0.0, 1e3),
            release_rate: p.clamp_release,
            limit,
            per_thrust: p.arm_d / p.tendon_lever,
            bend_per_force,
            demand: GripDemand::from_params(p, limit),
        }
    }

    /// Largest force, N.
    pub fn limit(&self) -> f32 {
        self.limit
    }

    /// Force below which a grip is proven, N.
    pub fn provable(&self) -> f32 {
        self.demand.force
    }
}
