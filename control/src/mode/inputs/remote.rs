//! Orders of a remote link as the gestures and switch positions that they stand for.
//!
//! The perch switch by order holds until the pilot moves his own, until a mode begins in which there is no grip, and
//! before it has had an effect for [`GRAB_WAIT`]. Where it ends without him, where his switch stands is no wish.

use crate::arming::Gesture;
use crate::mode::context::Step;
use crate::mode::states::approach;
use crate::mode::states::perched::Perched;
use crate::mode::{Inputs, Mode, Reason, State};
use crate::pilot::remote::{RemoteAnswer, RemoteOrder, RemoteRefusal, RemoteRequest};
use crate::pilot::stick_positions::{centred, keeps_hold};

/// Time for which a grab that was ordered in the air waits for the touch, s: what was ordered for one approach must not
/// close the arms at a landing much later.
pub const GRAB_WAIT: f32 = 30.0;

/// The orders of a remote link since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Remote {
    answer: RemoteAnswer,
    /// Position of the perch switch by order.
    perch: Option<bool>,
    /// The same before the newest order.
    before: Option<bool>,
    /// Position of the pilot's own, when it was seen last.
    pilots: Option<bool>,
    /// Time in the air since a grab was ordered, s.
    waited: f32,
    /// Rotors are to stop in this step as by the arm switch.
    pub kill: bool,
}

impl Remote {
    /// An order that has not been answered.
    pub fn take(&self, request: Option<RemoteRequest>) -> Option<RemoteRequest> {
        // Numbers wrap; one that is not above the last is an old one.
        let above = |r: &RemoteRequest| (1..1 << 31).contains(&r.number.wrapping_sub(self.answer.number));
        request.filter(above)
    }

    /// One step of `dt` s before any order: the pilot's switch wins when it moves. True where the order ends without it.
    pub fn follow(&mut self, inputs: &Inputs, state: &State, dt: f32) -> bool {
        self.kill = false;
        if let Some(sticks) = inputs.sticks {
            let moved = self.pilots.is_some_and(|before| before != sticks.perch_switch);
            self.pilots = Some(sticks.perch_switch);
            if moved || self.perch == self.pilots {
                self.perch = None;
            }
        }
        let waits = state.mode() == Mode::Flight && self.perch == Some(true);
        self.waited = if waits { self.waited + dt } else { 0.0 };
        let open = state.mode() == Mode::Disarmed && at_rest_closed(state).is_err();
        (self.waited >= GRAB_WAIT || open) && self.perch.take().is_some()
    }

    /// The inputs with the perch switch where it is by order.
    pub fn apply(&self, mut inputs: Inputs) -> Inputs {
        if let (Some(sticks), Some(perch)) = (&mut inputs.sticks, self.perch) {
            sticks.perch_switch = perch;
        }
        inputs
    }

    /// Puts the perch switch where `order` wants it.
    pub fn turn(&mut self, order: RemoteOrder) {
        self.before = self.perch;
        match order {
            RemoteOrder::Grab => self.perch = Some(true),
            RemoteOrder::Release => self.perch = Some(false),
            RemoteOrder::Arm | RemoteOrder::Disarm | RemoteOrder::Kill => (),
        }
    }

    /// Takes back a release that nothing has come of.
    pub fn turn_back(&mut self, order: RemoteOrder) {
        if order == RemoteOrder::Release {
            self.perch = self.before;
        }
    }

    /// `mode` begins, which the vehicle has come to `by_itself` or not. True where the order ends with it.
    pub fn enters(&mut self, mode: Mode, by_itself: bool) -> bool {
        let grips = match mode {
            Mode::Flight | Mode::Contact | Mode::Clamping | Mode::Perched | Mode::Releasing => true,
            // The way to the next try, and off the pipe.
            Mode::Approach | Mode::Escaping => by_itself,
            _ => false,
        };
        !grips && self.perch.take().is_some()
    }

    pub fn reply(&mut self, number: u32, refusal: Option<RemoteRefusal>) {
        self.answer = RemoteAnswer { number, refusal };
    }

    /// What has become of the newest order.
    pub fn answer(&self) -> RemoteAnswer {
        self.answer
    }
}

