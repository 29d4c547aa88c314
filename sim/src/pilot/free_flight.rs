//! Steps in free flight: hover, the roll manoeuvre, flying to a point.

use glam::DVec2;

use super::guidance::Vertical;
use super::mission::{Mission, Phase, Progress, View};
use super::stick_dynamics::StickTarget;
use super::wrap;

/// Share of the roll angle at which a side is reached, and by which the stick exceeds it: the vehicle's lag would never
/// close the last degree.
const ROLL_REACHED: f64 = 0.95;
const ROLL_LEAD: f64 = 1.05;
/// How near the nose comes to a heading that is reached, rad.
const TURNED: f64 = 0.09;
/// Distance from the spot (m) and speed (m/s) after which the roll manoeuvre is over.
const RECOVERED: f64 = 0.3;
const RECOVERED_SPEED: f64 = 0.3;
/// Distance from a point (m) and speed (m/s) at which it is reached.
pub(super) const REACHED: f64 = 0.25;
pub(super) const REACHED_SPEED: f64 = 0.25;

impl Mission {
    pub(super) fn hover(&mut self, v: &View<'_>, seconds: f64, dt: f64) -> Progress {
        if self.phase == Phase::Start {
            self.spot = v.seen.position.truncate();
            self.enter(Phase::Fly);
        }
        let target = self.go_to(v, self.spot, self.height, dt);
        if self.phase_time >= seconds {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    pub(super) fn yaw(&mut self, v: &View<'_>, heading: f64, seconds: f64, dt: f64) -> Progress {
        if self.phase == Phase::Start {
            self.spot = v.seen.position.truncate();
            self.heading_goal = heading;
            self.enter(Phase::Fly);
        }
        let target = self.go_to(v, self.spot, self.height, dt);
        let there = wrap(heading - v.seen.yaw).abs() < TURNED;
        if self.held_for(there, seconds, dt) {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    pub(super) fn roll(&mut self, v: &View<'_>, angle: f64, seconds: f64, dt: f64) -> Progress {
        match self.phase {
            Phase::Start => {
                self.spot = v.seen.position.truncate();
                self.enter(Phase::Right);
            }
            Phase::Right if v.seen.roll >= ROLL_REACHED * angle => self.enter(Phase::Left),
            Phase::Left if v.seen.roll <= -ROLL_REACHED * angle => self.enter(Phase::Fly),
            _ => (),
        }
        let side = if self.phase == Phase::Right { 1.0 } else { -1.0 };
        // No roll in a failsafe: its end is awaited over the spot.
        if self.phase == Phase::Fly || self.trouble.is_some() {
            let target = self.go_to(v, self.spot, self.height, dt);
            let off = (v.seen.position.truncate() - self.spot).length();
            let there = off < RECOVERED && v.seen.velocity.length() < RECOVERED_SPEED;
            return if self.held_for(there && self.phase == Phase::Fly, 0.5, dt) {
                Progress::Done(target)
            } else {
                Progress::Going(target)
            };
        }
        if self.phase_time >= seconds {
            return Progress::Failed(format!(
                "roll of {:+.0} deg not reached in {seconds:.1} s: {:+.1} deg",
                (side * angle).to_degrees(),
                v.seen.roll.to_degrees()
            ));
        }
        let throttle = self
            .guidance
            .climb(Vertical::Height(self.height), libm::cos(angle), dt);
        let yaw = self.guidance.rudder(&v.seen, self.heading, 0.0);
        Progress::Going(StickTarget {
            roll: side * ROLL_LEAD * angle / self.stick_angle,
            yaw,
            throttle,
            ..Default::default()
        })
    }

    pub(super) fn fly_to(&mut self, v: &View<'_>, place: DVec2, height: f64, dt: f64) -> Progress {
        let target = self.go_to(v, place, height, dt);
        let off = libm::hypot((v.seen.position.truncate() - place).length(), v.height() - height);
        let there = off < REACHED && v.seen.velocity.length() < REACHED_SPEED;
        if self.held_for(there, 1.0, dt) {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }
}
