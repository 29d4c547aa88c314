//! Algorithm 1 with the printed matrix, its singular yaw row corrected.

use sophie_control::allocation::arm_deflection::{Algorithm1, ArmModel};
use sophie_control::allocation::effectiveness::Geometry;
use sophie_control::allocation::least_thrust::least_thrust;
use sophie_control::allocation::mixer::{Split, stiff};
use sophie_control::allocation::wrench::{Configuration, PerArm, Wrench};
use sophie_control::params::Params;

use crate::law::{Law, Situation};

/// Tilt by the last step's thrust, only in the thrust row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Printed {
    geometry: Geometry,
    algorithm_1: Algorithm1,
    last: PerArm<f32>,
}

impl Printed {
    /// With the parameters' vehicle, rotors idle.
    pub fn new(configuration: Configuration, p: &Params) -> Self {
        Self {
            geometry: Geometry::from_params(p, configuration),
            algorithm_1: Algorithm1::new(ArmModel::from_params(p), p.power_exponent),
            last: [least_thrust(p); 4],
        }
    }
}

impl Law for Printed {
    fn split(&self, w: Wrench, s: &Situation<'_>) -> Split {
        let power = s.thrust_ratio * s.thrust_ratio;
        let tilt = self.last.map(|t| self.algorithm_1.angle(t, power));
        stiff(&self.geometry, w, tilt)
    }

    fn follow(&mut self, thrusts: &PerArm<f32>, _: f32) {
        self.last = *thrusts;
    }
}
