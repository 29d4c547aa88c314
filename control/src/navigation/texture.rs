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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_noise::TestNoise;

    const DT: f32 = 0.02;
    const NOISE: f32 = 2.4e-3;
    /// Inverse distances of a pipe and of the ground, 1/m, each half of the view.
    const PIPE: f32 = 1.0 / 0.6;
    const GROUND: f32 = 1.0 / 2.1;

    /// What is learnt in `seconds` of a sway of this `speed`, m/s at 0.8 Hz, over a pipe of this `weight`, with a speed that is
    /// estimated `off` m/s wrong after five seconds, as a bias makes it.
    fn learnt(weight: f32, speed: f32, off: f32, seconds: f32) -> Texture {
        let mut noise = TestNoise(3);
        let mut texture = Texture::default();
        for i in 0..(seconds / DT) as u32 {
            let phase = 5.0 * DT * i as f32;
            let off = off * (0.2 * DT * i as f32).min(1.0);
            let flow = |speed: f32, weight: f32| {
                let moved = speed * DT;
                moved * (weight * PIPE + (1.0 - weight) * GROUND)
            };
            let speeds = [speed * scalar::sin(phase), speed * scalar::cos(phase)];
            let innovations =
                speeds.map(|v| flow(v, weight) - flow(v + off, texture.weight()) + NOISE * noise.normal());
            let sensitivities = speeds.map(|v| (v + off) * DT * (PIPE - GROUND));
            texture.update(innovations, sensitivities, NOISE, DT);
        }
        texture
    }

    #[test]
    fn the_stronger_texture_is_learnt_from_a_sway() {
        for weight in [0.1, 0.5, 0.9] {
            let texture = learnt(weight, 0.15, 0.0, 10.0);
            assert!((texture.weight() - weight).abs() < 0.15, "{weight}: {texture:?}");
            assert!(texture.deviation() < 0.12, "{weight}: {texture:?}");
        }
    }

    #[test]
    fn without_motion_or_by_a_steady_error_of_the_speed_nothing_is_learnt() {
        let still = learnt(0.9, 0.0, 0.0, 10.0);
        assert!(
            (still.weight() - 0.5).abs() < 1e-6 && still.deviation() > 0.28,
            "{still:?}"
        );
        let steady = learnt(0.5, 0.0, 0.2, 10.0);
        assert!((steady.weight() - 0.5).abs() < 0.15, "{steady:?}");
    }
}
