//! Timer values of pulse trains: from microseconds to counts.

use sophie_control::math;

/// Prescaler and period of a timer for a frame rate, and the length of a count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PwmTiming {
    /// What the prescaler register takes: the clock is divided by one more.
    pub prescaler: u16,
    /// Counts of a frame; the reload register takes one less.
    pub period: u32,
    counts_per_us: f32,
}

impl PwmTiming {
    /// Counts of a 16-bit timer.
    const COUNTS: u32 = 1 << 16;
    /// Counts at the end of a frame that no pulse may fill: two pulses must not run into one.
    const REST: u32 = 2;

    /// The finest values for `frame_hz` frames a second on a 16-bit timer that is clocked at `clock_hz`;
    /// `None` for a rate that it cannot make.
    pub fn new(clock_hz: u32, frame_hz: u32) -> Option<Self> {
        let per_frame = clock_hz.checked_div(frame_hz)?;
        let divider = per_frame.div_ceil(Self::COUNTS).max(1);
        let prescaler = u16::try_from(divider - 1).ok()?;
        let rate = frame_hz.checked_mul(divider)?;
        let period = (clock_hz.checked_add(rate / 2)?)
            .checked_div(rate)?
            .min(Self::COUNTS);
        (period > Self::REST).then(|| Self {
            prescaler,
            period,
            counts_per_us: clock_hz as f32 * 1e-6 / divider as f32,
        })
    }

    /// Length of a count, µs.
    pub fn count_us(&self) -> f32 {
        1.0 / self.counts_per_us
    }

    /// What is left of a frame of which `passed` counts have passed, µs, rounded.
    pub fn left_us(&self, passed: u32) -> u32 {
        (self.period.saturating_sub(passed) as f32 * self.count_us() + 0.5) as u32
    }

    /// Counts of a pulse of `us` µs, for the compare register; 0 (no pulse) for 0, for a negative number and
    /// for a NaN, and never as long as the frame.
    pub fn compare(&self, us: f32) -> u32 {
        let longest = self.period.saturating_sub(Self::REST);
        let counts = math::clamp(us * self.counts_per_us + 0.5, 0.0, longest as f32);
        counts as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_fit_a_16_bit_timer_and_pulses_are_exact() {
        for clock in [
            84_000_000,
            108_000_000,
            168_000_000,
            200_000_000,
            216_000_000,
            240_000_000,
        ] {
            for hz in [50, 100, 200, 333, 400, 1000, 2000] {
                let t = PwmTiming::new(clock, hz).unwrap();
                assert!(t.period <= 65536, "{clock} {hz}: {t:?}");
                let frame_us = t.period as f32 * t.count_us();
                assert!(
                    (frame_us * hz as f32 * 1e-6 - 1.0).abs() < 1e-3,
                    "{clock} {hz}: {t:?}"
                );
                // Half a count of rounding at most; a count is at most 0.31 µs, at 50 Hz.
                for us in [125.0, 250.0f32] {
                    assert!((t.compare(us) as f32 * t.count_us() - us).abs() <= 0.51 * t.count_us());
                }
                assert!(t.count_us() < 0.32);
            }
        }
    }

    #[test]
    fn nonsense_makes_no_pulse_and_no_endless_one() {
        let t = PwmTiming::new(168_000_000, 400).unwrap();
        for us in [0.0, -5.0, f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(t.compare(us), 0);
        }
        assert!(t.compare(1e9) < t.period && t.compare(f32::INFINITY) < t.period);
        assert!(PwmTiming::new(168_000_000, 0).is_none());
        assert!(PwmTiming::new(100, 400).is_none());
        assert!(PwmTiming::new(240_000_000, 1).is_some_and(|t| t.period <= 65536));
        assert!(PwmTiming::new(u32::MAX, 1).is_none());
    }

    #[test]
    fn what_is_left_of_a_frame_falls_to_nothing() {
        // 108 MHz by 33: 65,455 counts of 0.3056 µs are 20 ms.
        let t = PwmTiming::new(108_000_000, 50).unwrap();
        assert_eq!((t.prescaler, t.period), (32, 65_455));
        for (passed, us) in [
            (0, 20_000),
            (16_364, 15_000),
            (65_454, 0),
            (65_455, 0),
            (70_000, 0),
        ] {
            assert_eq!(t.left_us(passed), us, "{passed}");
        }
    }
}
