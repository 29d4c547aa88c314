//! Velocity of the air: a steady wind, gusts, and the eddies that it sheds behind the pipe.

use glam::DVec3;
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;

use super::super::contact::Pipe;
use super::super::gauss_markov::GaussMarkov;
use super::shedding::Shedding;
use crate::normal::StandardNormal;
use crate::streams::Streams;

/// Correlation time of the gusts, s: integral times near the ground are 0.36 to 1.5 s (Atmosphere 17, 3, 314).
const GUST_TIME: f64 = 1.0;
/// Plant steps between new gusts; 125 Hz is fast against the correlation time.
const DIVIDER: u32 = 16;

/// The air's motion, as a scenario sets it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WindSpec {
    /// Steady speed, m/s, horizontal.
    pub speed: f64,
    /// Direction that it comes from, clockwise from north, rad.
    pub from: f64,
    /// RMS of the gusts on each horizontal axis, m/s; half of it vertically.
    pub gust: f64,
    /// Vertical speed of the eddies behind the pipe over the speed across it.
    pub shedding: f64,
}

impl WindSpec {
    /// Still air.
    #[must_use]
    pub fn is_calm(&self) -> bool {
        self.speed == 0.0 && self.gust == 0.0
    }
}

/// Moving air.
#[derive(Clone, Debug)]
pub struct Wind {
    steady: DVec3,
    gust: GaussMarkov,
    shedding: Shedding,
    rng: Pcg64Mcg,
    count: u32,
    elapsed: f64,
}

impl Wind {
    /// The air of `spec`, with random numbers of its own.
    #[must_use]
    pub fn new(spec: &WindSpec, streams: Streams) -> Self {
        Self {
            steady: DVec3::new(-libm::cos(spec.from), -libm::sin(spec.from), 0.0) * spec.speed,
            gust: GaussMarkov::new(DVec3::new(1.0, 1.0, 0.5) * spec.gust, GUST_TIME),
            shedding: Shedding::new(spec.shedding),
            rng: streams.of("wind gust"),
            count: 0,
            elapsed: 0.0,
        }
    }

    /// Advances by `dt` s past `pipe`.
    pub fn step(&mut self, dt: f64, pipe: &Pipe) {
        self.shedding.step(dt, self.steady, pipe);
        self.count += 1;
        self.elapsed += dt;
        if self.count < DIVIDER {
            return;
        }
        self.count = 0;
        let mut normal = || -> f64 { StandardNormal.sample(&mut self.rng) };
        let normal = DVec3::from_array(std::array::from_fn(|_| normal()));
        self.gust.step(std::mem::take(&mut self.elapsed), normal);
    }

    /// Velocity of the air at `point` (m, NED), m/s, NED.
    #[must_use]
    pub fn at(&self, point: DVec3, pipe: &Pipe) -> DVec3 {
        self.steady + self.gust.value() + self.shedding.at(point, pipe)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::STEP;
    use super::super::tests::pipe;
    use super::*;

    #[test]
    fn a_wind_from_the_east_blows_west_and_its_gusts_have_the_stated_rms() {
        let spec = WindSpec {
            speed: 4.0,
            from: 90_f64.to_radians(),
            gust: 0.8,
            shedding: 0.0,
        };
        let (mut wind, mut sum, n) = (Wind::new(&spec, Streams::new(3)), DVec3::ZERO, 4_000_000);
        let mut squares = DVec3::ZERO;
        for _ in 0..n {
            wind.step(STEP, &pipe());
            let v = wind.at(DVec3::ZERO, &pipe());
            sum += v;
            squares += (v - DVec3::new(0.0, -4.0, 0.0)).powf(2.0);
        }
        let (mean, rms) = (sum / f64::from(n), (squares / f64::from(n)).powf(0.5));
        // 2000 s have 1,000 independent gusts: 0.8 / √1000 · 3 and 0.8 / √2000 · 3.
        assert!((mean - DVec3::new(0.0, -4.0, 0.0)).length() < 0.13, "{mean}");
        assert!((rms - DVec3::new(0.8, 0.8, 0.4)).length() < 0.08, "{rms}");
    }
}
