//! Steps without a link: transmitter off, recovery from the failsafe, restart of the board.

use sophie_control::mode::{Mode, Reason};

use super::mission::{Mission, Phase, Progress, View};
use super::stick_dynamics::StickTarget;
use crate::scenario::Step;

/// Roll stick that takes the vehicle over, share of its travel: beyond the 0.3 that ends the failsafe.
const TAKE_OVER: f64 = 0.45;
/// Time that a restarted vehicle must be displayed, s.
const SHOWN: f64 = 1.0;

impl Mission {
    /// Sticks centred, throttle held at its position `throttle`: the link returns to unchanged sticks.
    pub(super) fn radio_off(&mut self, v: &View<'_>, seconds: f64, throttle: f64) -> Progress {
        if self.phase == Phase::Start {
            self.throttle = throttle;
            self.enter(Phase::Silent);
        }
        if self.step_time >= seconds && self.phase == Phase::Silent {
            self.enter(Phase::Wait);
        }
        let target = StickTarget {
            throttle: self.throttle,
            ..StickTarget::default()
        };
        if self.phase == Phase::Wait && v.mode.is_some() {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    /// Sticks centred, throttle and switches held, until the vehicle reports disarmed; reports before `over` s do not
    /// count.
    pub(super) fn reset(&mut self, v: &View<'_>, over: f64, throttle: f64, dt: f64) -> Progress {
        if self.phase == Phase::Start {
            self.throttle = throttle;
            self.enter(Phase::Wait);
        }
        let target = StickTarget {
            throttle: self.throttle,
            ..StickTarget::default()
        };
        let disarmed = self.step_time > over + SHOWN && v.mode == Some(Mode::Disarmed);
        if self.held_for(disarmed, SHOWN, dt) {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    /// Sticks that take back a vehicle sinking without radio.
    pub(super) fn take_over(step: &Step, v: &View<'_>, target: StickTarget) -> StickTarget {
        let flies = matches!(step, Step::Hover { .. } | Step::FlyTo { .. });
        if flies && v.mode == Some(Mode::Failsafe) && v.shows(Reason::RADIO_LOST) {
            StickTarget {
                roll: TAKE_OVER,
                ..target
            }
        } else {
            target
        }
    }
}
