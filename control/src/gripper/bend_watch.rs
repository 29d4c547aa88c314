//! Detects an arm without touch that does not bend as its tension rises.
//!
//! An obstacle that the sensor does not feel (a cable, the wrong side of a pipe) stops the arm, and the controller
//! would wind to the force limit.

use super::Config;
use crate::filter::LowPass;

/// Tension rise over which an arm without touch must bend, N.
const WINDOW: f32 = 8.0;
/// Least tension of the watch, N: below, the tendon may be slack, knotted 1 mm too long (8 N) with the tilt off by 0.03
/// rad (6 N).
const TENSION_MIN: f32 = 20.0;
/// Least share of the expected bending: 1 for a free arm within its model, 0.4 for the stiffest on a pipe's skin, 0.2
/// for a soft one.
const BEND_SHARE_MIN: f32 = 0.6;
/// Delay of the watch on an arm that starts under tension, s.
const START_TIME: f32 = 0.4;
/// Cut-off of tilt and tension, rad/s.
const CUTOFF: f32 = 20.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendWatch {
    tilt: LowPass,
    tension: LowPass,
    from: Option<BendSample>,
    /// Time until the watch begins, s.
    wait: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendSample {
    /// Tilt, rad.
    pub tilt: f32,
    /// Tension, N.
    pub tension: f32,
    /// Demanded force, N.
    pub force: f32,
}

impl BendWatch {
    pub fn new(tilt: f32, tension: f32) -> Self {
        Self {
            tilt: LowPass::at(tilt),
            tension: LowPass::at(tension),
            from: None,
            wait: 0.0,
        }
    }

    /// For an arm that starts under tension: its late tilt looks like a rise.
    pub fn of_a_start(tilt: f32, tension: f32) -> Self {
        Self {
            wait: START_TIME,
            ..Self::new(tilt, tension)
        }
    }

    /// One step of `dt` s; returns the force before the rise, N, if the tension rose by the window but the tilt hardly
    /// fell.
    pub fn step(&mut self, cfg: &Config, sample: BendSample, dt: f32) -> Option<f32> {
        let tilt = self.tilt.step(sample.tilt, CUTOFF, dt);
        let tension = self.tension.step(sample.tension, CUTOFF, dt);
        let now = BendSample {
            tilt,
            tension,
            ..sample
        };
        if self.wait > 0.0 {
            self.wait -= dt;
            return None;
        }
        let Some(from) = self.from else {
            self.from = (tension > TENSION_MIN).then_some(now);
            return None;
        };
        let rise = tension - from.tension;
        if rise < WINDOW {
            return None;
        }
        self.from = Some(now);
        (from.tilt - tilt < BEND_SHARE_MIN * cfg.bend_per_force * rise).then_some(from.force)
    }
}
