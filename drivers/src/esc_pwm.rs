//! Motor controllers on pulses: standard PWM and OneShot125.

use sophie_control::math;

use crate::pwm_timing::PwmTiming;

/// Protocol of a motor controller that takes pulses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EscPulse {
    /// 1000 to 2000 µs, at most 400 a second: what a DJI 430 Lite takes.
    #[default]
    Standard,
    /// 125 to 250 µs, one for each mix.
    OneShot125,
}

impl EscPulse {
    /// Time that a pulse and the rest after it take, µs: no other begins before.
    pub const fn period_us(self) -> u32 {
        match self {
            // Controllers on standard pulses take 400 a second (PX4 sends them so many), some no more.
            Self::Standard => 2500,
            // The length of its pulses is all that OneShot125 is; two must not run into one.
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

    /// Timer values for a timer clocked at `clock_hz`.
    pub fn timing(self, clock_hz: u32) -> Option<PwmTiming> {
        PwmTiming::new(clock_hz, self.period_us())
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
        }
    }

    #[test]
    fn a_full_pulse_ends_before_its_period_and_the_period_before_a_command_of_1_khz() {
        // The third command after a standard pulse, the next one after a short pulse.
        for (protocol, high, commands) in [
            (EscPulse::Standard, 2000.0, 2..3),
            (EscPulse::OneShot125, 250.0, 0..1),
        ] {
            for clock in [84_000_000, 168_000_000, 200_000_000, 216_000_000] {
                let t = protocol.timing(clock).unwrap();
                let period = t.period as f32 * t.count_us();
                assert!(high + 9.0 < period, "{protocol:?} {clock}: {period}");
                let ms = (period * 1e-3) as u32;
                // A command that comes a quarter of a millisecond early or late changes nothing.
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
        // 2000 steps over the range are what DShot has.
        let t = EscPulse::Standard.timing(84_000_000).unwrap();
        assert!(1000.0 / t.count_us() > 2000.0);
        let t = EscPulse::OneShot125.timing(84_000_000).unwrap();
        assert!(125.0 / t.count_us() > 2000.0);
    }
}
