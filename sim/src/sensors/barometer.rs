//! A board's barometer: a DPS310 that measures on command over 8 samples.
//!
//! | quantity | value | source |
//! |---|---|---|
//! | noise, step, time of a measurement | 0.4 Pa, 0.06 Pa, 14.8 ms | DPS310's data sheet |
//! | drift, 0.2 m in ten minutes | 0.1 Pa/√s | its long-term and thermal drift, 0.5 Pa/K |
//! | prop wash and gusts at the board | below | assumed |

use std::collections::VecDeque;

use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;
use sophie_control::navigation::air_pressure::AirPressure;

use crate::normal::StandardNormal;
use crate::streams::Streams;

/// Time of a measurement, µs.
pub const MEASUREMENT_US: u64 = 14_800;
/// Pressure at the ground, Pa, and the height in which it falls by a factor e, m: the standard atmosphere at 15 °C.
const GROUND: f64 = 101_325.0;
const SCALE_HEIGHT: f64 = 8_434.0;
/// White noise, and step of the result, Pa.
const NOISE: f64 = 0.4;
const STEP: f64 = 0.06;
/// Random walk of its zero, Pa/√s.
const WALK: f64 = 0.1;
/// Pressure drop at the board by the rotors' wash at hover thrust, Pa, and its lag, s.
const WASH: f64 = 6.0;
const WASH_LAG: f64 = 0.3;
/// Pressure noise by wash and gusts at hover thrust, Pa RMS (0.17 m), and its correlation time, s.
const SWING: f64 = 2.0;
const SWING_TIME: f64 = 1.0;
/// Temperature of the part, °C: 10 °C above the air.
const CELSIUS: f32 = 25.0;
/// Height of a jump, Pa, its time, ms, and rate of a drift, Pa/s: 2 m and 1 m/s.
const JUMP: f64 = 24.0;
const JUMP_MS: u64 = 300;
const DRIFT: f64 = 12.0;

/// Fault of a barometer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BarometerFault {
    /// Sound.
    #[default]
    None,
    /// It sends nothing.
    Silent,
    /// It repeats its last value.
    Frozen,
    /// It jumps by 2 m, back and forth.
    Jumps,
    /// It drifts by 1 m/s.
    Drifts,
}

/// The barometer of one board.
#[derive(Clone, Debug)]
pub struct Barometer {
    rng: Pcg64Mcg,
    /// Weight of the vehicle, N: the thrust in hover.
    weight: f64,
    /// Since power-up, ms.
    ms: u64,
    zero: f64,
    wash: f64,
    swing: f64,
    /// True pressures at the board of the last measurement's time, Pa.
    recent: VecDeque<f64>,
    fault: BarometerFault,
    failure: (u64, u64),
    held: Option<AirPressure>,
}

impl Barometer {
    /// A barometer without fault, with the errors of `streams`, on a vehicle of `weight` N.
    #[must_use]
    pub fn new(streams: Streams, weight: f64) -> Self {
        Self {
            rng: streams.of("barometer"),
            weight,
            ms: 0,
            zero: streams.within("barometer.zero", -100.0, 100.0),
            wash: 0.0,
            swing: 0.0,
            recent: VecDeque::new(),
            fault: BarometerFault::None,
            failure: (0, 0),
            held: None,
        }
    }

    /// The same, with `fault` from `at` s after power-up for `seconds`.
    #[must_use]
    pub fn failing(self, fault: BarometerFault, at: f64, seconds: f64) -> Self {
        let failure = ((at * 1e3) as u64, ((at + seconds) * 1e3) as u64);
        Self {
            fault,
            failure,
            ..self
        }
    }

    /// Advances by a millisecond to `height` m above the ground under a total thrust of `thrust` N.
    pub fn step(&mut self, height: f64, thrust: f64) {
        const DT: f64 = 1e-3;
        let thrust = thrust / self.weight;
        self.ms += 1;
        self.zero += WALK * DT.sqrt() * self.normal();
        self.wash += (WASH * thrust - self.wash) * DT / (DT + WASH_LAG);
        let shake = SWING * (2.0 * DT / SWING_TIME).sqrt() * self.normal();
        self.swing += shake - self.swing * DT / SWING_TIME;
        let air = GROUND * libm::exp(-height / SCALE_HEIGHT);
        self.recent
            .push_back(air + self.zero - self.wash + self.swing * thrust);
        if self.recent.len() > (MEASUREMENT_US / 1000) as usize {
            self.recent.pop_front();
        }
    }

