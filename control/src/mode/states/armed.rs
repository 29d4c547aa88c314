//! Rotors idle on the ground, throttle low.

use crate::chain::setpoint::Setpoint;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::Context;
use crate::mode::inputs::Inputs;

/// Longest idling of the rotors, s.
pub const IDLE_MAX: f32 = 30.0;

/// State of the mode [`crate::mode::Mode::Armed`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Armed;

impl Behaviour for Armed {
    fn rotors(&self, _: &Context, _: &Inputs) -> Setpoint {
        Setpoint::Idle
    }
}
