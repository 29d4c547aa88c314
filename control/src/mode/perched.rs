//! Grip proven, rotors stopped.

use super::behaviour::Behaviour;
use super::context::{Context, Step};
use super::releasing::RELEASE_THROTTLE_MIN;
use super::{Inputs, Reason, Setpoint};
use crate::arming::ArmingInhibits;
use crate::grip_memory::GripMemory;
use crate::math::deg;
use crate::params::Params;
use crate::rc::Sticks;
use crate::support::Held;

/// Turn of the body since the perch that is a slip, rad, and the time that it must last, s: a push passes.
const SLIP_ANGLE: f32 = deg(5.0);
const SLIP_TIME: f32 = 1.0;

/// See [`super::Mode::Perched`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perched {
    /// Closed by the clamp loops, or held by the gears.
    pub grip_memory: GripMemory,
    /// Roll and pitch at the first look, rad.
    attitude: Option<[f32; 2]>,
    /// Turned away from it.
    turned: Held,
}

impl Perched {
    /// On `grip_memory`, wherever the body is now.
    pub fn on(grip_memory: GripMemory) -> Self {
        Self {
            grip_memory,
            attitude: None,
            turned: Held::default(),
        }
    }

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
        } else if self.turned.time() >= SLIP_TIME {
            Some(Reason::Slips)
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
    fn observe(&mut self, step: &mut Step<'_>) {
        let Some(motion) = step.inputs.motion else {
            return;
        };
        let (roll, pitch, _) = motion.q.to_euler();
        let [first_roll, first_pitch] = *self.attitude.get_or_insert([roll, pitch]);
        let turned = (roll - first_roll).abs().max((pitch - first_pitch).abs());
        self.turned.step(turned > SLIP_ANGLE, step.dt);
    }

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
