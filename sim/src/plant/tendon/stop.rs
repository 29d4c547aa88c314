//! Stop error of a servo: its dead band, in the form of a position.
//!
//! The controller drives its motor once the error exceeds d, and stops it at [`REACHED`] of d: static friction keeps a
//! motor at rest that a small error drives. So a servo stands anywhere within ±d of its target, and each start is a
//! kick. 1 to 5 µs are claimed, d 0.5 to 2.5° are measured with stiction (STS3215, TheRobotStudio/SO-ARM100 #134). d = 0:
//! the servo reaches its target.

/// Share of the band at which a running servo stops (assumed).
const REACHED: f64 = 0.2;

/// Whether the motor of a servo runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// d, rad.
    band: f64,
    runs: bool,
}

impl Stop {
    /// A servo at rest with the `band`, rad.
    #[must_use]
    pub const fn new(band: f64) -> Self {
        Self { band, runs: false }
    }

    /// Whether the servo has a band: then changes of its pulse have none.
    #[must_use]
    pub fn has_band(&self) -> bool {
        self.band > 0.0
    }

    /// The part of the `error`, rad, that the motor works on: 0 at rest.
    pub fn driven(&mut self, error: f64) -> f64 {
        if self.band == 0.0 {
            return error;
        }
        self.runs = error.abs() > if self.runs { REACHED * self.band } else { self.band };
        if !self.runs {
            return 0.0;
        }
        error - error.signum() * REACHED * self.band
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_servo_starts_beyond_its_band_and_stops_within_a_fifth_of_it() {
        let mut stop = Stop::new(0.02);
        assert_eq!(stop.driven(0.019), 0.0);
        assert!((stop.driven(0.021) - 0.017).abs() < 1e-12);
        assert!(stop.driven(0.01) > 0.0);
        assert_eq!(stop.driven(0.004), 0.0);
        // At rest again: the same error that drove it does not start it.
        assert_eq!(stop.driven(-0.01), 0.0);
        assert!(stop.driven(-0.03) < 0.0);
    }

    #[test]
    fn without_a_band_every_error_is_driven() {
        assert_eq!(Stop::new(0.0).driven(1e-9), 1e-9);
    }
}
