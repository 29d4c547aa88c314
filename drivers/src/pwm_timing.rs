//! Timer values of pulse trains: microseconds to counts.

use sophie_control::maths::scalar;

/// Prescaler, period and counts per µs of a frame rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PwmTiming {
    /// Prescaler register: divider less one.
    pub prescaler: u16,
    /// Counts per frame; the reload register takes one less.
    pub period: u32,
    counts_per_us: f32,
}

impl PwmTiming {
    const COUNTS: u32 = 1 << 16;
    /// Counts that separate two pulses.
    const REST: u32 = 2;

    /// Finest values of a 16-bit timer at `clock_hz` for frames of exactly `frame_us` µs; `None` if the timer cannot.
    /// Exact frames keep their phase to the board's clock: an error of 1e-7 shifts them by 0.4 ms an hour. The finest
    /// values win if exactness costs more than twice the count.
    pub fn new(clock_hz: u32, frame_us: u32) -> Option<Self> {
        // Unit: a millionth of a clock; a count is `MICRO` times the divider.
        const MICRO: u64 = 1_000_000;
        let frame = u64::from(clock_hz) * u64::from(frame_us);
        let least = frame.div_ceil(MICRO * u64::from(Self::COUNTS)).max(1);
        let exact = (least..=2 * least).find(|divider| frame.is_multiple_of(divider * MICRO));
        let divider = exact.unwrap_or(least);
        let prescaler = u16::try_from(divider - 1).ok()?;
        let count = divider * MICRO;
        let period = u32::try_from((frame + count / 2) / count).ok()?.min(Self::COUNTS);
        (period > Self::REST).then(|| Self {
            prescaler,
            period,
            counts_per_us: clock_hz as f32 * 1e-6 / divider as f32,
        })
    }

    /// Count length, µs.
    pub fn count_us(&self) -> f32 {
        1.0 / self.counts_per_us
    }

    /// Counts after `us` µs of a frame, limited to the frame.
    pub fn passed(&self, us: u32) -> u32 {
        ((us as f32 * self.counts_per_us) as u32).min(self.period - 1)
    }

    /// Rest of a frame after `passed` counts, µs, rounded.
    pub fn left_us(&self, passed: u32) -> u32 {
        (self.period.saturating_sub(passed) as f32 * self.count_us() + 0.5) as u32
    }

    /// Compare value of a pulse of `us` µs, shorter than the frame; 0 (no pulse) for 0, negative numbers and NaN.
    pub fn compare(&self, us: f32) -> u32 {
        let longest = self.period.saturating_sub(Self::REST);
        let counts = scalar::clamp(us * self.counts_per_us + 0.5, 0.0, longest as f32);
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
            for frame_us in [20_000, 10_000, 5000, 3003, 2500, 1000, 500] {
                let t = PwmTiming::new(clock, frame_us).unwrap();
                assert!(t.period <= 65536, "{clock} {frame_us}: {t:?}");
                let clocks = u64::from(t.period) * (u64::from(t.prescaler) + 1);
                assert_eq!(
                    clocks * 1_000_000,
                    u64::from(clock) * u64::from(frame_us),
                    "{t:?}"
                );
                // Rounding of half a count; a count is at most 1/3 µs, at 50 Hz.
                for us in [125.0, 250.0f32] {
                    assert!((t.compare(us) as f32 * t.count_us() - us).abs() <= 0.51 * t.count_us());
                }
                assert!(t.count_us() < 0.334);
            }
        }
    }

    #[test]
    fn nonsense_makes_no_pulse_and_no_endless_one() {
        let t = PwmTiming::new(168_000_000, 2500).unwrap();
        for us in [0.0, -5.0, f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(t.compare(us), 0);
        }
        assert!(t.compare(1e9) < t.period && t.compare(f32::INFINITY) < t.period);
        assert!(PwmTiming::new(168_000_000, 0).is_none());
        assert!(PwmTiming::new(100, 2500).is_none());
        assert!(PwmTiming::new(240_000_000, 1_000_000).is_some_and(|t| t.period <= 65536));
        assert!(
            PwmTiming::new(u32::MAX, 1_000_000).is_none() && PwmTiming::new(u32::MAX, u32::MAX).is_none()
        );
    }

    #[test]
    fn what_is_left_of_a_frame_falls_to_nothing() {
        // 108 MHz by 36: 60,000 counts of a third of a µs are 20 ms.
        let t = PwmTiming::new(108_000_000, 20_000).unwrap();
        assert_eq!((t.prescaler, t.period), (35, 60_000));
        for (passed, us) in [
            (0, 20_000),
            (15_000, 15_000),
            (59_999, 0),
            (60_000, 0),
            (70_000, 0),
        ] {
            assert_eq!(t.left_us(passed), us, "{passed}");
        }
        for (us, passed) in [(0, 0), (1, 3), (5000, 15_000), (19_999, 59_997), (20_000, 59_999)] {
            assert_eq!(t.passed(us), passed, "{us}");
        }
    }
}
