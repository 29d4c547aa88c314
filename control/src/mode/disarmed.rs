//! Motors stopped, ready to be armed.

use super::behaviour::Behaviour;
use super::context::{Context, Step};
use super::{Inputs, Reason, Setpoint};
use crate::arming::ArmingInhibits;
use crate::grip_memory::GripMemory;

/// See [`super::Mode::Disarmed`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disarmed {
    /// A grip outlives rotors and resets.
    pub grip_memory: GripMemory,
}

impl Behaviour for Disarmed {
    fn observe(&mut self, step: &mut Step<'_>) {
        self.grip_memory = step.check_power_up_grip(self.grip_memory);
    }

    fn advance(&mut self, step: &mut Step<'_>) {
        self.grip_memory = step.context.after_switch(step.inputs.sticks, self.grip_memory);
    }

    fn grip_memory(&self) -> GripMemory {
        self.grip_memory
    }

    fn rotors(&self, _: &Context, _: &Inputs) -> Setpoint {
        Setpoint::Stop
    }

    fn reason(&self, context: &Context, i: &Inputs, inhibits: ArmingInhibits) -> Option<Reason> {
        // What just happened comes before what keeps from arming again.
        match context.noted() {
            None if i.sticks.is_some_and(|s| s.arm_switch) => first(inhibits),
            None if !i.hardware.is_empty() => first(i.hardware),
            _ => context.reason(i, false),
        }
    }
}

/// The most basic of `inhibits`.
pub fn first(inhibits: ArmingInhibits) -> Option<Reason> {
    inhibits.first().map(Reason::Check)
}
