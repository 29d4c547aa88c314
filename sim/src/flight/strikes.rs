//! Strikes of turning propellers, looked for at each sample: one that lasts less than 10 ms may be missed.

use sophie_control::allocation::wrench::PerArm;

use crate::record::{Strike, Struck};

/// Time without contact after which the next one is another strike, s.
const APART: f64 = 0.2;

/// The strikes of a flight.
#[derive(Debug, Default)]
pub struct Strikes {
    /// In order of their begin.
    pub all: Vec<Strike>,
}

impl Strikes {
    /// Takes the depths (m) of pipe and own arm in each disc at `t` s; returns a line for each strike that begins.
    pub fn step(&mut self, t: f64, depths: [PerArm<Option<f64>>; 2]) -> Vec<String> {
        let mut lines = Vec::new();
        for (against, depths) in [Struck::Pipe, Struck::OwnArm].into_iter().zip(depths) {
            for (arm, depth) in (1..).zip(depths) {
                let Some(depth) = depth else { continue };
                let mut last = self.all.iter_mut().rev();
                let lasting = last.find(|s| s.arm == arm && s.against == against && t - s.end < APART);
                if let Some(strike) = lasting {
                    strike.end = t;
                    strike.depth = strike.depth.max(depth);
                    continue;
                }
                self.all.push(Strike {
                    arm,
                    against,
                    start: t,
                    end: t,
                    depth,
                });
                lines.push(format!("propeller {arm} strikes {}", against.name()));
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strike_lasts_until_its_disc_is_clear() {
        let mut strikes = Strikes::default();
        let none = [None; 4];
        let second = |depth| [[None, Some(depth), None, None], none];
        assert_eq!(strikes.step(1.0, second(0.01)), ["propeller 2 strikes the pipe"]);
        assert!(strikes.step(1.01, second(0.03)).is_empty());
        assert!(strikes.step(1.02, [none, none]).is_empty());
        assert_eq!(
            strikes.step(1.03, [none, [Some(0.002), None, None, None]]),
            ["propeller 1 strikes its own arm"]
        );
        assert_eq!(strikes.step(1.5, second(0.02)).len(), 1);
        let depths: Vec<_> = strikes
            .all
            .iter()
            .map(|s| (s.arm, s.start, s.end, s.depth))
            .collect();
        assert_eq!(
            depths,
            [(2, 1.0, 1.01, 0.03), (1, 1.03, 1.03, 0.002), (2, 1.5, 1.5, 0.02)]
        );
    }
}
