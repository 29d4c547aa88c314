//! One bending arm in motion.
//!
//! Coordinates: the two terms of the shape and the twist. Virtual work gives A q̈ + C (a, ω̇) = R, the body gets the
//! masses at their places less Cᵀ A⁻¹ C, and Cᵀ A⁻¹ R less.
//!
//! The rotor couples bending and twist by ±H with up to 70 Hz: forward steps of 0.5 ms would feed that nutation. It
//! therefore acts at the mean of the rates before and after a step, which neither feeds nor damps it; the body feels it
//! at the rates before.

use glam::DVec3;
use sophie_control::allocation::wrench::{FORE, SIDE};

use super::super::GRAVITY;
use super::super::contact::{ARM_LENGTH, ARM_X, BELLY_Z, HINGE_Z, Pose};
use super::super::flexible::{Carried, Carrier, Drive, Flexible, Nearby};
use super::super::mass_matrix::{Column, MassMatrix};
use super::in_plane::{InPlane, InPlaneSpec};
use super::masses::MIDDLE;
use super::material::{Material, MaterialSpec};
use super::section::BeamSpec;
use super::shape::{Point, points, sin_cos};
use super::skin::{BeamContact, Bent};
use super::{PerTerm, TERMS};
use crate::plant::load::Acceleration;
use crate::plant::load::Load;

/// One arm with its contacts.
#[derive(Clone, Debug)]
pub struct BeamArm {
    spec: BeamSpec,
    side: f64,
    x: f64,
    pub(super) q: PerTerm,
    pub(super) rate: PerTerm,
    pub(super) twist: f64,
    pub(super) twist_rate: f64,
    contact: BeamContact,
    /// Time that passes for slow processes of the material in the step, s.
    slow: f64,
    /// `None`: elastic.
    material: Option<Material>,
    /// `None`: rigid in the plane of the disc.
    in_plane: Option<InPlane>,
    /// Middle and tip, as `q` and `rate` have them.
    places: [Point; 2],
    /// Sine of the tilt.
    sin: f64,
    cos: f64,
    /// Sine of the twist.
    twist_sin: f64,
    twist_cos: f64,
    thrust: f64,
    /// Weight on the tip, N.
    hung: f64,
    /// Equations of this step.
    equations: Equations,
}

/// The arm's own equations: A, C and R.
#[derive(Clone, Copy, Debug, Default)]
struct Equations {
    inverse: [PerTerm; TERMS],
    columns: [Column; TERMS],
    rest: PerTerm,
    twist_rest: f64,
    /// Half a step of the rotor's coupling, N·m·s².
    nutation: f64,
    /// Σ m (g - bias) with its moment, and the motor's own.
    held: Load,
}

impl BeamArm {
    /// Arm `index`, 0 to 3, without thrust. If it would droop below the ground, its tip rests on it.
    #[must_use]
    pub fn new(index: usize, spec: BeamSpec) -> Self {
        // A tip held up by a force adds β (ξ - ξ²/2) to the slope, L β/3 to the height.
        let room = (BELLY_Z - HINGE_Z) / ARM_LENGTH;
        let lift = (-3.0 * (room + 0.5 * spec.rest)).max(0.0);
        let mut arm = Self {
            spec,
            side: f64::from(SIDE[index]),
            x: ARM_X * f64::from(FORE[index]),
            q: [spec.rest + lift, -0.5 * lift],
            rate: [0.0; TERMS],
            twist: 0.0,
            twist_rate: 0.0,
            contact: BeamContact::default(),
            slow: 0.0,
            material: None,
            in_plane: None,
            places: [Point::default(); 2],
            sin: 0.0,
            cos: 1.0,
            twist_sin: 0.0,
            twist_cos: 1.0,
            thrust: 0.0,
            hung: 0.0,
            equations: Equations::default(),
        };
        arm.place();
        arm
    }

    /// The same arm of `material`, new.
    #[must_use]
    pub fn of_material(mut self, material: MaterialSpec) -> Self {
        let printed = material != MaterialSpec::default();
        self.material = printed.then(|| Material::new(material, self.spec.in_hover()));
        self
    }

