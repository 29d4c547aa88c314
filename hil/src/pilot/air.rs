//! Steps in free flight: hover, the roll manoeuvre, flying to a point.

use core::f64::consts::FRAC_PI_2;

use glam::DVec2;
use sophie_control::mode::Mode;

use super::guidance::Vertical;
use super::hands::Wish;
use super::mind::{HEADING, Mind, Phase, Progress, View};

/// Distance from the spot, m, and speed, m/s, at which the roll manoeuvre has been recovered from.
const RECOVERED: f64 = 0.3;
const RECOVERED_SPEED: f64 = 0.3;
/// Distance from a point, m, and speed, m/s, at which it has been reached.
const REACHED: f64 = 0.25;
const REACHED_SPEED: f64 = 0.25;

impl Mind {
    /// The vehicle has stopped in the air: nothing that a pilot could do.
    fn stopped(v: &View<'_>) -> Option<Progress> {
        (v.mode == Some(Mode::Disarmed)).then(|| {
            Progress::Failed(format!(
                "rotors stopped at a height of {:.2} m, {}",
                v.height(),
                v.shown()
            ))
        })
    }

    pub(super) fn hover(&mut self, v: &View<'_>, seconds: f64, dt: f64) -> Progress {
        if let Some(failed) = Self::stopped(v) {
            return failed;
        }
        if self.phase == Phase::Start {
            self.spot = v.seen.position.truncate();
            self.enter(Phase::Fly);
        }
        let wish = self.go_to(v, self.spot, self.height, dt);
        if self.phase_time >= seconds {
            Progress::Done(wish)
        } else {
            Progress::Going(wish)
        }
    }

    pub(super) fn roll(&mut self, v: &View<'_>, angle: f64, seconds: f64, dt: f64) -> Progress {
        if let Some(failed) = Self::stopped(v) {
            return failed;
        }
        let side = match self.phase {
            Phase::Start => {
                self.spot = v.seen.position.truncate();
                self.enter(Phase::Right);
                1.0
            }
            Phase::Right if self.phase_time < seconds => 1.0,
            Phase::Right => {
                self.enter(Phase::Left);
                -1.0
            }
            Phase::Left if self.phase_time < seconds => -1.0,
            Phase::Left => {
                self.enter(Phase::Fly);
                0.0
            }
            _ => 0.0,
        };
        if self.phase == Phase::Fly {
            let wish = self.go_to(v, self.spot, self.height, dt);
            let off = (v.seen.position.truncate() - self.spot).length();
            let there = off < RECOVERED && v.seen.velocity.length() < RECOVERED_SPEED;
            return if self.held_for(there, 0.5, dt) {
                Progress::Done(wish)
            } else {
                Progress::Going(wish)
            };
        }
        let lean = angle.min(FRAC_PI_2 * 0.8);
        let throttle = self.guidance.climb(Vertical::Height(self.height), lean.cos(), dt);
        let yaw = self.guidance.rudder(&v.seen, HEADING);
        Progress::Going(Wish {
            roll: side * lean / self.stick_angle,
            yaw,
            throttle,
            ..Default::default()
        })
    }

    pub(super) fn fly_to(&mut self, v: &View<'_>, target: DVec2, height: f64, dt: f64) -> Progress {
        if let Some(failed) = Self::stopped(v) {
            return failed;
        }
        let wish = self.go_to(v, target, height, dt);
        let off = (v.seen.position.truncate() - target)
            .length()
            .hypot(v.height() - height);
        let there = off < REACHED && v.seen.velocity.length() < REACHED_SPEED;
        if self.held_for(there, 1.0, dt) {
            Progress::Done(wish)
        } else {
            Progress::Going(wish)
        }
    }
}
