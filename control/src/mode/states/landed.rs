//! On the ground again, rotors idle, about to disarm.

use crate::chain::setpoint::Setpoint;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::Context;
use crate::mode::inputs::Inputs;

/// Time from landing to disarming, s.
pub const LANDED_TIME: f32 = 2.0;

/// State of the mode [`crate::mode::Mode::Landed`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landed;

impl Behaviour for Landed {
    fn rotors(&self, _: &Context, _: &Inputs) -> Setpoint {
        Setpoint::Idle
    }
}
