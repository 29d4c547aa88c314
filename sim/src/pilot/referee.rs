//! Detects a lost vehicle from the truth, not from the pilot's view.

use core::f64::consts::PI;

use super::{VisibleState, wrap};

/// Tilt limit, rad.
const TILT_MAX: f64 = 80.0 * PI / 180.0;
/// Depth below the ground, m.
const DEPTH_MAX: f64 = 0.5;
/// Distance from the take-off point, m.
const DISTANCE_MAX: f64 = 30.0;
/// Limits of heading error, rad, and turn rate, rad/s.
const HEADING_MAX: f64 = 60.0 * PI / 180.0;
const TURN_MAX: f64 = 150.0 * PI / 180.0;
/// Minimum duration, s: a touch may twitch the nose.
const YAW_TIME: f64 = 0.15;
/// Averaging time of the turn rate, s.
const TURN_TIME: f64 = 0.1;

/// The referee.
#[derive(Clone, Debug, Default)]
pub struct Referee {
    last_yaw: Option<f64>,
    turn: f64,
    astray: f64,
}

impl Referee {
    /// Reason of the loss, if lost.
    pub fn judge(&mut self, truth: &VisibleState, heading: f64, dt: f64) -> Option<String> {
        let yaw = truth.yaw;
        if dt > 0.0 {
            let step = wrap(yaw - self.last_yaw.unwrap_or(yaw));
            self.turn += (step / dt - self.turn) * (dt / (dt + TURN_TIME));
        }
        self.last_yaw = Some(yaw);
        let error = wrap(yaw - heading);
        let astray = error.abs() > HEADING_MAX || self.turn.abs() > TURN_MAX;
        self.astray = if astray { self.astray + dt } else { 0.0 };
        let deg = 180.0 / PI;
        if self.astray >= YAW_TIME {
            let (error, turn) = (error * deg, self.turn * deg);
            return Some(format!(
                "lost yaw: heading {error:.0} deg off, turning at {turn:.0} deg/s"
            ));
        }
        let tilt = libm::acos((libm::cos(truth.roll) * libm::cos(truth.pitch)).clamp(-1.0, 1.0));
        let p = truth.position;
        if !(p.is_finite() && tilt.is_finite() && yaw.is_finite()) {
            return Some("lost the vehicle: its position is no number".to_owned());
        }
        if tilt > TILT_MAX {
            let cause = if astray {
                "lost yaw and tipped over"
            } else {
                "tipped over"
            };
            return Some(format!(
                "{cause}: tilt {:.0} deg at a height of {:.2} m",
                tilt * deg,
                -p.z
            ));
        }
        if p.z > DEPTH_MAX {
            return Some(format!("lost the vehicle: height {:.2} m", -p.z));
        }
        let distance = p.truncate().length();
        (distance > DISTANCE_MAX).then(|| format!("lost the vehicle: {distance:.0} m away"))
    }
}
