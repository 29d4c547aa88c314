//! Time limits of the steps.

use crate::scenario::{Assist, Step};

/// Longest time for `step` with `assist`, s.
pub fn of(step: &Step, assist: Assist) -> f64 {
    match *step {
        // Five tries of a search each.
        Step::Touch | Step::Clamp { .. } | Step::Perch { .. } if assist == Assist::Autonomous => 400.0,
        // Includes the calibration at rest.
        Step::Arm => 30.0,
        Step::TakeOff { height } => 12.0 + 4.0 * height,
        // A hold that is lost is flown by hand, and tried again.
        Step::Hover { seconds } => 2.0 * seconds + 20.0,
        Step::Roll { seconds, .. } => 2.0 * seconds + 30.0,
        // A half turn takes 7 s; gusts may push the nose off for a while.
        Step::Yaw { seconds, .. } => 2.0 * seconds + 30.0,
        Step::FlyToPipe => 90.0,
        // With room for several tries.
        Step::Touch => 180.0,
        Step::Clamp { .. } | Step::Perch { .. } => 240.0,
        Step::Hold { seconds, lapse, .. } => Step::hold_time(seconds, lapse) + 1.0,
        Step::Open => 15.0,
        Step::Release => 45.0,
        Step::FlyTo { .. } => 120.0,
        Step::Land => 90.0,
        Step::Disarm => 10.0,
        // The display must return.
        Step::RadioOff { seconds } => seconds + 5.0,
        // Includes the calibration at rest after a loss of power.
        Step::Reset { after, off, .. } => after + off + 20.0,
    }
}
