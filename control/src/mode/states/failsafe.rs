//! Radio lost or battery empty: descends, stops on any support.

use crate::arming::ArmingInhibits;
use crate::chain::setpoint::Setpoint;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::reason::Reason;
use crate::mode::shared::descent::descent;
use crate::mode::shared::landing_point::LandingPoint;
use crate::pilot::rc::Sticks;
use crate::pilot::stick_positions;

/// Longest radio silence, beyond the link's staleness, after which flight resumes without a stick motion, s.
pub const RESUME_TIME: f32 = 1.0;
/// Roll or pitch stick that resumes flight after a longer silence, share of its travel.
pub const RESUME_STICK: f32 = 0.3;

/// State of the mode [`crate::mode::Mode::Failsafe`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failsafe {
    pub cause: Reason,
    /// Landing point; `None` without a position, or while the pilot commands angles.
    pub landing_point: Option<LandingPoint>,
}

impl Failsafe {
    /// Begins for `cause`; `landing_point` returns the landing point if a position is known.
    pub fn begin(
        cause: Reason,
        step: &mut Step<'_>,
        landing_point: impl FnOnce(&mut Step<'_>) -> Option<LandingPoint>,
    ) -> Self {
        let mut failsafe = Self {
            cause,
            landing_point: None,
        };
        if failsafe.holds(step.inputs) {
            failsafe.landing_point = landing_point(step);
        }
        failsafe
    }

    /// The pilot's sticks, if he steers.
    fn pilot(&self, inputs: &Inputs) -> Option<Sticks> {
        inputs.sticks.filter(|_| self.cause != Reason::RADIO_LOST)
    }

    /// A position is known, and the pilot does not command angles.
    fn holds(&self, inputs: &Inputs) -> bool {
        inputs.motion.is_some()
            && !inputs.position_lost()
            && self
                .pilot(inputs)
                .as_ref()
                .is_none_or(stick_positions::keeps_hold)
    }
}

impl Behaviour for Failsafe {
    fn advance(&mut self, step: &mut Step<'_>) {
        self.landing_point = match (self.holds(step.inputs), self.landing_point) {
            (false, _) => None,
            (true, Some(mut landing_point)) => {
                landing_point.step(self.pilot(step.inputs), step);
                Some(landing_point)
            }
            (true, None) => LandingPoint::here(step),
        };
    }

    /// Level and sinking; with radio the pilot steers. Position hold tilts the vehicle only until a support carries it.
    fn rotors(&self, context: &Context, inputs: &Inputs) -> Setpoint {
        match &self.landing_point {
            Some(landing_point) => landing_point.rotors(context),
            None => descent(context, self.pilot(inputs)),
        }
    }

    fn reason(&self, _: &Context, _: &Inputs, _: ArmingInhibits) -> Option<Reason> {
        Some(self.cause)
    }
}