    /// The same arm with its bending in the plane of the disc.
    #[must_use]
    pub fn bending_in_plane(mut self, spec: Option<InPlaneSpec>) -> Self {
        self.in_plane = spec.map(|spec| InPlane::new(spec, self.spec.masses.tip));
        self
    }

    /// Bends the arm to the shape `q` at rest.
    pub fn bend(&mut self, q: PerTerm) {
        (self.q, self.rate) = (q, [0.0; TERMS]);
        self.place();
    }

    /// Shape: the slope's terms, rad.
    #[must_use]
    pub fn shape(&self) -> PerTerm {
        self.q
    }

    /// Twist of motor and propeller about the arm, rad.
    #[must_use]
    pub fn twist(&self) -> f64 {
        self.twist
    }

    fn bent(&self) -> Bent {
        Bent {
            q: self.q,
            rate: self.rate,
            x: self.x,
            side: -self.side,
        }
    }

    fn place(&mut self) {
        self.places = points(&self.q, &self.rate, [MIDDLE, 1.0]);
        ([self.sin, self.twist_sin], [self.cos, self.twist_cos]) = sin_cos([self.tilt(), self.twist]);
    }

    /// In body axes.
    fn vector(&self, out: f64, up: f64) -> DVec3 {
        DVec3::new(0.0, -self.side * out, -up)
    }

    fn position(&self, point: &Point) -> DVec3 {
        DVec3::new(self.x, 0.0, HINGE_Z) + self.vector(point.out, point.up)
    }

    /// Axis about which the tip tilts up, body.
    fn axis(&self) -> DVec3 {
        DVec3::X * self.side
    }

    /// Tangent of the tip, outward, and its normal, upward.
    fn tip_axes(&self) -> (DVec3, DVec3) {
        (self.vector(self.cos, self.sin), self.vector(-self.sin, self.cos))
    }

    /// Axis of the rotor, body: along its thrust.
    #[must_use]
    pub fn rotor_axis(&self) -> DVec3 {
        let (_, normal) = self.tip_axes();
        normal * self.twist_cos + self.axis() * self.twist_sin
    }

    fn tip_rate(&self) -> f64 {
        self.rate[0] + self.rate[1]
    }

    /// Angular rate of the motor, rad/s, body at `omega`.
    fn motor_rate(&self, omega: DVec3) -> DVec3 {
        let (tangent, _) = self.tip_axes();
        omega + self.axis() * self.tip_rate() + tangent * self.twist_rate
    }

