//! The simulated pilot: flies the steps of a scenario with sticks alone.
//!
//! Inputs: the vehicle's position, velocity and attitude, late and with errors, and the transmitter's display, or the
//! vehicle's log without telemetry. Output: channel frames of the radio; the sticks move with a limited bandwidth.
//! Pilot and flight stack exchange no other data.

mod assisted;
mod autonomous;
mod free_flight;
mod guidance;
mod limits;
mod mission;
mod perception;
mod perch;
mod radio;
mod referee;
mod response;
mod stick_dynamics;
mod takeoff_landing;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod toy;

use std::collections::VecDeque;

use glam::DVec3;
use sophie_control::mode::Mode;
use sophie_control::pilot::rc::CHANNELS;

pub use self::guidance::{CLIMB_MAX, DESCENT_MAX};
use self::mission::{Mission, Progress, View};
use self::perception::Perception;
pub use self::perch::throttle_on_pipe;
use self::referee::Referee;
use self::stick_dynamics::{StickDynamics, StickTarget};
use crate::devices::crsf::{FRAME_HZ, Frame, Telemetry, rc_frame};
use crate::record::{Ended, Outcome};
use crate::scenario::{Scenario, Step};

/// The vehicle's true state that an observer on the ground sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VisibleState {
    /// Simulated time, s.
    pub t: f64,
    /// Position of the centre of mass, NED from the take-off point on the ground, m.
    pub position: DVec3,
    /// Velocity, NED, m/s.
    pub velocity: DVec3,
    /// Roll, right side down positive, rad.
    pub roll: f64,
    /// Pitch, nose up positive, rad.
    pub pitch: f64,
    /// Heading of the nose, clockwise from north, rad.
    pub yaw: f64,
}

/// A step of the mission began or ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepEvent {
    /// The step of this index began.
    Began(usize),
    /// The step of this index ended: done, or failed and the mission with it.
    Ended {
        /// Index in [`Scenario::steps`].
        index: usize,
        /// It was done.
        done: bool,
    },
}

/// Output of the pilot in one step of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PilotOutput {
    /// A channel frame from a receiver of CRSF, [`FRAME_HZ`] a second while the transmitter is on.
    pub rc_bytes: Option<Frame>,
    /// The same channels as sent over the air, for a receiver of another protocol.
    pub channels: Option<[u16; CHANNELS]>,
    /// Index of the step being flown; the number of steps once all are done.
    pub step: usize,
    /// Steps that began or ended just now.
    pub events: Vec<StepEvent>,
    /// Outcome of the mission, in the one call in which it ends.
    pub outcome: Option<Outcome>,
}

/// The pilot.
#[derive(Debug)]
pub struct Pilot {
    steps: Vec<Step>,
    index: usize,
    begun: bool,
    outcome: Option<Outcome>,
    /// Time since the last frame, s.
    elapsed: f64,
    telemetry: Telemetry,
    perception: Perception,
    /// Modes shown on the display over the last reaction time.
    display: VecDeque<Option<Mode>>,
    display_delay: usize,
    mission: Mission,
    sticks: StickDynamics,
    target: StickTarget,
    referee: Referee,
    /// Time of the permanent loss of the radio, s after power-up.
    radio_lost_at: f64,
    /// Time since power-up, s.
    now: f64,
}

