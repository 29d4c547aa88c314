//! What every state answers: what it watches, what rotors and tendons do in it, what the pilot reads.

use super::context::{Context, Step};
use super::demand::HAND_OVER_TIME;
use super::{ClampCommand, Inputs, Reason, Setpoint};
use crate::arming::ArmingInhibits;
use crate::grip_memory::GripMemory;

/// One state, with the fields that live in it.
pub trait Behaviour {
    /// Before the transitions are looked through: brings up to date what their guards ask of this state.
    fn observe(&mut self, _step: &mut Step<'_>) {}

    /// After them, when none applies: a step within this state.
    fn advance(&mut self, _step: &mut Step<'_>) {}

    /// The grip that must outlive a reset: from the first step of closing until every arm is proven free.
    fn grip_memory(&self) -> GripMemory {
        GripMemory::Open
    }

    /// What the tendons are to do.
    fn tendons(&self) -> ClampCommand {
        self.grip_memory().tendons()
    }

    /// What the rotors are to do, before the collective is handed over and limited.
    fn rotors(&self, context: &Context, inputs: &Inputs) -> Setpoint;

    /// What the pilot reads beside the mode.
    fn reason(&self, context: &Context, inputs: &Inputs, _inhibits: ArmingInhibits) -> Option<Reason> {
        context.reason(inputs, true)
    }

    /// Time over which the collective goes from that of the state before to this one's, s.
    fn hand_over_time(&self) -> f32 {
        HAND_OVER_TIME
    }
}