    /// The measurement that ends `now` µs after power-up; `None` from a silent part.
    pub fn measure(&mut self, now: u64) -> Option<AirPressure> {
        let mean = self.recent.iter().sum::<f64>() / self.recent.len().max(1) as f64;
        let mut pascal = mean + NOISE * self.normal();
        let at_us = now.saturating_sub(MEASUREMENT_US / 2);
        let (begins, ends) = self.failure;
        match self.fault {
            _ if !(begins..ends).contains(&self.ms) => self.held = None,
            BarometerFault::None => {}
            BarometerFault::Silent => return None,
            BarometerFault::Frozen => {
                if let Some(held) = self.held {
                    return Some(AirPressure { at_us, ..held });
                }
            }
            BarometerFault::Jumps if (self.ms / JUMP_MS).is_multiple_of(2) => pascal += JUMP,
            BarometerFault::Jumps => {}
            BarometerFault::Drifts => pascal += DRIFT * 1e-3 * (self.ms - begins) as f64,
        }
        let air = AirPressure {
            at_us,
            pascal: ((pascal / STEP).round() * STEP) as f32,
            celsius: CELSIUS,
        };
        self.held = Some(air);
        Some(air)
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.rng)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pressures, 25 a second, at `height` with `thrust`, for `seconds`.
    fn pressures(barometer: &mut Barometer, height: f64, thrust: f64, seconds: u64) -> Vec<f64> {
        let mut found = vec![];
        for _ in 0..seconds * 1000 {
            barometer.step(height, thrust);
            if barometer.ms.is_multiple_of(40) {
                let air = barometer.measure(barometer.ms * 1000).unwrap();
                found.push(f64::from(air.pascal));
            }
        }
        found
    }

    fn mean_and_rms(values: &[f64]) -> (f64, f64) {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        (
            mean,
            (values.iter().map(|p| (p - mean) * (p - mean)).sum::<f64>() / n).sqrt(),
        )
    }

    #[test]
    fn a_metre_is_twelve_pascal_and_the_rotors_add_their_wash() {
        let mut barometer = Barometer::new(Streams::new(3), 1.0);
        let (ground, still) = mean_and_rms(&pressures(&mut barometer, 0.0, 0.0, 4));
        let (high, _) = mean_and_rms(&pressures(&mut barometer, 10.0, 0.0, 4));
        assert!((ground - high - 120.1).abs() < 1.0, "{}", ground - high);
        let (low, swings) = mean_and_rms(&pressures(&mut barometer, 10.0, 1.0, 60));
        assert!((high - low - WASH).abs() < 2.0, "{}", high - low);
        assert!(
            (0.3..0.8).contains(&still) && (1.2..3.0).contains(&swings),
            "{still} {swings}"
        );
    }

    #[test]
    fn a_fault_lasts_as_long_as_it_was_asked_for() {
        let sound = || Barometer::new(Streams::new(4), 1.0);
        let mut frozen = sound().failing(BarometerFault::Frozen, 1.0, 2.0);
        let all = pressures(&mut frozen, 1.0, 1.0, 4);
        assert!(all[27..72].windows(2).all(|w| w[0] == w[1]) && all[80..].windows(2).any(|w| w[0] != w[1]));
        let mut drifts = sound().failing(BarometerFault::Drifts, 1.0, 10.0);
        let all = pressures(&mut drifts, 1.0, 0.0, 11);
        assert!((all[270] - all[24] - 120.0).abs() < 6.0, "{}", all[270] - all[24]);
        let mut jumps = sound().failing(BarometerFault::Jumps, 1.0, 10.0);
        let all = pressures(&mut jumps, 1.0, 0.0, 11);
        let far = all
            .windows(2)
            .filter(|w| (w[0] - w[1]).abs() > 0.8 * JUMP)
            .count();
        assert!((30..36).contains(&far), "{far}");
    }
}
