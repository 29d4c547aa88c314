//! A motor controller as built: the pulses that it accepts, which may differ from the stack's parameters.

/// A standard pulse over one of OneShot125.
pub const ONESHOT125: f64 = 8.0;

/// Ends and dead zone, µs of a standard pulse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EscSpec {
    /// No drive at and below.
    pub pulse_min: f64,
    /// The motor stands still below.
    pub pulse_idle: f64,
    /// Full drive at and above.
    pub pulse_max: f64,
}

impl Default for EscSpec {
    /// Taught 1000 and 2000 µs; motors turn from 5 % on.
    fn default() -> Self {
        Self {
            pulse_min: 1000.0,
            pulse_idle: 1050.0,
            pulse_max: 2000.0,
        }
    }
}

impl EscSpec {
    /// Drive of the motor, 0..1, by a standard pulse of `us` µs; `us` is 0 without a pulse.
    #[must_use]
    pub fn drive(&self, us: f64) -> f64 {
        if us >= self.pulse_idle {
            ((us - self.pulse_min) / (self.pulse_max - self.pulse_min)).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motor_stands_still_in_the_dead_zone_and_turns_by_the_ends_above() {
        let dji = EscSpec {
            pulse_min: 1120.0,
            pulse_idle: 1180.0,
            pulse_max: 1920.0,
        };
        for (us, drive) in [
            (0.0, 0.0),
            (1000.0, 0.0),
            (1179.9, 0.0),
            (1180.0, 0.075),
            (1520.0, 0.5),
            (1920.0, 1.0),
            (2000.0, 1.0),
            (f64::NAN, 0.0),
        ] {
            assert!((dji.drive(us) - drive).abs() < 1e-12, "{us}: {}", dji.drive(us));
        }
    }
}
