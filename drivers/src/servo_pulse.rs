//! Servo pulses: microseconds to counts.

use sophie_control::maths::scalar;

use crate::pwm_timing::PwmTiming;

/// Shortest and longest pulse, µs: a safety limit.
pub const LIMITS_US: [f32; 2] = [400.0, 2600.0];
/// Shortest and longest frame, µs: analog servos accept 50 Hz, digital ones up to 333 Hz.
pub const FRAME_US: core::ops::RangeInclusive<u32> = 3003..=20_000;

/// Timer values at `clock_hz`; `None` for frames outside [`FRAME_US`].
pub fn timing(clock_hz: u32, frame_us: u32) -> Option<PwmTiming> {
    if FRAME_US.contains(&frame_us) {
        PwmTiming::new(clock_hz, frame_us)
    } else {
        None
    }
}

/// Compare value of a pulse of `us` µs: 0 (no pulse, servo not driven) for 0 and anything not positive, else limited to
/// [`LIMITS_US`].
pub fn compare(timing: &PwmTiming, us: f32) -> u32 {
    let [shortest, longest] = LIMITS_US;
    if us > 0.0 {
        timing.compare(scalar::clamp(us, shortest, longest))
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_are_limited_and_none_is_none() {
        for frame in [20_000, 10_000, 3003] {
            let t = timing(108_000_000, frame).unwrap();
            for (us, expected) in [
                (1500.0, 1500.0),
                (100.0, 400.0),
                (9000.0, 2600.0),
                (f32::INFINITY, 2600.0),
            ] {
                let counted = compare(&t, us) as f32 * t.count_us();
                assert!((counted - expected).abs() < 0.2, "{frame} {us}: {counted}");
            }
            for us in [0.0, -1500.0, f32::NAN] {
                assert_eq!(compare(&t, us), 0);
            }
        }
        assert!(timing(108_000_000, 20_001).is_none() && timing(108_000_000, 3002).is_none());
    }
}
