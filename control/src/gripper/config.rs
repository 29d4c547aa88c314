//! Configuration of the gripper.

use crate::allocation::arm_deflection::ArmModel;
use crate::gripper::grip::GripDemand;
use crate::gripper::tendon::ForceLimit;
use crate::maths::scalar;
use crate::params::Params;

/// Tendon force that a newton of the rotor's thrust relieves on the pipe, N/N.
pub fn force_per_thrust(p: &Params) -> f32 {
    p.tendon_relief * p.arm_d / p.tendon_lever
}

/// Number of times that a slipping grip is tightened.
pub const TIGHTENINGS: u8 = 2;
/// Increase at each tightening, share of the grip pressure: friction on the pipe grows with it, to 2,850 Pa in all,
/// below the 3 kPa of a bump. Half of it is too little: a slip at the limit of friction continues (measured in the
/// plant).
const TIGHTER: f32 = 1.0;

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
    /// Tendon force relieved by a rotor's thrust on the pipe, N/N.
    pub(super) per_thrust: f32,
    /// Thrust that bends a free arm as much as a newton of tendon force, N/N.
    pub(super) thrust_per_force: f32,
    /// Tilt loss of a free arm by tendon force, rad/N.
    pub(super) bend_per_force: f32,
    pub(super) demand: GripDemand,
    /// Bending of an arm round the pipe, rad.
    pub(super) pipe_bend: f32,
}

impl Config {
    /// From the parameters.
    pub fn from_params(p: &Params) -> Self {
        // A newton of tendon bends a free arm as much as this thrust; below level thrust the arm is linear.
        let thrust_per_force = scalar::clamp(p.tendon_bend * p.tendon_lever / p.arm_d, 1e-3, 10.0);
        let compliance = scalar::clamp(ArmModel::from_params(p).slope(0.0), 1e-3, 10.0);
        let bend_per_force = compliance * thrust_per_force;
        let limit = ForceLimit::from_params(p).asked;
        Self {
            p: p.clamp_p,
            i: p.clamp_i,
            d: p.clamp_d,
            approach_rate: scalar::clamp(p.clamp_approach / bend_per_force, 0.0, 1e3),
            release_rate: p.clamp_release,
            limit,
            per_thrust: force_per_thrust(p),
            thrust_per_force,
            bend_per_force,
            demand: GripDemand::from_params(p, limit),
            pipe_bend: scalar::clamp(2.0 * p.arm_d / p.pipe_diameter, 0.01, 10.0),
        }
    }

    /// Configuration of a grip that was tightened `times`.
    pub fn tightened(mut self, times: u8) -> Self {
        self.demand.pressure *= 1.0 + TIGHTER * f32::from(times.min(TIGHTENINGS));
        self
    }

    /// Configuration of an arm that releases from `force` while the tightest releases from `most`, N.
    pub(super) fn releasing(mut self, force: f32, most: f32) -> Self {
        if most > 0.0 {
            self.release_rate *= scalar::clamp(force / most, 0.0, 1.0);
        }
        self
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
