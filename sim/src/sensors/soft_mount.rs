//! Printed platform between arms and inertial sensor: a mass on a spring along and about each axis.
//!
//! The sensor moves with the platform's spot, y'' = ω² (x - y) + 2 ζ ω (x' - y'), ω = 2π f: a motion far below f passes, one
//! at f is 1/(2ζ) times as large, one far above is kept away. Plates of printed TPU are at 25 to 60 Hz, ζ 0.1 (estimated).

use std::f64::consts::TAU;

use glam::DVec3;

/// A soft mount.
#[derive(Clone, Copy, Debug)]
pub struct SoftMount {
    omega: f64,
    zeta: f64,
    /// `None` before the first sample.
    motion: Option<Motion>,
}

#[derive(Clone, Copy, Debug)]
struct Motion {
    input: DVec3,
    output: DVec3,
    rate: DVec3,
}

impl SoftMount {
    /// A mount with its mode at `frequency` Hz and a damping ratio of `zeta`, which rests in its first sample's motion.
    #[must_use]
    pub fn new(frequency: f64, zeta: f64) -> Self {
        Self {
            omega: TAU * frequency,
            zeta,
            motion: None,
        }
    }

    /// The sensor's motion, `dt` s later, with `input` that of the arms' roots; any quantity linear in the motion.
    pub fn step(&mut self, dt: f64, input: DVec3) -> DVec3 {
        let motion = self.motion.get_or_insert(Motion {
            input,
            output: input,
            rate: DVec3::ZERO,
        });
        let moved = (input - std::mem::replace(&mut motion.input, input)) / dt;
        let acceleration = (input - motion.output) * (self.omega * self.omega)
            + (moved - motion.rate) * (2.0 * self.zeta * self.omega);
        motion.rate += acceleration * dt;
        motion.output += motion.rate * dt;
        motion.output
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE: f64 = 4000.0;

    /// Amplitude of the output for a sine of 1 at `frequency` Hz, once swung in.
    fn gain(mount: SoftMount, frequency: f64) -> f64 {
        let mut mount = mount;
        let n = (4.0 * RATE) as u32;
        let mut most: f64 = 0.0;
        for i in 0..n {
            let input = libm::sin(TAU * frequency * f64::from(i) / RATE);
            let output = mount.step(1.0 / RATE, DVec3::splat(input)).x;
            if i > n / 2 {
                most = most.max(output.abs());
            }
        }
        most
    }

    /// |H| of 2 ζ ω s + ω² over s² + 2 ζ ω s + ω²: at f √(1 + 1/4ζ²) = 5.10 for ζ 0.1.
    #[test]
    fn slow_motion_passes_resonance_grows_and_fast_motion_stays_outside() {
        let mount = SoftMount::new(40.0, 0.1);
        assert!((gain(mount, 2.0) - 1.0).abs() < 0.01);
        assert!((gain(mount, 40.0) / 5.10 - 1.0).abs() < 0.05);
        assert!(gain(mount, 400.0) < 0.03);
    }

    #[test]
    fn rest_is_seen_from_the_first_sample_and_a_step_arrives_whole() {
        let mut mount = SoftMount::new(25.0, 0.1);
        let gravity = DVec3::new(0.0, 0.0, -9.8);
        assert_eq!(mount.step(1.0 / RATE, gravity), gravity);
        let mut last = DVec3::ZERO;
        for _ in 0..8000 {
            last = mount.step(1.0 / RATE, DVec3::new(0.0, 0.3, -9.8));
        }
        assert!((last - DVec3::new(0.0, 0.3, -9.8)).length() < 1e-6);
    }
}
