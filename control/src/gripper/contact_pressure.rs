//! Contact pressure from the counts of a force-sensing resistor's divider.
//!
//! [`Fsr::step`] runs for every sensor at 500 Hz in the task `analog`. A missed conversion keeps the last pressure;
//! after 20 ms the gripper holds that arm's force.
//!
//! The resistor R hangs between supply and pad, a fixed R_d between pad and ground. The pad has the share x = R_d /
//! (R_d + R) of the supply, so the conductance is x / ((1 - x) R_d). It is proportional to the force (Interlink
//! integration guide); pressure is force over the sensor's area. With full scale at the share s, x = s counts / full
//! scale; on a bare pad s is 1. A pin that sees only a part s of x reads at most s / ((1 - s) R_d): 692 Pa for a half,
//! 69 Pa for an eleventh. An open lead reads as no pressure; only the gripper, which knows its pull, detects it
//! ([`crate::gripper::grip_fault::GripFault::Unfelt`]).
//!
//! A sensor in a curved skin conducts as G = g (F + F_p - F_0): the skin's curvature preloads it with F_p, and below the
//! turn-on force F_0 it conducts nothing (Interlink: 0.2 N; guide: 20 to 100 g). So F = G / g + (F_0 - F_p), and with
//! c = G / (g A), which is the pressure of a sensor without both, the pressure is p = c - z, z = (F_p - F_0) / A
//! ([`SensorLine`]). Of a sensor with more turn-on than preload z is negative and all pressures from 0 to -z give c = 0:
//! it reads 0 there, since an arm in the air must count as free. Just above, c is the noise of the converter, which must
//! not read as -z either: so the missing pressure is added in proportion up to c = `RAMP`, and in full from there on.

use crate::allocation::wrench::PerArm;
use crate::maths::scalar;
use crate::params::Params;

/// Full scale of the 12-bit converter.
pub const FULL_SCALE: f32 = 4095.0;

/// Counts of a shorted sensor on a bare pad: below 240 Ω with a 10 kΩ divider, 40 N on the sensor.
const SHORT_COUNTS: f32 = 4000.0;
/// Range over the grip pressure: a grip overshoots and is pushed.
const RANGE_MARGIN: f32 = 1.2;
/// Plausible time that clears a fault, s.
const RECOVERY_TIME: f32 = 0.2;

/// Conductance, as a pressure, over which the pressure that a late sensor misses is added, Pa. A count of noise (0.17 Pa
/// at 10 kΩ) reads as 1.3 Pa at the most of 650 Pa missed, a free arm with five counts far less than `release_pressure`.
/// From 750 Pa on, below a grip's tolerance, even that sensor reads by its line.
const RAMP: f32 = 100.0;

/// Line of one sensor: its conductance as a pressure by the common model, c Pa, is trim times (pressure + zero).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorLine {
    /// Conductance over the common one.
    pub trim: f32,
    /// Preload less turn-on force, over the area, Pa: what the unloaded sensor reads, or, negative, the pressure below
    /// which it reads nothing.
    pub zero: f32,
}

impl SensorLine {
    /// That of arm `arm` (0 to 3).
    pub const fn from_params(p: &Params, arm: usize) -> Self {
        let (trim, zero) = match arm {
            0 => (p.fsr_trim_1, p.fsr_zero_1),
            1 => (p.fsr_trim_2, p.fsr_zero_2),
            2 => (p.fsr_trim_3, p.fsr_zero_3),
            _ => (p.fsr_trim_4, p.fsr_zero_4),
        };
        Self { trim, zero }
    }

    /// Pressure below which the sensor reads nothing, Pa; 0 without one.
    pub fn turn_on(&self) -> f32 {
        if self.zero < 0.0 { -self.zero } else { 0.0 }
    }

    /// Pressure, Pa, at a conductance over the sensor's own of `c` Pa.
    pub fn pressure(&self, c: f32) -> f32 {
        if self.zero < 0.0 && c < RAMP {
            c - self.zero * (c / RAMP)
        } else {
            c - self.zero
        }
    }

