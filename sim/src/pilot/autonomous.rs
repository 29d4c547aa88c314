//! Steps that the vehicle flies autonomously: the pilot holds near the pipe, turns the perch switch on and leaves the
//! sticks centred.

use sophie_control::mode::{Mode, Reason};

use super::assisted::CENTRE;
use super::mission::{Mission, Phase, Progress, View};
use super::stick_dynamics::StickTarget;
use crate::scenario::Step;

/// Height over the pipe at which he holds, m.
const OVER: f64 = 0.6;
/// Distance, m, and speed, m/s, below which HOLD flies the rest of the way.
const NEAR: f64 = 0.8;
pub(super) const NEAR_SPEED: f64 = 0.5;
/// Time with centred sticks before he turns the perch switch, s.
const STILL: f64 = 1.5;
/// Time for which the display must ask for the pilot before he takes over, s.
const NOTICED: f64 = 0.5;
/// Climb after which the departure counts as done, m.
const LEFT: f64 = 0.4;
/// Longest wait for that climb if the vehicle holds lower, s.
const LEAVES: f64 = 15.0;

impl Mission {
    /// Flies by hand to the pipe and the last metre in HOLD.
    pub(super) fn fly_to_pipe_held(&mut self, v: &View<'_>, dt: f64) -> Progress {
        let height = self.pipe_top + OVER;
        if !self.hold_switch && self.phase == Phase::Start {
            let off = libm::hypot(
                (v.seen.position.truncate() - self.pipe).length(),
                v.height() - height,
            );
            let near = off < NEAR && v.seen.velocity.length() < NEAR_SPEED;
            if !self.held_for(near, 1.0, dt) {
                return Progress::Going(self.go_to(v, self.pipe, height, dt));
            }
            self.spot = self.pipe;
            self.height = height;
        }
        let progress = self.fly_to_held(v, self.pipe, height, dt);
        if matches!(progress, Progress::Done(_)) {
            self.hold_switch = true;
        }
        progress
    }

    /// Turns the perch switch on and waits for the mode that ends `step`.
    pub(super) fn perch_autonomously(&mut self, step: &Step, v: &View<'_>, dt: f64) -> Progress {
        let done = match step {
            Step::Touch => matches!(v.mode, Some(Mode::Contact | Mode::Clamping | Mode::Perched)),
            Step::Clamp { .. } => matches!(v.mode, Some(Mode::Clamping | Mode::Perched)),
            _ => v.mode == Some(Mode::Perched),
        };
        if self.perch_switch && self.phase == Phase::Start {
            self.enter(Phase::Commit);
        }
        match self.phase {
            Phase::Descend if v.mode != Some(Mode::Hold) => self.enter(Phase::Fly),
            Phase::Descend if self.phase_time >= STILL => {
                self.perch_switch = true;
                self.enter(Phase::Commit);
            }
            Phase::Descend => (),
            Phase::Commit => {
                // The display lags.
                let back = v.mode == Some(Mode::Hold) || Self::left_to_him(v);
                if self.held_for(back, STILL, dt) {
                    return Progress::Failed(format!("handed back, {}", v.shown()));
                }
            }
            _ => match self.enter_hold(v, self.pipe, self.pipe_top + OVER, dt) {
                Err(progress) => return progress,
                Ok(()) => self.enter(Phase::Descend),
            },
        }
        let target = self.idle();
        if done {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    /// The vehicle flies, but not autonomously.
    fn left_to_him(v: &View<'_>) -> bool {
        matches!(v.mode, Some(Mode::Flight | Mode::Failsafe))
            || (v.mode == Some(Mode::Escaping) && v.shows(Reason::PositionLost))
    }

    /// Turns the perch switch off and waits until the vehicle holds its position above the pipe. If it cannot hold, the
    /// pilot flies by hand.
    pub(super) fn release_autonomously(&mut self, step: &Step, v: &View<'_>, dt: f64) -> Progress {
        if self.phase == Phase::Fly {
            return self.release(v, dt);
        }
        let holds = v.mode == Some(Mode::Hold);
        let risen = v.height() > self.height + LEFT;
        let left = Self::left_to_him(v) || (holds && !risen && self.phase_time > LEAVES);
        if left && self.phase == Phase::Wait && self.held_for(left, NOTICED, dt) {
            self.hold_switch = false;
            self.height = v.height();
            self.spot = v.seen.position.truncate();
            self.enter(Phase::Fly);
        }
        let target = self.idle();
        if left {
            return Progress::Going(target);
        }
        if self.phase == Phase::Start {
            self.height = v.height();
            self.enter(Phase::Throttle);
        }
        if self.phase == Phase::Throttle && self.phase_time >= STILL {
            self.perch_switch = false;
            self.enter(Phase::Wait);
        }
        let done = match step {
            Step::Open => v.mode == Some(Mode::Releasing),
            _ => holds && risen,
        };
        if self.held_for(done, 0.5, dt) {
            self.hold_switch &= matches!(step, Step::Open);
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    /// The same with the sticks centred.
    pub(super) fn hands_off(&mut self, progress: Progress) -> Progress {
        match progress {
            Progress::Going(_) => Progress::Going(self.idle()),
            Progress::Done(_) => Progress::Done(self.idle()),
            failed @ Progress::Failed(_) => failed,
        }
    }

    /// Every stick centred.
    fn idle(&mut self) -> StickTarget {
        self.guidance.stand(CENTRE);
        StickTarget {
            throttle: CENTRE,
            ..StickTarget::default()
        }
    }
}
