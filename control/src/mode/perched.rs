//! Grip proven, rotors stopped.

use super::behaviour::Behaviour;
use super::context::{Context, Step};
use super::releasing::RELEASE_THROTTLE_MIN;
use super::{Inputs, Reason, Setpoint};
use crate::arming::ArmingInhibits;
use crate::grip_memory::GripMemory;
use crate::params::Params;
use crate::rc::Sticks;

/// See [`super::Mode::Perched`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perched {
    /// Closed by the clamp loops, or held by the gears.
    pub grip_memory: GripMemory,
}

impl Perched {
    /// The pilot validly asks to open the arms.
    pub fn release_asked(step: &Step<'_>) -> bool {
        let Context {
            params, perch_switch, ..
        } = &step.context;
        step.inputs.sticks.is_some_and(|s| {
            s.arm_switch && !s.perch_switch && perch_switch.seen_on && Self::throttle_set(&s, params)
        })
    }

    /// The rotors will carry some of the weight, and not more than the arms bear.
    pub fn throttle_set(sticks: &Sticks, params: &Params) -> bool {
        (RELEASE_THROTTLE_MIN..=params.perch_thr_max).contains(&sticks.throttle)
    }

    fn trouble(&self, context: &Context, i: &Inputs) -> Option<Reason> {
        let asked = i
            .sticks
            .is_some_and(|s| !s.perch_switch && s.throttle >= RELEASE_THROTTLE_MIN);
        if i.grip.is_none() {
            Some(Reason::ClampSilent)
        } else if !context.grasps(i, self.grip_memory) {
            Some(Reason::GripLost)
        } else if i.sticks.is_none() {
            Some(Reason::RADIO_LOST)
        } else if i.motion.is_none() {
            Some(Reason::IMU_SILENT)
        } else if let Some(landing) = context.dangers.landing() {
            Some(landing)
        } else if asked && !context.perch_switch.seen_on {
            Some(Reason::PerchSwitchNotOn)
        } else if asked && i.sticks.is_some_and(|s| !s.arm_switch) {
            Some(Reason::ArmSwitchOff)
        } else if asked && context.lean.too_far_to_release() {
            Some(Reason::LeansTooFar)
        } else if asked {
            Some(Reason::ThrottleTooHigh)
        } else {
            None
        }
    }
}

impl Behaviour for Perched {
    fn grip_memory(&self) -> GripMemory {
        self.grip_memory
    }

    fn rotors(&self, _: &Context, _: &Inputs) -> Setpoint {
        Setpoint::Stop
    }

    fn reason(&self, context: &Context, i: &Inputs, _: ArmingInhibits) -> Option<Reason> {
        self.trouble(context, i).or(context.noted())
    }
}
