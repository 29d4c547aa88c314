//! Motor controllers on pulses: standard PWM and OneShot125.

use sophie_control::math;

use crate::pwm_timing::PwmTiming;

/// Protocol of a motor controller that takes pulses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EscPulse {
    /// 1000 to 2000 µs, 400 frames a second: what a DJI 430 Lite takes.
    #[default]
    Standard,
    /// 125 to 250 µs, 1000 frames a second: one for each mix.
    OneShot125,
}

impl EscPulse {
    /// Frames a second.
    pub const fn frame_hz(self) -> u32 {
        match self {
            Self::Standard => 400,
            Self::OneShot125 => 1000,
        }
    }

    /// Pulse of a stopped motor, µs.
    pub const fn stop_us(self) -> f32 {
        match self {
            Self::Standard => 1000.0,
            Self::OneShot125 => 125.0,
        }
    }

    /// Timer values for a timer clocked at `clock_hz`.
    pub fn timing(self, clock_hz: u32) -> Option<PwmTiming> {
        PwmTiming::new(clock_hz, self.frame_hz())
    }

    /// Pulse of a motor command, µs: the stop pulse for 0 and for anything that is not a positive number,
    /// twice as long for 1.
    pub fn pulse_us(self, command: f32) -> f32 {
        // The clamp turns a NaN into its lower bound.
        self.stop_us() * (1.0 + math::clamp(command, 0.0, 1.0))
    }

    /// Counts of a motor command, for the compare register.
    pub fn compare(self, timing: &PwmTiming, command: f32) -> u32 {
        timing.compare(self.pulse_us(command))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulses_have_the_protocol_s_length() {
        for (protocol, low, high) in [
            (EscPulse::Standard, 1000.0, 2000.0),
            (EscPulse::OneShot125, 125.0, 250.0),
        ] {
            let t = protocol.timing(168_000_000).unwrap();
            for (command, us) in [
                (0.0, low),
                (-1.0, low),
                (f32::NAN, low),
                (0.5, 0.5 * (low + high)),
                (1.0, high),
                (7.0, high),
                (f32::INFINITY, high),
            ] {
                let counted = protocol.compare(&t, command) as f32 * t.count_us();
                assert!((counted - us).abs() < 0.05, "{protocol:?} {command}: {counted}");
            }
            // A full pulse leaves room before the next one.
            assert!(high < 1e6 / protocol.frame_hz() as f32 - 100.0);
        }
    }

    #[test]
    fn steps_are_finer_than_dshot_s() {
        // 2000 steps over the range are what DShot has.
        let t = EscPulse::Standard.timing(84_000_000).unwrap();
        assert!(1000.0 / t.count_us() > 2000.0);
        let t = EscPulse::OneShot125.timing(84_000_000).unwrap();
        assert!(125.0 / t.count_us() > 2000.0);
    }
}
