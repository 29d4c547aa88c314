//! A pipe that vibrates: z = a sin(2π f t), down. It moves its surface under what rests on it; the contact's springs,
//! dampers and bristles pass it on.
//!
//! Piping is held to 0.25 mm peak to peak or 25 mm/s (Wood, formerly Beta Machinery: their screening guideline), 13 mm/s by
//! ASME OM-3. At 10 Hz 0.4 mm have 25 mm/s.

use core::f64::consts::TAU;

use super::PipeShape;

/// A steady vibration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vibration {
    /// Amplitude, m.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Time since power-up, s.
    time: f64,
}

impl Vibration {
    /// A vibration of `amplitude` m at `frequency` Hz.
    #[must_use]
    pub const fn new(amplitude: f64, frequency: f64) -> Self {
        Self {
            amplitude,
            frequency,
            time: 0.0,
        }
    }

    /// Advances by `dt` s and moves the pipe.
    pub fn step(&mut self, dt: f64, shape: &mut PipeShape) {
        if self.amplitude == 0.0 {
            return;
        }
        self.time += dt;
        let rate = TAU * self.frequency;
        let (sin, cos) = libm::sincos(rate * self.time);
        shape.heave = self.amplitude * sin;
        shape.heave_speed = self.amplitude * rate * cos;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::STEP;

    #[test]
    fn its_speed_is_the_rate_of_its_way_and_its_peak_the_product_of_amplitude_and_rate() {
        let (mut vibration, mut shape) = (Vibration::new(0.4e-3, 10.0), PipeShape::STRAIGHT);
        let (mut way, mut fastest) = (0.0, 0.0_f64);
        for _ in 0..2000 {
            vibration.step(STEP, &mut shape);
            way += shape.heave_speed * STEP;
            fastest = fastest.max(shape.heave_speed);
            assert!((way - shape.heave).abs() < 2e-5, "{way} {}", shape.heave);
        }
        assert!((fastest - 25.1e-3).abs() < 0.2e-3, "{fastest}");
        let mut still = PipeShape::STRAIGHT;
        Vibration::new(0.0, 10.0).step(STEP, &mut still);
        assert_eq!(still, PipeShape::STRAIGHT);
    }
}
