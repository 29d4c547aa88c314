//! Free flight that holds the position.

use super::approach;
use crate::arming::ArmingInhibits;
use crate::chain::setpoint::Setpoint;
use crate::maths::scalar::clamp;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::reason::Reason;
use crate::mode::shared::coasting_hold::CoastingHold;
use crate::mode::shared::stick_velocity::velocity_from_sticks;
use crate::navigation::estimate::Estimate;
use crate::pilot::stick_positions::{THROTTLE_CENTRE, THROTTLE_ZONE};
use crate::position_hold::PositionHold;

/// State of the mode [`crate::mode::Mode::Hold`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    pub place: CoastingHold,
    wanted: Setpoint,
    /// The throttle was centred since the hold began; before that it commands no climb.
    centred: bool,
}

impl Hold {
    /// Holds the present position.
    pub fn here(step: &mut Step<'_>) -> Self {
        let estimate = step.inputs.position.unwrap_or_default();
        let position_hold = step.position_hold(&estimate);
        Self::begin(position_hold, false, step)
    }

    /// Holds the present position after autonomous flight, with the wind that `position_hold` has estimated; the sticks are
    /// centred.
    pub fn after(position_hold: Option<PositionHold>, step: &mut Step<'_>) -> Self {
        let estimate = step.inputs.position.unwrap_or_default();
        let mut position_hold = position_hold.unwrap_or_else(|| step.position_hold(&estimate));
        position_hold.anchor_at(&estimate);
        step.calm(&mut position_hold);
        Self::begin(position_hold, true, step)
    }

    fn begin(position_hold: PositionHold, centred: bool, step: &mut Step<'_>) -> Self {
        let estimate = step.inputs.position.unwrap_or_default();
        let mut hold = Self {
            place: CoastingHold::new(position_hold),
            wanted: Setpoint::Stop,
            centred,
        };
        hold.step(&estimate, step);
        hold
    }

    fn step(&mut self, estimate: &Estimate, step: &Step<'_>) {
        let sticks = step.inputs.sticks.unwrap_or_default();
        self.centred |= (sticks.throttle - THROTTLE_CENTRE).abs() <= THROTTLE_ZONE;
        let climb = if self.centred { climb(sticks.throttle) } else { 0.0 };
        let command = velocity_from_sticks(&sticks, climb, step.context);
        self.wanted = self.place.step(estimate, &command, step);
    }
}

/// Share of the largest climb rate that a throttle commands, -1..1.
fn climb(throttle: f32) -> f32 {
    let off = throttle - THROTTLE_CENTRE;
    let beyond = clamp(off.abs() - THROTTLE_ZONE, 0.0, 1.0) / (THROTTLE_CENTRE - THROTTLE_ZONE);
    clamp(if off < 0.0 { -beyond } else { beyond }, -1.0, 1.0)
}

impl Behaviour for Hold {
    fn advance(&mut self, step: &mut Step<'_>) {
        // A silent inertial sensor stops the rotors within some steps; until then the last setpoint stands.
        if let (Some(estimate), Some(_)) = (step.inputs.position, step.inputs.motion) {
            step.calm(&mut self.place.position_hold);
            self.step(&estimate, step);
        }
        if approach::asked(step)
            && step.context.noted().is_none()
            && let Some(why) = approach::obstacle(step)
        {
            step.context.note(Some(why));
        }
    }

    fn rotors(&self, _: &Context, _: &Inputs) -> Setpoint {
        self.wanted
    }

    fn reason(&self, context: &Context, inputs: &Inputs, _: ArmingInhibits) -> Option<Reason> {
        let stale = self.place.adrift.then_some(Reason::PositionStale);
        stale.or_else(|| context.reason(inputs, true))
    }
}
