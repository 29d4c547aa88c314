//! Position hold that bridges gaps of the position by dead reckoning.

use crate::chain::setpoint::Setpoint;
use crate::mode::context::Step;
use crate::navigation::estimate::Estimate;
use crate::navigation::fix_age::COAST_AGE;
use crate::position_hold::{PositionHold, VelocityCommand};

/// Position hold whose position may be lost and return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoastingHold {
    pub position_hold: PositionHold,
    /// The position is missing at present.
    pub adrift: bool,
}

impl CoastingHold {
    pub fn new(position_hold: PositionHold) -> Self {
        Self {
            position_hold,
            adrift: false,
        }
    }

    /// One step: holds up to [`COAST_AGE`] of the estimate, then keeps level. When a position returns, it holds the
    /// vehicle's present place.
    pub fn step(&mut self, estimate: &Estimate, command: &VelocityCommand, step: &Step<'_>) -> Setpoint {
        let adrift = estimate.age > COAST_AGE;
        if self.adrift && !adrift {
            self.position_hold.anchor_at(estimate);
        }
        self.adrift = adrift;
        self.position_hold
            .step(estimate, &step.body_motion(), command, !adrift, step.dt)
    }
}
