//! Equations of motion of the body with four hinged tip masses.
//!
//! A tip slides along its normal n and is held otherwise: it adds m (1 - n nᵀ) to the body's mass and passes the
//! generalised force on its hinge as -Q/L along n. The remaining 6×6 system is solved by 3×3 blocks, then each tilt's
//! acceleration.

use glam::{DMat3, DVec3};

use super::arm::{Arm, TIP_MASS};
use super::contact::{ARM_LENGTH, ARM_X, HINGE_Z, Pose};

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

/// Load at the origin, body axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// N.
    pub force: DVec3,
    /// N·m.
    pub moment: DVec3,
}

impl Load {
    /// Adds a force (N) with its moment (N·m) about the origin.
    pub fn add(&mut self, force: DVec3, moment: DVec3) {
        self.force += force;
        self.moment += moment;
    }
}

/// Accelerations of one step.
#[derive(Clone, Copy, Debug)]
pub struct Accelerations {
    /// Body origin, m/s², body.
    pub linear: DVec3,
    /// Angular, rad/s², body.
    pub angular: DVec3,
    /// Tilt of each arm, rad/s².
    pub arms: [f64; 4],
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
    /// `coupled` gives the arms their tip masses, otherwise the body has all mass. The vehicle's centre of mass with
    /// level arms is the origin.
    #[must_use]
    pub fn new(spec: &BodySpec, coupled: bool) -> Self {
        let whole = DVec3::from_array(spec.inertia);
        let (mass, centre, inertia) = if coupled {
            let mass = spec.mass - 4.0 * TIP_MASS;
            let (x2, y2, z2) = (ARM_X * ARM_X, ARM_LENGTH * ARM_LENGTH, HINGE_Z * HINGE_Z);
            let tips = DVec3::new(y2 + z2, x2 + z2, x2 + y2) * (4.0 * TIP_MASS);
            (
                mass,
                DVec3::new(0.0, 0.0, -4.0 * TIP_MASS * HINGE_Z / mass),
                whole - tips,
            )
        } else {
            (spec.mass, DVec3::ZERO, whole)
        };
        let inertia = DMat3::from_diagonal(inertia);
        Self {
            coupled,
            mass,
            centre,
            inertia,
            inverse: inertia.inverse(),
        }
    }

    /// Accelerations under `gravity` (m/s², body), the thrusts of the loaded `arms`, and all other `load`.
    #[must_use]
    pub fn accelerate(&self, pose: &Pose, load: Load, gravity: DVec3, arms: [&Arm; 4]) -> Accelerations {
        let w = pose.omega;
        let inertia_tip = TIP_MASS * ARM_LENGTH * ARM_LENGTH;
        let mut force = load.force + self.mass * (gravity - w.cross(w.cross(self.centre)));
        let mut moment = load.moment + self.mass * self.centre.cross(gravity) - w.cross(self.inertia * w);
        if !self.coupled {
            for arm in arms {
                let thrust = arm.normal() * arm.thrust;
                force += thrust;
                moment += arm.tip().cross(thrust);
            }
            return Accelerations {
                linear: force / self.mass,
                angular: self.inverse * moment,
                arms: arms.map(|arm| arm.generalised / inertia_tip),
            };
        }

        let mut m = MassMatrix::new(self.mass, self.centre, self.inertia);
        for arm in arms {
            // The hinge holds the tip along x and along the arm: m (1 - n nᵀ) = Σ m u uᵀ over these directions u,
            // acting at the origin through (u, r × u).
            let (r, n, along) = (arm.tip(), arm.normal(), arm.outward());
            m.add_tip(r, along);
            let bias = arm.bias_acceleration(w);
            let held = (DVec3::X * bias.x + along * along.dot(bias)) * TIP_MASS;
            // Thrust and weight of the tip, less its acceleration along the free direction.
            let free = arm.generalised / ARM_LENGTH;
            let f = n * (arm.thrust - free) + gravity * TIP_MASS - held;
            force += f;
            moment += r.cross(f);
        }
        let (linear, angular) = m.solve(force, moment);
        let tilt = |arm: &Arm| {
            let carried = linear + angular.cross(arm.tip()) + arm.bias_acceleration(w);
            arm.generalised / inertia_tip - arm.normal().dot(carried) / ARM_LENGTH
        };
        Accelerations {
            linear,
            angular,
            arms: arms.map(tilt),
        }
    }
}

