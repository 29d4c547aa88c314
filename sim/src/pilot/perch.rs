//! Steps at the pipe: fly over it, touch, perch, hold, release.

use sophie_control::mode::{Mode, Reason};
use sophie_control::params::Params;

use super::guidance::Guidance;
use super::mission::{Mission, Phase, Progress, View};
use super::stick_dynamics::StickTarget;

/// Height over the pipe at the start of the descent and after a release, m.
const OVER: f64 = 1.0;
/// Height over the pipe to which a missed approach goes up again, m.
const OVER_AGAIN: f64 = 0.4;
/// Distance, m, speed, m/s, and time, s, within which the vehicle counts as over the pipe; the descent corrects the
/// rest.
const SETTLED: f64 = 0.20;
const SETTLED_SPEED: f64 = 0.20;
const SETTLED_TIME: f64 = 1.5;
/// Time after which distance and speed may be larger, in proportion to the time, and how often as large at most: in gusts
/// he descends from where he gets to.
const SETTLING: f64 = 12.0;
const UNSETTLED: f64 = 2.0;
/// Rates of descent, m/s: to the gate over the pipe, and from there onto it.
const DESCENT: f64 = 0.15;
const LAST_DESCENT: f64 = 0.25;
/// Height of the centre of mass over the pipe's top at the gate, where the pilot waits until he is over the
/// crown, and the height at which the belly touches, m. Lower, the pipe's ground effect throws the vehicle aside while he waits.
const GATE: f64 = 0.16;
const BELLY: f64 = 0.05;
/// Share of the tolerances that applies at the gate at first, and the time, s, over which it grows to 1.
const STRICT: f64 = 0.6;
const PATIENCE: f64 = 25.0;
/// Time of the last descent, s, and time for which the vehicle must stay within the tolerances, s.
const LAST_TIME: f64 = 0.5;
const CENTRED_TIME: f64 = 0.15;
/// Tolerance on the last descent, share of that at the gate: larger, since a go-around costs more than an error of the
/// eye.
const COMMITTED: f64 = 1.3;
/// Largest distance along the pipe from the spot, m.
const ALONG: f64 = 0.25;
/// Height over the pipe below which the distance is checked, m, and the distance that calls for a go-around, m.
const NEAR: f64 = 0.4;
const ASTRAY: f64 = 0.20;
/// Distance from the spot at which he descends again, m: well within [`ASTRAY`], or one gust would cost every try.
const BACK: f64 = 0.10;
/// Distance beside the crown beyond which a vehicle slides off, share of the pipe's radius.
const SLIPPING: f64 = 0.33;
/// Height over the pipe below which a vehicle without sink rate stands on it, m.
const STANDS: f64 = 0.12;
/// Depth of the centre of mass below the pipe's top by which it was missed, m.
const MISSED: f64 = 0.05;
/// Sink rate of a vehicle that stands, m/s, and the time for which it must last, s.
const STOPPED: f64 = 0.05;
const STOPPED_TIME: f64 = 0.3;
/// Throttle at which the vehicle stands firmly, and the speed at which it is set, 1/s: with nearly all of the
/// weight on the rotors the slightest lean makes it slide.
const FIRM_THROTTLE: f64 = 0.36;
const FIRM_EASE: f64 = 0.5;
/// Tries after which the pilot gives up, and those of a grip that the vehicle itself has given up.
const TRIES: u32 = 8;
const GRIPS: u32 = 3;
/// Speed of the throttle on the pipe, 1/s.
const EASE: f64 = 0.25;
/// Throttle at which the arms are opened: enough to steer by, but most of the weight still presses the belly onto
/// the pipe. The more thrust, the more of it pushes a leaning vehicle off the crown.
const RELEASE_THROTTLE: f64 = 0.25;
/// The same at least: below 0.20 the stack opens nothing, whatever the rotors' strength.
const RELEASE_LEAST: f64 = 0.21;
/// Displays after which the pilot comes down nearer to the crown.
const BESIDE: [Reason; 2] = [Reason::SlidesOff, Reason::LeansToStay];
/// Displayed reasons for which a perched vehicle refuses the release, and the time for which they must last, s.
const TROUBLES: [Reason; 2] = [Reason::BatteryCritical, Reason::RADIO_LOST];
const REFUSED_TIME: f64 = 3.0;
/// Drop below its standing height at which the vehicle has slid off, m.
const SUNK: f64 = 0.06;
/// Longest time with a lost grip on the display, s.
const GRIP_LOST_TIME: f64 = 1.0;
/// Rise at which the vehicle is clear of the pipe and the sticks are used again, m.
const CLEAR: f64 = 0.06;

