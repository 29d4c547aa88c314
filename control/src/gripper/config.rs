//! Configuration of the gripper.

use crate::deflection::ArmModel;
use crate::grip::GripDemand;
use crate::math;
use crate::params::Params;
use crate::tendon::ForceLimit;

/// Derived from the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Gains of the pressure loop, N/Pa, N/(Pa s) and N s/Pa.
    pub(super) p: f32,
    pub(super) i: f32,
    pub(super) d: f32,
    /// Force rise at the approach speed of a free arm, N/s.
    pub(super) approach_rate: f32,
    /// Force fall on release, N/s.
    pub(super) release_rate: f32,
    /// Largest force, N.
    pub(super) limit: f32,
    /// Tendon force relieved by a rotor's thrust, N/N.
    pub(super) per_thrust: f32,
    /// Tilt loss of a free arm by tendon force, rad/N.
    pub(super) bend_per_force: f32,
    pub(super) demand: GripDemand,
}

impl Config {
    /// From the parameters.
    pub fn from_params(p: &Params) -> Self {
        // The moment h F bends like the thrust F h/d; below level thrust the arm is linear.
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
