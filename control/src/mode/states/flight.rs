//! Free flight under the pilot's sticks.

use crate::chain::setpoint::Setpoint;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::modes::Mode;
use crate::mode::reason::Reason;
use crate::mode::shared::collective;
use crate::mode::shared::descent::descent;
use crate::pilot::stick_positions;

/// Time allowed for the throttle to follow the perch switch, s.
const SWITCH_FIRST: f32 = 1.0;
/// Hand-over time of the collective to a pilot who calls a touch off, s: short, since he may see the vehicle slide.
const CALL_OFF_TIME: f32 = 0.1;

/// State of the mode [`crate::mode::Mode::Flight`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight;

impl Flight {
    /// Perch switch on, throttle down, attitude known.
    pub fn means_to_perch(step: &Step<'_>) -> bool {
        let most = step.context.params.perch_thr_max;
        let wanted = |s: crate::pilot::rc::Sticks| s.perch_switch && s.throttle <= most;
        step.inputs.motion.is_some() && step.inputs.sticks.is_some_and(wanted)
    }

    /// The same, or the switch has just been turned off: the vehicle still descends until the throttle follows.
    pub fn sets_down(step: &Step<'_>) -> bool {
        let context = &step.context;
        let most = context.params.perch_thr_max;
        let recent = context.perch_switch.off.time() < SWITCH_FIRST;
        let down = |s: crate::pilot::rc::Sticks| recent && s.throttle <= most;
        step.inputs.motion.is_some() && step.inputs.sticks.is_some_and(down)
    }

    /// Friction holds the vehicle while the arms close.
    pub fn is_level(step: &Step<'_>) -> bool {
        step.context.lean.may_close()
    }
}

impl Behaviour for Flight {
    fn advance(&mut self, step: &mut Step<'_>) {
        if step.context.oscillation.swings_by_itself() {
            step.context.swing();
        }
        if step
            .inputs
            .sticks
            .as_ref()
            .is_some_and(stick_positions::asks_hold)
            && step.context.noted().is_none()
        {
            if !step.context.hold_seen_off {
                step.context.note(Some(Reason::HoldSwitchNotOff));
            } else if !step.context.motors_follow() {
                step.context.note(Some(Reason::MotorsTooSlow));
            } else if !step.inputs.position_fresh() {
                step.context.note(Some(Reason::NoPosition));
            }
        }
        if !Self::means_to_perch(step) {
            return;
        }
        if let Some(why) = step.inputs.servo_trouble() {
            // Before contact: arms whose servos would lose power must not close.
            step.context.note(Some(Reason::Check(why)));
            return;
        }
        if !step.context.contact_force.resting() {
            return;
        }
        if !step.context.perch_switch.seen_off {
            step.context.note(Some(Reason::PerchSwitchNotOff));
        } else if !Self::is_level(step) {
            step.context.note(Some(Reason::NotOnCrown));
        }
    }

    fn rotors(&self, context: &Context, inputs: &Inputs) -> Setpoint {
        match inputs.sticks {
            Some(s) => collective::from_sticks(&s, &context.params, context.full_thrust()),
            // Unreachable: without radio the failsafe flies.
            None => descent(context, None),
        }
    }

    fn hand_over_time(&self, from: Mode) -> f32 {
        if from == Mode::Contact {
            CALL_OFF_TIME
        } else {
            collective::HAND_OVER_TIME
        }
    }
}
