//! Pulses for motor controllers: standard PWM and OneShot125.

use sophie_control::math;

use crate::pwm_timing::PwmTiming;

/// Pulse protocol.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EscPulse {
    /// 1000 to 2000 µs, at most 400 Hz, as a DJI 430 Lite accepts.
    #[default]
    Standard,
    /// 125 to 250 µs, one per mix.
    OneShot125,
}

impl EscPulse {
    /// Least time between pulse starts, µs.
    pub const fn period_us(self) -> u32 {
        match self {
            // 400 Hz (PX4's rate); some controllers accept no more.
            Self::Standard => 2500,
            // Only the pulse is specified; two must not merge.
            Self::OneShot125 => 260,
        }
    }

    /// Pulse of a stopped motor, µs.
    pub const fn stop_us(self) -> f32 {
        match self {
            Self::Standard => 1000.0,
            Self::OneShot125 => 125.0,
        }
    }

    /// Timer values at `clock_hz`.
    pub fn timing(self, clock_hz: u32) -> Option<PwmTiming> {
        PwmTiming::new(clock_hz, self.period_us())
    }

    /// Pulse of a motor command, µs: the stop pulse for 0 and anything not positive, twice as long for 1.
    pub fn pulse_us(self, command: f32) -> f32 {
        // The clamp maps NaN to its lower bound.
        self.stop_us() * (1.0 + math::clamp(command, 0.0, 1.0))
    }

    /// Compare value of a motor command.
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
        }
    }

    #[test]
    fn a_full_pulse_ends_before_its_period_and_the_period_before_a_command_of_1_khz() {
        // The third command after a standard pulse.
        for (protocol, high, commands) in [
            (EscPulse::Standard, 2000.0, 2..3),
            (EscPulse::OneShot125, 250.0, 0..1),
        ] {
            for clock in [84_000_000, 168_000_000, 200_000_000, 216_000_000] {
                let t = protocol.timing(clock).unwrap();
                let period = t.period as f32 * t.count_us();
                assert!(high + 9.0 < period, "{protocol:?} {clock}: {period}");
                let ms = (period * 1e-3) as u32;
                // A command 0.25 ms early or late changes nothing.
                let margin = (period * 1e-3).fract();
                assert!(
                    commands.contains(&ms) && (0.25..0.75).contains(&margin),
                    "{clock}: {period}"
                );
            }
        }
    }

    #[test]
    fn steps_are_finer_than_dshot_s() {
        // DShot has 2000 steps over the range.
        let t = EscPulse::Standard.timing(84_000_000).unwrap();
        assert!(1000.0 / t.count_us() > 2000.0);
        let t = EscPulse::OneShot125.timing(84_000_000).unwrap();
        assert!(125.0 / t.count_us() > 2000.0);
    }
}
