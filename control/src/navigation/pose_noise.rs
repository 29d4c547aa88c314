//! White noise of a source of poses, measured from the poses themselves.
//!
//! Senders give no variance, or one that is not that of their tag, light and distance. The second difference of three
//! poses, p - 2 p' + p'', has six times the variance of one; in 20 ms an acceleration of 5 m/s² adds 2 mm. The median of
//! its square follows by a step up or down for each pose, so that outliers, up to a third of the poses, do not count by
//! their size: 5 % of them raise the variance by half.

use super::fix::{DEVIATION_BOUNDS, FIX_DEVIATION};
use crate::maths::scalar;
use crate::maths::vector::Vec3;

/// Median of the square of a normal variable over its mean.
const MEDIAN: f32 = 0.4549;
/// Share by which the variance moves with each pose: tenfold in 2 s at 50 Hz, with a scatter of 20 %.
const STEP: f32 = 0.025;

/// The noise, the same along each axis: that of a tag lies along the line of sight, which turns with the flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseNoise {
    /// Along the worst axis, m².
    variance: f32,
    /// The last pose and the difference to the one before it, m.
    last: Option<Vec3>,
    way: Option<Vec3>,
}

impl Default for PoseNoise {
    fn default() -> Self {
        Self {
            variance: FIX_DEVIATION * FIX_DEVIATION,
            last: None,
            way: None,
        }
    }
}

impl PoseNoise {
    /// Takes the next pose, m, which `follows` the last one or comes after a gap.
    pub fn step(&mut self, position: Vec3, follows: bool) {
        let way = self.last.filter(|_| follows).map(|last| position - last);
        if let (Some(way), Some(before)) = (way, self.way) {
            let seen = (way - before).norm_squared() * (1.0 / 6.0);
            let share = if seen > MEDIAN * self.variance {
                1.0 + STEP
            } else {
                1.0 / (1.0 + STEP)
            };
            let (least, most) = DEVIATION_BOUNDS;
            self.variance = scalar::clamp(self.variance * share, least * least, most * most);
        }
        (self.last, self.way) = (Some(position), way);
    }

    /// Variance of a pose along its worst axis, m²; up to five times too much where all are equal.
    pub fn variance(&self) -> f32 {
        self.variance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_noise::TestNoise;

    /// Deviation found after `seconds` at 50 Hz of poses of this deviation, of which a share is 0.3 m off, in a flight that
    /// swings by 3 m/s².
    fn found(deviation: f32, outliers: f32, seconds: u32) -> f32 {
        let (mut random, mut noise) = (TestNoise(5), PoseNoise::default());
        for i in 0..50 * seconds {
            let t = 0.02 * i as f32;
            let off = if random.uniform() < outliers { 0.3 } else { 0.0 };
            let there = 0.33 * scalar::sin(scalar::wrap_pi(3.0 * t));
            noise.step(
                Vec3::new(there + off + deviation * random.normal(), 0.0, 0.0),
                true,
            );
        }
        scalar::sqrt(noise.variance())
    }

    #[test]
    fn the_noise_of_any_source_is_found_in_seconds() {
        for deviation in [0.004, 0.01, 0.04, 0.1] {
            let found = found(deviation, 0.0, 6);
            assert!((found / deviation - 1.0).abs() < 0.2, "{deviation}: {found}");
        }
        assert!((found(0.0, 0.0, 20) - 0.003).abs() < 1e-6);
    }

    #[test]
    fn outliers_count_by_their_number() {
        let found = found(0.01, 0.05, 20);
        assert!((0.01..0.0145).contains(&found), "{found}");
    }

    #[test]
    fn what_comes_after_a_gap_is_no_noise() {
        let mut noise = PoseNoise::default();
        for i in 0..2000 {
            let there = if i % 2 == 0 { 0.0 } else { 5.0 };
            noise.step(Vec3::new(there, 0.0, 0.0), i % 2 == 1);
        }
        assert_eq!(
            noise,
            PoseNoise {
                last: noise.last,
                way: noise.way,
                ..PoseNoise::default()
            }
        );
    }
}
