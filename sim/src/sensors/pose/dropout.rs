//! Poses that are lost in bursts, as markers that are covered or blurred: the two states of Gilbert and Elliott, of which one
//! sends nothing. A burst ends with the probability 1/n at each pose and begins with s / (n (1 - s)), so that the share s is
//! lost, n poses at a time in the mean.

use rand::Rng;
use rand_pcg::Pcg64Mcg;

use crate::streams::Streams;

/// Mean length of a burst, poses: 0.25 s (assumed).
const BURST: f64 = 12.5;

/// State of the bursts.
#[derive(Clone, Debug)]
pub struct Dropout {
    rng: Pcg64Mcg,
    share: f64,
    lost: bool,
}

impl Dropout {
    /// Bursts that lose the `share`, 0 to below 1.
    #[must_use]
    pub fn new(share: f64, streams: Streams) -> Self {
        Self {
            rng: streams.of("pose.dropout"),
            share,
            lost: false,
        }
    }

    /// Whether the next pose is lost.
    pub fn next(&mut self) -> bool {
        if self.share <= 0.0 {
            return false;
        }
        let change = if self.lost {
            1.0 / BURST
        } else {
            self.share / (BURST * (1.0 - self.share))
        };
        self.lost ^= self.rng.random::<f64>() < change;
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_lost_in_bursts_of_their_mean_length() {
        for share in [0.1, 0.5] {
            let mut dropout = Dropout::new(share, Streams::new(4));
            let lost: Vec<bool> = (0..200_000).map(|_| dropout.next()).collect();
            let count = lost.iter().filter(|lost| **lost).count() as f64;
            let bursts = lost.windows(2).filter(|two| !two[0] && two[1]).count() as f64;
            assert!((count / 200_000.0 / share - 1.0).abs() < 0.05, "{share}: {count}");
            assert!((count / bursts / BURST - 1.0).abs() < 0.05, "{share}: {bursts}");
        }
        assert!(!Dropout::new(0.0, Streams::new(4)).next());
    }
}
