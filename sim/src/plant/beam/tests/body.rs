//! Arms on a moving body: energy, momentum, and the signs of the rotors' moments.

use glam::DQuat;

use super::super::in_plane::InPlaneSpec;
use super::super::masses::MIDDLE;
use super::super::shape::points;
use super::*;
use crate::plant::contact::{ARM_LENGTH, HINGE_Z, Pose};

/// A free vehicle without weight.
struct Loose {
    body: Body,
    pose: Pose,
    arms: [BeamArm; 4],
}

const WEIGHTLESS: DVec3 = DVec3::ZERO;

impl Loose {
    fn new(spec: BeamSpec) -> Self {
        Self {
            body: Body::new(&BodySpec::default(), &Masses::of(&BodySpec::default()).points()),
            pose: Pose {
                position: DVec3::ZERO,
                attitude: DQuat::IDENTITY,
                velocity: DVec3::ZERO,
                omega: DVec3::ZERO,
            },
            arms: std::array::from_fn(|i| BeamArm::new(i, spec)),
        }
    }

    fn carrier(&self) -> Carrier {
        Carrier {
            omega: self.pose.omega,
            gravity: WEIGHTLESS,
            coupled: true,
        }
    }

    /// One step of `dt` s with rotors of the angular momenta `momentum`.
    fn step(&mut self, dt: f64, momentum: [f64; 4], moment: DVec3) {
        let carrier = self.carrier();
        let mut load = Load {
            force: DVec3::ZERO,
            moment,
        };
        for (arm, momentum) in self.arms.iter_mut().zip(momentum) {
            let drive = Drive {
                dt,
                momentum,
                ..Drive::default()
            };
            arm.drive(&drive, &carrier, &mut load);
        }
        let a = self
            .body
            .accelerate(&self.pose, load, WEIGHTLESS, self.arms.each_ref());
        for arm in &mut self.arms {
            arm.advance(dt, &a, &carrier);
        }
        let pose = &mut self.pose;
        pose.velocity += pose.attitude * a.linear * dt;
        pose.omega += a.angular * dt;
        pose.position += pose.velocity * dt;
        let h = pose.omega * (0.5 * dt);
        pose.attitude = (pose.attitude * DQuat::from_xyzw(h.x, h.y, h.z, 1.0)).normalize();
    }

    /// Energy (J), and momentum (kg·m/s) and angular momentum (kg·m²/s) in world axes.
    fn balance(&self, spec: &BeamSpec, spin: [f64; 4]) -> (f64, DVec3, DVec3) {
        let (w, v) = (
            self.pose.omega,
            self.pose.attitude.conjugate() * self.pose.velocity,
        );
        let (mut energy, mut linear, mut angular) = self.body.motion(v, w);
        for (i, arm) in self.arms.iter().enumerate() {
            let side = f64::from(sophie_control::allocation::wrench::SIDE[i]);
            let x = ARM_LENGTH * f64::from(sophie_control::allocation::wrench::FORE[i]);
            let (q, rate) = (arm.q, arm.rate);
            let ends = points(&q, &rate, [MIDDLE, 1.0]);
            for (point, mass) in ends.iter().zip([spec.masses.middle, spec.masses.tip]) {
                let r = DVec3::new(x, -side * point.out, HINGE_Z - point.up);
                let out = point.out_by[0] * rate[0] + point.out_by[1] * rate[1];
                let up = point.up_by[0] * rate[0] + point.up_by[1] * rate[1];
                let u = v + w.cross(r) + DVec3::new(0.0, -side * out, -up);
                energy += 0.5 * mass * u.length_squared() - mass * GRAVITY * point.up;
                linear += u * mass;
                angular += r.cross(u * mass);
            }
            let tilt = q[0] + q[1];
            let tangent = DVec3::new(0.0, -side * libm::cos(tilt), -libm::sin(tilt));
            let axis = DVec3::X * side;
            let turning = w + axis * (rate[0] + rate[1]) + tangent * arm.twist_rate;
            energy += 0.5 * spec.masses.block * turning.length_squared();
            angular += turning * spec.masses.block + arm.rotor_axis() * spin[i];
            // ∫ κ² ds EI/2 of a uniform beam.
            let (a, b) = (q[0] - spec.rest, q[1]);
            energy += 0.5 * spec.bending_stiffness() / ARM_LENGTH * (a * a + 2.0 * a * b + 4.0 / 3.0 * b * b);
            energy += 0.5 * spec.twist.stiffness * arm.twist * arm.twist;
        }
        let at = self.pose.attitude;
        // About the world's origin.
        let angular = at * angular + self.pose.position.cross(at * linear);
        (energy, at * linear, angular)
    }
}

/// A vehicle that turns about every axis, its arms bent by up to 23° and twisted.
fn tumbling(spec: BeamSpec) -> Loose {
    let mut loose = Loose::new(spec);
    loose.pose.omega = DVec3::new(2.0, -1.5, 1.0);
    for (i, arm) in loose.arms.iter_mut().enumerate() {
        let share = 1.0 - 0.4 * i as f64;
        arm.twist = 0.1 * share;
        arm.bend([0.3 * share, 0.1 * share]);
        arm.rate = [1.0, -2.0 * share];
        arm.twist_rate = 3.0;
    }
    loose
}

