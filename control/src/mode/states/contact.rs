//! Resting on the pipe with running rotors; attitude held, yaw given up.

use crate::arming::ArmingInhibits;
use crate::chain::setpoint::Setpoint;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::modes::Mode;
use crate::mode::reason::Reason;
use crate::mode::shared::on_pipe::PipeAttitudeHold;

/// Time on the pipe before the tendons close, s.
pub const CONTACT_TIME: f32 = 0.2;
/// Time in which the collective falls to that of the closing, s: about the motors' time constant; a longer one lets the
/// lean grow.
const SET_DOWN_TIME: f32 = 0.06;
/// Throttle above `perch_thr_max` that ends the contact, 1.
pub const CONTACT_MARGIN: f32 = 0.03;

/// State of the mode [`crate::mode::Mode::Contact`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    pub hold: PipeAttitudeHold,
}

impl Behaviour for Contact {
    fn advance(&mut self, step: &mut Step<'_>) {
        self.hold = self.hold.levelled(step.dt);
    }

    fn rotors(&self, context: &Context, _: &Inputs) -> Setpoint {
        self.hold.rotors(context.set_down_thrust())
    }

    fn hand_over_time(&self, _: Mode) -> f32 {
        SET_DOWN_TIME
    }

    fn reason(&self, context: &Context, inputs: &Inputs, _: ArmingInhibits) -> Option<Reason> {
        context.reason(inputs, true).or(context.crown_side())
    }
}
