//! Motors stopped, ready to be armed.

use crate::arming::ArmingInhibits;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::retained_grip::GripMemory;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::reason::Reason;
use crate::pilot::actuator_test::ActuatorTest;

/// State of the mode [`crate::mode::Mode::Disarmed`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disarmed {
    /// Grip state, retained across motor stop and reset.
    pub grip_memory: GripMemory,
    /// Running actuator test.
    pub actuator_test: Option<ActuatorTest>,
}

impl Behaviour for Disarmed {
    fn observe(&mut self, step: &mut Step<'_>) {
        self.grip_memory = step.check_power_up_grip(self.grip_memory);
        self.actuator_test = step.context.actuator_tests.order();
    }

    fn advance(&mut self, step: &mut Step<'_>) {
        self.grip_memory = step.context.after_switch(step.inputs.sticks, self.grip_memory);
    }

    fn grip_memory(&self) -> GripMemory {
        self.grip_memory
    }

    fn tendons(&self) -> ClampCommand {
        match (self.actuator_test, self.grip_memory) {
            (Some(ActuatorTest::Place(place)), GripMemory::Open) => ClampCommand::Place(place),
            (_, grip_memory) => grip_memory.tendons(),
        }
    }

    fn rotors(&self, context: &Context, _: &Inputs) -> Setpoint {
        context.actuator_tests.rotors()
    }

    fn reason(&self, context: &Context, i: &Inputs, inhibits: ArmingInhibits) -> Option<Reason> {
        if self.actuator_test.is_some() {
            return Some(Reason::ActuatorTest);
        }
        // A recent event takes precedence over the arming checks.
        match context.noted() {
            None if i.sticks.is_some_and(|s| s.arm_switch) => first(inhibits),
            None if !i.hardware.is_empty() => first(i.hardware),
            _ => context.reason(i, false),
        }
    }
}

/// Highest-priority inhibit.
pub fn first(inhibits: ArmingInhibits) -> Option<Reason> {
    inhibits.first().map(Reason::Check)
}
