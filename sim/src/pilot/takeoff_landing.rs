//! Steps that begin or end on the ground: arm, take off, land, disarm.

use sophie_control::mode::Mode;

use super::autonomous::NEAR_SPEED;
use super::mission::{Mission, Phase, Progress, View};
use super::stick_dynamics::StickTarget;
use crate::scenario::Assist;

/// Throttle at which the paper's vehicle surely leaves the ground.
const TAKE_OFF: f64 = 0.85;
/// Throttle rate while taking up or setting down the weight, 1/s.
const TAKE_UP: f64 = 0.3;
const GIVE_BACK: f64 = 0.6;
/// Rise (m) and speed (m/s) that count as flying.
const RISEN: f64 = 0.08;
const RISING: f64 = 0.2;
/// Height error (m) and speed (m/s) that count as reached.
const REACHED: f64 = 0.15;
const REACHED_SPEED: f64 = 0.25;
/// Time after which [`NEAR_SPEED`] suffices if HOLD takes over at the pipe, s.
const PATIENCE: f64 = 12.0;
/// Rates of descent, m/s: high up, and below [`LAST_BIT`].
const DESCENT: f64 = 0.4;
const LAST_DESCENT: f64 = 0.2;
/// Height over the ground of the slow descent, m.
const LAST_BIT: f64 = 0.8;
/// Height below which a vehicle without sink rate stands, m.
const STANDS: f64 = 0.4;
/// Sink rate of a standing vehicle, m/s, and how long it must last, s.
const STOPPED: f64 = 0.06;
const STOPPED_TIME: f64 = 0.5;
/// Time with the arm switch off, s.
const SWITCH_OFF: f64 = 0.5;
/// Duration of the arming gesture, and its repeat period, s.
const GESTURE: f64 = 2.0;
const GESTURE_AGAIN: f64 = 3.0;

impl Mission {
    pub(super) fn arm(&mut self, v: &View<'_>) -> Progress {
        match (self.phase, v.mode) {
            // Still on after a restart: it must have been off.
            (Phase::Start, Some(Mode::Disarmed)) if self.arm_switch => {
                self.arm_switch = false;
                self.enter(Phase::Throttle);
                Progress::Going(StickTarget::default())
            }
            (Phase::Start, Some(Mode::Disarmed)) | (Phase::Throttle, _)
                if self.phase == Phase::Start || self.phase_time > SWITCH_OFF =>
            {
                self.arm_switch = true;
                self.enter(Phase::Gesture);
                Progress::Going(StickTarget::default())
            }
            (Phase::Gesture, Some(Mode::Armed | Mode::Perched)) => {
                self.enter(Phase::Wait);
                Progress::Going(StickTarget::default())
            }
            (Phase::Gesture, _) => Progress::Going(StickTarget {
                // Refused: centre the stick and retry.
                yaw: if self.phase_time % GESTURE_AGAIN < GESTURE {
                    1.0
                } else {
                    0.0
                },
                ..Default::default()
            }),
            (Phase::Wait, _) if self.phase_time > 0.5 => Progress::Done(StickTarget::default()),
            _ => Progress::Going(StickTarget::default()),
        }
    }

    pub(super) fn take_off(&mut self, v: &View<'_>, height: f64, dt: f64) -> Progress {
        if self.phase == Phase::Start {
            if self.step_time <= dt {
                self.spot = v.seen.position.truncate();
                self.throttle = 0.0;
            }
            let risen = v.height() > self.height + RISEN || v.seen.velocity.z < -RISING;
            if !risen {
                let s = self.guidance.strength();
                return Progress::Going(self.throttle_to((TAKE_OFF * s).min(1.0), TAKE_UP * s, dt));
            }
            self.enter(Phase::Fly);
        }
        let target = self.go_to(v, self.spot, height, dt);
        // Gusts may keep the pilot from settling; HOLD settles at the pipe.
        let patient = self.assist != Assist::Autonomous || self.step_time < PATIENCE;
        let speed = if patient { REACHED_SPEED } else { NEAR_SPEED };
        let there = (v.height() - height).abs() < REACHED && v.seen.velocity.length() < speed;
        if self.held_for(there, 1.0, dt) {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    pub(super) fn land(&mut self, v: &View<'_>, dt: f64) -> Progress {
        match self.phase {
            Phase::Throttle => {
                let target = self.throttle_to(0.0, GIVE_BACK, dt);
                let stands = matches!(v.mode, Some(Mode::Landed | Mode::Disarmed));
                if stands && self.throttle <= 0.0 {
                    Progress::Done(target)
                } else {
                    Progress::Going(target)
                }
            }
            _ => {
                if self.phase == Phase::Start {
                    self.spot = v.seen.position.truncate();
                    self.enter(Phase::Descend);
                }
                let rate = if v.height() > LAST_BIT {
                    DESCENT
                } else {
                    LAST_DESCENT
                };
                let target = self.climb_over(v, self.spot, -rate, dt);
                let stands = v.height() < STANDS && v.seen.velocity.z.abs() < STOPPED;
                // A failsafe or the vehicle itself may have ended the flight.
                let over = matches!(v.mode, Some(Mode::Landed | Mode::Disarmed));
                if self.held_for(stands || over, STOPPED_TIME, dt) {
                    self.throttle = target.throttle;
                    self.enter(Phase::Throttle);
                }
                Progress::Going(target)
            }
        }
    }

    pub(super) fn disarm(&mut self, v: &View<'_>) -> Progress {
        match (self.phase, v.mode) {
            (Phase::Wait, Some(Mode::Disarmed)) if self.phase_time > 0.5 => {
                Progress::Done(StickTarget::default())
            }
            (Phase::Wait, _) => Progress::Going(StickTarget::default()),
            (_, Some(Mode::Disarmed)) => {
                self.arm_switch = false;
                self.enter(Phase::Wait);
                Progress::Going(StickTarget::default())
            }
            _ => Progress::Going(StickTarget {
                yaw: -1.0,
                ..Default::default()
            }),
        }
    }
}
