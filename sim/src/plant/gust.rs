//! Gusts: forces and moments as first-order Gauss-Markov processes.

use glam::DVec3;
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;

use super::gauss_markov::GaussMarkov;
use crate::normal::StandardNormal;
use crate::streams::Streams;

/// Correlation time, s (assumed).
const FORCE_TIME: f64 = 1.0;
/// Correlation time, s (assumed).
const MOMENT_TIME: f64 = 0.3;
/// Plant steps; 125 Hz is fast against both times.
const DIVIDER: u32 = 16;

/// A gust with its own random numbers.
#[derive(Clone, Debug)]
pub struct Gust {
    /// The steady wind's, N, NED.
    steady: DVec3,
    rng: Pcg64Mcg,
    force: GaussMarkov,
    moment: GaussMarkov,
    count: u32,
    elapsed: f64,
}

impl Gust {
    /// `force_rms` in N (world axes; half of it vertically), `moment_rms` in N·m (body axes).
    #[must_use]
    pub fn new(force_rms: f64, moment_rms: f64, streams: Streams) -> Self {
        Self {
            steady: DVec3::ZERO,
            rng: streams.of("gust"),
            force: GaussMarkov::new(DVec3::new(1.0, 1.0, 0.5) * force_rms, FORCE_TIME),
            moment: GaussMarkov::new(DVec3::splat(moment_rms), MOMENT_TIME),
            count: 0,
            elapsed: 0.0,
        }
    }

    /// The same in a steady wind that pushes with `force` N and comes from `from` rad, clockwise from north.
    #[must_use]
    pub fn in_wind(self, force: f64, from: f64) -> Self {
        Self {
            steady: DVec3::new(-libm::cos(from), -libm::sin(from), 0.0) * force,
            ..self
        }
    }

    /// Advances by `dt` s.
    pub fn step(&mut self, dt: f64) {
        self.count += 1;
        self.elapsed += dt;
        if self.count < DIVIDER {
            return;
        }
        let elapsed = std::mem::take(&mut self.elapsed);
        self.count = 0;
        let mut normal = || -> f64 { StandardNormal.sample(&mut self.rng) };
        let (f, m) = (
            DVec3::from_array(std::array::from_fn(|_| normal())),
            DVec3::from_array(std::array::from_fn(|_| normal())),
        );
        self.force.step(elapsed, f);
        self.moment.step(elapsed, m);
    }

    /// Force, N, NED.
    #[must_use]
    pub fn force(&self) -> DVec3 {
        self.force.value() + self.steady
    }

    /// Moment, N·m, body.
    #[must_use]
    pub fn moment(&self) -> DVec3 {
        self.moment.value()
    }
}

#[cfg(test)]
mod tests {
    use super::super::STEP;
    use super::*;

    #[test]
    fn a_wind_from_the_east_pushes_west() {
        let wind = Gust::new(0.0, 0.0, Streams::new(7)).in_wind(2.0, 90_f64.to_radians());
        assert!((wind.force() - DVec3::new(0.0, -2.0, 0.0)).length() < 1e-12);
    }

    #[test]
    fn gusts_have_the_stated_rms() {
        let mut g = Gust::new(0.35, 0.015, Streams::new(7));
        let (mut force, mut moment, n) = (0.0, 0.0, 4_000_000);
        for _ in 0..n {
            g.step(STEP);
            force += g.force().x * g.force().x;
            moment += g.moment().y * g.moment().y;
        }
        assert!(((force / f64::from(n)).sqrt() / 0.35 - 1.0).abs() < 0.15);
        assert!(((moment / f64::from(n)).sqrt() / 0.015 - 1.0).abs() < 0.1);
    }
}
