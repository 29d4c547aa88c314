//! Inertial vertical speed, independent of the range. A range whose scale changes, or that slides off a flank with a
//! wrong scale, corrupts the estimate's speed within tenths of a second; without a range afterwards that error would
//! last for seconds. This law detects it and replaces the estimate's speed, for up to [`HEIGHT_AGE`].

#[cfg(test)]
mod tests;

use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar::{clamp, clamp_abs};
use crate::navigation::estimate::Estimate;
use crate::navigation::fix_age::{FRESH_AGE, HEIGHT_AGE};

/// Time constants with which the inertial speed follows the estimate's, s, and the bias of the acceleration is learnt
/// from the difference, s.
const FOLLOW: f32 = 4.0;
const LEARN: f32 = 8.0;
/// Largest bias, m/s², and speed, m/s.
const BIAS_MAX: f32 = 0.3;
const SPEED_MAX: f32 = 20.0;
/// Age of the newest flow beyond which, with no range in reach, the height has no source, s.
const BLIND_AGE: f32 = 0.1;
/// Difference of the two speeds beyond which the inertial one is used, m/s: without a source of height, with a range,
/// and with an estimate that has just begun. On the first way to the pipe sound modules reach 0.22; on a later one,
/// one exceeded 0.25.
const BENT: f32 = 0.06;
const BROKEN: f32 = 0.25;
const UNLEARNT: f32 = 0.45;
/// The same near and above a crown, where no edge disturbs the speed: in 54 sound missions none exceeds 0.07; a range
/// that becomes 1.6 times too long 10 cm above the crown reaches 0.12.
const STEADY: f32 = 0.1;
/// Age from which an estimate has learnt the bias of its acceleration, s.
const LEARNING: f32 = 4.0;
/// Time for which the speeds must differ, s.
const BENT_TIME: f32 = 0.05;
/// Time constant with which the height correction is given back, s, and the correction that becomes an origin reset
/// instead, m.
const RETURN_TIME: f32 = 0.5;
const JUMP: f32 = 0.12;

/// The inertial vertical speed, and the height correction by it.
#[derive(Clone, Copy, Debug, Default)]
pub struct VerticalFallback {
    /// Speed downwards, m/s, and bias of the measured acceleration, m/s².
    speed: f32,
    bias: f32,
    differs: HoldTimer,
    /// Age of the estimate.
    age: HoldTimer,
    /// Time for which the inertial speed has been in use, s; `None` while the estimate's is.
    since: Option<f32>,
    /// A range that disagrees has started it in this step.
    misfit: bool,
    /// The vehicle is over a crown and near it.
    pub steady: bool,
    /// Correction of the estimate's height, m down, and count of the origin resets by it.
    lacks: f32,
    reset_count: u8,
}

impl VerticalFallback {
    /// One step of `dt` s with an acceleration of `down` m/s² along world down; it runs while the vehicle `flies`
    /// free.
    pub fn step(&mut self, flies: bool, down: f32, estimate: Option<&Estimate>, dt: f32) {
        let (bias, reset_count) = (self.bias, self.reset_count);
        let begun = Self {
            bias,
            reset_count,
            ..Self::default()
        };
        if !flies {
            *self = begun;
            return;
        }
        self.speed = clamp_abs(self.speed + (down - self.bias) * dt, SPEED_MAX);
        let Some(e) = estimate else {
            *self = Self {
                speed: self.speed,
                ..begun
            };
            return;
        };
        let off = e.velocity.z - self.speed;
        let learnt = self.age.step(true, dt) > LEARNING;
        let (ranged, blind) = (e.range_hit.age < f32::MAX, blind(e));
        let steady = core::mem::take(&mut self.steady);
        let limit = match (blind, learnt) {
            (true, _) => BENT,
            (false, true) if steady => STEADY,
            (false, true) => BROKEN,
            (false, false) => UNLEARNT,
        };
        let begins = self.differs.step((ranged || blind) && off.abs() > limit, dt) > BENT_TIME;
        self.misfit = self.since.is_none() && begins && learnt && limit > BENT;
        self.since = match self.since {
            // Poses that are back give the height.
            Some(since) => (off.abs() > BENT && (ranged || blind)).then_some(clamp(since + dt, 0.0, 1e3)),
            None => begins.then_some(0.0),
        };
        if self.since.is_some() {
            self.lacks -= off * dt;
            return;
        }
        self.speed += off * dt / FOLLOW;
        self.bias = clamp_abs(self.bias - off * dt / (FOLLOW * LEARN), BIAS_MAX);
        if self.lacks.abs() > JUMP {
            (self.lacks, self.reset_count) = (0.0, self.reset_count.wrapping_add(1));
        }
        self.lacks -= self.lacks * clamp(dt / RETURN_TIME, 0.0, 1.0);
    }

    /// The estimate with the inertial height and vertical speed, while these are in use.
    pub fn apply(&self, mut e: Estimate) -> Estimate {
        e.position.z += self.lacks;
        e.reset_count = e.reset_count.wrapping_add(self.reset_count);
        if let Some(point) = &mut e.range_hit.surface_point {
            point.z += self.lacks;
        }
        if let Some(since) = self.since {
            e.velocity.z = self.speed;
            // Dead reckoning gives no height for longer.
            e.age = if since > HEIGHT_AGE {
                e.age.max(since)
            } else {
                e.age
            };
        }
        e
    }

    /// In this step the range is found to disagree with the vehicle's motion.
    pub fn misfit(&self) -> bool {
        self.misfit
    }
}

/// The height has no source.
fn blind(e: &Estimate) -> bool {
    let seen = e.range_hit.surface_point.is_some() && e.range_hit.age <= FRESH_AGE;
    !seen && e.age > BLIND_AGE
}
