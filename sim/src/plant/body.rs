//! Equations of motion of the body that carries the arms.
//!
//! Each arm adds its mass and forces to the body's equations ([`Carried`]). The remaining 6×6 system is solved by 3×3
//! blocks; then each arm finds its own acceleration.

use glam::{DMat3, DVec3};

use super::contact::{ARM_X, HINGE_Z, Pose};
use super::flexible::{Carried, Carrier};
use super::load::Load;
use super::mass_matrix::MassMatrix;
use crate::plant::load::Acceleration;

/// Mass and inertia as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodySpec {
    /// Mass of the vehicle, kg.
    pub mass: f64,
    /// Roll, pitch, yaw with level arms, kg·m².
    pub inertia: [f64; 3],
}

impl Default for BodySpec {
    fn default() -> Self {
        Self {
            // Paper, Table II.
            mass: 1.805,
            // Assumed, 30 %.
            inertia: [0.021, 0.044, 0.063],
        }
    }
}

/// State of the body.
#[derive(Clone, Copy, Debug)]
pub struct BodyState {
    /// Position, attitude and motion.
    pub pose: Pose,
}

/// A point mass of every arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmPoint {
    /// Mass, kg.
    pub mass: f64,
    /// Distance from the centre line with a level arm, m.
    pub out: f64,
    /// Inertia about its own centre, any axis, kg·m².
    pub inertia: f64,
}

/// Rigid part of the vehicle.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    coupled: bool,
    mass: f64,
    centre: DVec3,
    inertia: DMat3,
    inverse: DMat3,
}

impl Body {
    /// The vehicle without the masses that its arms carry, `points` each. The vehicle's centre of mass with level arms
    /// is the origin.
    #[must_use]
    pub fn new(spec: &BodySpec, points: &[ArmPoint]) -> Self {
        let mut body = Self::whole(spec);
        body.coupled = true;
        let mut inertia = DVec3::from_array(spec.inertia);
        let mut first = 0.0;
        for ArmPoint {
            mass,
            out,
            inertia: own,
        } in points
        {
            let (x2, y2, z2) = (ARM_X * ARM_X, out * out, HINGE_Z * HINGE_Z);
            inertia -= DVec3::new(y2 + z2, x2 + z2, x2 + y2) * (4.0 * mass) + DVec3::splat(4.0 * own);
            body.mass -= 4.0 * mass;
            first += 4.0 * mass * HINGE_Z;
        }
        body.centre = DVec3::new(0.0, 0.0, -first / body.mass);
        body.inertia = DMat3::from_diagonal(inertia);
        body.inverse = body.inertia.inverse();
        body
    }

    /// A body with all mass, whose arms have none.
    #[must_use]
    pub fn whole(spec: &BodySpec) -> Self {
        let inertia = DMat3::from_diagonal(DVec3::from_array(spec.inertia));
        Self {
            coupled: false,
            mass: spec.mass,
            centre: DVec3::ZERO,
            inertia,
            inverse: inertia.inverse(),
        }
    }

    /// Whether arms act on the body by their mass.
    #[must_use]
    pub fn coupled(&self) -> bool {
        self.coupled
    }

    /// Kinetic energy (J), momentum (kg·m/s) and angular momentum (kg·m²/s) about the origin of the part without arms,
    /// which moves at `velocity` (m/s) and turns at `omega` (rad/s), body axes.
    #[must_use]
    pub fn motion(&self, velocity: DVec3, omega: DVec3) -> (f64, DVec3, DVec3) {
        let momentum = (velocity + omega.cross(self.centre)) * self.mass;
        let angular = self.inertia * omega + self.centre.cross(velocity) * self.mass;
        (
            0.5 * (momentum.dot(velocity) + angular.dot(omega)),
            momentum,
            angular,
        )
    }

