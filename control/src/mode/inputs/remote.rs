//! Orders of a remote link as the gestures and switch positions that they stand for.
//!
//! The perch switch by order holds until the pilot moves his own, until a mode begins in which there is no grip, and
//! before it has had an effect for [`GRAB_WAIT`]. Where it ends without him, where his switch stands is no wish.

use super::Inputs;
use crate::arming::Gesture;
use crate::gripper::retained_grip::GripMemory;
use crate::mode::modes::Mode;
use crate::pilot::remote::{RemoteAnswer, RemoteOrder, RemoteRefusal, RemoteRequest};

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
    pub fn follow(&mut self, inputs: &Inputs, mode: Mode, grip_memory: GripMemory, dt: f32) -> bool {
        self.kill = false;
        if let Some(sticks) = inputs.sticks {
            let moved = self.pilots.is_some_and(|before| before != sticks.perch_switch);
            self.pilots = Some(sticks.perch_switch);
            if moved || self.perch == self.pilots {
                self.perch = None;
            }
        }
        let waits = mode == Mode::Flight && self.perch == Some(true);
        self.waited = if waits { self.waited + dt } else { 0.0 };
        let open = mode == Mode::Disarmed && grip_memory.arms().is_none();
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

    /// `mode` begins, which the vehicle has come to `auto_perch` or not. True where the order ends with it.
    pub fn enters(&mut self, mode: Mode, auto_perch: bool) -> bool {
        let grips = match mode {
            Mode::Flight | Mode::Contact | Mode::Clamping | Mode::Perched | Mode::Releasing => true,
            // The way to the next try, and off the pipe.
            Mode::Approach | Mode::Escaping => auto_perch,
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

/// The gesture that `order` stands for.
pub fn gesture(order: RemoteOrder) -> Option<Gesture> {
    match order {
        RemoteOrder::Arm => Some(Gesture::Arm),
        RemoteOrder::Disarm | RemoteOrder::Kill => Some(Gesture::Disarm),
        RemoteOrder::Grab | RemoteOrder::Release => None,
    }
}
