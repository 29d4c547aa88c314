//! The whole effectiveness inverted at the arms' present tilt.

use sophie_control::allocation::desaturation::Patterns;
use sophie_control::allocation::effectiveness::{Effectiveness, Geometry, Inverse, Load};
use sophie_control::allocation::least_thrust::least_thrust;
use sophie_control::allocation::mixer::{Split, moment_patterns, stiff};
use sophie_control::allocation::wrench::{Configuration, PerArm, Wrench};
use sophie_control::maths::filter::LowPass;
use sophie_control::params::Params;

use crate::law::{Law, Situation};

/// Arm mode of [`DynamicTilt`] (assumed).
const ARM_DAMPING: f32 = 0.15;

#[derive(Clone, Copy, Debug, PartialEq)]
struct DynamicTilt {
    motor: LowPass,
    /// Thrust whose static tilt is the present one, N.
    load: f32,
    speed: f32,
    omega: f32,
}

impl DynamicTilt {
    fn at(thrust: f32, mode_hz: f32) -> Self {
        Self {
            motor: LowPass::at(thrust),
            load: thrust,
            speed: 0.0,
            omega: core::f32::consts::TAU * mode_hz,
        }
    }

    fn step(&mut self, thrust: f32, motor_rate: f32, dt: f32) {
        let thrust = self.motor.step(thrust, motor_rate, dt);
        let pull = self.omega * (thrust - self.load) - 2.0 * ARM_DAMPING * self.speed;
        self.speed += self.omega * pull * dt;
        self.load += self.speed * dt;
    }
}

/// T = M(α)⁻¹ w, α from a model of motor lag and arm mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frozen {
    geometry: Geometry,
    arms: PerArm<DynamicTilt>,
    motor_rate: f32,
}

impl Frozen {
    /// With the parameters' vehicle, rotors idle.
    pub fn new(configuration: Configuration, p: &Params) -> Self {
        Self {
            geometry: Geometry::from_params(p, configuration),
            arms: [DynamicTilt::at(least_thrust(p), p.notch_hz); 4],
            motor_rate: 1.0 / p.motor_tau,
        }
    }
}

impl Law for Frozen {
    fn split(&self, w: Wrench, s: &Situation<'_>) -> Split {
        let tilt = self.arms.map(|arm| s.tilt.model().angle(arm.load));
        let e = Effectiveness::frozen(&self.geometry, &tilt);
        let Some(inverse) = Inverse::new(&e) else {
            let w = Wrench { yaw: 0.0, ..w };
            return Split {
                fade: 0.0,
                ..stiff(&self.geometry, w, [0.0; 4])
            };
        };
        let half = 0.5 * w.thrust;
        let patterns = Patterns {
            collective: inverse.solve(Load {
                front: half,
                rear: half,
                ..Load::default()
            }),
            ..moment_patterns(&self.geometry, &inverse, w)
        };
        Split { patterns, fade: 1.0 }
    }

    fn follow(&mut self, thrusts: &PerArm<f32>, dt: f32) {
        for (arm, t) in self.arms.iter_mut().zip(thrusts) {
            arm.step(*t, self.motor_rate, dt);
        }
    }
}
