//! Grip proven, rotors stopped.

use crate::arming::ArmingInhibits;
use crate::chain::setpoint::Setpoint;
use crate::contact::slip::{Slip, bending};
use crate::gripper::TIGHTENINGS;
use crate::gripper::grip::{ArmState, GripDemand};
use crate::gripper::retained_grip::GripMemory;
use crate::gripper::tendon::ForceLimit;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::reason::Reason;
use crate::params::Params;
use crate::pilot::rc::Sticks;
use crate::pilot::release_throttle::RELEASE_THROTTLE_MIN;

/// State of the mode [`crate::mode::Mode::Perched`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perched {
    /// Closed by the clamp loops, or held by the gears.
    pub grip_memory: GripMemory,
    slip: Slip,
}

impl Perched {
    /// On `grip_memory`, at the body's present attitude.
    pub fn on(grip_memory: GripMemory) -> Self {
        Self {
            grip_memory,
            slip: Slip::default(),
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

    /// The throttle lets the rotors carry some of the weight, and not more than the arms bear.
    pub fn throttle_set(sticks: &Sticks, params: &Params) -> bool {
        (RELEASE_THROTTLE_MIN..=params.perch_thr_max).contains(&sticks.throttle)
    }

    /// Every arm presses and has force left.
    fn may_tighten(&self, step: &Step<'_>) -> bool {
        let (GripMemory::Controlled(arms), Some(grip)) = (self.grip_memory, step.inputs.grip) else {
            return false;
        };
        let p = &step.context.params;
        let most = GripDemand::from_params(p, ForceLimit::from_params(p).asked).force;
        let mut chosen = grip.arms.iter().zip(arms.mask()).filter(|(_, chosen)| *chosen);
        step.context.tightened < TIGHTENINGS
            && chosen
                .all(|(a, _)| matches!(a.state, ArmState::Holding | ArmState::Touching) && a.force < most)
    }

    fn trouble(&self, context: &Context, i: &Inputs) -> Option<Reason> {
        let asked = i
            .sticks
            .is_some_and(|s| !s.perch_switch && s.throttle >= RELEASE_THROTTLE_MIN);
        if i.grip.is_none() {
            Some(Reason::ClampSilent)
        } else if !context.grasps(i, self.grip_memory) {
            Some(Reason::GripLost)
        } else if self.slip.helpless() {
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
            // Without power the servos can neither hold the grip nor open the arms. The rotors never start without the
            // pilot: he releases.
            i.servo_trouble().map(Reason::Check)
        }
    }
}

impl Behaviour for Perched {
    fn observe(&mut self, step: &mut Step<'_>) {
        let Some(motion) = step.inputs.motion else {
            return;
        };
        let arms = self.grip_memory.arms();
        let bent = arms.and_then(|arms| bending(&step.inputs.tilts, arms.mask()));
        if self.slip.step(motion, bent, self.may_tighten(step), step.dt) {
            let times = step.context.tightened.saturating_add(1);
            step.context.tightened = times;
            let last = times >= TIGHTENINGS;
            step.context.note(Some(if last {
                Reason::TightensLast
            } else {
                Reason::TightensOnce
            }));
        }
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
