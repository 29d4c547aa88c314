//! Weight of the pipe's texture in the flow's picture against that of the ground beside it.
//!
//! A correlator follows the stronger texture: over a painted pipe on gravel it sees the gravel's motion, over a rusty one on
//! concrete the pipe's (docs/design/flow-and-range.md). With the weight w of the pipe, 1 - w of the ground, and their sums of
//! 1/distance over the view, the flow is the speed times (w P + (1 - w) G) / (w p + (1 - w) g). While both are in view, gusts
//! that the inertial sensor measures show which: a filter of one state.

use crate::maths::scalar;

/// Deviation of an unknown weight: that of even odds between 0 and 1.
const UNKNOWN: f32 = 0.29;
/// Walk of the weight as the vehicle moves along, 1/√s (assumed: 0.1 in 10 s).
const WALK: f32 = 0.03;
/// Bounds of the weight: contrasts of 1 to 7.
const BOUNDS: (f32, f32) = (0.02, 0.98);
/// Corner of the high-pass on innovation and sensitivity, rad/s: at lower frequencies the predicted speed comes from the flow itself.
const CUTOFF: f32 = 5.0;
/// Deviation of an innovation over that of the flow's noise: gyro, places and delays add to it (assumed).
const ROUGH: f32 = 1.5;

/// The weight and its variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texture {
    weight: f32,
    variance: f32,
    /// Low-passed innovation and sensitivity of each axis.
    slow: [[f32; 2]; 2],
}

impl Default for Texture {
    fn default() -> Self {
        Self {
            weight: 0.5,
            variance: UNKNOWN * UNKNOWN,
            slow: [[0.0; 2]; 2],
        }
    }
}

impl Texture {
    /// Weight of the pipe, 0 to 1: half of equal textures.
    pub fn weight(&self) -> f32 {
        self.weight
    }

    /// Deviation of the weight, 1.
    pub fn deviation(&self) -> f32 {
        scalar::sqrt(self.variance)
    }

    /// Takes a flow's innovations, rad, of which each rises by this `sensitivity`, rad, for a weight of one more; `noise` is the
    /// deviation of a flow, rad, `dt` the time since the last, s.
    pub fn update(&mut self, innovations: [f32; 2], sensitivities: [f32; 2], noise: f32, dt: f32) {
        let share = CUTOFF * dt / (1.0 + CUTOFF * dt);
        self.variance = (self.variance + WALK * WALK * dt).min(UNKNOWN * UNKNOWN);
        let noise = ROUGH * ROUGH * noise * noise;
        for ((slow, innovation), sensitivity) in self.slow.iter_mut().zip(innovations).zip(sensitivities) {
            let [y, h] = slow;
            *y += (innovation - *y) * share;
            *h += (sensitivity - *h) * share;
            let (y, h) = (innovation - *y, sensitivity - *h);
            let gain = self.variance * h / (h * h * self.variance + noise);
            self.weight = scalar::clamp(self.weight + gain * y, BOUNDS.0, BOUNDS.1);
            self.variance *= 1.0 - gain * h;
        }
    }
}