    /// Accelerations under `gravity` (m/s², body), the loaded `arms`, and all other `load`.
    #[must_use]
    pub fn accelerate<A: Carried>(
        &self,
        pose: &Pose,
        load: Load,
        gravity: DVec3,
        arms: [&A; 4],
    ) -> Acceleration {
        let w = pose.omega;
        let mut load = Load {
            force: load.force + self.mass * (gravity - w.cross(w.cross(self.centre))),
            moment: load.moment + self.mass * self.centre.cross(gravity) - w.cross(self.inertia * w),
        };
        if !self.coupled {
            for arm in arms {
                arm.condense_massless(&mut load);
            }
            return Acceleration {
                linear: load.force / self.mass,
                angular: self.inverse * load.moment,
            };
        }
        let carrier = Carrier {
            omega: w,
            gravity,
            coupled: true,
        };
        let mut mass = MassMatrix::new(self.mass, self.centre, self.inertia);
        for arm in arms {
            arm.condense(&carrier, &mut mass, &mut load);
        }
        mass.solve(&load)
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::super::contact::ARM_LENGTH;
    use super::super::hinged::link::{Arm, ArmSpec, TIP, TIP_MASS};
    use super::super::{GRAVITY, STEP};
    use super::*;

    /// Mass, kg (paper).
    const MASS: f64 = 1.805;

    fn arms() -> [Arm; 4] {
        std::array::from_fn(|i| Arm::new(i, ArmSpec::new(6.9, 7.75, 1.0, 0.0, 0.15)))
    }

    fn pose() -> Pose {
        Pose {
            position: DVec3::ZERO,
            attitude: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            omega: DVec3::ZERO,
        }
    }

    /// Returns the end and the angular momentum about the world origin.
    fn fly(thrust: f64, moment: DVec3, seconds: f64, omega: DVec3) -> (Pose, [Arm; 4], DVec3) {
        run(arms(), thrust, |_| moment, seconds, omega)
    }

    /// From hover with arms at rest: `moment` for `on` s, free until `seconds`.
    fn pulse(moment: DVec3, on: f64, seconds: f64) -> (Pose, [Arm; 4], DVec3) {
        let mut arms = arms();
        let rest = ArmSpec::new(6.9, 7.75, 1.0, 0.0, 0.15).static_tilt(4.425);
        for arm in &mut arms {
            arm.tilt = rest;
            arm.integrate(0.0, 0.0);
        }
        let during = |t: f64| if t < on { moment } else { DVec3::ZERO };
        run(arms, 4.425, during, seconds, DVec3::ZERO)
    }

    fn run(
        mut arms: [Arm; 4],
        thrust: f64,
        moment: impl Fn(f64) -> DVec3,
        seconds: f64,
        omega: DVec3,
    ) -> (Pose, [Arm; 4], DVec3) {
        let body = Body::new(&BodySpec::default(), &TIP);
        let mut pose = pose();
        pose.omega = omega;
        let gravity = DVec3::new(0.0, 0.0, GRAVITY);
        for i in 0..(seconds / STEP) as usize {
            let g = pose.to_body(gravity);
            for arm in &mut arms {
                arm.load(thrust, 0.0, g, true);
            }
            let acc = body.accelerate(
                &pose,
                Load {
                    force: DVec3::ZERO,
                    moment: moment(i as f64 * STEP),
                },
                g,
                arms.each_ref(),
            );
            let carrier = Carrier {
                omega: pose.omega,
                gravity: g,
                coupled: true,
            };
            for arm in &mut arms {
                arm.integrate(STEP, arm.acceleration(&acc, &carrier));
            }
            pose.velocity += pose.attitude * acc.linear * STEP;
            pose.omega += acc.angular * STEP;
            pose.position += pose.velocity * STEP;
            let h = pose.omega * (0.5 * STEP);
            pose.attitude = (pose.attitude * DQuat::from_xyzw(h.x, h.y, h.z, 1.0)).normalize();
        }
        // About the origin, body axes.
        let mut momentum = body.inertia * pose.omega
            + body.mass * body.centre.cross(pose.attitude.conjugate() * pose.velocity);
        for arm in &arms {
            let v = pose.attitude.conjugate() * pose.velocity
                + pose.omega.cross(arm.tip())
                + arm.normal() * (ARM_LENGTH * arm.rate);
            momentum += TIP_MASS * arm.tip().cross(v);
        }
        (pose, arms, pose.attitude * momentum)
    }

    #[test]
    fn hover_thrust_hovers_with_arms_at_the_static_tilt() {
        let (pose, arms, _) = fly(MASS * GRAVITY / 4.0 / 0.99978, DVec3::ZERO, 6.0, DVec3::ZERO);
        let spec = ArmSpec::new(6.9, 7.75, 1.0, 0.0, 0.15);
        let expected = spec.static_tilt(MASS * GRAVITY / 4.0);
        for arm in &arms {
            assert!((arm.tilt - expected).abs() < 1e-4, "{} {expected}", arm.tilt);
        }
        assert!(pose.velocity.x.abs() < 1e-9 && pose.velocity.y.abs() < 1e-9);
        assert!(pose.omega.length() < 1e-9);
    }

    #[test]
    fn free_fall_turns_no_arm_and_keeps_angular_momentum() {
        let (_, _, start) = fly(0.0, DVec3::ZERO, 0.0, DVec3::new(1.0, 0.5, -0.7));
        let body = Body::new(&BodySpec::default(), &TIP);
        let omega = DVec3::new(1.0, 0.5, -0.7);
        let (pose, arms, end) = fly(0.0, DVec3::ZERO, 0.4, omega);
        // Less the momentum of the centre of mass.
        let centre = |pose: &Pose, arms: &[Arm; 4]| {
            let mut c = body.mass * body.centre;
            let mut p =
                body.mass * (pose.attitude.conjugate() * pose.velocity + pose.omega.cross(body.centre));
            for arm in arms {
                c += TIP_MASS * arm.tip();
                p += TIP_MASS
                    * (pose.attitude.conjugate() * pose.velocity
                        + pose.omega.cross(arm.tip())
                        + arm.normal() * (ARM_LENGTH * arm.rate));
            }
            pose.attitude * (c / MASS).cross(p)
        };
        let mut initial = super::tests::pose();
        initial.omega = omega;
        let about_start = start - centre(&initial, &super::tests::arms());
        let about_end = end - centre(&pose, &arms);
        assert!(
            (about_end - about_start).length() < 2e-3 * about_start.length(),
            "{about_start} {about_end}"
        );
    }

    #[test]
    fn a_slow_yaw_moment_meets_the_whole_inertia() {
        // M / I: 0.0063 N·m on 0.063 kg·m² for 3 s.
        let (pose, _, _) = fly(4.425, DVec3::new(0.0, 0.0, 0.0063), 3.0, DVec3::ZERO);
        assert!((pose.omega.z / 0.3 - 1.0).abs() < 0.02, "{}", pose.omega.z);
    }

    #[test]
    fn a_short_roll_or_pitch_moment_leaves_its_momentum_in_the_whole_inertia() {
        // The tips swing until damped; a turn rate of 0.1 s · M / I remains.
        for (axis, inertia) in [(0, 0.021), (1, 0.044)] {
            let mut moment = DVec3::ZERO;
            moment[axis] = 0.01;
            let (pose, arms, _) = pulse(moment, 0.1, 1.5);
            let (rate, whole) = (pose.omega[axis], 0.001 / inertia);
            assert!((rate / whole - 1.0).abs() < 0.05, "axis {axis}: {rate} {whole}");
            assert!(
                arms.iter().all(|arm| arm.rate.abs() < 0.05 * whole),
                "axis {axis}: still swinging"
            );
        }
    }
}
