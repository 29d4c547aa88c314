//! Wash of a rotor on the arm below it: a steady loss of thrust, and buffeting.
//!
//! Arms of 6, 15 and 22 mm under a 5-inch propeller leave 1408, 1384 and 1337 g (a bench of shendrones): 1.7 to 5 %. The
//! buffeting's size and correlation time are assumed; soft propelled arms see "significant and random disturbance" of it
//! (arXiv 2502.12716).

use glam::DVec3;
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;
use sophie_control::allocation::wrench::PerArm;

use super::super::gauss_markov::GaussMarkov;
use crate::normal::StandardNormal;
use crate::streams::Streams;

/// Correlation time of the buffeting, s (assumed).
const TIME: f64 = 0.05;
/// Plant steps between new numbers: 500 Hz.
const DIVIDER: u32 = 4;

/// Shares of the thrust that the arm takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WashSpec {
    /// Always.
    pub loss: f64,
    /// RMS of the buffeting.
    pub buffet: f64,
}

/// Wash on the four arms.
#[derive(Clone, Debug)]
pub struct Wash {
    spec: WashSpec,
    /// Arms 1 to 3 and arm 4.
    buffet: [GaussMarkov; 2],
    rng: Pcg64Mcg,
    count: u32,
    elapsed: f64,
}

impl Wash {
    /// Wash of `spec`, with random numbers of its own.
    #[must_use]
    pub fn new(spec: WashSpec, streams: Streams) -> Self {
        Self {
            spec,
            buffet: [GaussMarkov::new(DVec3::splat(spec.buffet), TIME); 2],
            rng: streams.of("arm wash"),
            count: 0,
            elapsed: 0.0,
        }
    }

    /// Advances by `dt` s.
    pub fn step(&mut self, dt: f64) {
        if self.spec.buffet == 0.0 {
            return;
        }
        self.count += 1;
        self.elapsed += dt;
        if self.count < DIVIDER {
            return;
        }
        self.count = 0;
        let elapsed = std::mem::take(&mut self.elapsed);
        for process in &mut self.buffet {
            let mut normal = || -> f64 { StandardNormal.sample(&mut self.rng) };
            process.step(elapsed, DVec3::from_array(std::array::from_fn(|_| normal())));
        }
    }

    /// Factor on the thrust of each rotor that its arm receives.
    #[must_use]
    pub fn factors(&self) -> PerArm<f64> {
        let [a, b] = self.buffet.map(|process| process.value());
        [a.x, a.y, a.z, b.x].map(|buffet| 1.0 - self.spec.loss - buffet)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::STEP;
    use super::*;

    #[test]
    fn the_loss_is_steady_and_the_buffeting_has_its_rms_on_each_arm() {
        let steady = Wash::new(
            WashSpec {
                loss: 0.03,
                buffet: 0.0,
            },
            Streams::new(1),
        );
        assert_eq!(steady.factors(), [0.97; 4]);
        let spec = WashSpec {
            loss: 0.03,
            buffet: 0.02,
        };
        let (mut wash, n) = (Wash::new(spec, Streams::new(1)), 400_000);
        let mut squares = [0.0; 4];
        for _ in 0..n {
            wash.step(STEP);
            for (sum, factor) in squares.iter_mut().zip(wash.factors()) {
                *sum += (factor - 0.97) * (factor - 0.97);
            }
        }
        for (arm, sum) in squares.iter().enumerate() {
            let rms = (sum / f64::from(n)).sqrt();
            assert!((rms / 0.02 - 1.0).abs() < 0.08, "arm {arm}: {rms}");
        }
    }
}
