//! The state machine: one step takes what is seen and gives what is to be done.

use super::escape::{Escape, SLIDE_RAMP};
use super::failsafe::{Cause, Dangers};
use super::hold::{Hold, Spool};
use super::lean::Lean;
use super::look::Look;
use super::{Inputs, Mode, Outputs, Reason, demand};
use crate::arming::{Gesture, GestureWatch};
use crate::grip_memory::GripMemory;
use crate::math::{clamp, cos};
use crate::params::Params;
use crate::rc::Sticks;
use crate::support::{Felt, Support};

/// Longest step accepted, s: a stall of the commander must not end a timer.
const STEP_MAX: f32 = 0.05;
/// Time for which the rotors may idle before they are stopped, s.
pub const IDLE_MAX: f32 = 30.0;
/// Time from landing to disarming, s.
pub const LANDED_TIME: f32 = 2.0;
/// Time on the pipe before the tendons close, s.
pub const CONTACT_TIME: f32 = 0.3;
/// Throttle above `perch_thr_max` by which the contact is given up, 1.
const CONTACT_MARGIN: f32 = 0.03;
/// Lean beyond which the arms are not closed, rad. Before the arms hold, a vehicle that leans by θ along a pipe's
/// flank stays only while sin θ <= μ (cos θ - T/W): 14° at μ 0.6 and 30 % throttle.
pub const PERCH_LEAN_MAX: f32 = crate::math::deg(11.0);
/// Time over which gravity is learnt at rest, s, and what may come of it, m/s²: a part's bias of some 40 mg.
const GRAVITY_TIME: f32 = 0.5;
const GRAVITY_BOUNDS: (f32, f32) = (9.4, 10.2);
/// Time for which a reason stays on the pilot's display, s.
const NOTE_TIME: f32 = 10.0;

/// The state with what belongs to it; [`Mode`] is its public name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum State {
    /// A grip outlives rotors and resets.
    Calibrating {
        grip_memory: GripMemory,
    },
    /// As above.
    Disarmed {
        grip_memory: GripMemory,
    },
    Armed,
    Flight,
    Contact {
        hold: Hold,
    },
    Clamping {
        hold: Hold,
        spool: Spool,
    },
    Perched {
        /// Closed or kept.
        grip_memory: GripMemory,
    },
    Releasing {
        hold: Hold,
        /// Share of the collective that the rotors have reached, 0..1.
        share: f32,
        /// Time for which every arm has been free, s.
        free: f32,
        /// The tendons are paying out.
        opening: bool,
        /// The gears alone hold: the tendons' drives start when they open.
        kept: bool,
    },
    Escaping(Escape),
    Landed,
    Failsafe(Cause),
}

impl State {
    pub(super) fn mode(self) -> Mode {
        match self {
            Self::Calibrating { .. } => Mode::Calibrating,
            Self::Disarmed { .. } => Mode::Disarmed,
            Self::Armed => Mode::Armed,
            Self::Flight => Mode::Flight,
            Self::Contact { .. } => Mode::Contact,
            Self::Clamping { .. } => Mode::Clamping,
            Self::Perched { .. } => Mode::Perched,
            Self::Releasing { .. } => Mode::Releasing,
            Self::Escaping(_) => Mode::Escaping,
            Self::Landed => Mode::Landed,
            Self::Failsafe(_) => Mode::Failsafe,
        }
    }
}

/// The mode logic of one vehicle.
#[derive(Clone, Debug)]
pub struct ModeLogic {
    pub(super) params: Params,
    pub(super) state: State,
    /// Time in this mode, s.
    pub(super) since: f32,
    pub(super) support: Support,
    pub(super) dangers: Dangers,
    pub(super) gestures: GestureWatch,
    /// The gesture completed in this step.
    pub(super) gesture: Option<Gesture>,
    /// The throttle last seen: held when the radio is lost on the pipe.
    pub(super) throttle: f32,
    /// The arm switch has been off since power-up.
    pub(super) arm_seen_off: bool,
    /// The perch switch has been off since the last try: on starts the next.
    pub(super) perch_seen_off: bool,
    /// The perch switch has been on since the arms closed: off opens them.
    pub(super) perch_seen_on: bool,
    /// The perch switch has been on since the start: where it was left says nothing about what the pilot wants now.
    perch_left_on: bool,
    pub(super) look: Look,
    pub(super) lean: Lean,
    /// Acceleration along world down, m/s².
    pub(super) sinking: f32,
    pub(super) collective: demand::Collective,
    /// A reason and the time for which it is still shown, s.
    pub(super) note: (Option<Reason>, f32),
    /// Specific force at rest, m/s².
    gravity: f32,
}

