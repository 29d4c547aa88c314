//! Steps of the running calibration.
//!
//! The BNO055 calibrates itself while it runs, and its vector steps when it accepts a new offset (users report jumps of
//! about a degree; PX4 pull request 21413 leaves its fusion out). Here the error of the tilt takes a new value, evenly
//! within ±`most`, at random times, a minute apart on average (assumed). `most` = 0: none.

use rand::Rng;
use rand_pcg::Pcg64Mcg;

/// Mean time between steps, s (assumed).
const APART: f64 = 60.0;

/// Error by the running calibration.
#[derive(Clone, Debug)]
pub struct Steps {
    /// rad.
    most: f64,
    error: f64,
    rng: Pcg64Mcg,
}

impl Steps {
    /// Steps of up to `most` rad, by `rng`.
    #[must_use]
    pub const fn new(most: f64, rng: Pcg64Mcg) -> Self {
        Self {
            most,
            error: 0.0,
            rng,
        }
    }

    /// The same with steps of up to `most` rad.
    #[must_use]
    pub fn up_to(self, most: f64) -> Self {
        Self { most, ..self }
    }

    /// Error `dt` s later, rad.
    pub fn step(&mut self, dt: f64) -> f64 {
        if self.most > 0.0 && self.rng.random::<f64>() < dt / APART {
            self.error = self.rng.random_range(-self.most..=self.most);
        }
        self.error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::streams::Streams;

    #[test]
    fn steps_are_a_minute_apart_and_within_their_bound() {
        let mut steps = Steps::new(0.02, Streams::new(1).of("steps"));
        let (mut last, mut count, mut most) = (0.0, 0, 0.0_f64);
        for _ in 0..3_600_000 {
            let error = steps.step(0.01);
            count += i32::from(error != last);
            (last, most) = (error, most.max(error.abs()));
        }
        // 600 in ten hours, four sigma.
        assert!(
            (500..700).contains(&count) && (0.019..=0.02).contains(&most),
            "{count} {most}"
        );
    }

    #[test]
    fn without_a_bound_there_are_none() {
        let mut steps = Steps::new(0.0, Streams::new(1).of("steps"));
        assert!((0..100_000).all(|_| steps.step(0.01) == 0.0));
    }
}
