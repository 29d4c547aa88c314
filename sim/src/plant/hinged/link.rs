//! One soft arm as a rigid link on a virtual hinge at the centre line, with Eq. 1 as its spring.
//!
//! Eq. 1 gives the tilt at rest on a level bench, the arm's weight included. Inverted, it is the spring: the moment
//! that holds the tilt α is L (T_s(α) - m g cos α), T_s the thrust with the static tilt α. With the tip mass its mode
//! is 5 Hz in hover at ρ 6.9 %, K 7.75.

use glam::DVec3;
use sophie_control::allocation::wrench::{FORE, SIDE};

use crate::plant::GRAVITY;
use crate::plant::body::ArmPoint;
use crate::plant::contact::{ARM_LENGTH, ARM_X, BELLY_Z, HINGE_Z};
use crate::plant::flexible::{Carried, Carrier};
use crate::plant::load::Acceleration;
use crate::plant::load::Load;
use crate::plant::mass_matrix::MassMatrix;

/// Motor, propeller and the arm's share, kg (assumed; gives 5 Hz in hover).
pub const TIP_MASS: f64 = 0.077;
/// Point mass of an arm on one hinge.
pub const TIP: [ArmPoint; 1] = [ArmPoint {
    mass: TIP_MASS,
    out: ARM_LENGTH,
    inertia: 0.0,
}];
/// A1, A2, B1, B2 of Eq. 1 (paper, Table I).
pub const TABLE_1: [f64; 4] = [2.4387, -0.1997, -0.162, 0.0151];
/// Level thrust, N: half of the paper's largest.
const LEVEL_THRUST: f64 = 4.15;
/// Hover thrust, N: the damping ratio holds here.
const HOVER_THRUST: f64 = 4.425;
/// Least compliance over that at rest, for large thrusts, beyond the turn of Eq. 1's parabola.
const LEAST_COMPLIANCE: f64 = 0.15;

/// An arm as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmSpec {
    offset: f64,
    /// Linear and quadratic coefficients of the nominal arm, rad/N and rad/N².
    nominal: (f64, f64),
    /// Linear coefficient, rad/N.
    linear: f64,
    /// Quadratic coefficient, rad/N².
    quadratic: f64,
    /// Thrust beyond which the spring is linear, N.
    knee: f64,
    /// Damping, N·m·s/rad.
    damping: f64,
}

/// Parameters of a printed arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmPrint {
    /// A1, A2, B1, B2: °/N, °/(N %), °/N², °/(N² %).
    pub coefficients: [f64; 4],
    /// Infill, %.
    pub infill: f64,
    /// Gain on Eq. 1's elastic term.
    pub gain_k: f64,
    /// Compliance over the nominal one.
    pub gain: f64,
    /// Tilt against the nominal one, rad.
    pub offset: f64,
    /// Damping ratio in hover.
    pub zeta: f64,
}

impl ArmSpec {
    /// Infill in %, gain K, damping ratio `zeta` in hover; compliance factor `gain` and tilt `offset` (rad) against the
    /// nominal arm.
    #[must_use]
    pub fn new(infill: f64, gain_k: f64, gain: f64, offset: f64, zeta: f64) -> Self {
        Self::of(&ArmPrint {
            coefficients: TABLE_1,
            infill,
            gain_k,
            gain,
            offset,
            zeta,
        })
    }

    /// The arm of this print.
    #[must_use]
    pub fn of(print: &ArmPrint) -> Self {
        let &ArmPrint {
            coefficients: [a1, a2, b1, b2],
            infill,
            gain_k,
            gain,
            offset,
            zeta,
        } = print;
        let nominal_linear = (gain_k * (a1 + a2 * infill)).to_radians();
        let nominal_quadratic = (gain_k * (b1 + b2 * infill)).to_radians();
        let (linear, quadratic) = (nominal_linear * gain, nominal_quadratic * gain);
        // Limited as the spring is: an arm stiff at 4.425 N may be soft in a light vehicle's hover.
        let slope = (linear + 2.0 * quadratic * HOVER_THRUST).max(LEAST_COMPLIANCE * linear);
        let stiffness = ARM_LENGTH / slope;
        let inertia = TIP_MASS * ARM_LENGTH * ARM_LENGTH;
        Self {
            offset: offset - rise((nominal_linear, nominal_quadratic), LEVEL_THRUST),
            nominal: (nominal_linear, nominal_quadratic),
            linear,
            quadratic,
            knee: if quadratic < 0.0 {
                linear * (1.0 - LEAST_COMPLIANCE) / (-2.0 * quadratic)
            } else {
                f64::INFINITY
            },
            damping: 2.0 * zeta * (stiffness * inertia).sqrt(),
        }
    }

