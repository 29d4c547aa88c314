//! Sensors are being calibrated at rest; arming is refused.

use super::disarmed::first;
use crate::arming::{ArmingInhibit, ArmingInhibits};
use crate::chain::setpoint::Setpoint;
use crate::gripper::retained_grip::GripMemory;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::reason::Reason;

/// State of the mode [`crate::mode::Mode::Calibrating`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibrating {
    /// Grip state, retained across motor stop and reset.
    pub grip_memory: GripMemory,
}

impl Behaviour for Calibrating {
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

    fn reason(&self, _: &Context, i: &Inputs, _: ArmingInhibits) -> Option<Reason> {
        if i.motion.is_none() {
            first(i.hardware.with(ArmingInhibit::ImuStale))
        } else if i.hardware.is_empty() {
            Some(Reason::KeepStill)
        } else {
            // Shows defects without an attempt to arm.
            first(i.hardware)
        }
    }
}
