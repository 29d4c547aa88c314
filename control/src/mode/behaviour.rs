//! Interface of a state: transitions, rotors, tendons, display.

use super::context::{Context, Step};
use super::inputs::Inputs;
use super::modes::Mode;
use super::reason::Reason;
use super::shared::collective::HAND_OVER_TIME;
use crate::arming::ArmingInhibits;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::retained_grip::GripMemory;

/// One state with its fields.
pub trait Behaviour {
    /// Runs before the transitions and updates the values that their guards read.
    fn observe(&mut self, _step: &mut Step<'_>) {}

    /// Runs when no transition applies.
    fn advance(&mut self, _step: &mut Step<'_>) {}

    /// Grip to retain: closed from the first step of closing until every arm is proven free.
    fn grip_memory(&self) -> GripMemory {
        GripMemory::Open
    }

    fn tendons(&self) -> ClampCommand {
        self.grip_memory().tendons()
    }

    /// Setpoint before hand-over and limiting of the collective.
    fn rotors(&self, context: &Context, inputs: &Inputs) -> Setpoint;

    /// Reason shown to the pilot beside the mode.
    fn reason(&self, context: &Context, inputs: &Inputs, _inhibits: ArmingInhibits) -> Option<Reason> {
        context.reason(inputs, true)
    }

    /// Hand-over time of the collective `from` the state before, s.
    fn hand_over_time(&self, _from: Mode) -> f32 {
        HAND_OVER_TIME
    }
}