/// Largest relative errors of energy, momentum and angular momentum of a tumbling vehicle within 1 s by steps of `dt` s.
fn lost(dt: f64) -> [f64; 3] {
    let spec = uniform(6.0, 0.0);
    let momentum = [0.027, -0.027, -0.027, 0.027];
    let mut loose = tumbling(spec);
    let (energy, linear, angular) = loose.balance(&spec, momentum);
    let mut worst = [0.0_f64; 3];
    for _ in 0..(1.0 / dt) as u32 {
        loose.step(dt, momentum, DVec3::ZERO);
        let (e, p, l) = loose.balance(&spec, momentum);
        worst[0] = worst[0].max((e / energy - 1.0).abs());
        worst[1] = worst[1].max((p - linear).length() / linear.length().max(0.1));
        worst[2] = worst[2].max((l - angular).length() / angular.length());
    }
    worst
}

#[test]
fn nothing_is_lost_without_damping() {
    // The error comes from the step and shrinks with its length.
    let (long, short) = (lost(STEP / 5.0), lost(STEP / 10.0));
    assert!(long[0] < 0.1 && long[1] < 0.005 && long[2] < 0.005, "{long:?}");
    for (long, short) in long.into_iter().zip(short) {
        assert!(short < 0.6 * long, "{long} {short}");
    }
}

#[test]
fn a_slow_moment_meets_the_whole_inertia() {
    slow_moments(None);
}

/// Arms that bend in the plane of their discs are carried along by their springs.
#[test]
fn a_slow_moment_meets_the_whole_inertia_of_arms_that_bend_in_plane() {
    slow_moments(Some(InPlaneSpec {
        frequency: 5.0,
        damping: 0.3,
    }));
}

fn slow_moments(in_plane: Option<InPlaneSpec>) {
    let spec = uniform(1.0, 0.15);
    for (axis, inertia) in [(0, 0.021), (1, 0.044), (2, 0.063)] {
        let mut loose = Loose::new(spec);
        for arm in &mut loose.arms {
            arm.bend([0.0, 0.0]);
            *arm = arm.clone().bending_in_plane(in_plane);
        }
        let mut moment = DVec3::ZERO;
        moment[axis] = 0.1 * inertia;
        for _ in 0..4000 {
            loose.step(STEP, [0.0; 4], moment);
        }
        // The spring is the level bench's, so that a weightless arm bends up a little: 1 %.
        let rate = loose.pose.omega[axis];
        assert!((rate / 0.2 - 1.0).abs() < 0.02, "axis {axis}: {rate}");
    }
}

#[test]
fn a_rotor_turns_its_own_axis_a_quarter_turn_late() {
    // Counterclockwise from above on the left front: H up, 0.027 N·m·s. Rolled right at 2 rad/s (about +x), the rotor
    // pushes with H × ω = (0, 0, -H) × (ω, 0, 0) = (0, -H ω, 0) N·m: nose down.
    let carrier = Carrier {
        omega: DVec3::new(2.0, 0.0, 0.0),
        ..BENCH
    };
    let mut arm = BeamArm::new(0, uniform(6.0, 0.15));
    arm.bend([0.0, 0.0]);
    let drive = Drive {
        dt: STEP,
        momentum: 0.027,
        ..Drive::default()
    };
    let mut load = Load::default();
    arm.drive(&drive, &carrier, &mut load);
    assert!(
        (load.moment - DVec3::new(0.0, -0.054, 0.0)).length() < 1e-12,
        "{}",
        load.moment
    );
    // About the left arm's axis, which points to -y, it is a positive twist that leans the thrust forward.
    for _ in 0..4000 {
        arm.drive(&drive, &BENCH_ROLLING, &mut Load::default());
        let held = Acceleration {
            linear: DVec3::ZERO,
            angular: DVec3::ZERO,
        };
        arm.advance(STEP, &held, &BENCH_ROLLING);
    }
    let expected = 0.054 / arm_twist_stiffness();
    assert!(
        (arm.twist() / expected - 1.0).abs() < 0.02,
        "{} {expected}",
        arm.twist()
    );
    assert!(arm.rotor_axis().x > 0.0);
}

/// Level, rolled right at 2 rad/s, arms without mass on the body: no centrifugal force.
const BENCH_ROLLING: Carrier = Carrier {
    omega: DVec3::new(2.0, 0.0, 0.0),
    ..BENCH
};

fn arm_twist_stiffness() -> f64 {
    uniform(6.0, 0.15).twist.stiffness
}

#[test]
fn the_torsional_stiffness_is_that_of_a_square_section() {
    // By hand: E I = L²/2A = 0.1513 N·m² at 6 °/N, G J = 0.562 of it over 0.178 m: 0.4776 N·m/rad.
    assert!(
        (arm_twist_stiffness() - 0.477_6).abs() < 1e-3,
        "{}",
        arm_twist_stiffness()
    );
}

#[test]
fn light_vehicles_have_light_arms() {
    let of = |roll: f64| {
        let spec = BodySpec {
            inertia: [roll, 0.044, 0.063],
            ..BodySpec::default()
        };
        (Masses::of(&spec), Body::new(&spec, &Masses::of(&spec).points()))
    };
    let (nominal, _) = of(0.021);
    assert!(
        (nominal.tip - 0.123_33).abs() < 1e-4 && (nominal.middle - 0.093_33).abs() < 1e-4,
        "{nominal:?}"
    );
    for roll in [0.012, 0.0147, 0.021, 0.0273] {
        let (masses, body) = of(roll);
        let (energy, _, _) = body.motion(DVec3::ZERO, DVec3::X);
        assert!(energy > 0.0 && masses.tip <= nominal.tip, "{roll}: {energy}");
    }
}