    /// Conductance as a pressure by the common model, Pa, at which the sensor reads `pressure` Pa.
    pub fn conductance(&self, pressure: f32) -> f32 {
        let turn_on = self.turn_on();
        self.trim
            * if turn_on > 0.0 && pressure < RAMP + turn_on {
                pressure * (RAMP / (RAMP + turn_on))
            } else {
                pressure + self.zero
            }
    }
}

/// Fault of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FsrFault {
    /// Conducts more than under the largest force, or than its pad can show.
    Short,
    /// More counts than the converter's full scale.
    Converter,
}

/// Scale of a sensor, its divider and its pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FsrScale {
    pascal_per_siemens: f32,
    line: SensorLine,
    divider: f32,
    /// Counts at the whole supply.
    full: f32,
    /// Largest counts of a sound sensor.
    most: f32,
}

impl FsrScale {
    /// The sensor of arm `arm` (0 to 3).
    pub fn from_params(p: &Params, arm: usize) -> Self {
        let scale = match arm {
            0 => p.fsr_scale_1,
            1 => p.fsr_scale_2,
            2 => p.fsr_scale_3,
            _ => p.fsr_scale_4,
        };
        let line = SensorLine::from_params(p, arm);
        Self {
            pascal_per_siemens: 1.0 / (p.fsr_gain * line.trim * p.fsr_area),
            line,
            divider: p.fsr_divider,
            full: FULL_SCALE / scale,
            // Such a pin saturates first.
            most: if scale > 1.0 {
                SHORT_COUNTS / scale
            } else {
                SHORT_COUNTS
            },
        }
    }

    /// Scales of all four arms.
    pub fn all(p: &Params) -> PerArm<Self> {
        [0, 1, 2, 3].map(|arm| Self::from_params(p, arm))
    }

    /// Pressure below which the sensor reads nothing, Pa; 0 without one.
    pub fn turn_on(&self) -> f32 {
        self.line.turn_on()
    }

    /// Pressure, Pa, for `counts`, limited to a sound sensor's.
    pub fn pressure(&self, counts: u16) -> f32 {
        self.pressure_of(f32::from(counts))
    }

    /// Largest readable pressure, Pa.
    pub fn largest(&self) -> f32 {
        self.pressure_of(self.most)
    }

    /// The grip pressure can be read, with a fifth to spare.
    pub fn reaches_grip(&self, p: &Params) -> bool {
        self.largest() >= RANGE_MARGIN * p.grip_pressure
    }

    fn pressure_of(&self, counts: f32) -> f32 {
        let counts = if counts > self.most { self.most } else { counts };
        let x = counts / self.full;
        let c = x / ((1.0 - x) * self.divider) * self.pascal_per_siemens;
        self.line.pressure(c)
    }
}

/// One sensor with its fault detection.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fsr {
    fault: Option<FsrFault>,
    sound_for: f32,
}

