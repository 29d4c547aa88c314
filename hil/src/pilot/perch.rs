//! Steps at the pipe: fly over it, touch, perch, hold, release.

use sophie_control::mode::Mode;

use super::hands::Wish;
use super::mind::{Mind, Phase, Progress, View};

/// Height over the pipe from which it is approached, and to which the vehicle goes after a release, m.
const OVER: f64 = 1.0;
/// Distance, m, speed, m/s, and time, s, at which the vehicle has settled over the pipe.
const SETTLED: f64 = 0.08;
const SETTLED_SPEED: f64 = 0.10;
const SETTLED_TIME: f64 = 1.5;
/// Rate of descent onto the pipe, m/s.
const DESCENT: f64 = 0.15;
/// Height over the pipe below which being off it matters, and by which a missed approach goes up again, m.
const NEAR: f64 = 0.4;
/// Largest distance beside the pipe's crown, and along it from the spot, on the last bit, m.
const BESIDE: f64 = 0.10;
const ALONG: f64 = 0.25;
/// Distance beside the crown at which the vehicle waits at its height, and the least height over the pipe at
/// which it can: below that it goes down, m.
const WAIT: f64 = 0.035;
const WAIT_OVER: f64 = 0.12;
/// Height over the pipe at which a vehicle that does not sink any more stands on it, m.
const STANDS: f64 = 0.25;
/// Depth below the pipe's top by which it was missed, m.
const MISSED: f64 = 0.05;
/// Sink rate of a vehicle that stands, m/s, and the time for which it must last, s.
const STOPPED: f64 = 0.05;
const STOPPED_TIME: f64 = 0.5;
/// Tries after which the pilot gives up.
const TRIES: u32 = 5;
/// Speed of the throttle on the pipe, 1/s.
const EASE: f64 = 0.25;
/// Throttle at which the arms are opened.
const RELEASE_THROTTLE: f64 = 0.30;
/// Distance beside the crown at which the vehicle has slid off, and depth below where it stood, m.
const SLID: f64 = 0.20;
const SUNK: f64 = 0.12;
/// Time for which the display may tell of a lost grip, s.
const GRIP_LOST_TIME: f64 = 1.0;
/// Rise at which the vehicle is clear of the pipe and the sticks are used again, m.
const CLEAR: f64 = 0.06;

impl Mind {
    pub(super) fn fly_to_pipe(&mut self, v: &View<'_>, dt: f64) -> Progress {
        let wish = self.go_to(v, self.pipe, self.pipe_top + OVER, dt);
        if self.settled(v, dt) { Progress::Done(wish) } else { Progress::Going(wish) }
    }

    fn settled(&mut self, v: &View<'_>, dt: f64) -> bool {
        let off = (v.seen.position.truncate() - self.pipe).length().hypot(v.height() - self.pipe_top - OVER);
        let there = off < SETTLED && v.seen.velocity.length() < SETTLED_SPEED;
        self.held_for(there, SETTLED_TIME, dt)
    }

    pub(super) fn touch(&mut self, v: &View<'_>, dt: f64) -> Progress {
        let (wish, felt) = self.approach(v, dt);
        if self.missed >= TRIES {
            return Progress::Failed(format!(
                "missed the pipe {TRIES} times, last {:.2} m beside it",
                (v.seen.position.y - self.pipe.y).abs()
            ));
        }
        if felt { Progress::Done(wish) } else { Progress::Going(wish) }
    }

    /// Descends onto the pipe, and up again for another try when it would be missed. True once it carries.
    fn approach(&mut self, v: &View<'_>, dt: f64) -> (Wish, bool) {
        if self.phase == Phase::GoAround {
            let wish = self.go_to(v, self.pipe, self.pipe_top + OVER, dt);
            if self.settled(v, dt) {
                self.enter(Phase::Descend);
            }
            return (wish, false);
        }
        if self.phase != Phase::Descend {
            self.enter(Phase::Descend);
        }
        let over = v.height() - self.pipe_top;
        let off = v.seen.position.truncate() - self.pipe;
        let astray = over < NEAR && (off.y.abs() > BESIDE || off.x.abs() > ALONG);
        if astray || over < -MISSED {
            self.missed += 1;
            self.enter(Phase::GoAround);
        }
        let beside = (self.guidance.position_ahead().y - self.pipe.y).abs();
        let wait = (WAIT_OVER..NEAR).contains(&over) && beside > WAIT;
        let wish = self.climb_over(v, self.pipe, if wait { 0.0 } else { -DESCENT }, dt);
        let stands = over < STANDS && v.seen.velocity.z.abs() < STOPPED;
        let felt = self.held_for(stands, STOPPED_TIME, dt);
        if felt {
            self.throttle = wish.throttle;
            self.height = v.height();
        }
        (wish, felt)
    }