impl ModeLogic {
    /// A vehicle that has just been switched on: whether its arms are closed is looked at first.
    pub fn new(params: &Params) -> Self {
        Self::resume(params, GripMemory::Unknown)
    }

    /// A vehicle whose board has restarted with this grip. The rotors wait for the pilot, whatever ran before.
    pub fn resume(params: &Params, grip_memory: GripMemory) -> Self {
        Self {
            params: *params,
            state: State::Calibrating { grip_memory },
            since: 0.0,
            support: Support::new(params),
            dangers: Dangers::default(),
            gestures: GestureWatch::default(),
            gesture: None,
            throttle: 0.0,
            arm_seen_off: false,
            perch_seen_off: false,
            perch_seen_on: false,
            perch_left_on: true,
            look: Look::default(),
            lean: Lean::default(),
            sinking: 0.0,
            collective: demand::Collective::default(),
            note: (None, 0.0),
            gravity: crate::math::GRAVITY,
        }
    }

    /// One step, `dt` s after the one before.
    pub fn step(&mut self, inputs: &Inputs, dt: f32) -> Outputs {
        let dt = clamp(dt, 0.0, STEP_MAX);
        let inputs = &inputs.finite();
        self.observe(inputs, dt);
        let next = match self.emergency(inputs) {
            Some((state, why)) => {
                self.note(why);
                state
            }
            None => self.transition(inputs, dt),
        };
        // Whatever leads there: without the radio it is the failsafe that flies.
        let next = match (next, inputs.sticks) {
            (State::Flight, None) => State::Failsafe(Cause::RadioLost),
            (next, _) => next,
        };
        if next.mode() != self.state.mode() {
            self.since = 0.0;
            self.collective.hand_over(match next {
                State::Escaping(_) => SLIDE_RAMP,
                _ => demand::HAND_OVER_TIME,
            });
            if next.mode() == Mode::Armed {
                self.note(None);
            }
        }
        self.state = next;
        self.decide(inputs, dt)
    }

    /// Updates everything that outlives a state.
    fn observe(&mut self, i: &Inputs, dt: f32) {
        self.since = clamp(self.since + dt, 0.0, 1e6);
        self.note.1 -= dt;
        self.gesture = self
            .gestures
            .step(i.sticks.as_ref(), self.params.throttle_low, dt);
        if let Some(s) = i.sticks {
            self.throttle = clamp(s.throttle, 0.0, 1.0);
            self.arm_seen_off |= !s.arm_switch;
            self.perch_seen_off |= !s.perch_switch;
            self.perch_left_on &= s.perch_switch;
            self.perch_seen_on |= s.perch_switch && !self.perch_left_on;
        }
        self.look_for_grasp(i, dt);
        let down = i.motion.map_or(-self.gravity, |m| m.q.rotate(m.accel).z);
        if matches!(self.state, State::Calibrating { .. } | State::Disarmed { .. }) && i.motion.is_some() {
            // What the accelerometer calls gravity at rest: its bias would otherwise add up in the sink rate.
            let seen = clamp(-down, GRAVITY_BOUNDS.0, GRAVITY_BOUNDS.1);
            self.gravity += (seen - self.gravity) * dt / (dt + GRAVITY_TIME);
        }
        let felt = i.motion.map(|m| Felt {
            specific_force_z: m.accel.z,
            down: down + self.gravity,
            rate: m.rate.norm(),
            lift: i.lift,
        });
        self.support.step(felt, dt);
        self.sinking = felt.map_or(0.0, |f| f.down);
        self.watch_lean(i, dt);
        self.dangers.step(i, &self.params, dt);
    }