/// What speaks against `order` before the step; `step` has the pilot's own switches.
pub fn refusal(order: RemoteOrder, state: &State, step: &Step<'_>) -> Option<RemoteRefusal> {
    let mode = state.mode();
    match order {
        RemoteOrder::Arm => {
            let off = step.inputs.sticks.is_some_and(|s| !s.arm_switch);
            (off && matches!(mode, Mode::Disarmed | Mode::Calibrating)).then_some(RemoteRefusal::ArmSwitchOff)
        }
        RemoteOrder::Disarm | RemoteOrder::Kill => None,
        _ if step.inputs.sticks.is_none() => Some(RemoteRefusal::RadioLost),
        RemoteOrder::Grab => match mode {
            Mode::Contact | Mode::Clamping | Mode::Perched => None,
            Mode::Approach if !step.context.by_itself.leaving => None,
            Mode::Flight | Mode::Releasing | Mode::Hold if !step.context.perch_switch.seen_off => {
                Some(RemoteRefusal::SwitchNotOff)
            }
            Mode::Flight | Mode::Releasing => None,
            Mode::Hold => not_approached(step),
            _ => at_rest_closed(state).err(),
        },
        RemoteOrder::Release => match mode {
            Mode::Flight | Mode::Contact | Mode::Clamping | Mode::Releasing | Mode::Approach => None,
            Mode::Perched => not_released(step),
            _ => match at_rest_closed(state) {
                Ok(()) if step.context.perch_switch.seen_on => None,
                Ok(()) => Some(RemoteRefusal::SwitchNotOn),
                Err(why) => Some(why),
            },
        },
    }
}

/// Disarmed with arms that the perch switch opens.
fn at_rest_closed(state: &State) -> Result<(), RemoteRefusal> {
    match state {
        State::Disarmed(d) if d.grip_memory.arms().is_some() => Ok(()),
        _ => Err(RemoteRefusal::NotHere),
    }
}

/// Why the perch switch turned on would not begin the perching by itself.
fn not_approached(step: &Step<'_>) -> Option<RemoteRefusal> {
    approach::obstacle(step).map(|why| match why {
        Reason::SticksNotCentred => RemoteRefusal::SticksNotCentred,
        _ => RemoteRefusal::NoWay,
    })
}

/// Why the perch switch turned off would not let go now: an order leaves no wish behind that acts later.
fn not_released(step: &Step<'_>) -> Option<RemoteRefusal> {
    let sticks = step.inputs.sticks?;
    let context = &step.context;
    let by_itself = context.by_itself.active && keeps_hold(&sticks) && centred(&sticks);
    if !context.perch_switch.seen_on {
        Some(RemoteRefusal::SwitchNotOn)
    } else if !sticks.arm_switch {
        Some(RemoteRefusal::ArmSwitchOff)
    } else if context.dangers.landing().is_some() || step.inputs.motion.is_none() {
        Some(RemoteRefusal::MustStay)
    } else if context.lean.too_far_to_release() {
        Some(RemoteRefusal::LeansTooFar)
    } else if !(by_itself || Perched::throttle_set(&sticks, &context.params)) {
        Some(RemoteRefusal::Throttle)
    } else {
        None
    }
}

/// The gesture that `order` stands for.
pub fn gesture(order: RemoteOrder) -> Option<Gesture> {
    match order {
        RemoteOrder::Arm => Some(Gesture::Arm),
        RemoteOrder::Disarm | RemoteOrder::Kill => Some(Gesture::Disarm),
        RemoteOrder::Grab | RemoteOrder::Release => None,
    }
}

/// What `order` has come to in `mode`, after the step.
pub fn outcome(order: RemoteOrder, mode: Mode) -> Option<RemoteRefusal> {
    match (order, mode) {
        (RemoteOrder::Arm, Mode::Disarmed | Mode::Calibrating) => Some(RemoteRefusal::Checks),
        (RemoteOrder::Disarm, Mode::Perched) => Some(RemoteRefusal::ArmSwitchOn),
        // Something came up in this very step.
        (RemoteOrder::Release, Mode::Perched) => Some(RemoteRefusal::MustStay),
        (RemoteOrder::Disarm, mode) if !mode.rotors_stand() => Some(RemoteRefusal::Flying),
        _ => None,
    }
}
