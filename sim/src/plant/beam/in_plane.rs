//! Bending of an arm in the plane of its rotor's disc, by the drag torque of the rotor.
//!
//! One coordinate: the way u of the tip along body x, of a beam loaded at its tip: k = 3 EI/L³, and the tip turns by
//! 3u/2L. Virtual work: m ü + c u̇ + k u = F + (3/2L) M, M the rotor's moment about the vertical that turns the tip that
//! way. The body gets the tip's mass at its place less m, since that part gives way along x, and the spring's force.
//! EI 0.11 N·m² of a printed arm gives 3.5 Hz with its tip of 0.123 kg and 10 mm under 0.07 N·m; a wider root more: 4 to
//! 7.5 Hz (estimated). The middle's mass stays with the body: a tenth of the tip's would move.

use core::f64::consts::TAU;

use glam::DVec3;

use super::super::contact::ARM_LENGTH;
use super::super::load::{Acceleration, Load};
use super::super::mass_matrix::MassMatrix;

/// Mode of one arm, as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InPlaneSpec {
    /// Frequency of the clamped arm, Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub damping: f64,
}

/// The in-plane coordinate of one arm.
#[derive(Clone, Copy, Debug)]
pub struct InPlane {
    /// Mass of the tip, kg.
    mass: f64,
    /// k / m, 1/s².
    stiffness: f64,
    /// c / m, 1/s.
    damping: f64,
    /// u, m, along body x.
    way: f64,
    /// u̇, m/s.
    rate: f64,
    /// Sum of all forces but the body's acceleration, N.
    rest: f64,
    /// Place of the tip, m, body.
    place: DVec3,
}

impl InPlane {
    /// At rest, of an arm that carries `mass` kg at its tip.
    #[must_use]
    pub fn new(spec: InPlaneSpec, mass: f64) -> Self {
        let omega = TAU * spec.frequency;
        Self {
            mass,
            stiffness: omega * omega,
            damping: 2.0 * spec.damping * omega,
            way: 0.0,
            rate: 0.0,
            rest: 0.0,
            place: DVec3::ZERO,
        }
    }

    /// Way of the tip along body x, m.
    #[must_use]
    pub fn way(&self) -> f64 {
        self.way
    }

    /// Sums the forces of a step: `force` on the tip along x, N, its weight and inertia among them, and the rotor's
    /// `moment` about body z, N·m, with the tip at `place`, m, body.
    pub fn load(&mut self, force: f64, moment: f64, place: DVec3) {
        self.place = place;
        let turning = -place.y.signum() * 1.5 / ARM_LENGTH * moment;
        self.rest = force + turning - self.mass * (self.stiffness * self.way + self.damping * self.rate);
    }

    /// Gives the body's equations what gives way.
    pub fn condense(&self, mass: &mut MassMatrix, load: &mut Load) {
        mass.give_way_along_x(self.mass, self.place);
        let passed = DVec3::X * -self.rest;
        load.add(passed, self.place.cross(passed));
    }

    /// Advances by `dt` s on a body with the acceleration `body`.
    pub fn advance(&mut self, dt: f64, body: &Acceleration) {
        let carried = body.linear.x + body.angular.cross(self.place).x;
        self.rate += (self.rest / self.mass - carried) * dt;
        self.way += self.rate * dt;
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::STEP;
    use super::*;

    /// A body that cannot move.
    const HELD: Acceleration = Acceleration {
        linear: DVec3::ZERO,
        angular: DVec3::ZERO,
    };
    const TIP: DVec3 = DVec3::new(0.178, 0.178, 0.02);

    fn soft() -> InPlane {
        // 3 EI/L³ of 0.11 N m² with 0.123 kg.
        let k: f64 = 3.0 * 0.11 / (ARM_LENGTH * ARM_LENGTH * ARM_LENGTH);
        InPlane::new(
            InPlaneSpec {
                frequency: (k / 0.123).sqrt() / TAU,
                damping: 0.1,
            },
            0.123,
        )
    }

    /// M L²/2EI of a cantilever: 10.1 mm. A moment that turns right moves a right arm's tip back.
    #[test]
    fn the_rotor_s_torque_bends_the_arm_as_a_cantilever() {
        let mut arm = soft();
        for _ in 0..20_000 {
            arm.load(0.0, 0.07, TIP);
            arm.advance(STEP, &HELD);
        }
        let expected = 0.07 * ARM_LENGTH * ARM_LENGTH / (2.0 * 0.11);
        assert!((arm.way() + expected).abs() < 1e-5, "{} {expected}", arm.way());
        // At rest the body feels no force: the moment is its own.
        assert!(arm.rest.abs() < 1e-6);
    }

    #[test]
    fn it_swings_at_its_frequency() {
        let mut arm = InPlane::new(
            InPlaneSpec {
                frequency: 5.0,
                damping: 0.0,
            },
            0.123,
        );
        arm.way = 0.01;
        let (mut crossings, mut last) = (0, arm.way);
        for _ in 0..(10.0 / STEP) as u32 {
            arm.load(0.0, 0.0, TIP);
            arm.advance(STEP, &HELD);
            crossings += u32::from(last < 0.0 && arm.way >= 0.0);
            last = arm.way;
        }
        assert_eq!(crossings, 50);
    }
}
