//! Whether a range stands still: it does not change although noise, or the vehicle's motion, must have changed it.
//!
//! A reading in millimetres is finer than its noise, so that equal ones are rare: a run of n has a probability below
//! exp(-n / m) for a usual run of m, which is learnt, since a module may send each reading several times. One in centimetres
//! is coarser than its noise and may stand while the vehicle does: there the inertial sensor must say that it has moved.

use super::range_scale::Climb;
use crate::maths::elapsed::seconds;

/// Readings that differ by less are equal, m.
const EQUAL: f32 = 1e-4;
/// Step below which a module shows millimetres, m. With 3 mm of noise (VL53L1X, measured) 25 of 2.5 mm are equal once in 10¹².
const FINE: f32 = 2.5e-3;
/// Usual runs that are one of a module that stands still, ln 10⁹ = 20.7, and at least so many readings, of 1.2 each.
const RUNS: f32 = 20.7;
const LEAST: f32 = 25.0;
/// Share of a new run that the usual one follows, and its longest: 12 readings a second, sent a hundred times.
const FOLLOW: f32 = 0.05;
const LONGEST: f32 = 8.0;
/// Up to here, m, equal ranges are no sign of a vehicle that stands, and twice as many are one of a vehicle that flies: some
/// modules read their least for the half second in which it sinks on.
const NEAR: f32 = 0.1;
/// Coarsest reading, m, and the deviation of a range with what it lags behind, m.
const RESOLUTION: f32 = 0.01;
const NOISE: f32 = 0.02;
/// Deviations, squared, by which a way must exceed these: five, one in 1.7 million runs.
const EXCEEDS: f32 = 25.0;
/// Acceleration beyond which it is a shock, m/s².
const SHOCK: f32 = 4.0;
/// Time for which no module holds or delays a reading, µs.
const HELD: u64 = 250_000;
/// Time in the air, µs, in which noise of 3 mm alone leaves the middle of a centimetre at 24 readings a second, but for once in
/// 10⁹: 205 readings that stay in it with 0.904 each.
const STILL: u64 = 8_500_000;

/// The way since a run began, by the inertial sensor alone.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way {
    began_us: u64,
    at_us: u64,
    /// Height that the range gave, m, with what tilt and lever make of it.
    height: f32,
    /// Way, m, and speed, m/s, up, and what was known of it when it began.
    way: f32,
    rate: f32,
    climb: Climb,
}

/// The last readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frozen {
    before: Option<f32>,
    /// Equal ones in a row after the first, and since when they are in the air, µs.
    same: u32,
    since_us: u64,
    still: bool,
    /// Readings of a usual run, and whether the module shows millimetres.
    usual: f32,
    fine: bool,
    /// A run has begun of which the way is not known yet.
    begun: bool,
    way: Option<Way>,
    /// The vehicle has moved farther than the range shows: now, and at an equal reading.
    exceeds: bool,
    moved: bool,
}

impl Default for Frozen {
    /// None yet.
    fn default() -> Self {
        Self {
            before: None,
            same: 0,
            since_us: 0,
            still: false,
            usual: 1.0,
            fine: false,
            begun: false,
            way: None,
            exceeds: false,
            moved: false,
        }
    }
}

impl Frozen {
    /// The range stands still.
    pub fn holds(&self) -> bool {
        let near = self.before.is_some_and(|before| before <= NEAR);
        let runs = (RUNS * self.usual).max(LEAST) * if near { 2.0 } else { 1.0 };
        self.moved || self.still || (self.fine && self.same as f32 >= runs)
    }

    /// Takes a reading of `distance` m, at `at_us` µs, of a vehicle whose rotors carry it where it `flies`.
    pub fn take(&mut self, distance: f32, at_us: u64, flies: bool) {
        let step = self.before.map_or(f32::MAX, |before| (before - distance).abs());
        if step >= EQUAL {
            if !self.holds() && self.before.is_some() {
                let run = (self.same as f32 + 1.0).min(LONGEST);
                self.usual += FOLLOW * (run - self.usual);
            }
            self.fine |= step < FINE;
            (self.same, self.since_us) = (0, at_us);
            (self.still, self.moved, self.exceeds) = (false, false, false);
            (self.begun, self.way) = (true, None);
        } else if flies || distance > NEAR {
            self.same = self.same.saturating_add(1);
            if !flies {
                self.since_us = at_us;
            }
            let time = at_us.saturating_sub(self.since_us);
            self.still |= time > STILL;
            self.moved |= self.exceeds && time > HELD;
        } else {
            (self.same, self.since_us) = (0, at_us);
        }
        self.before = Some(distance);
    }

    /// A run of equal readings has a way, or is to have one.
    #[inline(always)]
    pub fn feels(&self) -> bool {
        self.begun || self.way.is_some()
    }

    /// Carries the way on to `at_us` µs with what is felt `down`wards, m/s², gravity left out, of a vehicle whose share down
    /// of its axis is `cos` and whose lens lies `lever` m below. Where it does not fly, and does not `climb` as is known, there
    /// is none.
    pub fn feel(&mut self, at_us: u64, down: Option<f32>, (cos, lever): (f32, f32), climb: Option<Climb>) {
        let (Some(down), Some(distance)) = (down.filter(|a| a.abs() < SHOCK), self.before) else {
            (self.way, self.exceeds) = (None, false);
            return;
        };
        let height = distance * cos + lever;
        if core::mem::take(&mut self.begun) {
            self.way = climb.map(|climb| Way {
                began_us: at_us,
                at_us,
                height,
                way: 0.0,
                rate: climb.rate,
                climb,
            });
            return;
        }
        let Some(way) = &mut self.way else {
            return;
        };
        let dt = seconds(way.at_us, at_us);
        way.at_us = at_us;
        way.rate += (way.climb.bias - down) * dt;
        way.way += way.rate * dt;
        // What the range shows of it, though it stands still, is what tilt and lever do.
        let off = (way.way - (height - way.height)).abs() - RESOLUTION;
        let variance = way.climb.way_variance(seconds(way.began_us, at_us)) + NOISE * NOISE;
        self.exceeds = off > 0.0 && off * off > EXCEEDS * variance;
    }
}
