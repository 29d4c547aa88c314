//! State and helpers that all steps of a mission share.

use glam::DVec2;
use sophie_control::mode::{Mode, Reason};

use super::guidance::{Course, Guidance, Vertical};
use super::limits;
use super::stick_dynamics::StickTarget;
use super::{VisibleState, wrap};
use crate::scenario::{Assist, Scenario, Step};

/// Heading flown unless a step turns the vehicle, rad: north, along the pipe.
const HEADING: f64 = 0.0;
/// Speed at which the nose is swept round, rad/s.
const SWEEP: f64 = 0.5;
/// Distance beside the crown within which the capture map holds careful touches, share of the pipe's diameter
/// (docs/results.md).
const WITHIN: f64 = 0.1;

/// Inputs of a step.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Delayed, noisy state.
    pub seen: VisibleState,
    /// Time now, s.
    pub now: f64,
    /// Mode read from the display.
    pub mode: Option<Mode>,
    /// Text beside the mode: reason or warning.
    pub text: &'a str,
}

impl View<'_> {
    /// Height over the ground, m.
    pub fn height(&self) -> f64 {
        -self.seen.position.z
    }

    /// Whether the display shows `reason`.
    pub fn shows(&self, reason: Reason) -> bool {
        self.text == reason.text()
    }

    /// The mode as displayed.
    pub fn shown(&self) -> String {
        let name = self.mode.map_or("nothing", Mode::name);
        if self.text.is_empty() {
            format!("display {name}")
        } else {
            format!("display {name}: {}", self.text)
        }
    }
}

/// Progress of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Progress {
    /// Under way, with stick targets.
    Going(StickTarget),
    /// Done, with stick targets.
    Done(StickTarget),
    /// Failed, with the reason in one line.
    Failed(String),
}

/// Phase of a step; a step uses those that it needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Just begun.
    Start,
    /// Arming or disarming gesture.
    Gesture,
    /// Waiting for the display.
    Wait,
    /// Flying to the step's target.
    Fly,
    /// Leaning right, then left.
    Right,
    /// See [`Phase::Right`].
    Left,
    /// Descending to the ground, or to the gate over the pipe.
    Descend,
    /// From the gate onto the pipe.
    Commit,
    /// Sticks at trim, weight onto the pipe.
    Plant,
    /// Moving the throttle to its goal.
    Throttle,
    /// Climbing for another try.
    GoAround,
    /// The transmitter is off.
    Silent,
}

/// The pilot's state over a mission.
#[derive(Clone, Debug)]
pub struct Mission {
    pub(super) guidance: Guidance,
    pub(super) pipe: DVec2,
    pub(super) pipe_top: f64,
    pub(super) pipe_radius: f64,
    /// Largest distance from the crown at the touch, m, and largest drift across the pipe, m/s.
    pub(super) within: f64,
    pub(super) drift: f64,
    pub(super) stick_angle: f64,
    pub(super) arm_switch: bool,
    pub(super) perch_switch: bool,
    pub(super) hold_switch: bool,
    /// Heading flown now, and the one that it is swept to, rad.
    pub(super) heading: f64,
    pub(super) heading_goal: f64,
    pub(super) assist: Assist,
    pub(super) phase: Phase,
    /// Time since the step and the phase began, s.
    pub(super) step_time: f64,
    pub(super) phase_time: f64,
    /// Time for which the awaited condition has been true, s.
    pub(super) held: f64,
    /// Point to hold: north, east, m; height at the step's beginning.
    pub(super) spot: DVec2,
    pub(super) height: f64,
    /// Throttle set by hand when not flying.
    pub(super) throttle: f64,
    /// Number of failed touches, and of grips that the vehicle has given up.
    pub(super) missed: u32,
    pub(super) grips: u32,
    /// The displayed reason of the failsafe that ended the flight.
    pub(super) trouble: Option<String>,
}

impl Mission {
    /// A pilot for `scenario`.
    pub fn new(scenario: &Scenario) -> Self {
        let pipe = scenario.pilot.assumed.pipe(&scenario.world);
        Self {
            guidance: Guidance::new(scenario),
            pipe: DVec2::from_array(pipe.position),
            pipe_top: pipe.top,
            pipe_radius: 0.5 * pipe.diameter,
            within: scenario.pilot.touch_within.unwrap_or(WITHIN * pipe.diameter),
            drift: scenario.pilot.touch_drift,
            stick_angle: f64::from(scenario.params.stick_angle),
            arm_switch: false,
            perch_switch: false,
            hold_switch: false,
            heading: HEADING,
            heading_goal: HEADING,
            assist: scenario.pilot.assist,
            phase: Phase::Start,
            step_time: 0.0,
            phase_time: 0.0,
            held: 0.0,
            spot: DVec2::ZERO,
            height: 0.0,
            throttle: 0.0,
            missed: 0,
            grips: 0,
            trouble: None,
        }
    }

