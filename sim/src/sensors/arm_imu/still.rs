//! Dead zone of the fusion at slow rates.
//!
//! The BNO055's fusion takes a slow rate for the bias of its gyroscopes: at 3 °/s its angle stands still, from 5 to
//! 10 °/s on it follows (boschsensortec/BNO055_SensorAPI#12; arduino-libraries/Arduino_NineAxesMotion#3). Here the fused
//! vector stands, and creeps towards the accelerometers' with the time constant [`SLOW`], while the true one turns
//! slower than the dead zone; else it turns along and catches up within [`QUICK`]. A dead zone of 0: none.

use glam::DVec3;

/// Time constants of the accelerometers' correction, s (assumed): below and above the dead zone.
const SLOW: f64 = 5.0;
const QUICK: f64 = 0.3;

/// Fused direction of gravity in the sensor's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Still {
    /// rad/s.
    dead_zone: f64,
    /// The true and the fused vector of the last step.
    last: Option<(DVec3, DVec3)>,
}

impl Still {
    /// A sensor that is switched on at rest, with the `dead_zone`, rad/s.
    #[must_use]
    pub const fn new(dead_zone: f64) -> Self {
        Self {
            dead_zone,
            last: None,
        }
    }

    /// The fused vector of the `true_down` one, `dt` s later; `None` without a dead zone.
    pub fn step(&mut self, dt: f64, true_down: DVec3) -> Option<DVec3> {
        if self.dead_zone == 0.0 {
            return None;
        }
        let (before, mut fused) = self.last.unwrap_or((true_down, true_down));
        let turned = true_down - before;
        let rate = turned.length() / (true_down.length() * dt);
        let time = if rate < self.dead_zone {
            SLOW
        } else {
            fused += turned;
            QUICK
        };
        fused += (true_down - fused) * (dt / time);
        self.last = Some((true_down, fused));
        Some(fused)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Error in rad after turning for `seconds` at `rate`, rad/s.
    fn error(still: &mut Still, from: f64, rate: f64, seconds: f64) -> f64 {
        let (steps, mut error) = ((seconds * 100.0) as u32, 0.0);
        for step in 0..=steps {
            let angle = from + rate * 0.01 * f64::from(step);
            let down = DVec3::new(0.0, libm::sin(angle), libm::cos(angle)) * 9.8;
            let fused = still.step(0.01, down).unwrap_or(down);
            error = angle - libm::atan2(fused.y, fused.z);
        }
        error
    }

    #[test]
    fn a_slow_turn_is_followed_by_the_accelerometers_alone_and_a_quick_one_by_the_gyroscopes() {
        let mut still = Still::new(0.05);
        // In the end it lags by the rate times 5 s.
        let slow = error(&mut still, 0.0, 0.02, 30.0);
        assert!((slow - 0.1).abs() < 0.005, "{slow}");
        // Three time constants of a quick turn take the lag out.
        assert!(error(&mut still, 0.6, 0.1, 0.9) < 0.1 * slow);
        assert!(error(&mut Still::new(0.05), 0.0, 0.1, 5.0).abs() < 1e-3);
    }

    #[test]
    fn without_a_dead_zone_it_changes_nothing() {
        assert_eq!(Still::new(0.0).step(0.01, DVec3::Z), None);
    }
}
