//! Step of the surface below: the range's beam passes an edge.
//!
//! A beam has a width. While it passes an edge a time-of-flight sensor that mixes its targets reads something between both,
//! from the one to the other over the beam's width (docs/design/flow-and-range.md): a step is over when the beam has passed.

use crate::maths::elapsed::seconds;
use crate::maths::vector::Vec3;

/// Ranges in a row that agree on the new surface, and the difference up to which they do, m: four deviations of two ranges.
const AGREE: u32 = 3;
const SAME: f32 = 0.08;
/// Difference from the level before that is a jump, m, the height of the smallest pipe, and the time constant with which that
/// follows, s. A level that creeps with 1 m/s, as by a scale of 1.6 in a climb, is 0.1 m ahead of it; a beam of 20 cm that passes
/// an edge of a metre with 0.3 m/s is 0.2 m.
const JUMP: f32 = 0.2;
const CREEP_TIME: f32 = 0.1;
/// Width of the range's beam at 1 m, m: 6°.
pub const BEAM: f32 = 0.105;
/// Way at one level after which a beam rests on no edge, in its widths: over one of them it reads what changes.
const PASSED: f32 = 2.0;

/// A step that has begun.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceStep {
    /// First of the hits in a row that agree, m, level of the newest one, m down, and their number, and
    /// that any two have jumped.
    first: Vec3,
    level: f32,
    agreed: u32,
    jumped: bool,
    /// Level before, m down, and time of the newest hit, µs.
    slow: f32,
    at_us: u64,
}

impl SurfaceStep {
    /// A step has begun and is not over.
    pub fn begun(&self) -> bool {
        self.agreed > 0
    }

    /// Between two ranges the level has jumped: without that the surface is the same, whatever its level seems to be.
    pub fn jumped(&self) -> bool {
        self.jumped
    }

    /// Takes a hit at `point` and `at_us` µs beside the old surface, whose last hit was at the level `before`, m down, of a beam that is `near` m long down to the nearer of both. It has arrived
    /// on a surface that is `known` as soon as ranges agree, on another one when the beam has moved over it. True if the
    /// step is over.
    pub fn take(&mut self, (at_us, point): (u64, Vec3), before: f32, near: f32, known: bool) -> bool {
        if !self.begun() {
            (self.level, self.slow, self.at_us) = (before, before, at_us);
        }
        let ahead = point.z - self.slow;
        self.jumped |= ahead.abs() > JUMP;
        let dt = seconds(core::mem::replace(&mut self.at_us, at_us), at_us);
        self.slow += ahead * dt / (dt + CREEP_TIME);
        let off = (point.z - self.level).abs();
        if self.agreed > 0 && off <= SAME {
            self.agreed = self.agreed.saturating_add(1);
        } else {
            (self.first, self.agreed) = (point, 1);
        }
        self.level = point.z;
        let way = point - self.first;
        let passed = PASSED * BEAM * near;
        self.agreed >= AGREE && (known || way.x * way.x + way.y * way.y >= passed * passed)
    }

    /// The newest hit departs from the one before: of a step without mixtures its first.
    pub fn departs(&self) -> bool {
        self.agreed == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ranges until a step is over that falls by `step` m a range to 1.9 m, of a beam 0.4 m over the pipe that moves across by
    /// `speed` m a range.
    fn lasts(step: f32, speed: f32, known: bool) -> Option<u32> {
        let mut surface = SurfaceStep::default();
        (1..100u8).map(u32::from).find(|i| {
            let depth = (0.55 + step * *i as f32).min(1.9);
            surface.take(
                (20_000 * u64::from(*i), Vec3::new(0.0, speed * *i as f32, depth)),
                0.4,
                0.4,
                known,
            )
        })
    }

    #[test]
    fn a_step_is_over_when_the_beam_has_moved_over_the_new_surface() {
        // At once to the other surface: 8.4 cm of way.
        assert_eq!(lasts(2.0, 0.006, false), Some(15));
        // Through a mixture of both that grows over the beam's width: as far behind it.
        assert_eq!(lasts(0.13, 0.006, false), Some(25));
        // On a surface that is known as soon as three agree.
        assert_eq!(lasts(2.0, 0.006, true), Some(3));
    }

    #[test]
    fn a_beam_that_rests_on_an_edge_arrives_nowhere() {
        assert_eq!(lasts(2.0, 0.0, false), None);
    }
}