    /// The transmitter is on.
    pub fn transmits(&self) -> bool {
        self.phase != Phase::Silent
    }

    /// Begins a step.
    pub fn begin(&mut self, seen: &VisibleState) {
        // An autonomous vehicle reads a switch turned off as a change to flight by hand.
        self.hold_switch &= self.assist == Assist::Autonomous;
        self.enter(Phase::Start);
        self.step_time = 0.0;
        (self.missed, self.grips) = (0, 0);
        self.height = -seen.position.z;
    }

    /// Flies `step` for `dt` s from stick positions `sticks` (roll, pitch, yaw, throttle).
    pub fn fly(&mut self, step: &Step, view: &View<'_>, sticks: [f64; 4], dt: f64) -> Progress {
        self.step_time += dt;
        self.phase_time += dt;
        self.guidance.foresee(&view.seen, view.now, sticks, dt);
        match view.mode {
            Some(Mode::Failsafe) if self.trouble.is_none() => self.trouble = Some(view.text.to_owned()),
            Some(Mode::Flight | Mode::Hold | Mode::Approach) => self.trouble = None,
            _ => (),
        }
        if let Some(why) = self.stopped(step, view) {
            return Progress::Failed(why);
        }
        if matches!(step, Step::FlyToPipe) {
            self.heading_goal = HEADING;
        }
        self.sweep(dt);
        let progress = match *step {
            Step::Arm => self.arm(view),
            Step::TakeOff { height } => self.take_off(view, height, dt),
            Step::Hover { seconds } if self.assist == Assist::Hold => self.hover_held(view, seconds, dt),
            Step::FlyTo { north, east, height } if self.assist == Assist::Hold => {
                self.fly_to_held(view, DVec2::new(north, east), height, dt)
            }
            Step::FlyToPipe if self.assist == Assist::Autonomous => self.fly_to_pipe_held(view, dt),
            Step::Touch | Step::Clamp { .. } | Step::Perch { .. } if self.assist == Assist::Autonomous => {
                self.perch_autonomously(step, view, dt)
            }
            Step::Hold { seconds, lapse, .. } if self.assist == Assist::Autonomous => {
                let held = self.hold(view, Step::hold_time(seconds, lapse), dt);
                self.hands_off(held)
            }
            Step::Open | Step::Release if self.assist == Assist::Autonomous => {
                self.release_autonomously(step, view, dt)
            }
            Step::Hover { seconds } => self.hover(view, seconds, dt),
            Step::Yaw { heading, seconds } => self.yaw(view, heading, seconds, dt),
            Step::Roll { angle, seconds } => self.roll(view, angle, seconds, dt),
            Step::FlyTo { north, east, height } => self.fly_to(view, DVec2::new(north, east), height, dt),
            Step::FlyToPipe => self.fly_to_pipe(view, dt),
            Step::Touch => self.touch(view, sticks[3], dt),
            Step::Clamp { throttle } => self.clamp(view, throttle, sticks[3], dt),
            Step::Perch { throttle } => self.perch(view, throttle, sticks[3], dt),
            Step::Hold { seconds, lapse, .. } => self.hold(view, Step::hold_time(seconds, lapse), dt),
            Step::Open => self.open(view, dt),
            Step::Release => self.release(view, dt),
            Step::Land => self.land(view, dt),
            Step::Disarm => self.disarm(view),
            Step::RadioOff { seconds } => self.radio_off(view, seconds, sticks[3]),
            Step::Reset { after, off, .. } => self.reset(view, after + off, sticks[3], dt),
        };
        let limit = limits::of(step, self.assist);
        match progress {
            Progress::Going(_) if self.step_time > limit => Progress::Failed(format!(
                "not done after {limit:.0} s: {}",
                self.shortfall(step, view)
            )),
            Progress::Going(target) => Progress::Going(self.switches(Self::take_over(step, view, target))),
            Progress::Done(target) => Progress::Done(self.switches(target)),
            failed @ Progress::Failed(_) => failed,
        }
    }

