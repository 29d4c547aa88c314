//! State history: a delayed fix is compared with the state at the time of its measurement.

use super::axis_filter::Change;
use crate::maths::elapsed::seconds;
use crate::maths::frames::about_down;
use crate::maths::scalar;
use crate::maths::vector::{Quat, Vec3};

/// States kept, 0.25 s at 200 Hz: twice the latency of a slow camera.
pub const LENGTH: usize = 50;
/// Older states kept, and the least time between two, µs: another 0.3 s, for a range with a latency of 0.2 s that waits for as long.
/// What is older than these is ignored.
const OLDER: usize = 16;
const SPACING: u64 = 20_000;

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
    older: [Option<StateSnapshot>; OLDER],
    next_older: usize,
}

impl Default for StateHistory {
    fn default() -> Self {
        Self {
            moments: [None; LENGTH],
            next: 0,
            older: [None; OLDER],
            next_older: 0,
        }
    }
}

impl StateHistory {
    /// Drops every state.
    pub fn clear(&mut self) {
        self.moments.fill(None);
        self.older.fill(None);
    }

    /// Adds the newest state.
    pub fn push(&mut self, moment: StateSnapshot) {
        let slot = self.moments.get_mut(self.next);
        let dropped = slot.and_then(|slot| slot.replace(moment));
        self.next = (self.next + 1) % LENGTH;
        let newest = self.older.get((self.next_older + OLDER - 1) % OLDER);
        let newest = newest.and_then(|newest| newest.as_ref());
        if let Some(dropped) = dropped
            && newest.is_none_or(|newest| dropped.at_us.saturating_sub(newest.at_us) >= SPACING)
            && let Some(slot) = self.older.get_mut(self.next_older)
        {
            *slot = Some(dropped);
            self.next_older = (self.next_older + 1) % OLDER;
        }
    }

    /// The state at `at_us` µs, interpolated between its neighbours; `None` before the oldest and after the newest.
    pub fn at(&self, at_us: u64) -> Option<StateSnapshot> {
        let oldest = |moments: &[Option<StateSnapshot>]| moments.iter().flatten().map(|m| m.at_us).min();
        if oldest(&self.moments).is_some_and(|oldest| oldest <= at_us) {
            Self::between(|| self.moments.iter().flatten(), at_us)
        } else {
            Self::between(|| self.moments.iter().chain(&self.older).flatten(), at_us)
        }
    }

    fn between<'a, I>(known: impl Fn() -> I, at_us: u64) -> Option<StateSnapshot>
    where
        I: Iterator<Item = &'a StateSnapshot>,
    {
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
        for moment in self.moments.iter_mut().chain(&mut self.older).flatten() {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_200_hz_it_keeps_half_a_second_between_whose_states_it_interpolates() {
        let mut history = StateHistory::default();
        let pushed = |us: u64| StateSnapshot {
            at_us: us,
            position: Vec3::new(0.0, 0.0, us as f32 * 1e-6),
            ..StateSnapshot::default()
        };
        for step in 1..400u64 {
            history.push(pushed(5_000 * step));
            let now = 5_000 * step;
            // The newest one is kept, whatever its distance from the one before.
            assert_eq!(history.at(now).map(|then| then.at_us), Some(now));
            let oldest = now.saturating_sub(490_000).max(10_000);
            for at in (oldest..now).step_by(3_500) {
                let then = history.at(at).expect("a state");
                assert!(
                    then.at_us == at && (then.position.z - at as f32 * 1e-6).abs() < 1e-5,
                    "{at} {now}"
                );
            }
            assert_eq!(history.at(now + 1), None);
        }
        assert_eq!(history.at(1_995_000 - 600_000), None);
    }

    #[test]
    fn slower_steps_are_all_kept() {
        let mut history = StateHistory::default();
        for step in 1..100u64 {
            history.push(StateSnapshot {
                at_us: 20_000 * step,
                position: Vec3::new(if step.is_multiple_of(2) { 1.0 } else { 0.0 }, 0.0, 0.0),
                ..StateSnapshot::default()
            });
        }
        for step in 60..100u64 {
            let x = history.at(20_000 * step).expect("a state").position.x;
            assert!((x - if step.is_multiple_of(2) { 1.0 } else { 0.0 }).abs() < 1e-6);
        }
    }

    #[test]
    fn a_change_moves_what_came_after_its_measurement() {
        let mut history = StateHistory::default();
        let mut axis = crate::navigation::axis_filter::Axis::at(0.0);
        for step in 0..40u64 {
            history.push(StateSnapshot {
                at_us: 10_000 * step,
                ..StateSnapshot::default()
            });
        }
        let change = axis.correct(0.1, 4e-4, 0.0);
        history.change(200_000, &[Change::default(), Change::default(), change]);
        let z = |at: u64| history.at(at).expect("a state").position.z;
        assert!(
            z(190_000).abs() < 1e-9 && (z(200_000) - 0.05).abs() < 1e-4 && (z(390_000) - 0.05).abs() < 1e-4
        );
    }
}
