//! Orders of a remote link, mapped to gestures and switch positions.
//!
//! A remote perch command overrides the switch until the pilot moves it, the vehicle enters a mode without grip, or
//! [`GRAB_WAIT`] expires before a touch. If it ends without the pilot, he must turn his switch off and on before it
//! acts again.

use super::Inputs;
use crate::arming::Gesture;
use crate::gripper::retained_grip::GripMemory;
use crate::mode::modes::Mode;
use crate::pilot::remote::{RemoteAnswer, RemoteOrder, RemoteRefusal, RemoteRequest};

/// Time for which a grab ordered in the air waits for the touch, s: an order given for one approach must not close the
/// arms at a much later landing.
pub const GRAB_WAIT: f32 = 30.0;

/// Remote orders since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Remote {
    answer: RemoteAnswer,
    /// Perch switch position set by an order.
    perch: Option<bool>,
    /// Its value before the newest order.
    before: Option<bool>,
    /// Last position of the pilot's own perch switch.
    pilots: Option<bool>,
    /// Time in the air since a grab was ordered, s.
    waited: f32,
    /// The rotors stop in this step, as by the arm switch.
    pub kill: bool,
}

impl Remote {
    /// Returns an order that has not been answered.
    pub fn take(&self, request: Option<RemoteRequest>) -> Option<RemoteRequest> {
        // Numbers wrap around; a number that is not above the last belongs to an old order.
        let above = |r: &RemoteRequest| (1..1 << 31).contains(&r.number.wrapping_sub(self.answer.number));
        request.filter(above)
    }

    /// One step of `dt` s before any order: the pilot's switch overrides the order when it moves. True when the order
    /// ends without it.
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

    /// The inputs, with the perch switch replaced by the ordered position.
    pub fn apply(&self, mut inputs: Inputs) -> Inputs {
        if let (Some(sticks), Some(perch)) = (&mut inputs.sticks, self.perch) {
            sticks.perch_switch = perch;
        }
        inputs
    }

    /// Sets the perch switch to the position that `order` asks for.
    pub fn turn(&mut self, order: RemoteOrder) {
        self.before = self.perch;
        match order {
            RemoteOrder::Grab => self.perch = Some(true),
            RemoteOrder::Release => self.perch = Some(false),
            RemoteOrder::Arm | RemoteOrder::Disarm | RemoteOrder::Kill => (),
        }
    }

    /// Takes back a release that had no effect.
    pub fn turn_back(&mut self, order: RemoteOrder) {
        if order == RemoteOrder::Release {
            self.perch = self.before;
        }
    }

    /// Called when `mode` begins; `auto_perch`: the vehicle flies autonomously. True when the order ends.
    pub fn enters(&mut self, mode: Mode, auto_perch: bool) -> bool {
        let grips = match mode {
            Mode::Flight | Mode::Contact | Mode::Clamping | Mode::Perched | Mode::Releasing => true,
            // Autonomous, between two tries or off the pipe.
            Mode::Approach | Mode::Escaping => auto_perch,
            _ => false,
        };
        !grips && self.perch.take().is_some()
    }

    pub fn reply(&mut self, number: u32, refusal: Option<RemoteRefusal>) {
        self.answer = RemoteAnswer { number, refusal };
    }

    /// Reply to the newest order.
    pub fn answer(&self) -> RemoteAnswer {
        self.answer
    }
}

/// The gesture equivalent to `order`.
pub fn gesture(order: RemoteOrder) -> Option<Gesture> {
    match order {
        RemoteOrder::Arm => Some(Gesture::Arm),
        RemoteOrder::Disarm | RemoteOrder::Kill => Some(Gesture::Disarm),
        RemoteOrder::Grab | RemoteOrder::Release => None,
    }
}
