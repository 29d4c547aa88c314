//! Time from step to step.

use crate::maths::scalar;

/// Rate of the step, Hz.
pub const CONTROL_RATE_HZ: f32 = 1000.0;

/// Bounds of a law's step time, s: half and five times the nominal one. A longer gap is a fault reported elsewhere;
/// integrating over it would jump.
const SHORTEST: f32 = 0.5e-3;
const LONGEST: f32 = 5e-3;

/// Step times from stamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepClock {
    last_us: u64,
}

/// Stamp before the first: no stamp is within 32 bits of it, so that the first step needs no test in the others.
const NO_STAMP: u64 = 1 << 63;

impl Default for StepClock {
    /// No step yet.
    fn default() -> Self {
        Self { last_us: NO_STAMP }
    }
}

impl StepClock {
    /// Time since the last step, s, 0.5 to 5 ms, for the stamp `at_us` µs; 1 ms at first.
    #[inline(always)]
    pub fn step(&mut self, at_us: u64) -> f32 {
        // 32 bits: converting 64 is a library call on these cores.
        let dt = match u32::try_from(at_us.wrapping_sub(self.last_us)) {
            Ok(gap_us) => gap_us as f32 * 1e-6,
            Err(_) => odd_gap(self.last_us, at_us),
        };
        self.last_us = at_us;
        scalar::clamp(dt, SHORTEST, LONGEST)
    }
}

/// Step time (s) of the first step, and for a gap over an hour, or backwards.
#[cold]
const fn odd_gap(last_us: u64, at_us: u64) -> f32 {
    if last_us == NO_STAMP {
        1.0 / CONTROL_RATE_HZ
    } else if at_us < last_us {
        SHORTEST
    } else {
        LONGEST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_takes_the_time_between_two_stamps_within_sane_limits() {
        let mut clock = StepClock::default();
        let mut at = 7;
        assert!(clock.step(at) == 1e-3);
        for (us, dt) in [
            (1000, 1e-3),
            (1250, 1.25e-3),
            (100, 0.5e-3),
            (0, 0.5e-3),
            (4999, 4.999e-3),
        ] {
            at += us;
            assert!((clock.step(at) - dt).abs() < 1e-9, "{us}");
        }
        for gap in [5000, 20_000, u64::from(u32::MAX) + 1000, u64::MAX / 2] {
            at += gap;
            assert!(clock.step(at) == 5e-3, "{gap}");
        }
        // An earlier stamp counts as none.
        assert!(clock.step(1) == 0.5e-3);
    }
}