/// 6×6 mass matrix by blocks: linear `a`, coupling (rows linear, columns angular) `c`, angular `j`. Entries are written
/// out, as a tip adds to few: this takes a third of the plant's time.
struct MassMatrix {
    mass: f64,
    ayy: f64,
    ayz: f64,
    azz: f64,
    c: [DVec3; 3],
    j: DMat3,
}

impl MassMatrix {
    /// Rigid part, centre of mass at `centre`.
    fn new(mass: f64, centre: DVec3, inertia: DMat3) -> Self {
        let DVec3 { x, y, z } = centre * mass;
        let c = [
            DVec3::new(0.0, z, -y),
            DVec3::new(-z, 0.0, x),
            DVec3::new(y, -x, 0.0),
        ];
        Self {
            mass,
            ayy: mass,
            ayz: 0.0,
            azz: mass,
            c,
            j: inertia,
        }
    }

    /// Adds a tip at `r`, held along x and the unit vector `along` in the y-z plane.
    fn add_tip(&mut self, r: DVec3, along: DVec3) {
        let (ey, ez) = (along.y, along.z);
        let lever_x = DVec3::new(0.0, r.z, -r.y);
        let lever = DVec3::new(r.y * ez - r.z * ey, -r.x * ez, r.x * ey);
        let (mx, my, mz) = (TIP_MASS, TIP_MASS * ey, TIP_MASS * ez);
        self.mass += mx;
        self.ayy += my * ey;
        self.ayz += my * ez;
        self.azz += mz * ez;
        self.c[0] += lever_x * mx;
        self.c[1] += lever * my;
        self.c[2] += lever * mz;
        let (tx, t) = (lever_x * TIP_MASS, lever * TIP_MASS);
        self.j.x_axis += t * lever.x;
        self.j.y_axis += tx * lever_x.y + t * lever.y;
        self.j.z_axis += tx * lever_x.z + t * lever.z;
    }

    fn solve(&self, force: DVec3, moment: DVec3) -> (DVec3, DVec3) {
        let inv_x = 1.0 / self.mass;
        let inv_det = 1.0 / (self.ayy * self.azz - self.ayz * self.ayz);
        let (byy, byz, bzz) = (self.azz * inv_det, -self.ayz * inv_det, self.ayy * inv_det);
        let [cx, cy, cz] = self.c;
        // Rows of A⁻¹ C.
        let (gx, gy, gz) = (cx * inv_x, cy * byy + cz * byz, cy * byz + cz * bzz);
        let mut j = self.j;
        j.x_axis -= cx * gx.x + cy * gy.x + cz * gz.x;
        j.y_axis -= cx * gx.y + cy * gy.y + cz * gz.y;
        j.z_axis -= cx * gx.z + cy * gy.z + cz * gz.z;
        let angular = j.inverse() * (moment - gx * force.x - gy * force.y - gz * force.z);
        let rest = force - DVec3::new(cx.dot(angular), cy.dot(angular), cz.dot(angular));
        let linear = DVec3::new(
            inv_x * rest.x,
            byy * rest.y + byz * rest.z,
            byz * rest.y + bzz * rest.z,
        );
        (linear, angular)
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::super::arm::ArmSpec;
    use super::super::{GRAVITY, STEP};
    use super::*;

    /// kg (paper).
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
        let body = Body::new(&BodySpec::default(), true);
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
            for (arm, a) in arms.iter_mut().zip(acc.arms) {
                arm.integrate(STEP, a);
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
        let body = Body::new(&BodySpec::default(), true);
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