    /// Sets α0 so that the nominal arm is level at `thrust` N.
    #[must_use]
    pub fn level_at(self, thrust: f64) -> Self {
        Self {
            offset: self.offset + rise(self.nominal, LEVEL_THRUST) - rise(self.nominal, thrust),
            ..self
        }
    }

    /// Coefficients of the elastic tilt, rad/N and rad/N².
    #[must_use]
    pub fn elastic(&self) -> (f64, f64) {
        (self.linear, self.quadratic)
    }

    /// Static tilt (rad) on a level bench at `thrust` N.
    #[must_use]
    pub fn static_tilt(&self, thrust: f64) -> f64 {
        let curved = thrust.clamp(0.0, self.knee);
        let slope = self.linear + 2.0 * self.quadratic * curved;
        self.offset + (self.linear + self.quadratic * curved) * curved + slope * (thrust - curved)
    }

    /// Thrust (N) with this static tilt (rad). Linear below 0 N and beyond the knee (outside Eq. 1's measurements;
    /// assumed).
    #[must_use]
    pub fn static_load(&self, tilt: f64) -> f64 {
        let e = tilt - self.offset;
        if e <= 0.0 {
            return e / self.linear;
        }
        let e_knee = (self.linear + self.quadratic * self.knee) * self.knee;
        if e >= e_knee {
            return self.knee + (e - e_knee) / (self.linear * LEAST_COMPLIANCE);
        }
        // Root of q T² + l T = e that vanishes with e, also for q = 0.
        2.0 * e / (self.linear + (self.linear * self.linear + 4.0 * self.quadratic * e).sqrt())
    }
}

/// Elastic tilt (rad) of Eq. 1 at `thrust` N.
fn rise((linear, quadratic): (f64, f64), thrust: f64) -> f64 {
    (linear + quadratic * thrust) * thrust
}

/// An arm in motion.
#[derive(Clone, Debug)]
pub struct Arm {
    spec: ArmSpec,
    side: f64,
    x: f64,
    /// Tilt, rad; positive with the tip up.
    pub tilt: f64,
    /// Rate of the tilt, rad/s.
    pub rate: f64,
    sin: f64,
    cos: f64,
    /// Generalised force on the tilt, N·m.
    pub generalised: f64,
    /// Thrust in this step, N.
    pub thrust: f64,
}

impl Arm {
    /// Arm `index`, 0 to 3, at rest without thrust, its droop limited by the ground.
    #[must_use]
    pub fn new(index: usize, spec: ArmSpec) -> Self {
        let on_ground = -libm::asin((BELLY_Z - HINGE_Z) / ARM_LENGTH);
        let tilt = spec.static_tilt(0.0).max(on_ground);
        Self {
            spec,
            side: f64::from(SIDE[index]),
            x: ARM_X * f64::from(FORE[index]),
            tilt,
            rate: 0.0,
            sin: libm::sin(tilt),
            cos: libm::cos(tilt),
            generalised: 0.0,
            thrust: 0.0,
        }
    }

    /// Position of the tip, m, body.
    #[must_use]
    pub fn tip(&self) -> DVec3 {
        DVec3::new(
            self.x,
            -self.side * ARM_LENGTH * self.cos,
            HINGE_Z - ARM_LENGTH * self.sin,
        )
    }

    /// Direction of thrust and of tip motion with growing tilt: unit vector, body.
    #[must_use]
    pub fn normal(&self) -> DVec3 {
        DVec3::new(0.0, self.side * self.sin, -self.cos)
    }

    /// From hinge to tip: unit vector, body.
    #[must_use]
    pub fn outward(&self) -> DVec3 {
        DVec3::new(0.0, -self.side * self.cos, -self.sin)
    }

    /// Velocity-dependent acceleration of the tip (m/s²), body turning at `omega`.
    #[must_use]
    pub fn bias_acceleration(&self, omega: DVec3) -> DVec3 {
        omega.cross(omega.cross(self.tip())) + 2.0 * omega.cross(self.normal() * (ARM_LENGTH * self.rate))
            - self.outward() * (ARM_LENGTH * self.rate * self.rate)
    }

    /// Sums the generalised force: thrust (N), external moments (N·m), spring, damping, and if `coupled` the tip's
    /// weight (`gravity` m/s², body).
    pub fn load(&mut self, thrust: f64, moment: f64, gravity: DVec3, coupled: bool) {
        let load = self.spec.static_load(self.tilt);
        let weight = if coupled {
            TIP_MASS * ARM_LENGTH * (self.normal().dot(gravity) + GRAVITY * self.cos)
        } else {
            0.0
        };
        self.thrust = thrust;
        self.generalised = ARM_LENGTH * (thrust - load) + weight + moment - self.spec.damping * self.rate;
    }

