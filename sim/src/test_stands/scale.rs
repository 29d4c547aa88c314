//! A kitchen scale that a person reads.

use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;

use crate::normal::StandardNormal;
use crate::plant::GRAVITY;
use crate::streams::Streams;

/// Largest error of the scale's gain, share (assumed: kitchen scales of 5 kg state 0.1 to 0.3 %).
const GAIN: f64 = 0.003;
/// Resolution, g.
const RESOLUTION: f64 = 1.0;

/// A scale, tared.
#[derive(Clone, Debug)]
pub struct Scale {
    gain: f64,
    rng: Pcg64Mcg,
}

impl Scale {
    /// A scale with the errors of `streams`.
    #[must_use]
    pub fn new(streams: Streams) -> Self {
        Self {
            gain: streams.within("scale gain", 1.0 - GAIN, 1.0 + GAIN),
            rng: streams.of("scale"),
        }
    }

    /// What is read off for a force of `force` N that fluctuates by the share `fluctuation`, RMS, from reading to reading, g.
    pub fn read(&mut self, force: f64, fluctuation: f64) -> f64 {
        let noise: f64 = StandardNormal.sample(&mut self.rng);
        let grams = 1e3 / GRAVITY * force * self.gain * (1.0 + fluctuation * noise);
        (grams / RESOLUTION).round() * RESOLUTION
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_weight_is_read_to_a_gram_and_the_gain() {
        let mut scale = Scale::new(Streams::new(3));
        let read = scale.read(9.806_65, 0.0);
        assert!((read - 1000.0).abs() <= 4.0 && read.fract() == 0.0, "{read}");
        let gains = (0..200).map(|seed| Scale::new(Streams::new(seed)).gain);
        let most = gains.map(|gain| (gain - 1.0).abs()).fold(0.0, f64::max);
        assert!((0.0025..=GAIN).contains(&most), "{most}");
    }

    #[test]
    fn a_force_that_fluctuates_is_read_with_that_spread() {
        let mut scale = Scale::new(Streams::new(4));
        let reads: Vec<f64> = (0..2000).map(|_| scale.read(9.806_65, 0.01)).collect();
        let mean = reads.iter().sum::<f64>() / 2000.0;
        let square = reads
            .iter()
            .map(|read| (read - mean) * (read - mean))
            .sum::<f64>()
            / 2000.0;
        assert!((square.sqrt() - 10.0).abs() < 0.6, "{square}");
    }
}
