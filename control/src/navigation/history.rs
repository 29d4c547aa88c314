//! State history: a delayed fix is compared with the state at the time of its measurement.

use super::axis_filter::Change;
use crate::maths::elapsed::seconds;
use crate::maths::frames::about_down;
use crate::maths::scalar;
use crate::maths::vector::{Quat, Vec3};

/// States kept, 0.25 s at 200 Hz: twice the latency of a slow camera. An older fix is ignored.
pub const LENGTH: usize = 50;

/// The estimate at one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateSnapshot {
    /// µs.
    pub at_us: u64,
    /// m.
    pub position: Vec3,
    /// Body to world.
    pub q: Quat,
    /// Inertial displacement in the band of [`super::external_pose`], m.
    pub swing: Vec3,
}

impl StateSnapshot {
    /// The state of the point `lever` m from the centre of mass, body, in axes turned by `yaw_offset` rad.
    pub fn of(self, lever: Vec3, yaw_offset: f32) -> Self {
        Self {
            position: self.position + about_down(self.q.rotate(lever), yaw_offset),
            ..self
        }
    }

    /// Heading by the vehicle's own attitude, rad.
    pub fn yaw(&self) -> f32 {
        self.q.to_euler().2
    }
}

/// Ring buffer of the last states.
#[derive(Clone, Debug)]
pub struct StateHistory {
    moments: [Option<StateSnapshot>; LENGTH],
    next: usize,
}

impl Default for StateHistory {
    fn default() -> Self {
        Self {
            moments: [None; LENGTH],
            next: 0,
        }
    }
}

impl StateHistory {
    /// Drops every state.
    pub fn clear(&mut self) {
        self.moments.fill(None);
    }

    /// Adds the newest state.
    pub fn push(&mut self, moment: StateSnapshot) {
        if let Some(slot) = self.moments.get_mut(self.next) {
            *slot = Some(moment);
        }
        self.next = (self.next + 1) % LENGTH;
    }

    /// The state at `at_us` µs, interpolated between its neighbours; `None` before the oldest and after the newest.
    pub fn at(&self, at_us: u64) -> Option<StateSnapshot> {
        let known = || self.moments.iter().flatten();
        let before = known().filter(|m| m.at_us <= at_us).max_by_key(|m| m.at_us)?;
        if before.at_us == at_us {
            return Some(*before);
        }
        let after = known().filter(|m| m.at_us > at_us).min_by_key(|m| m.at_us)?;
        let share = seconds(before.at_us, at_us) / seconds(before.at_us, after.at_us);
        Some(StateSnapshot {
            at_us,
            position: before.position + (after.position - before.position) * share,
            q: between(before.q, after.q, share),
            swing: before.swing + (after.swing - before.swing) * share,
        })
    }

    /// Applies the `changes` of each axis at `at_us` µs to every state since, so that the next fix does not repeat
    /// them.
    pub fn change(&mut self, at_us: u64, changes: &[Change; 3]) {
        for moment in self.moments.iter_mut().flatten() {
            if moment.at_us >= at_us {
                let lag = seconds(at_us, moment.at_us);
                let [x, y, z] = changes.map(|change| change.position_after(lag));
                moment.position += Vec3::new(x, y, z);
            }
        }
    }
}

/// Interpolates from `a` to `b` by `share`, along the shorter way, linearly: a few milliseconds apart they are nearly
/// the same.
pub(crate) fn between(a: Quat, b: Quat, share: f32) -> Quat {
    let dot = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
    let share = scalar::clamp(share, 0.0, 1.0);
    let (of_a, of_b) = (1.0 - share, if dot < 0.0 { -share } else { share });
    let mixed = |a: f32, b: f32| of_a * a + of_b * b;
    Quat {
        w: mixed(a.w, b.w),
        x: mixed(a.x, b.x),
        y: mixed(a.y, b.y),
        z: mixed(a.z, b.z),
    }
    .normalised()
}
