//! Position hold that bridges gaps of the position by dead reckoning.

use crate::chain::setpoint::Setpoint;
use crate::mode::context::Step;
use crate::navigation::estimate::Estimate;
use crate::navigation::fix_age::COAST_AGE;
use crate::position_hold::{PositionHold, VelocityCommand};

/// The law with a position that may go and come back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoastingHold {
    pub law: PositionHold,
    /// There is no position at present.
    pub adrift: bool,
}

impl CoastingHold {
    pub fn new(law: PositionHold) -> Self {
        Self { law, adrift: false }
    }

    /// One step: up to [`COAST_AGE`] of the estimate it holds, then it keeps level, and holds where the vehicle is once there
    /// is a position again.
    pub fn step(&mut self, estimate: &Estimate, wish: &VelocityCommand, step: &Step<'_>) -> Setpoint {
        let adrift = estimate.age > COAST_AGE;
        if self.adrift && !adrift {
            self.law.anchor_at(estimate);
        }
        self.adrift = adrift;
        self.law
            .step(estimate, &step.body_motion(), wish, !adrift, step.dt)
    }
}