    /// Of the tilt, rad/s², on a body with the acceleration `body`.
    #[must_use]
    pub fn acceleration(&self, body: &Acceleration, carrier: &Carrier) -> f64 {
        let inertia = TIP_MASS * ARM_LENGTH * ARM_LENGTH;
        if !carrier.coupled {
            return self.generalised / inertia;
        }
        let carried = body.linear + body.angular.cross(self.tip()) + self.bias_acceleration(carrier.omega);
        self.generalised / inertia - self.normal().dot(carried) / ARM_LENGTH
    }

    /// Advances by `dt` s at the tilt's `acceleration` (rad/s²).
    pub fn integrate(&mut self, dt: f64, acceleration: f64) {
        self.rate += acceleration * dt;
        self.tilt += self.rate * dt;
        (self.sin, self.cos) = libm::sincos(self.tilt);
    }
}

impl Carried for Arm {
    /// A tip slides along its normal n and is held otherwise: it adds m (1 - n nᵀ) to the body's mass and passes the
    /// generalised force on its hinge as -Q/L along n.
    fn condense(&self, carrier: &Carrier, mass: &mut MassMatrix, load: &mut Load) {
        // m (1 - n nᵀ) = Σ m u uᵀ over the directions u that the hinge holds, acting at the origin through (u, r × u).
        let (r, n, along) = (self.tip(), self.normal(), self.outward());
        mass.add_tip(TIP_MASS, r, along);
        let bias = self.bias_acceleration(carrier.omega);
        let held = (DVec3::X * bias.x + along * along.dot(bias)) * TIP_MASS;
        // Thrust and weight of the tip, less its acceleration along the free direction.
        let free = self.generalised / ARM_LENGTH;
        let f = n * (self.thrust - free) + carrier.gravity * TIP_MASS - held;
        load.add(f, r.cross(f));
    }

    fn condense_massless(&self, load: &mut Load) {
        let thrust = self.normal() * self.thrust;
        load.add(thrust, self.tip().cross(thrust));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::STEP;

    fn spec() -> ArmSpec {
        ArmSpec::new(6.9, 7.75, 1.0, 0.0, 0.15)
    }

    #[test]
    fn the_load_undoes_the_tilt_and_goes_on_straight() {
        for infill in [4.0, 5.0, 6.0, 6.9, 8.0, 10.0] {
            let s = ArmSpec::new(infill, 7.75, 1.0, 0.0, 0.15);
            for i in -100..=150 {
                let t = 0.1 * f64::from(i);
                assert!((s.static_load(s.static_tilt(t)) - t).abs() < 1e-9, "{infill} {t}");
            }
        }
    }

    #[test]
    fn the_flight_stack_and_the_plant_agree_on_the_nominal_arm() {
        let model = sophie_control::allocation::arm_deflection::ArmModel::new(6.9, 7.75, 4.15);
        let stronger = sophie_control::allocation::arm_deflection::ArmModel::new(6.9, 7.75, 5.0);
        for i in 0..70 {
            let t = 0.1 * f64::from(i);
            for (spec, model) in [(spec(), model), (spec().level_at(5.0), stronger)] {
                let (built, modelled) = (spec.static_tilt(t), f64::from(model.angle(t as f32)));
                assert!((built - modelled).abs() < 1e-5, "{t}: {built} {modelled}");
            }
        }
    }

    #[test]
    fn the_mode_is_at_five_hertz_in_hover() {
        // Zero crossings about hover, body fixed and level.
        let mut arm = Arm::new(
            0,
            ArmSpec {
                damping: 0.0,
                ..spec()
            },
        );
        let rest = arm.spec.static_tilt(4.425);
        arm.tilt = rest + 0.02;
        arm.integrate(0.0, 0.0);
        let gravity = DVec3::new(0.0, 0.0, GRAVITY);
        let mut crossings = 0;
        for _ in 0..20_000 {
            let before = arm.tilt > rest;
            arm.load(4.425, 0.0, gravity, true);
            arm.integrate(STEP, arm.generalised / (TIP_MASS * ARM_LENGTH * ARM_LENGTH));
            crossings += i32::from(before != (arm.tilt > rest));
        }
        let hz = f64::from(crossings) / 2.0 / 10.0;
        assert!((4.7..5.3).contains(&hz), "{hz}");
    }
}
