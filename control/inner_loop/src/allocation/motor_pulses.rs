//! Pulses of the motor controllers: their two ends, and the dead zone above the lower one.
//!
//! A controller counts its drive from the lower end (AM32, SimonK: a linear map of the pulse between its ends) and stops
//! its motor below some pulse inside the range. So a command keeps the place that it has between the ends, which keeps
//! thrust right at every command, and one for a rotor that must turn is raised to the dead zone's end
//! ([`least_command`]): it is never spread over what is above it.

use crate::maths::scalar;
use crate::params::{MotorProtocol, Params};

/// Largest share of the range that may lie below the idle pulse: four rotors that idle at a full battery lift a third of
/// the default vehicle. ArduPilot refuses beyond the same share (`MOT_SPIN_MIN`); dead zones are 5 to 15 %.
const DEAD_MAX: f32 = 0.3;
/// A step of DShot, which has 2000: such a controller turns its motor at its lowest throttle.
const DIGITAL: f32 = 0.000_5;
/// Twice the error of the curve's root, so that it does not fall below the idle pulse: 0.004 µs of 1000.
const ROUNDING: f32 = 4e-6;

/// Pulses between the ends, µs, in the order stop, idle, full. OneShot125 takes an eighth of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorPulses {
    stop_us: f32,
    idle_us: f32,
    full_us: f32,
}

impl MotorPulses {
    /// Those of the parameters; `None` where `motor_pulse_min`, `_idle` and `_max` do not rise, or the dead zone takes
    /// more than 30 % of the range: no pulse is safe then.
    // In several tasks: the image has it once, and so the next two.
    #[inline(never)]
    pub fn from_params(p: &Params) -> Option<Self> {
        let pulses = Self {
            stop_us: p.motor_pulse_min,
            idle_us: p.motor_pulse_idle,
            full_us: p.motor_pulse_max,
        };
        let dead = pulses.idle_us - pulses.stop_us;
        (dead > 0.0 && dead <= DEAD_MAX * pulses.span_us()).then_some(pulses)
    }

    /// What stands for pulses where there are none, as with DShot: 1000 to 2000 µs.
    pub const DIGITAL: Self = Self {
        stop_us: 1000.0,
        idle_us: 1000.0,
        full_us: 2000.0,
    };

    /// Those that commands are shown as: [`Self::DIGITAL`] where there are none, `None` where none are sent.
    pub fn shown(p: &Params) -> Option<Self> {
        if by_pulses(p) {
            Self::from_params(p)
        } else {
            Some(Self::DIGITAL)
        }
    }

    fn span_us(&self) -> f32 {
        self.full_us - self.stop_us
    }

    /// Pulse of a motor command: the stop pulse for 0 and what is not positive or no number, the longest for 1 and more.
    pub fn pulse_us(&self, command: f32) -> f32 {
        // The clamp maps NaN to its lower bound.
        self.stop_us + scalar::clamp(command, 0.0, 1.0) * self.span_us()
    }

    /// Command of a pulse between the ends.
    pub fn command(&self, pulse_us: f32) -> f32 {
        (pulse_us - self.stop_us) / self.span_us()
    }
}

/// True where the controllers take pulses.
pub const fn by_pulses(p: &Params) -> bool {
    matches!(p.motor_protocol, MotorProtocol::Pwm | MotorProtocol::Oneshot125)
}

