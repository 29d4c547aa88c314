//! Vibration of the rotor at the sensor's own arm tip, as its fusion takes it.
//!
//! The rotor's imbalance turns in its disc: A (ω/600)² (cos φ, sin φ) along the hinge and along the arm. 0.3 mm at a
//! propeller of 12 g are 1 N, some 8.6 m/s² at a tip (estimated). The BNO055's accelerometers clip at 4 g and pass 62.5 Hz
//! in its fusion modes (data sheet, 3.5.2), here with second order; the fusion takes one reading in 10 ms, so that
//! a rotor at 100 Hz looks like a constant acceleration, and one at 86 Hz like 14 Hz. It enters the fused vector as
//! the body's acceleration does.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{LEAK, RATE_HZ};

/// Rotor speed of the given amplitude, rad/s.
const REFERENCE: f64 = 600.0;
/// Full scale, m/s², and bandwidth, rad/s, of the accelerometers in fusion modes (data sheet).
const FULL_SCALE: f64 = 4.0 * 9.806_65;
const BANDWIDTH: f64 = TAU * 62.5;

/// What the vibration adds to the fused vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaken {
    /// Amplitude at [`REFERENCE`], m/s².
    amplitude: f64,
    /// Of the imbalance, rad.
    phase: f64,
    /// Rotor speed at the last reading, rad/s.
    speed: f64,
    /// Along the hinge and along the arm, m/s².
    leaked: DVec2,
}

impl Shaken {
    /// A rotor with the `amplitude`, m/s² at 600 rad/s, its imbalance at `phase`, rad.
    #[must_use]
    pub const fn new(amplitude: f64, phase: f64) -> Self {
        Self {
            amplitude,
            phase,
            speed: 0.0,
            leaked: DVec2::ZERO,
        }
    }

    /// The same with the `amplitude`, m/s² at 600 rad/s.
    #[must_use]
    pub const fn with(self, amplitude: f64) -> Self {
        Self { amplitude, ..self }
    }

    /// Error of the fused vector, m/s², arm axes, at the next reading of a part that truly has `down` (m/s², arm axes), its
    /// rotor at `speed` rad/s.
    pub fn step(&mut self, down: DVec3, speed: f64) -> DVec3 {
        if self.amplitude == 0.0 {
            return DVec3::ZERO;
        }
        let dt = 1.0 / RATE_HZ;
        self.phase = (self.phase + 0.5 * (self.speed + speed) * dt) % TAU;
        self.speed = speed;
        let share = speed / REFERENCE;
        let size = self.amplitude * share * share;
        let shaken = DVec2::new(libm::cos(self.phase), libm::sin(self.phase)) * size;
        let full = DVec2::splat(FULL_SCALE);
        let read = (down.truncate() + shaken).clamp(-full, full) - down.truncate();
        let over = speed / BANDWIDTH;
        let passed = read / (1.0 + over * over * over * over).sqrt();
        self.leaked += (passed * LEAK.0 - self.leaked) * (dt / LEAK.1);
        self.leaked.extend(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVEL: DVec3 = DVec3::new(0.0, 0.0, 9.806_65);

    /// Largest error along the arm after two seconds, m/s².
    fn error(amplitude: f64, speed: f64, down: DVec3) -> f64 {
        let mut shaken = Shaken::new(amplitude, 0.25 * TAU);
        // At speed from the first reading on.
        shaken.speed = speed;
        let mut largest = 0.0_f64;
        for step in 0..400 {
            let error = shaken.step(down, speed);
            if step > 200 {
                largest = largest.max(error.y.abs());
            }
        }
        largest
    }

    /// 100 Hz: 8.6 · (628.3/600)² · 0.1 / √(1 + 1.6⁴) = 0.342 m/s², 2° of tilt, as long as the speed stays.
    #[test]
    fn a_rotor_at_the_fusion_s_rate_looks_like_a_constant_acceleration() {
        let constant = error(8.6, TAU * 100.0, LEVEL);
        assert!((constant - 0.342).abs() < 0.003, "{constant}");
        // 14 Hz are beyond the fusion's 0.3 s by a factor of 26.
        let beat = error(8.6, TAU * 86.0, LEVEL);
        assert!(beat < constant / 20.0, "{beat}");
        assert_eq!(error(0.0, TAU * 100.0, LEVEL), 0.0);
    }

    /// Of an arm along gravity, 4 g leave 3 g on one side: more amplitude adds nothing there.
    #[test]
    fn what_is_beyond_full_scale_is_cut_off() {
        let hanging = DVec3::new(0.0, 9.806_65, 0.0);
        let (some, more) = (
            error(35.0, TAU * 100.0, hanging),
            error(60.0, TAU * 100.0, hanging),
        );
        assert!((some - more).abs() < 1e-9, "{some} {more}");
        let most = 3.0 * 9.806_65 * LEAK.0 / (1.0 + 1.6_f64 * 1.6 * 1.6 * 1.6).sqrt();
        assert!((some - most).abs() < 0.01, "{some} {most}");
    }
}