    /// Reason to end a step that needs rotors: they stand still. Until then the pilot steers, even in a failsafe.
    fn stopped(&self, step: &Step, v: &View<'_>) -> Option<String> {
        let rotors = match step {
            Step::TakeOff { .. }
            | Step::Hover { .. }
            | Step::Roll { .. }
            | Step::Yaw { .. }
            | Step::FlyTo { .. }
            | Step::FlyToPipe
            | Step::Touch
            | Step::Clamp { .. }
            | Step::Perch { .. }
            | Step::Open
            | Step::Release => true,
            // Steps that end with stopped rotors, or start with them.
            Step::Arm
            | Step::Hold { .. }
            | Step::Land
            | Step::Disarm
            | Step::RadioOff { .. }
            | Step::Reset { .. } => false,
        };
        let stopped = rotors && v.mode == Some(Mode::Disarmed);
        stopped.then(|| {
            let after = self.trouble.as_ref().map(|why| format!("failsafe, {why}: "));
            let on_pipe = v.height() > self.pipe_top && matches!(self.phase, Phase::Throttle | Phase::Wait);
            let place = if on_pipe {
                "on the pipe".to_owned()
            } else {
                format!("at a height of {:.2} m", v.height())
            };
            format!(
                "{}rotors stopped {place}, {}",
                after.unwrap_or_default(),
                v.shown()
            )
        })
    }

    fn switches(&self, target: StickTarget) -> StickTarget {
        StickTarget {
            arm_switch: self.arm_switch,
            perch_switch: self.perch_switch,
            hold_switch: self.hold_switch,
            ..target
        }
    }

    pub(super) fn enter(&mut self, phase: Phase) {
        self.phase = phase;
        self.phase_time = 0.0;
        self.held = 0.0;
    }

    /// True once `holds` has been true for `seconds`.
    pub(super) fn held_for(&mut self, holds: bool, seconds: f64, dt: f64) -> bool {
        self.held = if holds { self.held + dt } else { 0.0 };
        self.held >= seconds
    }

    pub(super) fn go_to(&mut self, v: &View<'_>, target: DVec2, height: f64, dt: f64) -> StickTarget {
        let course = self.course(target, Vertical::Height(height));
        self.guidance.steer(&v.seen, &course, dt)
    }

    /// Climbs at `rate` m/s over `target`; negative: sinks.
    pub(super) fn climb_over(&mut self, v: &View<'_>, target: DVec2, rate: f64, dt: f64) -> StickTarget {
        let course = self.course(target, Vertical::Climb(rate));
        self.guidance.steer(&v.seen, &course, dt)
    }

    /// Sticks centred, throttle towards `goal` at `rate` 1/s.
    pub(super) fn throttle_to(&mut self, goal: f64, rate: f64, dt: f64) -> StickTarget {
        self.throttle += (goal - self.throttle).clamp(-rate * dt, rate * dt);
        self.guidance.stand(self.throttle);
        StickTarget {
            throttle: self.throttle,
            ..Default::default()
        }
    }

    /// Reason of a failure that names the value not reached.
    fn shortfall(&self, step: &Step, v: &View<'_>) -> String {
        let p = v.seen.position;
        let off = |target: DVec2| (p.truncate() - target).length();
        match *step {
            Step::TakeOff { height } => {
                format!("height {:.2} m of {height:.2} m, {}", v.height(), v.shown())
            }
            Step::Roll { .. } => {
                format!(
                    "{:.2} m off the spot at {:.2} m/s",
                    off(self.spot),
                    v.seen.velocity.length()
                )
            }
            Step::FlyToPipe | Step::Touch | Step::Clamp { .. } | Step::Perch { .. } => format!(
                "{:.2} m beside the spot, {:.2} m over the pipe, {} missed tries, {}",
                off(self.pipe),
                v.height() - self.pipe_top,
                self.missed,
                v.shown()
            ),
            Step::Yaw { heading, .. } => format!(
                "heading {:+.0} deg of {:+.0} deg",
                v.seen.yaw.to_degrees(),
                heading.to_degrees()
            ),
            Step::FlyTo { north, east, height } => {
                let away = libm::hypot(off(DVec2::new(north, east)), v.height() - height);
                format!("{away:.2} m from the point, {}", v.shown())
            }
            Step::Land => format!("height {:.2} m, {}", v.height(), v.shown()),
            _ => v.shown(),
        }
    }

    /// Moves the heading flown towards its goal for `dt` s.
    fn sweep(&mut self, dt: f64) {
        let left = wrap(self.heading_goal - self.heading);
        self.heading = wrap(self.heading + left.clamp(-SWEEP * dt, SWEEP * dt));
    }

    /// Speed at which the heading flown moves, rad/s.
    fn sweeping(&self) -> f64 {
        let left = wrap(self.heading_goal - self.heading);
        if left == 0.0 { 0.0 } else { SWEEP.copysign(left) }
    }

    /// To `target` (north, east, m), nose at the heading flown.
    fn course(&self, target: DVec2, vertical: Vertical) -> Course {
        Course {
            target,
            vertical,
            heading: self.heading,
            turning: self.sweeping(),
        }
    }
}
