//! The way onto a pipe whose place another computer says, in the axes of the poses: nothing is searched or crossed.

use super::{ApproachAbort, ApproachPlanner, Phase, View};
use crate::approach::limits::*;
use crate::approach::pipe_target::PipeTarget;
use crate::maths::frames::about_down;
use crate::maths::scalar;
use crate::maths::vector::Vec3;
use crate::navigation::estimate::Estimate;

impl ApproachPlanner {
    /// `target` is near the vehicle, and below it.
    pub fn reaches(target: &PipeTarget, e: &Estimate) -> bool {
        near(target.crown - e.position, TARGET_REACH)
    }

    /// The way to `target`, from where the try began.
    pub(super) fn to(self, target: &PipeTarget) -> Self {
        let crown = about_down(target.crown - self.origin, -self.heading);
        Self {
            phase: Phase::Over,
            has_target: true,
            crown: crown.y,
            top: crown.z,
            along: crown.x,
            ..self
        }
    }

    /// Follows the newest place of the pipe, as it comes: its noise is smoothed, and the poses' axes may drift.
    pub(super) fn follow(&mut self, v: &View, dt: f32) -> Result<(), ApproachAbort> {
        let target = v.target.ok_or(ApproachAbort::TargetStale)?;
        let reach = if self.returns { TARGET_RETURN } else { TARGET_REACH };
        // It climbs from beside the pipe, or from under its crown.
        if self.phase != Phase::Climb && !near(target.crown - v.position, reach) {
            return Err(ApproachAbort::TargetFar);
        }
        let known = Vec3::new(self.along, self.crown, self.top);
        let off = about_down(target.crown - self.origin, -self.heading) - known;
        if off.norm_squared() > TARGET_STEP * TARGET_STEP {
            return Err(ApproachAbort::TargetJumps);
        }
        let now = known + off * (dt / (dt + TARGET_TIME));
        (self.along, self.crown, self.top) = (now.x, now.y, now.z);
        Ok(())
    }

    /// Height over the crown by which it comes down, as a range would measure it, m. A lens above the centre of mass brings it
    /// no lower: the belly is below.
    pub(super) fn clearance(&self, at: Vec3) -> f32 {
        let surface = if self.has_target {
            self.top - UNDER + LOWER
        } else {
            // Beside the crown the beam meets the pipe's round back, by so much below it.
            let (half, square) = (self.half, self.lens.y * self.lens.y);
            let fallen = square / (half + scalar::sqrt(half * half - square));
            self.edges.surface_depth() - fallen - self.lens.z.max(0.0)
        };
        surface - at.z
    }
}

/// What is `off` from the vehicle can be flown to within `reach` m.
fn near(off: Vec3, reach: f32) -> bool {
    let (least, most) = TARGET_BELOW;
    let level = off.x * off.x + off.y * off.y;
    level <= reach * reach && (least..=most).contains(&off.z)
}
