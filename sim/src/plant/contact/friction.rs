//! Friction of a contact point: a bristle along the surface that sticks up to μs N and, once it slides, holds μk N until
//! it sticks again: Coulomb's two coefficients. The drop from one to the other is what makes stick-slip.
//!
//! μs/μk is 1.3 to 1.5 for rubber and polyurethane on dry steel, near 1 on wet (assumed from tables of elastomers).

use glam::DVec3;

use super::Pad;

/// Coefficients of a pair of surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Coefficient while it slides.
    pub kinetic: f64,
    /// Coefficient while it sticks, over the other.
    pub static_share: f64,
}

/// Bristle of a contact point.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bristle {
    deflection: DVec3,
    slides: bool,
}

impl Bristle {
    /// Advances by `dt` s along the surface of normal `n`, pressed with `normal` N and moved at `slip` m/s. Returns the
    /// force on the vehicle, N.
    pub fn step(
        &mut self,
        dt: f64,
        pad: &Pad,
        friction: &Friction,
        n: DVec3,
        normal: f64,
        slip: DVec3,
    ) -> DVec3 {
        let mut deflection = self.deflection + slip * dt;
        deflection -= n * deflection.dot(n);
        let sliding = friction.kinetic * normal;
        let sticking = sliding * friction.static_share;
        let mut tangential = -(deflection * pad.bristle + slip * pad.bristle_damping);
        let limit = if self.slides { sliding } else { sticking };
        self.slides = tangential.length() > limit;
        if self.slides {
            tangential *= sliding / tangential.length();
            // Sliding keeps the deflection that friction can hold.
            if deflection.length() * pad.bristle > sliding {
                deflection *= sliding / (deflection.length() * pad.bristle);
            }
        }
        self.deflection = deflection;
        tangential
    }
}

#[cfg(test)]
mod tests {
    use super::super::BELLY;
    use super::*;
    use crate::plant::STEP;

    /// Largest and last force (N) of a pad pressed with 10 N that is drawn along at 20 mm/s, and the same for one that a
    /// spring of 200 N/m draws with a mass of 0.5 kg: the smallest force after the largest.
    fn drawn(static_share: f64) -> (f64, f64) {
        let friction = Friction {
            kinetic: 0.4,
            static_share,
        };
        let mut bristle = Bristle::default();
        let (mut most, mut last) = (0.0_f64, 0.0);
        for _ in 0..1000 {
            let slip = DVec3::new(0.02, 0.0, 0.0);
            last = -bristle.step(STEP, &BELLY, &friction, DVec3::Z, 10.0, slip).x;
            most = most.max(last);
        }
        (most, last)
    }

    #[test]
    fn it_holds_the_static_coefficient_and_slides_with_the_kinetic_one() {
        let (most, last) = drawn(1.5);
        assert!(
            (most - 6.0).abs() < 0.1 && (last - 4.0).abs() < 1e-9,
            "{most} {last}"
        );
        // One coefficient: Coulomb's.
        let (most, last) = drawn(1.0);
        assert!(
            (most - 4.0).abs() < 1e-9 && (last - 4.0).abs() < 1e-9,
            "{most} {last}"
        );
    }

    /// A spring that is drawn at 10 mm/s: with μs > μk its force swings by twice their difference, with one coefficient it
    /// comes to rest.
    #[test]
    fn a_drawn_mass_sticks_and_slips_with_two_coefficients_alone() {
        for (static_share, least, most) in [(1.5, 2.0, 4.1), (1.0, 0.0, 0.2)] {
            let friction = Friction {
                kinetic: 0.4,
                static_share,
            };
            let mut bristle = Bristle::default();
            let (mass, spring) = (0.5, 200.0);
            let (mut x, mut v, mut drawn) = (0.0, 0.0, 0.0);
            let mut range = (f64::INFINITY, 0.0_f64);
            for step in 0..20_000 {
                drawn += 0.01 * STEP;
                let pull = spring * (drawn - x);
                let slip = DVec3::new(v, 0.0, 0.0);
                let held = bristle.step(STEP, &BELLY, &friction, DVec3::Z, 10.0, slip).x;
                v += (pull + held) / mass * STEP;
                x += v * STEP;
                if step > 10_000 {
                    range = (range.0.min(pull), range.1.max(pull));
                }
            }
            let swing = range.1 - range.0;
            assert!((least..most).contains(&swing), "{static_share}: {range:?}");
        }
    }
}