    fn transition(&mut self, i: &Inputs, dt: f32) -> State {
        let low = |s: &Sticks| s.throttle <= self.params.throttle_low;
        match (self.state, i.sticks) {
            (State::Calibrating { grip_memory }, sticks) => {
                let grip_memory = sticks.map_or(grip_memory, |s| self.after_switch(s, grip_memory));
                if i.motion.is_some_and(|m| m.calibrated) {
                    State::Disarmed { grip_memory }
                } else {
                    State::Calibrating { grip_memory }
                }
            }
            (State::Disarmed { grip_memory }, Some(s)) => self.disarmed(i, s, grip_memory),
            (State::Armed | State::Landed, None) => self.stop(Some(Reason::RADIO_LOST)),
            (State::Armed | State::Landed, _) if self.dangers.line_silent() => {
                self.stop(Some(Reason::LINE_SILENT))
            }
            (State::Armed | State::Landed, Some(_)) if self.gesture == Some(Gesture::Disarm) => {
                self.stop(None)
            }
            (State::Armed | State::Landed, Some(s)) if !low(&s) => State::Flight,
            (State::Armed, Some(_)) if self.since >= IDLE_MAX => self.stop(Some(Reason::IdleTooLong)),
            (State::Landed, Some(_)) if self.since >= LANDED_TIME => self.stop(None),
            (State::Flight, Some(_)) if let Some(landing) = self.dangers.landing() => {
                State::Failsafe(landing)
            }
            (State::Flight, Some(s)) if low(&s) && self.support.grounded() => State::Landed,
            (State::Flight, Some(s)) => self.touch(i, s).unwrap_or(State::Flight),
            (State::Contact { hold }, sticks) => self.contact(i, hold, sticks, dt),
            (State::Clamping { hold, spool }, sticks) => self.clamping(i, hold, spool, sticks, dt),
            (State::Perched { grip_memory }, sticks) => self.perched(i, grip_memory, sticks),
            (
                State::Releasing {
                    hold,
                    share,
                    free,
                    opening,
                    kept,
                },
                sticks,
            ) => self.releasing(i, hold, (share, free, opening, kept), sticks, dt),
            (State::Escaping(escape), _) => self.escaping(i, escape, dt),
            (State::Failsafe(cause), sticks) => self.failsafe(cause, sticks),
            (state, _) => state,
        }
    }

    fn disarmed(&mut self, i: &Inputs, s: Sticks, grip_memory: GripMemory) -> State {
        let grip_memory = self.after_switch(s, grip_memory);
        if self.gesture != Some(Gesture::Arm) || !self.refusals(i).is_empty() {
            return State::Disarmed { grip_memory };
        }
        match grip_memory {
            GripMemory::Controlled(_) | GripMemory::HeldByGears(_) => {
                // Armed on purpose with the switch where it is: from here on, off is a wish to go.
                self.perch_seen_on = s.perch_switch;
                self.perch_left_on = false;
                State::Perched { grip_memory }
            }
            GripMemory::Open => State::Armed,
            GripMemory::Unknown => State::Disarmed { grip_memory },
        }
    }

    /// The grip of a disarmed vehicle. A person who holds it opens the arms by the perch switch, on and off again.
    fn after_switch(&self, s: Sticks, grip_memory: GripMemory) -> GripMemory {
        if grip_memory.arms().is_some() && !s.perch_switch && self.perch_seen_on {
            GripMemory::Open
        } else {
            grip_memory
        }
    }

    /// The touch of the pipe: perch switch turned on, throttle down, something carries, nearly level.
    fn touch(&mut self, i: &Inputs, s: Sticks) -> Option<State> {
        let motion = i.motion?;
        let wanted = s.perch_switch && s.throttle <= self.params.perch_thr_max;
        if wanted && self.perch_seen_off && self.slides_at_touch() {
            return Some(self.slide_off(i, GripMemory::Open));
        }
        if !(wanted && self.support.resting()) {
            return None;
        }
        if !self.perch_seen_off {
            self.note(Some(Reason::PerchSwitchNotOff));
            return None;
        }
        if motion.q.down_in_body().z < cos(PERCH_LEAN_MAX) {
            self.note(Some(Reason::NotOnCrown));
            return None;
        }
        let (roll, pitch, _) = motion.q.to_euler();
        Some(State::Contact {
            hold: Hold {
                roll,
                pitch,
                arms: s.arms,
            },
        })
    }

    fn contact(&mut self, i: &Inputs, hold: Hold, sticks: Option<Sticks>, dt: f32) -> State {
        let most = self.params.perch_thr_max + CONTACT_MARGIN;
        if sticks.is_some_and(|s| !s.perch_switch || s.throttle > most) {
            return State::Flight;
        }
        if self.slides() {
            return self.slide_off(i, GripMemory::Open);
        }
        if !self.support.resting() {
            // Lost the pipe, or the inertial sensor for a moment: back to where the pilot steers.
            return State::Flight;
        }
        if self.since < CONTACT_TIME {
            return State::Contact {
                hold: hold.levelled(dt),
            };
        }
        // A radio lost just now finishes the landing that the pilot began.
        self.perch_seen_on = sticks.is_some();
        State::Clamping {
            hold,
            spool: Spool::at(1.0),
        }
    }

    /// Rotors off for good, from a state in which no arm is closed.
    pub(super) fn stop(&mut self, why: Option<Reason>) -> State {
        self.note(why);
        State::Disarmed {
            grip_memory: GripMemory::Open,
        }
    }

    /// Shows `why` for a while.
    pub(super) fn note(&mut self, why: Option<Reason>) {
        self.note = (why, NOTE_TIME);
    }
}
