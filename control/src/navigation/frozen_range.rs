//! Detects a frozen range: it does not change although noise, or the vehicle's motion, must have changed it.
//!
//! Readings in millimetres are finer than their noise, so that equal ones are rare: a run of n has a probability below
//! exp(-n / m) for a usual run length of m. m is learnt, since a module may send each reading several times. Readings
//! in centimetres are coarser than their noise and may repeat while the vehicle hovers: there the inertial sensor must
//! show that it has moved.

use super::range_scale::Climb;
use crate::maths::elapsed::seconds;

/// Readings that differ by less are equal, m.
const EQUAL: f32 = 1e-4;
/// Step below which a module has millimetre resolution, m. With 3 mm of noise (VL53L1X, measured) 25 readings of 2.5
/// mm are equal once in 10¹².
const FINE: f32 = 2.5e-3;
/// Run that makes a module frozen, in usual runs, ln 10⁹ = 20.7, and at least in readings, for a usual run of 1.2.
const RUNS: f32 = 20.7;
const LEAST: f32 = 25.0;
/// Share by which the usual run follows a new one, and its upper bound: 12 readings a second, sent at 100 Hz.
const FOLLOW: f32 = 0.05;
const LONGEST: f32 = 8.0;
/// Distance up to which equal ranges of a standing vehicle prove nothing, and a flying one needs twice as many, m:
/// some modules report their least distance for the half second in which the vehicle sinks further.
const NEAR: f32 = 0.1;
/// Coarsest resolution, m, and the deviation of a range, its lag included, m.
const RESOLUTION: f32 = 0.01;
const NOISE: f32 = 0.02;
/// Deviations, squared, by which the inertial displacement must exceed these: five, one in 1.7 million runs.
const EXCEEDS: f32 = 25.0;
/// Acceleration beyond which it is a shock and the displacement is dropped, m/s².
const SHOCK: f32 = 4.0;
/// Longest time for which a module holds or delays a reading, µs.
const HELD: u64 = 250_000;
/// Time in flight after which equal readings are a fault, µs: at 24 readings a second, noise of 3 mm alone stays in
/// the middle of a centimetre for so long once in 10⁹ (205 readings with 0.904 each).
const STILL: u64 = 8_500_000;

/// Inertial displacement since a run of equal readings began.
#[derive(Clone, Copy, Debug, PartialEq)]
struct InertialClimb {
    began_us: u64,
    at_us: u64,
    /// Height by the range at the beginning, m, corrected for tilt and lever arm.
    height: f32,
    /// Displacement, m, and speed, m/s, up, and the climb estimate at the beginning.
    displacement: f32,
    rate: f32,
    climb: Climb,
}

/// State of the detector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frozen {
    before: Option<f32>,
    /// Equal readings in a row after the first, and since when they are in flight, µs.
    same: u32,
    since_us: u64,
    still: bool,
    /// Usual run, in readings, and whether the module has millimetre resolution.
    usual: f32,
    fine: bool,
    /// A run has begun whose displacement is not initialised yet.
    begun: bool,
    climbed: Option<InertialClimb>,
    /// The vehicle has moved farther than the range shows: at present, and latched at an equal reading.
    exceeds: bool,
    moved: bool,
}

impl Default for Frozen {
    /// No reading yet.
    fn default() -> Self {
        Self {
            before: None,
            same: 0,
            since_us: 0,
            still: false,
            usual: 1.0,
            fine: false,
            begun: false,
            climbed: None,
            exceeds: false,
            moved: false,
        }
    }
}

impl Frozen {
    /// The range is frozen.
    pub fn holds(&self) -> bool {
        let near = self.before.is_some_and(|before| before <= NEAR);
        let runs = (RUNS * self.usual).max(LEAST) * if near { 2.0 } else { 1.0 };
        self.moved || self.still || (self.fine && self.same as f32 >= runs)
    }

    /// Takes a reading of `distance` m, at `at_us` µs; `flies` is true while the rotors carry the vehicle.
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
            (self.begun, self.climbed) = (true, None);
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

    /// A run of equal readings has a displacement, or is to begin one.
    #[inline(always)]
    pub fn needs_motion(&self) -> bool {
        self.begun || self.climbed.is_some()
    }

    /// Integrates the displacement to `at_us` µs with the measured acceleration `down`, m/s², gravity removed. `cos`
    /// is the down component of the vehicle's down axis, `lever` the offset of the lens below the centre of mass, m.
    /// Outside of flight the displacement is dropped, and without a `climb` estimate it does not begin.
    pub fn predict(&mut self, at_us: u64, down: Option<f32>, (cos, lever): (f32, f32), climb: Option<Climb>) {
        let (Some(down), Some(distance)) = (down.filter(|a| a.abs() < SHOCK), self.before) else {
            (self.climbed, self.exceeds) = (None, false);
            return;
        };
        let height = distance * cos + lever;
        if core::mem::take(&mut self.begun) {
            self.climbed = climb.map(|climb| InertialClimb {
                began_us: at_us,
                at_us,
                height,
                displacement: 0.0,
                rate: climb.rate,
                climb,
            });
            return;
        }
        let Some(climbed) = &mut self.climbed else {
            return;
        };
        let dt = seconds(climbed.at_us, at_us);
        climbed.at_us = at_us;
        climbed.rate += (climbed.climb.bias - down) * dt;
        climbed.displacement += climbed.rate * dt;
        // An equal range changes the height by tilt and lever arm alone.
        let off = (climbed.displacement - (height - climbed.height)).abs() - RESOLUTION;
        let variance = climbed
            .climb
            .displacement_variance(seconds(climbed.began_us, at_us))
            + NOISE * NOISE;
        self.exceeds = off > 0.0 && off * off > EXCEEDS * variance;
    }
}
