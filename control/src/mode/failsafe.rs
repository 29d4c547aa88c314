//! Radio lost or battery empty: descends, stops on whatever carries.

use super::behaviour::Behaviour;
use super::context::Context;
use super::descent::descent;
use super::{Inputs, Reason, Setpoint};
use crate::arming::ArmingInhibits;

/// Longest radio silence, beyond the link's staleness, after which flight resumes by itself, s.
pub const RESUME_TIME: f32 = 1.0;
/// Roll or pitch stick that resumes flight after a longer silence, share of its travel.
pub const RESUME_STICK: f32 = 0.3;

/// See [`super::Mode::Failsafe`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failsafe {
    pub cause: Reason,
}

impl Behaviour for Failsafe {
    /// Level and sinking; with radio the pilot steers.
    fn rotors(&self, context: &Context, inputs: &Inputs) -> Setpoint {
        descent(
            context,
            inputs.sticks.filter(|_| self.cause != Reason::RADIO_LOST),
        )
    }

    fn reason(&self, _: &Context, _: &Inputs, _: ArmingInhibits) -> Option<Reason> {
        Some(self.cause)
    }
}
