//! Departures of printed TPU from an elastic arm with viscous damping.
//!
//! *Rate*: a Maxwell branch beside the springs, ż = q̇ - z/τ with the force -s K z, K the tangent stiffness in hover: static
//! bending has K, bending faster than 1/τ has (1 + s) K. TPU is up to 2.8 times as stiff at 16 as at 0.006 1/s (Haid
//! 2023): 1.5 to 2 at 5 Hz against a bench. *Relaxation*: the arm's rest follows its bending by a share per decade of
//! time ([`Creep`]). *First cycles*: an arm that has not been bent as far is stiffer by a share that falls to 0 at the
//! bend of a perch (Mullins' effect in printed TPU: Eng. Proc. 85, 18).

use super::super::creep::Creep;
use super::{PerTerm, TERMS};

/// Time constant of the Maxwell branch, s (assumed: bending of 5 Hz is fast, a throttle's change slow).
const TIME: f64 = 0.1;
/// Time from which relaxation counts, s.
const RELAXES_FROM: f64 = 1.0;
/// Tilt of an arm on a pipe, rad: bent so far, it has its first cycle behind it.
const FULL_BEND: f64 = 1.2;

/// The material of an arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MaterialSpec {
    /// Stiffness of fast over that of slow bending, less 1.
    pub stiffening: f64,
    /// Share of its bend that an arm keeps per decade of time.
    pub relaxation: f64,
    /// Stiffness of an arm that was never bent over that of a used one, less 1.
    pub first_cycles: f64,
}

/// State of an arm's material.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    spec: MaterialSpec,
    /// Tangent stiffness in hover, N·m.
    stiffness: [PerTerm; TERMS],
    branch: PerTerm,
    creep: [Creep; TERMS],
    kept: PerTerm,
    /// Largest bend so far, rad.
    bent: f64,
}

impl Material {
    /// Of an arm with the tangent `stiffness` (N·m) in hover, at rest and new.
    #[must_use]
    pub fn new(spec: MaterialSpec, stiffness: [PerTerm; TERMS]) -> Self {
        Self {
            spec,
            stiffness,
            branch: [0.0; TERMS],
            creep: [Creep::new(spec.relaxation, RELAXES_FROM); TERMS],
            kept: [0.0; TERMS],
            bent: 0.0,
        }
    }

    /// Part of the shape that the springs no longer feel, rad.
    #[must_use]
    pub fn kept(&self) -> PerTerm {
        self.kept
    }

    /// Factor on the springs.
    #[must_use]
    pub fn virgin(&self) -> f64 {
        1.0 + self.spec.first_cycles * (1.0 - self.bent / FULL_BEND).max(0.0)
    }

    /// Generalised force of the Maxwell branch, N·m.
    #[must_use]
    pub fn force(&self) -> PerTerm {
        let z = &self.branch;
        let share = -self.spec.stiffening;
        self.stiffness.map(|row| share * (row[0] * z[0] + row[1] * z[1]))
    }

    /// Advances by `dt` s, and relaxation by `slow` s, with the arm bent by `bend` (rad, each term over the rest) at
    /// `rate` (rad/s).
    pub fn step(&mut self, dt: f64, slow: f64, bend: &PerTerm, rate: &PerTerm) {
        for k in 0..TERMS {
            self.branch[k] += (rate[k] - self.branch[k] / TIME) * dt;
            self.kept[k] = self.creep[k].step(slow, bend[k]);
        }
        self.bent = self.bent.max((bend[0] + bend[1]).abs());
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::STEP;
    use super::*;

    const K: [PerTerm; TERMS] = [[2.0, 1.0], [1.0, 1.5]];

    fn bent(spec: MaterialSpec, speed: f64, to: f64, then: f64) -> Material {
        let mut material = Material::new(spec, K);
        let moving = (to / speed / STEP).round() as u32;
        for i in 1..=moving {
            material.step(STEP, STEP, &[speed * STEP * f64::from(i), 0.0], &[speed, 0.0]);
        }
        for _ in 0..(then / STEP) as u32 {
            material.step(STEP, STEP, &[to, 0.0], &[0.0, 0.0]);
        }
        material
    }

    #[test]
    fn fast_bending_meets_more_stiffness_and_slow_bending_none() {
        let spec = MaterialSpec {
            stiffening: 0.6,
            ..MaterialSpec::default()
        };
        // 0.1 rad within 5 ms: nearly 0.6 K more; 1 s later nothing.
        let [first, second] = bent(spec, 20.0, 0.1, 0.0).force();
        assert!((first + 0.6 * 2.0 * 0.1).abs() < 0.005, "{first}");
        assert!((second + 0.6 * 0.1).abs() < 0.003, "{second}");
        assert!(bent(spec, 20.0, 0.1, 1.0).force()[0].abs() < 1e-5);
        assert_eq!(
            bent(MaterialSpec::default(), 20.0, 0.1, 0.0).force(),
            [0.0; TERMS]
        );
    }

    #[test]
    fn an_arm_keeps_its_share_of_a_bend_per_decade() {
        let spec = MaterialSpec {
            relaxation: 0.05,
            ..MaterialSpec::default()
        };
        let mut material = bent(spec, 20.0, 1.0, 10.0);
        let ten = material.kept()[0];
        // To 100 s in long steps.
        for _ in 0..900 {
            material.step(0.1, 0.1, &[1.0, 0.0], &[0.0, 0.0]);
        }
        let decade = material.kept()[0] - ten;
        assert!((decade - 0.05).abs() < 0.01, "{decade}");
    }

    #[test]
    fn the_first_bend_is_the_stiffest() {
        let spec = MaterialSpec {
            first_cycles: 0.15,
            ..MaterialSpec::default()
        };
        assert_eq!(Material::new(spec, K).virgin(), 1.15);
        assert!((bent(spec, 1.0, 0.6, 0.0).virgin() - 1.075).abs() < 1e-3);
        assert_eq!(bent(spec, 1.0, 1.3, 0.0).virgin(), 1.0);
    }
}