    pub(super) fn perch(&mut self, v: &View<'_>, throttle: f64, dt: f64) -> Progress {
        if matches!(self.phase, Phase::GoAround | Phase::Descend) {
            let (wish, felt) = self.approach(v, dt);
            if felt {
                self.enter(Phase::Throttle);
            }
            return Progress::Going(wish);
        }
        if self.phase == Phase::Start {
            self.enter(Phase::Throttle);
        }
        self.perch_switch = true;
        let closing = matches!(v.mode, Some(Mode::Contact | Mode::Clamping | Mode::Perched));
        if closing && self.phase == Phase::Throttle {
            self.enter(Phase::Wait);
        }
        let beside = (v.seen.position.y - self.pipe.y).abs();
        if self.phase == Phase::Throttle && (beside > SLID || v.height() < self.height - SUNK) {
            self.perch_switch = false;
            self.missed += 1;
            if self.missed >= TRIES {
                return Progress::Failed(format!("slid off the pipe {TRIES} times, last {beside:.2} m beside it"));
            }
            self.enter(Phase::GoAround);
        }
        if self.phase == Phase::Wait && matches!(v.mode, Some(Mode::Releasing | Mode::Flight | Mode::Failsafe)) {
            return Progress::Failed(format!("no proven grip, {}", v.shown()));
        }
        if v.mode == Some(Mode::Disarmed) {
            return Progress::Failed(format!("rotors stopped on the pipe, {}", v.shown()));
        }
        let perched = v.mode == Some(Mode::Perched);
        let wish = self.throttle_to(if perched { 0.0 } else { throttle }, EASE, dt);
        if perched && self.throttle <= 0.0 { Progress::Done(wish) } else { Progress::Going(wish) }
    }

    pub(super) fn hold(&mut self, v: &View<'_>, seconds: f64, dt: f64) -> Progress {
        if v.mode != Some(Mode::Perched) {
            return Progress::Failed(format!("no longer perched after {:.1} s, {}", self.step_time, v.shown()));
        }
        if self.held_for(v.reason == "grip lost", GRIP_LOST_TIME, dt) {
            return Progress::Failed(format!("grip lost after {:.1} s", self.step_time));
        }
        let wish = Wish::default();
        if self.step_time >= seconds { Progress::Done(wish) } else { Progress::Going(wish) }
    }

    pub(super) fn release(&mut self, v: &View<'_>, dt: f64) -> Progress {
        match self.phase {
            Phase::Start | Phase::Throttle => {
                if self.phase == Phase::Start {
                    self.throttle = 0.0;
                    self.enter(Phase::Throttle);
                }
                let wish = self.throttle_to(RELEASE_THROTTLE, EASE, dt);
                if self.held_for(self.throttle >= RELEASE_THROTTLE, 0.5, dt) {
                    self.perch_switch = false;
                    self.enter(Phase::Wait);
                }
                Progress::Going(wish)
            }
            Phase::Wait => {
                if v.mode == Some(Mode::Flight) {
                    self.height = v.height();
                    self.spot = v.seen.position.truncate();
                    self.enter(Phase::Fly);
                } else if v.mode == Some(Mode::Disarmed) {
                    return Progress::Failed(format!("rotors stopped on the pipe, {}", v.shown()));
                }
                Progress::Going(self.throttle_to(RELEASE_THROTTLE, EASE, dt))
            }
            _ => {
                let mut wish = self.go_to(v, self.spot, self.height + OVER, dt);
                if v.height() < self.height + CLEAR {
                    (wish.roll, wish.pitch, wish.yaw) = (0.0, 0.0, 0.0);
                }
                let there = (v.height() - self.height - OVER).abs() < 0.2 && v.seen.velocity.length() < 0.3;
                if self.held_for(there, 0.5, dt) { Progress::Done(wish) } else { Progress::Going(wish) }
            }
        }
    }
}
