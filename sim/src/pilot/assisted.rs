//! Steps flown in the mode HOLD: the pilot turns its switch on, then centres the sticks or commands velocities, and
//! flies by hand if the vehicle leaves the mode.

use glam::DVec2;
use sophie_control::mode::Mode;
use sophie_control::position_hold::{CLIMB_MAX, SPEED_MAX};

use super::free_flight::{REACHED, REACHED_SPEED};
use super::mission::{Mission, Phase, Progress, View};
use super::stick_dynamics::StickTarget;

/// Throttle of the centred stick, and the half width of its zone without a climb with some margin.
pub(super) const CENTRE: f64 = 0.5;
const ZONE: f64 = 0.1;
/// Distance to velocity, 1/s.
const GAIN: f64 = 0.6;
/// Largest commanded speed, m/s.
const SPEED: f64 = 1.0;
/// Time with the switch off before another try, s, and for which he waits for the display, s.
const SWITCH_OFF: f64 = 1.0;
const PATIENCE: f64 = 5.0;

impl Mission {
    pub(super) fn hover_held(&mut self, v: &View<'_>, seconds: f64, dt: f64) -> Progress {
        if self.phase == Phase::Start && self.step_time <= dt {
            self.spot = v.seen.position.truncate();
        }
        match self.enter_hold(v, self.spot, self.height, dt) {
            Err(progress) => progress,
            Ok(()) => {
                let target = self.centred(v);
                if self.held_for(true, seconds, dt) {
                    self.hold_switch = false;
                    Progress::Done(target)
                } else {
                    Progress::Going(target)
                }
            }
        }
    }

    pub(super) fn fly_to_held(&mut self, v: &View<'_>, target: DVec2, height: f64, dt: f64) -> Progress {
        if self.phase == Phase::Start && self.step_time <= dt {
            self.spot = v.seen.position.truncate();
        }
        if let Err(progress) = self.enter_hold(v, self.spot, self.height, dt) {
            return progress;
        }
        let away = target - v.seen.position.truncate();
        let velocity = (away * GAIN).clamp_length_max(SPEED);
        let body = DVec2::from_angle(-v.seen.yaw).rotate(velocity) / f64::from(SPEED_MAX);
        let climb = (GAIN * (height - v.height()) / f64::from(CLIMB_MAX)).clamp(-1.0, 1.0);
        let zone = if climb.abs() < 0.05 {
            0.0
        } else {
            ZONE.copysign(climb)
        };
        let target = StickTarget {
            roll: body.y,
            pitch: -body.x,
            throttle: CENTRE + zone + climb * (CENTRE - ZONE),
            ..self.centred(v)
        };
        let off = libm::hypot(away.length(), v.height() - height);
        let there = off < REACHED && v.seen.velocity.length() < REACHED_SPEED;
        if self.held_for(there, 1.0, dt) {
            self.hold_switch = false;
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    /// Flies by hand at `spot` until the display shows the hold.
    pub(super) fn enter_hold(
        &mut self,
        v: &View<'_>,
        spot: DVec2,
        height: f64,
        dt: f64,
    ) -> Result<(), Progress> {
        match (self.phase, v.mode) {
            (Phase::Fly, Some(Mode::Hold)) => return Ok(()),
            (Phase::Wait, Some(Mode::Hold)) => {
                self.enter(Phase::Fly);
                return Ok(());
            }
            (Phase::Wait, _) if self.phase_time > PATIENCE => {
                return Err(Progress::Failed(format!("no hold, {}", v.shown())));
            }
            (Phase::Wait, _) => (),
            // HOLD was lost: fly by hand with the switch off, then retry.
            (Phase::Fly, _) => {
                self.hold_switch = false;
                self.enter(Phase::Start);
            }
            _ if self.phase_time >= SWITCH_OFF => {
                self.hold_switch = true;
                self.enter(Phase::Wait);
            }
            _ => (),
        }
        Err(Progress::Going(self.go_to(v, spot, height, dt)))
    }

    /// Centres the sticks except for the heading; the throttle continues from there.
    fn centred(&mut self, v: &View<'_>) -> StickTarget {
        self.guidance.stand(CENTRE);
        StickTarget {
            yaw: self.guidance.rudder(&v.seen, self.heading, 0.0),
            throttle: CENTRE,
            ..StickTarget::default()
        }
    }
}