    /// Under the generalised `forces` and the moment `twisting` on the twist, N·m; `nutation` as in [`Equations`].
    fn equations(&self, carrier: &Carrier, forces: PerTerm, twisting: f64, nutation: f64) -> Equations {
        let Carrier { omega, gravity, .. } = *carrier;
        let masses = self.spec.masses;
        let (axis, (tangent, normal)) = (self.axis(), self.tip_axes());
        // Part of the motor's angular acceleration that depends on rates alone.
        let tip_rate = self.tip_rate();
        let turning =
            normal * (self.twist_rate * tip_rate) + omega.cross(axis * tip_rate + tangent * self.twist_rate);
        let twist_rest = twisting - masses.block * tangent.dot(turning);
        // The twist's own equation put into those of the shape.
        let stiffer = masses.block + nutation * nutation / masses.block;
        let [mut aa, mut ab, mut bb] = [stiffer; 3];
        let mut columns = [Column {
            linear: DVec3::ZERO,
            angular: axis * masses.block,
        }; TERMS];
        let given = masses.block * self.side * turning.x + twist_rest * nutation / masses.block;
        let mut rest = forces.map(|force| force - given);
        let mut held = Load {
            force: DVec3::ZERO,
            moment: turning * -masses.block,
        };
        for (point, mass) in self.places.iter().zip([masses.middle, masses.tip]) {
            let r = self.position(point);
            // All but the body's motion is in the arm's plane.
            let Point { out_by, up_by, .. } = point;
            let moving = self.vector(
                out_by[0] * self.rate[0] + out_by[1] * self.rate[1],
                up_by[0] * self.rate[0] + up_by[1] * self.rate[1],
            );
            let bias = omega.cross(omega.cross(r) + 2.0 * moving) + self.vector(point.bias.0, point.bias.1);
            let force = (gravity - bias) * mass;
            held.add(force, r.cross(force));
            // The spring holds the level bench's weight: Eq. 1 is measured with it.
            let (outward, upward) = (-self.side * force.y, mass * GRAVITY - force.z);
            for k in 0..TERMS {
                let DVec3 { y, z, .. } = self.vector(mass * out_by[k], mass * up_by[k]);
                columns[k].linear += DVec3::new(0.0, y, z);
                columns[k].angular += DVec3::new(r.y * z - r.z * y, -r.x * z, r.x * y);
                rest[k] += out_by[k] * outward + up_by[k] * upward;
            }
            aa += mass * (out_by[0] * out_by[0] + up_by[0] * up_by[0]);
            ab += mass * (out_by[0] * out_by[1] + up_by[0] * up_by[1]);
            bb += mass * (out_by[1] * out_by[1] + up_by[1] * up_by[1]);
        }
        if self.hung != 0.0 {
            let [_, tip] = &self.places;
            let (r, force) = (self.position(tip), gravity * (self.hung / GRAVITY));
            held.add(force, r.cross(force));
            for ((rest, out_by), up_by) in rest.iter_mut().zip(tip.out_by).zip(tip.up_by) {
                *rest -= out_by * self.side * force.y + up_by * force.z;
            }
        }
        let scale = 1.0 / (aa * bb - ab * ab);
        Equations {
            inverse: [[bb * scale, -ab * scale], [-ab * scale, aa * scale]],
            columns,
            rest,
            twist_rest,
            nutation,
            held,
        }
    }

    /// Generalised forces of the bent material, N·m.
    fn elastic(&self) -> PerTerm {
        let Some(material) = &self.material else {
            return self.spec.elastic(&self.q);
        };
        let kept = material.kept();
        let [a, b] = self.spec.elastic(&[self.q[0] - kept[0], self.q[1] - kept[1]]);
        let ([fast_a, fast_b], virgin) = (material.force(), material.virgin());
        [virgin * a + fast_a, virgin * b + fast_b]
    }

    /// Generalised forces other than weight and contact.
    fn forces(&self, drive: &Drive, moment: DVec3) -> PerTerm {
        let [_, tip] = &self.places;
        let damping = &self.spec.damping;
        let mut forces = self.elastic();
        // The thrust's part across the arm, and the rotor's moment about the bending axis.
        let (across, about) = (drive.thrust * self.twist_cos, moment.dot(self.axis()));
        for k in 0..TERMS {
            forces[k] += across * (self.cos * tip.up_by[k] - self.sin * tip.out_by[k]) + about + drive.tendon;
            forces[k] -= damping[k][0] * self.rate[0] + damping[k][1] * self.rate[1];
        }
        forces
    }
}

fn product(m: &[PerTerm; TERMS], v: &PerTerm) -> PerTerm {
    m.map(|row| row[0] * v[0] + row[1] * v[1])
}

impl Carried for BeamArm {
    fn condense(&self, _: &Carrier, mass: &mut MassMatrix, load: &mut Load) {
        let e = &self.equations;
        let (tangent, _) = self.tip_axes();
        let masses = self.spec.masses;
        for (point, kg) in self.places.iter().zip([masses.middle, masses.tip]) {
            mass.add_point(kg, self.position(point));
        }
        // The motor turns with the body except for the twist.
        mass.add_inertia(masses.block, tangent);
        let [c, d] = &e.columns;
        mass.give_way(&e.columns, &e.inverse);
        let free = product(&e.inverse, &e.rest);
        let [_, tip] = &self.places;
        let thrust = self.rotor_axis() * self.thrust;
        load.add(e.held.force, e.held.moment);
        load.add(thrust, self.position(tip).cross(thrust));
        if let Some(in_plane) = &self.in_plane {
            in_plane.condense(mass, load);
            load.moment += (DVec3::X * in_plane.way()).cross(thrust);
        }
        load.force -= c.linear * free[0] + d.linear * free[1];
        load.moment -= c.angular * free[0] + d.angular * free[1] + tangent * e.twist_rest;
    }

