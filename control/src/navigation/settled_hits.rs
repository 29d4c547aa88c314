//! Ranges that wait until it is known that the beam has stayed on its surface.
//!
//! Beside an edge a beam reads a mixture of both surfaces before anything shows it. A range counts when the beam has been on the
//! surface for as long before it as after it.

/// Time for which the beam stays on a surface before and after a range that counts, µs: at 0.35 m/s, the fastest crossing, it moves
/// by its own width from half a metre in that time.
pub const SETTLE: u64 = 160_000;
/// Least time between two that wait, µs, and the number of them: a faster module gives no more.
const SPACING: u64 = 9_000;
const LENGTH: usize = 20;

/// A range: time, µs, and distance, m.
pub type TimedRange = (u64, f32);

/// The ranges that wait.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SettledHits {
    waiting: [Option<TimedRange>; LENGTH],
    next: usize,
    /// When the beam came onto the surface, and the newest range that waits, µs.
    since_us: u64,
    newest_us: u64,
}

impl SettledHits {
    /// The beam has left the surface, or is on another one at `at_us` µs: what waits does not count.
    pub fn restart(&mut self, at_us: u64) {
        *self = Self {
            since_us: at_us,
            ..Self::default()
        };
    }

    /// At `at_us` µs the beam has been on the surface for long enough.
    pub fn arrived(&self, at_us: u64) -> bool {
        at_us.saturating_sub(self.since_us) >= SETTLE
    }

    /// Takes a range on the surface.
    pub fn push(&mut self, range: TimedRange) {
        let (at_us, _) = range;
        if !self.arrived(at_us) || at_us.saturating_sub(self.newest_us) < SPACING {
            return;
        }
        self.newest_us = at_us;
        if let Some(slot) = self.waiting.get_mut(self.next) {
            *slot = Some(range);
        }
        self.next = (self.next + 1) % LENGTH;
    }

    /// The oldest range that has settled by `at_us` µs, the time of the newest hit on the surface.
    pub fn pop(&mut self, at_us: u64) -> Option<TimedRange> {
        let settled = |(then, _): &TimedRange| at_us.saturating_sub(*then) >= SETTLE;
        let waiting = self
            .waiting
            .iter_mut()
            .filter(|slot| slot.as_ref().is_some_and(settled));
        waiting
            .min_by_key(|slot| slot.map_or(u64::MAX, |(at, _)| at))?
            .take()
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec;
    use std::vec::Vec;

    /// Those that count of ranges each `every` µs, of a beam that comes onto a surface at 1 s and leaves it at 2 s.
    fn counted(every: u64) -> Vec<u64> {
        let mut hits = SettledHits::default();
        hits.restart(1_000_000);
        let mut counted = vec![];
        for at in (1_000_000..2_000_000).step_by(every as usize) {
            hits.push((at, 1.0));
            counted.extend(core::iter::from_fn(|| hits.pop(at)).map(|(at, _)| at));
        }
        hits.restart(2_000_000);
        assert_eq!(hits.pop(3_000_000), None);
        counted
    }

    #[test]
    fn a_range_counts_if_the_beam_was_on_its_surface_before_and_after() {
        for every in [10_000, 20_000, 50_000, 100_000] {
            let counted = counted(every);
            let (first, last) = (counted[0], counted[counted.len() - 1]);
            assert!(
                (1_160_000..1_160_000 + every).contains(&first),
                "{every}: {first}"
            );
            assert!(
                (1_840_000 - 2 * every..=1_840_000).contains(&last),
                "{every}: {last}"
            );
            assert!(counted.windows(2).all(|w| w[1] - w[0] == every), "{every}");
        }
        // A module of 200 Hz gives as many as one of 100 Hz.
        assert!(counted(5_000).len() <= counted(10_000).len());
    }
}