impl Pilot {
    /// A pilot for `scenario`.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let limits = &scenario.pilot;
        Self {
            steps: scenario.steps.clone(),
            index: 0,
            begun: false,
            outcome: None,
            elapsed: 0.0,
            telemetry: Telemetry::default(),
            perception: Perception::new(limits.delay, limits.eye_noise, scenario.streams()),
            display: VecDeque::new(),
            display_delay: (limits.delay * FRAME_HZ) as usize,
            mission: Mission::new(scenario),
            sticks: StickDynamics::new(limits.bandwidth, scenario.arms),
            target: StickTarget::default(),
            referee: Referee::default(),
            radio_lost_at: scenario.faults.radio_at.unwrap_or(f64::INFINITY),
            now: 0.0,
        }
    }

    /// Advances by `dt` s (at most a few ms) with the visible state and the telemetry bytes of the vehicle.
    pub fn step(&mut self, dt: f64, seen: VisibleState, telemetry_bytes: &[u8]) -> PilotOutput {
        let mut out = PilotOutput {
            step: self.index,
            ..Default::default()
        };
        self.now = seen.t;
        if self.linked() {
            self.telemetry.take(telemetry_bytes);
        } else {
            self.telemetry.darken();
        }
        if self.outcome.is_none()
            && self.index > 0
            && let Some(why) = self.referee.judge(&seen, self.mission.heading, dt)
        {
            self.fail(&why, Ended::Lost, &mut out);
        }
        self.elapsed += dt;
        if self.elapsed >= 1.0 / FRAME_HZ {
            self.elapsed -= 1.0 / FRAME_HZ;
            if self.outcome.is_none() {
                self.think(seen, 1.0 / FRAME_HZ, &mut out);
            }
            let sticks = self.sticks.move_to(&self.target, 1.0 / FRAME_HZ);
            if self.linked() {
                out.rc_bytes = Some(rc_frame(&sticks));
                out.channels = Some(sticks.to_channels());
            }
        }
        out.step = self.index;
        out
    }

    /// Gives the pilot mode and reason from the vehicle's log, for a receiver without telemetry.
    pub fn hear(&mut self, mode: Mode, reason: &str) {
        if self.linked() {
            self.telemetry.report(mode, reason);
        }
    }

    /// The transmitter is on and the radio works.
    fn linked(&self) -> bool {
        self.mission.transmits() && self.now < self.radio_lost_at
    }

    /// How the mission ended; `None` before that.
    #[must_use]
    pub fn outcome(&self) -> Option<&Outcome> {
        self.outcome.as_ref()
    }

    /// Throttle stick, 0..1.
    #[must_use]
    pub fn throttle(&self) -> f64 {
        self.sticks.at()[3]
    }

    /// Contents of the transmitter's display.
    #[must_use]
    pub fn telemetry(&self) -> &Telemetry {
        &self.telemetry
    }

    fn think(&mut self, now: VisibleState, dt: f64, out: &mut PilotOutput) {
        let seen = self.perception.look(now, dt);
        self.display.push_back(self.telemetry.mode);
        while self.display.len() > self.display_delay + 1 {
            self.display.pop_front();
        }
        let mode = self.display.front().copied().flatten();
        let Some(step) = self.steps.get(self.index).cloned() else {
            self.outcome = Some(Outcome {
                accomplished: true,
                ended: Ended::Done,
                reason: "mission accomplished".to_owned(),
            });
            out.outcome.clone_from(&self.outcome);
            return;
        };
        if !self.begun {
            self.begun = true;
            self.mission.begin(&seen);
            out.events.push(StepEvent::Began(self.index));
        }
        let view = View {
            seen,
            now: now.t,
            mode,
            text: &self.telemetry.reason,
        };
        match self.mission.fly(&step, &view, self.sticks.at(), dt) {
            Progress::Going(target) => self.target = target,
            Progress::Done(target) => {
                self.target = target;
                out.events.push(StepEvent::Ended {
                    index: self.index,
                    done: true,
                });
                self.index += 1;
                self.begun = false;
            }
            Progress::Failed(why) => self.fail(&why, Ended::GivenUp, out),
        }
    }

    fn fail(&mut self, why: &str, ended: Ended, out: &mut PilotOutput) {
        let name = self.steps.get(self.index).map_or("end", Step::name);
        self.outcome = Some(Outcome {
            accomplished: false,
            ended,
            reason: format!("{name}: {why}"),
        });
        out.outcome.clone_from(&self.outcome);
        if self.begun {
            out.events.push(StepEvent::Ended {
                index: self.index,
                done: false,
            });
        }
    }
}

/// An angle folded into [-π, π).
fn wrap(x: f64) -> f64 {
    use core::f64::consts::PI;
    (x + PI).rem_euclid(2.0 * PI) - PI
}
