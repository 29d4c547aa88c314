//! Outputs of the mode logic.

use super::modes::Mode;
use super::reason::Reason;
use crate::arming::ArmingInhibits;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::retained_grip::GripMemory;
use crate::pilot::actuator_test::ActuatorTestAnswer;
use crate::pilot::remote::RemoteAnswer;
use crate::thrust_factor::ThrustFactor;

/// Outputs of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Mode.
    pub mode: Mode,
    /// Rotors.
    pub rotors: Setpoint,
    /// Tendons.
    pub tendons: ClampCommand,
    /// Grip to retain across a reset.
    pub grip_memory: GripMemory,
    /// Why arming is refused, the failsafe acts or the last state was left; `None` if nothing is wrong.
    pub reason: Option<Reason>,
    /// Everything against arming; empty while armed.
    pub inhibits: ArmingInhibits,
    /// Answer to the newest actuator test.
    pub actuator_test: ActuatorTestAnswer,
    /// Answer to the newest order of a remote link.
    pub remote: RemoteAnswer,
    /// The vehicle has swung by itself: roll and pitch slower.
    pub gentle: bool,
    /// Thrust learnt in flight, by which the mixer divides its demands.
    pub thrust_factor: ThrustFactor,
}
