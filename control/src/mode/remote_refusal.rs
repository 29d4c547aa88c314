//! Why the mode logic refuses an order of a remote link.

use super::context::Step;
use super::modes::Mode;
use super::reason::Reason;
use super::state::State;
use super::states::approach;
use super::states::perched::Perched;
use crate::pilot::remote::{RemoteOrder, RemoteRefusal};
use crate::pilot::stick_positions::{centred, keeps_hold};

/// Reason against `order`, evaluated before the step; `step` has the pilot's own switches.
pub fn refusal(order: RemoteOrder, state: &State, step: &Step<'_>) -> Option<RemoteRefusal> {
    let mode = state.mode();
    match order {
        RemoteOrder::Arm => {
            let off = step.inputs.sticks.is_some_and(|s| !s.arm_switch);
            (off && matches!(mode, Mode::Disarmed | Mode::Calibrating)).then_some(RemoteRefusal::ArmSwitchOff)
        }
        RemoteOrder::Disarm | RemoteOrder::Kill => None,
        _ if step.inputs.sticks.is_none() => Some(RemoteRefusal::RadioLost),
        RemoteOrder::Grab => match mode {
            Mode::Contact | Mode::Clamping | Mode::Perched => None,
            Mode::Approach if !step.context.auto_perch.leaving => None,
            Mode::Flight | Mode::Releasing | Mode::Hold if !step.context.perch_switch.seen_off => {
                Some(RemoteRefusal::SwitchNotOff)
            }
            Mode::Flight | Mode::Releasing => None,
            Mode::Hold => not_approached(step),
            _ => at_rest_closed(state).err(),
        },
        RemoteOrder::Release => match mode {
            Mode::Flight | Mode::Contact | Mode::Clamping | Mode::Releasing | Mode::Approach => None,
            Mode::Perched => not_released(step),
            _ => match at_rest_closed(state) {
                Ok(()) if step.context.perch_switch.seen_on => None,
                Ok(()) => Some(RemoteRefusal::SwitchNotOn),
                Err(why) => Some(why),
            },
        },
    }
}

/// Disarmed, with closed arms that the perch switch opens.
fn at_rest_closed(state: &State) -> Result<(), RemoteRefusal> {
    match state {
        State::Disarmed(d) if d.grip_memory.arms().is_some() => Ok(()),
        _ => Err(RemoteRefusal::NotHere),
    }
}

/// Reason for which turning the perch switch on would not start autonomous perching.
fn not_approached(step: &Step<'_>) -> Option<RemoteRefusal> {
    approach::obstacle(step).map(|why| match why {
        Reason::SticksNotCentred => RemoteRefusal::SticksNotCentred,
        Reason::ThrustUnknown => RemoteRefusal::ThrustUnknown,
        _ => RemoteRefusal::NoWay,
    })
}

/// Reason for which turning the perch switch off would not release now: a refused order must not act later.
fn not_released(step: &Step<'_>) -> Option<RemoteRefusal> {
    let sticks = step.inputs.sticks?;
    let context = &step.context;
    let auto_perch = context.auto_perch.active && keeps_hold(&sticks) && centred(&sticks);
    if !context.perch_switch.seen_on {
        Some(RemoteRefusal::SwitchNotOn)
    } else if !sticks.arm_switch {
        Some(RemoteRefusal::ArmSwitchOff)
    } else if context.dangers.landing().is_some() || step.inputs.motion.is_none() {
        Some(RemoteRefusal::MustStay)
    } else if context.lean.too_far_to_release() {
        Some(RemoteRefusal::LeansTooFar)
    } else if !(auto_perch || Perched::throttle_set(&sticks, &context.params)) {
        Some(RemoteRefusal::Throttle)
    } else {
        None
    }
}

/// Result of `order` in `mode`, after the step.
pub fn outcome(order: RemoteOrder, mode: Mode) -> Option<RemoteRefusal> {
    match (order, mode) {
        (RemoteOrder::Arm, Mode::Disarmed | Mode::Calibrating) => Some(RemoteRefusal::Checks),
        (RemoteOrder::Disarm, Mode::Perched) => Some(RemoteRefusal::ArmSwitchOn),
        // A danger arose in this very step.
        (RemoteOrder::Release, Mode::Perched) => Some(RemoteRefusal::MustStay),
        (RemoteOrder::Disarm, mode) if !mode.rotors_stand() => Some(RemoteRefusal::Flying),
        _ => None,
    }
}
