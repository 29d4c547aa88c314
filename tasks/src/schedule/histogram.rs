//! Times on a logarithmic scale, in a fixed number of buckets.
//!
//! Each microsecond below 8 µs has a bucket, every octave above has four: a quantile is never too small, and less than
//! a quarter too large. Smallest and largest are exact. Adding takes a few instructions, without division.

/// Buckets: up to 65.5 ms, the last for all beyond.
pub const BUCKETS: usize = 60;

/// A histogram of times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Histogram {
    counts: [u16; BUCKETS],
    min: u32,
    max: u32,
}

impl Histogram {
    /// Empty.
    pub const EMPTY: Self = Self {
        counts: [0; BUCKETS],
        min: u32::MAX,
        max: 0,
    };

    /// Adds a time, µs; a full bucket stays full.
    pub fn add(&mut self, us: u32) {
        if let Some(count) = self.counts.get_mut(bucket(us)) {
            *count = count.saturating_add(1);
        }
        self.min = self.min.min(us);
        self.max = self.max.max(us);
    }

    /// Number of times.
    pub fn count(&self) -> u32 {
        self.counts.iter().map(|&count| u32::from(count)).sum()
    }

    /// Smallest, µs; 0 without any.
    pub fn min(&self) -> u32 {
        self.min.min(self.max)
    }

    /// Largest, µs; 0 without any.
    pub const fn max(&self) -> u32 {
        self.max
    }

    /// Time, µs, not exceeded by `permille` of a thousand, less than a quarter too large; 0 without any.
    pub fn quantile(&self, permille: u32) -> u32 {
        let rank = (self.count() * permille.min(1000)).div_ceil(1000).max(1);
        let mut below = 0;
        for (index, &count) in self.counts.iter().enumerate() {
            below += u32::from(count);
            if below >= rank {
                return upper(index).clamp(self.min(), self.max);
            }
        }
        self.max
    }
}

fn bucket(us: u32) -> usize {
    if us < 4 {
        return us as usize;
    }
    // The leading one gives the octave, the next two digits the quarter.
    let octave = 31 - us.leading_zeros();
    let index = (octave - 1) * 4 + ((us >> (octave - 2)) & 3);
    (index as usize).min(BUCKETS - 1)
}

/// Largest time of a bucket, µs; the last one has none.
fn upper(bucket: usize) -> u32 {
    if bucket < 4 {
        return bucket as u32;
    }
    if bucket >= BUCKETS - 1 {
        return u32::MAX;
    }
    let (octave, quarter) = (bucket as u32 / 4 + 1, bucket as u32 % 4);
    ((5 + quarter) << (octave - 2)) - 1
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn buckets_follow_each_other_without_gap() {
        let mut last = 0;
        for us in 0..70_000 {
            let index = bucket(us);
            assert!(index == last || index == last + 1, "{us}");
            assert!(
                us <= upper(index) && (index == 0 || us > upper(index - 1)),
                "{us}"
            );
            last = index;
        }
        assert_eq!(last, BUCKETS - 1);
        assert_eq!(bucket(u32::MAX), BUCKETS - 1);
    }

    #[test]
    fn an_empty_histogram_is_all_zeros() {
        let none = Histogram::EMPTY;
        assert_eq!(
            (none.count(), none.min(), none.max(), none.quantile(500)),
            (0, 0, 0, 0)
        );
    }

    proptest! {
        #[test]
        fn a_quantile_is_never_too_small_and_too_large_by_less_than_a_quarter(
            times in proptest::collection::vec(prop_oneof![0u32..40, 0u32..2000, 0u32..65_000], 1..400),
            permille in 1u32..=1000,
        ) {
            let mut histogram = Histogram::EMPTY;
            times.iter().for_each(|&us| histogram.add(us));
            let mut sorted = times.clone();
            sorted.sort_unstable();
            let rank = (sorted.len() * permille as usize).div_ceil(1000).max(1);
            let exact = sorted[rank - 1];
            let estimate = histogram.quantile(permille);
            prop_assert!(estimate >= exact && u64::from(estimate) * 4 <= u64::from(exact) * 5, "{} for {}", estimate, exact);
            prop_assert_eq!(histogram.count() as usize, times.len());
            prop_assert_eq!((histogram.min(), histogram.max()), (sorted[0], sorted[sorted.len() - 1]));
        }

        #[test]
        fn what_lies_beyond_the_scale_keeps_its_extremes(us in 65_536u32..) {
            let mut histogram = Histogram::EMPTY;
            histogram.add(us);
            prop_assert_eq!((histogram.quantile(500), histogram.max()), (us, us));
        }
    }
}
