//! Contact pressure from the counts of a force-sensing resistor's divider.
//!
//! The resistor hangs between the supply and the converter's pin, a fixed resistor between the pin and
//! ground: x = counts / full scale = R_d / (R_d + R), so the conductance is x / ((1 - x) R_d). It grows in
//! proportion to the force (Interlink integration guide), and the force over the sensor's area is the
//! pressure. An unloaded sensor conducts nothing: 0 counts alone are no fault.

use crate::math;
use crate::params::Params;

/// Full scale of the 12-bit converter.
pub const FULL_SCALE: f32 = 4095.0;

/// Counts beyond which the sensor must be shorted: below 240 Ω with a 10 kΩ divider, 40 N on the sensor.
const SHORT_COUNTS: u16 = 4000;
/// Counts below which nothing conducts.
const OPEN_COUNTS: u16 = 3;
/// Pressure that cannot vanish within [`OPEN_TIME`], Pa: paying out takes three times as long.
const OPEN_PRESSURE: f32 = 300.0;
/// Time from pressure to nothing that only a broken lead needs, s, and the time for which nothing must last.
const OPEN_TIME: f32 = 0.008;
/// Time of plausible counts after which a fault is over, s.
const RECOVERY_TIME: f32 = 0.2;

/// What is wrong with a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FsrFault {
    /// The pressure vanished faster than any tendon can pay out: a broken lead.
    Open,
    /// It conducts more than the largest force would make it.
    Short,
    /// The converter gave more counts than it has, or nothing at all.
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
        Self { pascal_per_siemens: 1.0 / (p.fsr_gain * p.fsr_area), divider: p.fsr_divider }
    }

    /// Pressure (Pa) for the counts `counts`, which are limited to what a sound sensor gives.
    pub fn pressure(&self, counts: u16) -> f32 {
        let counts = if counts > SHORT_COUNTS { SHORT_COUNTS } else { counts };
        let x = f32::from(counts) / FULL_SCALE;
        x / ((1.0 - x) * self.divider) * self.pascal_per_siemens
    }
}

/// One sensor: its scale is applied and its faults are watched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fsr {
    /// Time since there was pressure, s; `None` when there has been none.
    loaded_before: Option<f32>,
    nothing_for: f32,
    fault: Option<FsrFault>,
    sound_for: f32,
}

impl Fsr {
    /// One conversion of `counts`, `dt` s after the one before; `None` when the converter gave nothing.
    ///
    /// # Errors
    /// The fault, until the counts have been plausible for 0.2 s.
    pub fn step(&mut self, scale: &FsrScale, counts: Option<u16>, dt: f32) -> Result<f32, FsrFault> {
        let dt = math::clamp(dt, 0.0, 0.1);
        let now = match counts {
            Some(c) if c <= 4095 => self.judge(scale, c, dt),
            _ => Err(FsrFault::Converter),
        };
        match (now, self.fault) {
            (Err(fault), _) => {
                self.fault = Some(fault);
                self.sound_for = 0.0;
                Err(fault)
            }
            (Ok(pressure), None) => Ok(pressure),
            (Ok(pressure), Some(fault)) => {
                self.sound_for += dt;
                if self.sound_for < RECOVERY_TIME {
                    return Err(fault);
                }
                self.fault = None;
                Ok(pressure)
            }
        }
    }

    fn judge(&mut self, scale: &FsrScale, counts: u16, dt: f32) -> Result<f32, FsrFault> {
        if counts > SHORT_COUNTS {
            return Err(FsrFault::Short);
        }
        let pressure = scale.pressure(counts);
        if pressure > OPEN_PRESSURE {
            self.loaded_before = Some(0.0);
        } else if let Some(age) = &mut self.loaded_before {
            *age += dt;
        }
        if counts >= OPEN_COUNTS {
            self.nothing_for = 0.0;
            return Ok(pressure);
        }
        self.nothing_for += dt;
        // Full pressure and then at once nothing, for longer than a knock.
        let vanished = self.loaded_before.is_some_and(|age| age < self.nothing_for + OPEN_TIME);
        // An open lead reads nothing for good: the fault stays until there is something again.
        let stays = self.fault == Some(FsrFault::Open);
        if self.nothing_for > OPEN_TIME && !vanished {
            self.loaded_before = None;
        }
        if stays || (vanished && self.nothing_for > OPEN_TIME) { Err(FsrFault::Open) } else { Ok(pressure) }
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
        assert!(f.step(&scale(), Some(2368), DT).is_ok());
        assert!(f.step(&scale(), Some(4095), DT) == Err(FsrFault::Short));
        let mut steps = 0;
        while f.step(&scale(), Some(2368), DT).is_err() {
            steps += 1;
            assert!(steps < 200);
        }
        assert!((98..=101).contains(&steps), "{steps}");
    }

    #[test]
    fn an_unloaded_sensor_is_no_fault_but_a_vanished_pressure_is() {
        let mut f = Fsr::default();
        for _ in 0..1000 {
            assert!(f.step(&scale(), Some(0), DT) == Ok(0.0));
        }
        for _ in 0..1000 {
            assert!(f.step(&scale(), Some(2368), DT).is_ok());
        }
        let opened = (0..10).position(|_| f.step(&scale(), Some(0), DT) == Err(FsrFault::Open));
        assert!(opened.is_some_and(|i| (3..=5).contains(&i)), "{opened:?}");
        // For good: a minute later it is still open.
        for _ in 0..30_000 {
            assert!(f.step(&scale(), Some(0), DT) == Err(FsrFault::Open));
        }
    }

    #[test]
    fn a_tendon_that_pays_out_is_no_open_lead() {
        let mut f = Fsr::default();
        // From 950 Pa to nothing in 60 ms, faster than any release.
        for i in 0..30u16 {
            assert!(f.step(&scale(), Some(2368 - 79 * i), DT).is_ok(), "{i}");
        }
        for _ in 0..1000 {
            assert!(f.step(&scale(), Some(0), DT) == Ok(0.0));
        }
    }

    #[test]
    fn a_silent_converter_is_a_fault() {
        assert!(Fsr::default().step(&scale(), None, DT) == Err(FsrFault::Converter));
        assert!(Fsr::default().step(&scale(), Some(5000), DT) == Err(FsrFault::Converter));
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
                (proptest::option::of(proptest::num::u16::ANY), proptest::num::f32::ANY), 1..60),
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
