//! Pulses for motor controllers: standard PWM and OneShot125, between the ends that the parameters have.

use sophie_control::allocation::motor_pulses::MotorPulses;
use sophie_control::params::Params;

use crate::pwm_timing::PwmTiming;

/// Pulse protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PulseRate {
    /// `motor_pulse_min` to `motor_pulse_max`, at most 400 Hz: a DJI 430 Lite takes 30 to 450 Hz.
    Standard,
    /// An eighth of that, one per mix.
    OneShot125,
}

impl PulseRate {
    /// Least time between pulse starts, µs.
    pub const fn period_us(self) -> u32 {
        match self {
            // 400 Hz (PX4's rate); some controllers accept no more.
            Self::Standard => 2500,
            // Only the pulse is specified; two must not merge. The longest is 275 µs.
            Self::OneShot125 => 300,
        }
    }

    /// This pulse over a standard one.
    const fn share(self) -> f32 {
        match self {
            Self::Standard => 1.0,
            Self::OneShot125 => 0.125,
        }
    }
}

/// Pulses of a protocol between a controller's ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EscPulse {
    rate: PulseRate,
    /// `None`: out of order.
    pulses: Option<MotorPulses>,
}

impl EscPulse {
    /// Those of the parameters.
    pub fn new(rate: PulseRate, params: &Params) -> Self {
        Self {
            rate,
            pulses: MotorPulses::from_params(params),
        }
    }

    /// Its protocol.
    pub const fn rate(self) -> PulseRate {
        self.rate
    }

    /// Timer values at `clock_hz`.
    pub fn timing(self, clock_hz: u32) -> Option<PwmTiming> {
        PwmTiming::new(clock_hz, self.rate.period_us())
    }

    /// Pulse of a motor command, µs: the stop pulse for 0 and anything not positive, the longest for 1. 0, no
    /// pulse at all, where the ends are out of order: the stop pulse is unknown then, and a controller without pulses stops.
    pub fn pulse_us(self, command: f32) -> f32 {
        self.pulses
            .map_or(0.0, |pulses| pulses.pulse_us(command) * self.rate.share())
    }

    /// Compare value of a motor command.
    pub fn compare(self, timing: &PwmTiming, command: f32) -> u32 {
        timing.compare(self.pulse_us(command))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With the ends of a DJI 430 Lite.
    fn dji() -> Params {
        Params {
            motor_pulse_min: 1120.0,
            motor_pulse_idle: 1180.0,
            motor_pulse_max: 1920.0,
            ..Params::default()
        }
    }

    #[test]
    fn pulses_have_the_protocol_s_length() {
        for (rate, params, low, idle, high) in [
            (PulseRate::Standard, Params::default(), 1000.0, 1070.0, 2000.0),
            (PulseRate::OneShot125, Params::default(), 125.0, 133.75, 250.0),
            (PulseRate::Standard, dji(), 1120.0, 1180.0, 1920.0),
            (PulseRate::OneShot125, dji(), 140.0, 147.5, 240.0),
        ] {
            let pulse = EscPulse::new(rate, &params);
            let t = pulse.timing(168_000_000).unwrap();
            for (command, us) in [
                (0.0, low),
                (-1.0, low),
                (f32::NAN, low),
                (f32::EPSILON, low),
                ((idle - low) / (high - low), idle),
                (0.5, 0.5 * (low + high)),
                (1.0, high),
                (7.0, high),
                (f32::INFINITY, high),
            ] {
                let counted = pulse.compare(&t, command) as f32 * t.count_us();
                assert!((counted - us).abs() < 0.05, "{pulse:?} {command}: {counted}");
            }
        }
    }

    #[test]
    fn ends_out_of_order_make_no_pulse_at_all() {
        // The upper end taken for the lower one: what should stop a motor would be full drive.
        let swapped = Params {
            motor_pulse_min: 1500.0,
            motor_pulse_max: 1200.0,
            ..Params::default()
        };
        let pulse = EscPulse::new(PulseRate::Standard, &swapped);
        let t = pulse.timing(168_000_000).unwrap();
        for command in [0.0, 0.5, 1.0, f32::NAN] {
            assert_eq!(pulse.compare(&t, command), 0, "{command}");
        }
    }

    #[test]
    fn a_full_pulse_ends_before_its_period_and_the_period_before_a_command_of_1_khz() {
        let longest = Params::row("motor_pulse_max").unwrap().max;
        let params = Params {
            motor_pulse_max: longest,
            ..Params::default()
        };
        // The third command after a standard pulse.
        for (rate, commands) in [(PulseRate::Standard, 2..3), (PulseRate::OneShot125, 0..1)] {
            let pulse = EscPulse::new(rate, &params);
            for clock in [84_000_000, 168_000_000, 200_000_000, 216_000_000] {
                let t = pulse.timing(clock).unwrap();
                let period = t.period as f32 * t.count_us();
                assert!(pulse.pulse_us(1.0) + 9.0 < period, "{rate:?} {clock}: {period}");
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
        let standard = EscPulse::new(PulseRate::Standard, &Params::default());
        let t = standard.timing(84_000_000).unwrap();
        assert!(1000.0 / t.count_us() > 2000.0);
        let short = EscPulse::new(PulseRate::OneShot125, &Params::default());
        let t = short.timing(84_000_000).unwrap();
        assert!(125.0 / t.count_us() > 2000.0);
    }
}