/// Throttle while closing: that of the scenario, limited with strong rotors (`lightly` below 1) so that the vehicle
/// stays on the pipe.
fn closing_throttle(lightly: f64, wanted: f64) -> f64 {
    if lightly < 1.0 {
        wanted.min(FIRM_THROTTLE * lightly)
    } else {
        wanted
    }
}

/// Throttle at which the arms of a vehicle with `params` close for the scenario's `wanted`, 0..1.
pub fn throttle_on_pipe(params: &Params, wanted: f64) -> f64 {
    closing_throttle(Guidance::strength_of(params).min(1.0), wanted).min(f64::from(params.perch_thr_max))
}

impl Mission {
    /// Factor on the throttles on the pipe: below 1 with stronger rotors, which would lift the vehicle off; at most 1,
    /// since the stack reads a throttle above `perch_thr_max` as a departure.
    fn lightly(&self) -> f64 {
        self.guidance.strength().min(1.0)
    }

    /// The throttle while closing.
    fn closing(&self, wanted: f64) -> f64 {
        closing_throttle(self.lightly(), wanted)
    }

    pub(super) fn fly_to_pipe(&mut self, v: &View<'_>, dt: f64) -> Progress {
        let target = self.go_to(v, self.pipe, self.pipe_top + OVER, dt);
        let share = (self.step_time / SETTLING).clamp(1.0, UNSETTLED);
        if self.settled(v, share, dt) {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    /// Whether the vehicle is over the pipe, within `share` of the distance and speed.
    fn settled(&mut self, v: &View<'_>, share: f64, dt: f64) -> bool {
        let off = libm::hypot(
            (v.seen.position.truncate() - self.pipe).length(),
            v.height() - self.pipe_top - OVER,
        );
        let there = off < share * SETTLED && v.seen.velocity.length() < share * SETTLED_SPEED;
        self.held_for(there, SETTLED_TIME, dt)
    }

    pub(super) fn touch(&mut self, v: &View<'_>, stick: f64, dt: f64) -> Progress {
        let (target, on_pipe) = self.approach(v, stick, dt);
        if self.missed >= TRIES {
            return Progress::Failed(format!(
                "missed the pipe {TRIES} times, last {:.2} m beside it",
                (v.seen.position.y - self.pipe.y).abs()
            ));
        }
        if on_pipe {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    /// Descends onto the pipe and climbs for another try if it would miss. True once the pipe carries the vehicle.
    /// `throttle` is the position of that stick.
    fn approach(&mut self, v: &View<'_>, throttle: f64, dt: f64) -> (StickTarget, bool) {
        let over = v.height() - self.pipe_top;
        let off = v.seen.position.truncate() - self.pipe;
        if self.phase == Phase::GoAround {
            let target = self.go_to(v, self.pipe, self.pipe_top + OVER_AGAIN, dt);
            if over > 0.75 * OVER_AGAIN && off.length() < BACK {
                self.enter(Phase::Descend);
            }
            return (target, false);
        }
        let (position, velocity) = self.guidance.ahead();
        let away = position.truncate() - self.pipe;
        let over_ahead = -position.z - self.pipe_top;
        let astray = over < NEAR && (off.y.abs() > ASTRAY || off.x.abs() > 2.0 * ALONG);
        let slips = self.phase == Phase::Plant && off.y.abs() > SLIPPING * self.pipe_radius;
        if astray || slips || over < -MISSED {
            // A go-around without a touch costs only time.
            self.missed += u32::from(self.phase == Phase::Plant || over < -MISSED);
            self.enter(Phase::GoAround);
        }
        match self.phase {
            Phase::Commit => {
                let outside =
                    away.y.abs() > COMMITTED * self.within || velocity.y.abs() > COMMITTED * self.drift;
                if outside && over_ahead > BELLY + 0.02 {
                    self.enter(Phase::Descend);
                } else if over_ahead < BELLY {
                    self.throttle = throttle;
                    self.enter(Phase::Plant);
                }
                (self.climb_over(v, self.pipe, -LAST_DESCENT, dt), false)
            }
            Phase::Plant => self.plant(v, dt),
            Phase::GoAround => (self.climb_over(v, self.pipe, DESCENT, dt), false),
            _ => {
                if self.phase != Phase::Descend {
                    self.enter(Phase::Descend);
                }
                let share = (STRICT + (1.0 - STRICT) * self.phase_time / PATIENCE).min(1.0);
                let (within, drift) = (share * self.within, share * self.drift);
                let centred = away.y.abs() < within
                    && (away.y + LAST_TIME * velocity.y).abs() < within
                    && velocity.y.abs() < drift
                    && away.x.abs() < ALONG
                    && velocity.x.abs() < 2.0 * drift;
                let at_gate = over_ahead < 1.5 * GATE;
                if self.held_for(at_gate && centred, CENTRED_TIME, dt) {
                    self.enter(Phase::Commit);
                }
                let rate = (1.5 * (GATE - over_ahead)).clamp(-DESCENT, DESCENT);
                (self.climb_over(v, self.pipe, rate, dt), false)
            }
        }
    }

    /// Puts the weight onto the pipe, the sticks at their trim. True once the pipe carries.
    fn plant(&mut self, v: &View<'_>, dt: f64) -> (StickTarget, bool) {
        let (firm, firm_ease) = (FIRM_THROTTLE * self.lightly(), FIRM_EASE * self.lightly());
        let stands = v.height() - self.pipe_top < STANDS && v.seen.velocity.z.abs() < STOPPED;
        // Most of the weight is still on the rotors: without the trim it would slide.
        let (roll, pitch) = self.guidance.trim(&v.seen);
        let target = StickTarget {
            roll,
            pitch,
            ..self.throttle_to(firm, firm_ease, dt)
        };
        let on_pipe = self.held_for(stands && self.throttle <= firm, STOPPED_TIME, dt);
        if on_pipe {
            self.height = v.height();
        }
        (target, on_pipe)
    }

    pub(super) fn clamp(&mut self, v: &View<'_>, throttle: f64, stick: f64, dt: f64) -> Progress {
        match self.perch(v, throttle, stick, dt) {
            Progress::Going(target) if v.mode == Some(Mode::Clamping) => Progress::Done(target),
            other => other,
        }
    }

    pub(super) fn perch(&mut self, v: &View<'_>, throttle: f64, stick: f64, dt: f64) -> Progress {
        if matches!(
            self.phase,
            Phase::GoAround | Phase::Descend | Phase::Commit | Phase::Plant
        ) {
            let (target, on_pipe) = self.approach(v, stick, dt);
            if on_pipe {
                self.enter(Phase::Throttle);
            }
            return Progress::Going(target);
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
        let slips = self.phase == Phase::Throttle
            && (beside > SLIPPING * self.pipe_radius || v.height() < self.height - SUNK);
        let left = v.mode == Some(Mode::Escaping) && BESIDE.iter().any(|why| v.shows(*why));
        if slips || left {
            self.perch_switch = false;
            self.missed += 1;
            if self.missed >= TRIES {
                return Progress::Failed(format!(
                    "slid off the pipe {TRIES} times, last {beside:.2} m beside it"
                ));
            }
            self.enter(Phase::GoAround);
        }
        if self.phase == Phase::Wait && v.mode == Some(Mode::Escaping) && self.grips + 1 < GRIPS {
            self.perch_switch = false;
            self.grips += 1;
            self.enter(Phase::GoAround);
        }
        if self.phase == Phase::Wait
            && matches!(
                v.mode,
                Some(Mode::Releasing | Mode::Escaping | Mode::Flight | Mode::Failsafe)
            )
        {
            return Progress::Failed(format!("no proven grip, {}", v.shown()));
        }
        let perched = v.mode == Some(Mode::Perched);
        let throttle = if perched { 0.0 } else { self.closing(throttle) };
        let target = self.throttle_to(throttle, EASE * self.lightly(), dt);
        if perched && self.throttle <= 0.0 {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    pub(super) fn hold(&mut self, v: &View<'_>, seconds: f64, dt: f64) -> Progress {
        if v.mode != Some(Mode::Perched) {
            return Progress::Failed(format!(
                "no longer perched after {:.1} s, {}",
                self.step_time,
                v.shown()
            ));
        }
        if self.held_for(v.shows(Reason::GripLost), GRIP_LOST_TIME, dt) {
            return Progress::Failed(format!("grip lost after {:.1} s", self.step_time));
        }
        let target = StickTarget::default();
        if self.step_time >= seconds {
            Progress::Done(target)
        } else {
            Progress::Going(target)
        }
    }

    pub(super) fn open(&mut self, v: &View<'_>, dt: f64) -> Progress {
        match self.release(v, dt) {
            Progress::Going(target) if v.mode == Some(Mode::Releasing) => Progress::Done(target),
            other => other,
        }
    }

    pub(super) fn release(&mut self, v: &View<'_>, dt: f64) -> Progress {
        let (opening, ease) = (
            (RELEASE_THROTTLE * self.lightly()).max(RELEASE_LEAST),
            EASE * self.lightly(),
        );
        match self.phase {
            Phase::Start if v.mode == Some(Mode::Releasing) => {
                self.enter(Phase::Wait);
                Progress::Going(self.throttle_to(opening, ease, dt))
            }
            Phase::Start | Phase::Throttle => {
                if self.phase == Phase::Start {
                    self.throttle = 0.0;
                    // After a reset during a release the switch is off already; it must be on before off counts.
                    self.perch_switch = true;
                    self.enter(Phase::Throttle);
                }
                let target = self.throttle_to(opening, ease, dt);
                if self.held_for(self.throttle >= opening, 0.5, dt) {
                    self.perch_switch = false;
                    self.enter(Phase::Wait);
                }
                Progress::Going(target)
            }
            Phase::Wait => {
                if matches!(v.mode, Some(Mode::Flight | Mode::Escaping)) {
                    self.height = v.height();
                    self.spot = v.seen.position.truncate();
                    self.enter(Phase::Fly);
                }
                let refused = v.mode == Some(Mode::Perched) && TROUBLES.iter().any(|&why| v.shows(why));
                if self.held_for(refused, REFUSED_TIME, dt) {
                    return Progress::Failed(format!("arms not opened, {}", v.shown()));
                }
                Progress::Going(self.throttle_to(opening, ease, dt))
            }
            _ => {
                let mut target = self.go_to(v, self.spot, self.height + OVER, dt);
                if v.height() < self.height + CLEAR {
                    (target.roll, target.pitch, target.yaw) = (0.0, 0.0, 0.0);
                }
                let there = (v.height() - self.height - OVER).abs() < 0.2 && v.seen.velocity.length() < 0.3;
                if self.held_for(there, 0.5, dt) {
                    Progress::Done(target)
                } else {
                    Progress::Going(target)
                }
            }
        }
    }
}
