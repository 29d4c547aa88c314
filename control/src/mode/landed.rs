//! On the ground again, rotors idle, about to disarm.

use super::behaviour::Behaviour;
use super::context::Context;
use super::{Inputs, Setpoint};

/// Time from landing to disarming, s.
pub const LANDED_TIME: f32 = 2.0;

/// See [`super::Mode::Landed`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landed;

impl Behaviour for Landed {
    fn rotors(&self, _: &Context, _: &Inputs) -> Setpoint {
        Setpoint::Idle
    }
}
