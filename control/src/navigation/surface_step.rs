//! Step of the surface below: the range's beam passes an edge.
//!
//! A beam has a width. While it passes an edge a time-of-flight sensor that mixes its targets reads something between both,
//! from the one to the other over the beam's width (docs/design/flow-and-range.md): a step is over when the beam has passed.

/// Ranges in a row that agree on the new surface, and the difference up to which they do, m: four deviations of two ranges.
const AGREE: u32 = 3;
const SAME: f32 = 0.08;
/// Width of the range's beam at 1 m, m: 6°.
pub const BEAM: f32 = 0.105;
/// Ranges after which a beam that rests on an edge is taken for past it: half a second at 50 Hz.
const RESTS: u32 = 25;

/// A step that has begun.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceStep {
    /// Place across the edge of the first hit beside the old surface, m, and the newest hit's depth, m down.
    first: f32,
    level: f32,
    /// Ranges since then, and those in a row that agree.
    ranges: u32,
    agreed: u32,
}

impl SurfaceStep {
    /// A step has begun and is not over.
    pub fn begun(&self) -> bool {
        self.ranges > 0
    }

    /// Takes a hit beside the old surface, at `depth` m down and at this place `across` the edge, m, of a beam that is `near`
    /// m long down to the nearer of both; on a `known` surface it has arrived as soon as ranges agree. True if the step is over.
    pub fn take(&mut self, depth: f32, across: f32, near: f32, known: bool) -> bool {
        if !self.begun() {
            self.first = across;
        }
        self.ranges = self.ranges.saturating_add(1);
        self.agreed = if self.agreed > 0 && (depth - self.level).abs() <= SAME {
            self.agreed.saturating_add(1)
        } else {
            1
        };
        self.level = depth;
        let passed = (across - self.first).abs() >= BEAM * near;
        self.agreed >= AGREE && (known || passed || self.ranges >= RESTS)
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
            surface.take(depth, speed * *i as f32, 0.4, known)
        })
    }

    #[test]
    fn a_step_is_over_when_the_beam_has_passed_and_ranges_agree() {
        // At once to the other surface: 4.2 cm of way.
        assert_eq!(lasts(2.0, 0.006, false), Some(8));
        // Through a mixture of both that grows over the beam's width.
        let mixed = lasts(0.13, 0.006, false).unwrap();
        assert!((11..=14).contains(&mixed), "{mixed}");
        // On a surface that is known as soon as three agree.
        assert_eq!(lasts(2.0, 0.006, true), Some(3));
    }

    #[test]
    fn a_beam_that_rests_on_an_edge_is_taken_for_past_it_after_half_a_second() {
        assert_eq!(lasts(2.0, 0.0, false), Some(RESTS));
    }
}
