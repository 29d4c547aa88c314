//! Watches that an arm bends as its tension rises, as long as its sensor feels nothing.
//!
//! Something that the sensor does not feel (a cable, the wrong side of a pipe) stops the arm: the tension then rises
//! and the tilt does not fall, and the controller would wind to the force limit.

use super::Config;
use crate::filter::LowPass;

/// Rise of the tension (N) over which an arm that does not touch is expected to bend.
const WINDOW: f32 = 8.0;
/// Tension (N) from which that is watched: below it the tendon may still be slack, when it was knotted 1 mm too
/// long (8 N) and the tilt is wrong by 0.03 rad (6 N).
const TENSION_MIN: f32 = 20.0;
/// Share of the expected bending below which something unfelt holds the arm: a free arm bends by 1 within its
/// model, the stiffest on the skin of a pipe by 0.4, a soft one by 0.2.
const BEND_SHARE_MIN: f32 = 0.6;
/// Time after the start of an arm that is under tension already, s, from which on that is watched.
const START_TIME: f32 = 0.4;
/// Cut-off of tilt and tension, rad/s.
const CUTOFF: f32 = 20.0;

/// The watch of one arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendWatch {
    tilt: LowPass,
    tension: LowPass,
    from: Option<BendSample>,
    /// Time for which nothing is judged yet, s.
    wait: f32,
}

/// One step of an arm that does not touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendSample {
    /// Tilt, rad.
    pub tilt: f32,
    /// Tension of the tendon, N.
    pub tension: f32,
    /// Force asked for, N.
    pub force: f32,
}

impl BendWatch {
    /// A watch that begins at this tilt (rad) and tension (N).
    pub fn new(tilt: f32, tension: f32) -> Self {
        Self {
            tilt: LowPass::at(tilt),
            tension: LowPass::at(tension),
            from: None,
            wait: 0.0,
        }
    }

    /// A watch of an arm that starts to move under tension: at first its tilt is late and the tension seems to rise.
    pub fn of_a_start(tilt: f32, tension: f32) -> Self {
        Self {
            wait: START_TIME,
            ..Self::new(tilt, tension)
        }
    }

    /// One step of `dt` s. When the tension rose by the window but the tilt hardly fell: the force that was asked
    /// for before, N.
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
