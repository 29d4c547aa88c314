//! Statistics of known times.

/// Times, µs, in ascending order.
#[derive(Clone, Debug, Default)]
pub struct Sorted(Vec<f64>);

impl Sorted {
    /// Sorts `times`.
    #[must_use]
    pub fn new(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        Self(times)
    }

    /// Count.
    #[must_use]
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The time not exceeded by `share` (0 to 1) of them, if any.
    #[must_use]
    pub fn quantile(&self, share: f64) -> Option<f64> {
        let rank = (self.0.len() as f64 * share).ceil() as usize;
        self.0.get(rank.saturating_sub(1)).copied()
    }

    /// The smallest.
    #[must_use]
    pub fn min(&self) -> Option<f64> {
        self.0.first().copied()
    }

    /// The largest.
    #[must_use]
    pub fn max(&self) -> Option<f64> {
        self.0.last().copied()
    }

    /// The mean.
    #[must_use]
    pub fn mean(&self) -> Option<f64> {
        (!self.0.is_empty()).then(|| self.0.iter().sum::<f64>() / self.0.len() as f64)
    }

    /// Standard deviation.
    #[must_use]
    pub fn deviation(&self) -> Option<f64> {
        let mean = self.mean()?;
        let squares: f64 = self.0.iter().map(|t| (t - mean).powi(2)).sum();
        Some((squares / self.0.len() as f64).sqrt())
    }

    /// Count per octave, `(from, to, count)`, µs, without empty ones; below 1 µs is one.
    #[must_use]
    pub fn octaves(&self) -> Vec<(f64, f64, usize)> {
        let mut octaves: Vec<(f64, f64, usize)> = Vec::new();
        for &time in &self.0 {
            let from = if time < 1.0 {
                0.0
            } else {
                time.log2().floor().exp2()
            };
            match octaves.last_mut() {
                Some(last) if last.0 == from => last.2 += 1,
                _ => octaves.push((from, if from == 0.0 { 1.0 } else { 2.0 * from }, 1)),
            }
        }
        octaves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_those_of_the_textbook() {
        let s = Sorted::new(vec![4.0, 2.0, 4.0, 5.0, 9.0, 4.0, 7.0, 5.0]);
        assert_eq!(
            (s.min(), s.mean(), s.max(), s.deviation()),
            (Some(2.0), Some(5.0), Some(9.0), Some(2.0))
        );
        assert_eq!(
            (s.quantile(0.5), s.quantile(0.99), s.quantile(0.0)),
            (Some(4.0), Some(9.0), Some(2.0))
        );
        assert_eq!(s.octaves(), [(2.0, 4.0, 1), (4.0, 8.0, 6), (8.0, 16.0, 1)]);
        assert_eq!(
            (Sorted::default().quantile(0.5), Sorted::default().mean()),
            (None, None)
        );
    }
}
