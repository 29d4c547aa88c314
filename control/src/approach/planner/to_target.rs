//! Approach to a pipe whose place another computer reports, in the axes of the poses: without search and crossings.

use super::{ApproachAbort, ApproachPlanner, Phase, View};
use crate::approach::limits::*;
use crate::approach::pipe_target::PipeTarget;
use crate::maths::frames::about_down;
use crate::maths::vector::Vec3;
use crate::navigation::estimate::Estimate;

impl ApproachPlanner {
    /// `target` is near the vehicle, and below it.
    pub fn reaches(target: &PipeTarget, e: &Estimate) -> bool {
        near(target.crown_position - e.position, TARGET_REACH)
    }

    /// The approach to `target`, relative to the beginning of the attempt.
    pub(super) fn to(self, target: &PipeTarget) -> Self {
        let crown = about_down(target.crown_position - self.origin, -self.heading);
        Self {
            phase: Phase::Over,
            has_target: true,
            crown_y: crown.y,
            crown_z: crown.z,
            along: crown.x,
            ..self
        }
    }

    /// Follows the newest reported place: its noise is smoothed, and the poses' axes may drift. Fails if the place is
    /// missing, out of reach or jumps.
    pub(super) fn follow(&mut self, v: &View, dt: f32) -> Result<(), ApproachAbort> {
        let target = v.target.ok_or(ApproachAbort::TargetStale)?;
        let reach = if self.returns { TARGET_RETURN } else { TARGET_REACH };
        // A climb begins beside the pipe, or under its crown: its reach is not checked.
        if self.phase != Phase::Climb && !near(target.crown_position - v.position, reach) {
            return Err(ApproachAbort::TargetFar);
        }
        let known = Vec3::new(self.along, self.crown_y, self.crown_z);
        let off = about_down(target.crown_position - self.origin, -self.heading) - known;
        if off.norm_squared() > TARGET_STEP * TARGET_STEP {
            return Err(ApproachAbort::TargetJumps);
        }
        let now = known + off * (dt / (dt + TARGET_TIME));
        (self.along, self.crown_y, self.crown_z) = (now.x, now.y, now.z);
        Ok(())
    }

    /// Height over the crown that controls the descent, as a range would measure it, m. A lens above the centre of
    /// mass does not lower it: the belly is below.
    pub(super) fn clearance(&self, at: Vec3) -> f32 {
        let surface = if self.has_target {
            self.crown_z - UNDER + LOWER
        } else {
            self.crown_z - self.lens.z.max(0.0)
        };
        surface - at.z
    }
}

/// The vehicle can fly by `off`: horizontally at most `reach` m, and down within [`TARGET_BELOW`].
fn near(off: Vec3, reach: f32) -> bool {
    let (least, most) = TARGET_BELOW;
    let horizontal = off.x * off.x + off.y * off.y;
    horizontal <= reach * reach && (least..=most).contains(&off.z)
}