impl Fsr {
    /// Takes one conversion, `dt` s after the last; returns the pressure, Pa.
    ///
    /// # Errors
    /// The fault, until the counts have been plausible for 0.2 s.
    pub fn step(&mut self, scale: &FsrScale, counts: u16, dt: f32) -> Result<f32, FsrFault> {
        let now = match f32::from(counts) {
            c if c <= scale.most => None,
            c if c <= FULL_SCALE => Some(FsrFault::Short),
            _ => Some(FsrFault::Converter),
        };
        if let Some(fault) = now {
            *self = Self {
                fault: now,
                sound_for: 0.0,
            };
            return Err(fault);
        }
        if let Some(fault) = self.fault {
            self.sound_for += scalar::clamp(dt, 0.0, 0.1);
            if self.sound_for < RECOVERY_TIME {
                return Err(fault);
            }
            self.fault = None;
        }
        Ok(scale.pressure(counts))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn params() -> Params {
        Params {
            fsr_gain: 1e-4,
            fsr_area: 0.001_444,
            fsr_divider: 10_000.0,
            grip_pressure: 950.0,
            ..Params::default()
        }
    }

    fn scale() -> FsrScale {
        FsrScale::from_params(&params(), 0)
    }

    fn scaled(full_scale: f32) -> FsrScale {
        FsrScale::from_params(
            &Params {
                fsr_scale_1: full_scale,
                ..params()
            },
            0,
        )
    }

    const DT: f32 = 0.002;

    #[test]
    fn each_sensor_has_its_own_zero_and_conductance() {
        let p = Params {
            fsr_trim_2: 2.0,
            fsr_zero_2: 40.0,
            fsr_trim_4: 0.5,
            ..params()
        };
        let [first, second, third, fourth] = FsrScale::all(&p).map(|scale| scale.pressure(2047));
        assert!(first == third && (first - 692.5).abs() < 1.0);
        assert!((second - (692.5 / 2.0 - 40.0)).abs() < 1.0, "{second}");
        assert!((fourth - 2.0 * 692.5).abs() < 1.0, "{fourth}");
    }

    #[test]
    fn a_sensor_with_a_turn_on_force_reads_by_its_line_and_nothing_without_conductance() {
        // 0.4 N on 1444 mm² are 277 Pa: it is missing at every pressure beyond 100 Pa of conductance.
        let p = Params {
            fsr_zero_1: -277.0,
            fsr_trim_1: 0.8,
            fsr_zero_2: -650.0,
            ..params()
        };
        let [late, latest, ..] = FsrScale::all(&p);
        // 2047 counts are 692.5 Pa by the common conductance.
        assert!((late.pressure(2047) - (692.5 / 0.8 + 277.0)).abs() < 1.0);
        assert!((latest.pressure(2047) - (692.5 + 650.0)).abs() < 1.0);
        assert!(late.pressure(0) == 0.0 && latest.pressure(0) == 0.0);
        // Half of the ramp, 50 Pa, 276 counts: half of what is missing is added.
        assert!(
            (latest.pressure(276) - (50.0 + 325.0)).abs() < 2.0,
            "{}",
            latest.pressure(276)
        );
        // Five counts of noise stay below the least release pressure, 20 Pa.
        assert!(latest.pressure(5) < 10.0, "{}", latest.pressure(5));
    }

    #[test]
    fn the_divider_by_hand() {
        // 950 Pa on 1444 mm² are 1.3718 N: 0.13718 mS, 7289.7 Ω; 10/(10 + 7.2897)·4095 = 2368.5 counts.
        assert!((scale().pressure(2368) - 950.0).abs() < 1.0);
        // Half scale: R = R_d = 10 kΩ, 1 N, 692.5 Pa.
        assert!((scale().pressure(2047) - 692.5).abs() < 1.0);
        assert!(scale().pressure(0) == 0.0);
    }

    #[test]
    fn a_pad_with_a_divider_reads_as_a_bare_one_once_its_full_scale_is_set() {
        // 950 Pa are the share 0.57838 of the supply: 2368.5 counts bare, 1184.2 behind 1:2, 215.3 behind 1:11.
        assert!((scaled(2.0).pressure(1184) - 950.0).abs() < 1.5);
        // A count is 11 Pa there.
        assert!((scaled(11.0).pressure(215) - 950.0).abs() < 6.0);
        // Not set, the whole supply reads as a half and an eleventh: x / (1 - x) is 1 and 0.1, times 692.52 Pa.
        assert!((scale().pressure(2047) - 692.5).abs() < 1.0);
        assert!((scale().pressure(372) - 69.25).abs() < 0.2);
    }

    #[test]
    fn a_range_must_reach_a_fifth_beyond_the_grip_pressure() {
        // The largest accepted share is 4000/4095; x / (1 - x) is 42.105, times 692.52 Pa.
        for full_scale in [1.0, 2.0, 11.0] {
            let scale = scaled(full_scale);
            assert!(
                (scale.largest() - 29_159.0).abs() < 20.0,
                "{full_scale}: {}",
                scale.largest()
            );
            assert!(scale.reaches_grip(&params()));
        }
        // A half and an eleventh: 0.95460 and 0.097464 times 692.52 Pa.
        for (full_scale, largest) in [(0.5, 661.1), (1.0 / 11.0, 67.50)] {
            let scale = scaled(full_scale);
            assert!((scale.largest() - largest).abs() < 0.1, "{}", scale.largest());
            assert!(!scale.reaches_grip(&params()));
        }
        // 1140 Pa are the share 0.62209: 0.63687 of the supply at 4095 counts.
        assert!(scaled(0.638).reaches_grip(&params()) && !scaled(0.636).reaches_grip(&params()));
        assert!(!scaled(f32::NAN).reaches_grip(&params()));
    }

    #[test]
    fn every_sensor_has_its_own_full_scale() {
        let p = Params {
            fsr_scale_1: 1.0,
            fsr_scale_2: 2.0,
            fsr_scale_3: 4.0,
            fsr_scale_4: 8.0,
            ..params()
        };
        let read = FsrScale::all(&p).map(|scale| scale.pressure(400));
        for (read, full_scale) in read.into_iter().zip([1.0, 2.0, 4.0, 8.0]) {
            let x = full_scale * 400.0 / 4095.0;
            assert!((read - x / (1.0 - x) * 692.52).abs() < 0.5, "{read}");
        }
    }

    #[test]
    fn a_short_behind_a_divider_is_seen() {
        for (full_scale, counts) in [(2.0, 2047), (11.0, 372), (0.5, 4095)] {
            let mut f = Fsr::default();
            assert!(f.step(&scaled(full_scale), counts, DT) == Err(FsrFault::Short));
        }
    }

    #[test]
    fn a_short_is_seen_at_once_and_recovers_after_a_while() {
        let mut f = Fsr::default();
        assert!(f.step(&scale(), 2368, DT).is_ok());
        assert!(f.step(&scale(), 4095, DT) == Err(FsrFault::Short));
        let mut steps = 0;
        while f.step(&scale(), 2368, DT).is_err() {
            steps += 1;
            assert!(steps < 200);
        }
        assert!((98..=101).contains(&steps), "{steps}");
    }

    #[test]
    fn an_unloaded_sensor_is_no_fault_and_a_garbled_converter_is() {
        let mut f = Fsr::default();
        assert!(f.step(&scale(), 0, DT) == Ok(0.0));
        assert!(f.step(&scale(), 5000, DT) == Err(FsrFault::Converter));
    }

    proptest! {
        #[test]
        fn more_counts_never_mean_less_pressure(a in 0u16..4096, b in 0u16..4096, zero in -650f32..300.0) {
            let (low, high) = if a < b { (a, b) } else { (b, a) };
            let scale = FsrScale::from_params(&Params { fsr_zero_1: zero, ..params() }, 0);
            prop_assert!(scale.pressure(low) <= scale.pressure(high));
            prop_assert!(scale.pressure(high).is_finite());
        }

        #[test]
        fn the_conductance_of_a_reading_gives_that_reading(
            c in 0f32..2000.0, trim in 0.2f32..5.0, zero in -650f32..300.0,
        ) {
            let line = SensorLine { trim, zero };
            let back = line.conductance(line.pressure(c)) / trim;
            prop_assert!((back - c).abs() < 1e-3 * (1.0 + c), "{back} {c}");
        }

        #[test]
        fn no_input_makes_a_bad_pressure(
            inputs in proptest::collection::vec(
                (proptest::num::u16::ANY, proptest::num::f32::ANY), 1..60),
        ) {
            let mut f = Fsr::default();
            for (counts, dt) in inputs {
                if let Ok(p) = f.step(&scale(), counts, dt) {
                    prop_assert!(p >= 0.0 && p.is_finite());
                }
            }
        }
    }
}
