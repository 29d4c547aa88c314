//! Contact pressure from the counts of a force-sensing resistor's divider.
//!
//! The resistor hangs between the supply and the converter's pin, a fixed resistor between the pin and
//! ground: x = counts / full scale = R_d / (R_d + R), so the conductance is x / ((1 - x) R_d). It grows in
//! proportion to the force (Interlink integration guide), and the force over the sensor's area is the
//! pressure. An unloaded sensor conducts nothing, so an open lead looks like no pressure at all: only the clamp
//! loop, which knows what it pulls, can tell ([`crate::clamp::Fault::Unfelt`]).

use crate::math;
use crate::params::Params;

/// Full scale of the 12-bit converter.
pub const FULL_SCALE: f32 = 4095.0;

/// Counts beyond which the sensor must be shorted: below 240 Ω with a 10 kΩ divider, 40 N on the sensor.
const SHORT_COUNTS: u16 = 4000;
/// Time of plausible counts after which a fault is over, s.
const RECOVERY_TIME: f32 = 0.2;

/// What is wrong with a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FsrFault {
    /// It conducts more than the largest force would make it.
    Short,
    /// The converter gave more counts than it has.
    Converter,
}

/// Scale of a sensor and its divider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FsrScale {
    pascal_per_siemens: f32,
    divider: f32,
}

impl FsrScale {
    /// The sensor that the parameters describe.
    pub fn from_params(p: &Params) -> Self {
        Self {
            pascal_per_siemens: 1.0 / (p.fsr_gain * p.fsr_area),
            divider: p.fsr_divider,
        }
    }

    /// Pressure (Pa) for the counts `counts`, which are limited to what a sound sensor gives.
    pub fn pressure(&self, counts: u16) -> f32 {
        let counts = if counts > SHORT_COUNTS {
            SHORT_COUNTS
        } else {
            counts
        };
        let x = f32::from(counts) / FULL_SCALE;
        x / ((1.0 - x) * self.divider) * self.pascal_per_siemens
    }
}

/// One sensor: its scale is applied and its faults are watched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fsr {
    fault: Option<FsrFault>,
    sound_for: f32,
}

impl Fsr {
    /// One conversion of `counts`, `dt` s after the one before; returns the pressure, Pa.
    ///
    /// # Errors
    /// The fault, until the counts have been plausible for 0.2 s.
    pub fn step(&mut self, scale: &FsrScale, counts: u16, dt: f32) -> Result<f32, FsrFault> {
        let now = match counts {
            0..=SHORT_COUNTS => None,
            c if f32::from(c) <= FULL_SCALE => Some(FsrFault::Short),
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
            self.sound_for += math::clamp(dt, 0.0, 0.1);
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

    fn scale() -> FsrScale {
        FsrScale::from_params(&Params {
            fsr_gain: 1e-4,
            fsr_area: 0.001_444,
            fsr_divider: 10_000.0,
            ..Params::default()
        })
    }

    const DT: f32 = 0.002;

    #[test]
    fn the_divider_by_hand() {
        // 950 Pa on 1444 mm² are 1.3718 N: 0.13718 mS, 7289.7 Ω; 10/(10 + 7.2897)·4095 = 2368.5 counts.
        assert!((scale().pressure(2368) - 950.0).abs() < 1.0);
        // Half scale: R = R_d = 10 kΩ, 1 N, 692.5 Pa.
        assert!((scale().pressure(2047) - 692.5).abs() < 1.0);
        assert!(scale().pressure(0) == 0.0);
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
        fn more_counts_never_mean_less_pressure(a in 0u16..4096, b in 0u16..4096) {
            let (low, high) = if a < b { (a, b) } else { (b, a) };
            prop_assert!(scale().pressure(low) <= scale().pressure(high));
            prop_assert!(scale().pressure(high).is_finite());
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