/// Least command of a rotor that must turn. With pulses out of order no rotor turns, whatever the command.
#[inline(never)]
pub fn least_command(p: &Params) -> f32 {
    match MotorPulses::from_params(p).filter(|_| by_pulses(p)) {
        Some(pulses) => pulses.command(pulses.idle_us) + ROUNDING,
        None => DIGITAL,
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::allocation::least_thrust::{FULL_RATIO, least_thrust};
    use crate::allocation::thrust_curve::ThrustCurve;

    /// Ends, idle pulse.
    const RANGES: [[f32; 3]; 2] = [[1000.0, 1070.0, 2000.0], [1120.0, 1180.0, 1920.0]];

    fn with([motor_pulse_min, motor_pulse_idle, motor_pulse_max]: [f32; 3]) -> Params {
        Params {
            motor_protocol: MotorProtocol::Pwm,
            motor_pulse_min,
            motor_pulse_idle,
            motor_pulse_max,
            ..Params::default()
        }
    }

    fn pulses(range: [f32; 3]) -> MotorPulses {
        MotorPulses::from_params(&with(range)).unwrap()
    }

    #[test]
    fn a_command_keeps_its_place_between_the_ends() {
        for range in RANGES {
            let [stop, idle, full] = range;
            let pulses = pulses(range);
            for (command, us) in [
                (0.0, stop),
                (-1.0, stop),
                (f32::NAN, stop),
                (f32::NEG_INFINITY, stop),
                (f32::EPSILON, stop),
                (pulses.command(idle), idle),
                (0.5, 0.5 * (stop + full)),
                (1.0, full),
                (7.0, full),
                (f32::INFINITY, full),
            ] {
                let pulse = pulses.pulse_us(command);
                assert!((pulse - us).abs() < 2e-3, "{range:?} {command}: {pulse}");
            }
        }
        // What hovers: 4.43 N of 8.3 N are a command of 0.693, which a DJI must get as 1674 µs, not 1693.
        let hover = ThrustCurve::from_params(&Params::default()).command(4.426, 1.0);
        let [usual, dji] = RANGES.map(|range| pulses(range).pulse_us(hover));
        assert!(
            (usual - 1692.6).abs() < 1.0 && (dji - 1674.1).abs() < 1.0,
            "{usual} {dji}"
        );
    }

    #[test]
    fn ends_that_do_not_rise_have_no_pulse() {
        for range in [
            [1000.0, 1000.0, 2000.0],
            [1120.0, 1070.0, 1920.0],
            [1000.0, 2000.0, 2000.0],
            [1000.0, 2100.0, 2000.0],
            [1500.0, 1550.0, 1500.0],
            [1500.0, 1400.0, 1200.0],
            [f32::NAN, 1070.0, 2000.0],
            [1000.0, f32::NAN, 2000.0],
            [1000.0, 1070.0, f32::NAN],
            // Rises, but four such rotors would almost lift the vehicle when it is armed.
            [1000.0, 1500.0, 2000.0],
        ] {
            assert_eq!(MotorPulses::from_params(&with(range)), None, "{range:?}");
        }
        assert!(MotorPulses::from_params(&with([1000.0, 1300.0, 2000.0])).is_some());
    }

    #[test]
    fn the_dead_zone_counts_where_there_are_pulses() {
        let dji = with(RANGES[1]);
        assert!((least_command(&dji) - 0.075).abs() < 1e-5);
        let digital = Params {
            motor_protocol: MotorProtocol::Dshot300,
            ..dji
        };
        assert_eq!(least_command(&digital), DIGITAL);
        // The dead zones of both ranges lie below what rotors idle at anyway; a wider one raises it.
        let idle = Params::default().thrust_idle;
        for params in [Params::default(), digital, dji, with(RANGES[0])] {
            assert_eq!(least_thrust(&params), idle, "{params:?}");
        }
        let wide = least_thrust(&with([1120.0, 1230.0, 1920.0]));
        // (4.2 / 3.7)² · 8.3 N · (0.75 · 0.1375² + 0.25 · 0.1375).
        assert!((wide - 0.5193).abs() < 1e-3, "{wide}");
    }

    proptest! {
        #[test]
        fn whatever_thrust_is_asked_of_a_rotor_that_must_turn_it_turns(
            stop in 800.0f32..1500.0, dead in 1.0f32..200.0, above in 500.0f32..900.0, thrust in any::<f32>(),
            ratio in any::<f32>(), curve in 0.0f32..=1.0,
        ) {
            let range = [stop, stop + dead, stop + dead + above];
            let params = Params { thrust_curve: curve, ..with(range) };
            let pulses = pulses(range);
            let curve = ThrustCurve::from_params(&params);
            for ratio in [ratio, 0.7, 1.0, FULL_RATIO] {
                for thrust in [thrust, 0.0, f32::EPSILON, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                    for command in curve.commands(&[thrust; 4], ratio) {
                        let pulse = pulses.pulse_us(command);
                        prop_assert!((range[1]..=range[2]).contains(&pulse), "{thrust} {ratio}: {pulse}");
                    }
                }
            }
        }
    }
}