    fn condense_massless(&self, load: &mut Load) {
        let [_, tip] = &self.places;
        let thrust = self.rotor_axis() * self.thrust;
        load.add(thrust, self.position(tip).cross(thrust));
    }
}

impl Flexible for BeamArm {
    fn tilt(&self) -> f64 {
        self.q[0] + self.q[1]
    }

    fn underside(&self) -> [DVec3; 3] {
        self.bent().underside().map(|skin_point| skin_point.place)
    }

    fn hang(&mut self, newtons: f64) {
        self.hung = newtons;
    }

    fn touch(&mut self, dt: f64, pose: &Pose, nearby: &Nearby, load: &mut Load) -> f64 {
        let bent = self.bent();
        self.contact.step(dt, &bent, pose, nearby, load)
    }

    fn drive(&mut self, drive: &Drive, carrier: &Carrier, load: &mut Load) {
        let axis = self.rotor_axis();
        let motor = self.motor_rate(carrier.omega);
        // The rotor resists the turning of its axis by H × ω.
        let moment = axis * drive.drag + (axis * drive.momentum).cross(motor);
        load.moment += moment;
        self.thrust = drive.thrust;
        let mut forces = self.forces(drive, moment);
        for (force, touched) in forces.iter_mut().zip(self.contact.forces) {
            *force += touched;
        }
        let (tangent, _) = self.tip_axes();
        let twist = self.spec.twist;
        let twisting = moment.dot(tangent) - twist.stiffness * self.twist - twist.damping * self.twist_rate;
        // An arm without coupling to the body is one on a level bench.
        let bench = Carrier {
            omega: DVec3::ZERO,
            gravity: DVec3::new(0.0, 0.0, GRAVITY),
            coupled: false,
        };
        let carrier = if carrier.coupled { carrier } else { &bench };
        let nutation = 0.5 * drive.dt * drive.momentum * self.twist_cos;
        self.equations = self.equations(carrier, forces, twisting, nutation);
        if let Some(in_plane) = &mut self.in_plane
            && carrier.coupled
        {
            let [_, tip] = &self.places;
            let place = DVec3::new(self.x, -self.side * tip.out, HINGE_Z - tip.up);
            let omega = carrier.omega;
            let inertia = carrier.gravity.x - omega.cross(omega.cross(place)).x;
            let force = self.spec.masses.tip * inertia + axis.x * drive.thrust;
            in_plane.load(force, moment.z, place);
        }
        self.slow = drive.slow;
    }

    fn advance(&mut self, dt: f64, body: &Acceleration, carrier: &Carrier) {
        let e = &self.equations;
        let (mut left, mut twisting) = (e.rest, e.twist_rest / self.spec.masses.block);
        if carrier.coupled {
            for (left, Column { linear, angular }) in left.iter_mut().zip(e.columns) {
                *left -= linear.dot(body.linear) + angular.dot(body.angular);
            }
            let (tangent, _) = self.tip_axes();
            twisting -= tangent.dot(body.angular);
        }
        if let Some(in_plane) = &mut self.in_plane
            && carrier.coupled
        {
            in_plane.advance(dt, body);
        }
        let bending = product(&e.inverse, &left);
        twisting += e.nutation * (bending[0] + bending[1]) / self.spec.masses.block;
        for ((q, rate), acceleration) in self.q.iter_mut().zip(&mut self.rate).zip(bending) {
            *rate += acceleration * dt;
            *q += *rate * dt;
        }
        let bend = [self.q[0] - self.spec.rest, self.q[1]];
        if let Some(material) = &mut self.material {
            // At the rates after the step, as the shape: at those before it the branch would feed its own swing.
            material.step(dt, self.slow, &bend, &self.rate);
        }
        self.twist_rate += twisting * dt;
        self.twist += self.twist_rate * dt;
        self.place();
    }
}
