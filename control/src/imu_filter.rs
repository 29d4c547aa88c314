//! Low-passes the inertial sensor at its own rate and decimates it to the control rate.

use crate::filter::{Biquad, Coefficients};
use crate::vector::Vec3;

/// Three axes through the same second-order filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisFilter {
    x: Biquad,
    y: Biquad,
    z: Biquad,
}

impl AxisFilter {
    /// The filter `c` on each axis, at rest.
    pub const fn new(c: Coefficients) -> Self {
        Self {
            x: Biquad::new(c),
            y: Biquad::new(c),
            z: Biquad::new(c),
        }
    }

    /// One sample.
    #[inline]
    pub fn step(&mut self, v: Vec3) -> Vec3 {
        Vec3::new(self.x.step(v.x), self.y.step(v.y), self.z.step(v.z))
    }

    /// Takes `v` as the constant input so far.
    pub fn reset(&mut self, v: Vec3) {
        self.x.reset(v.x);
        self.y.reset(v.y);
        self.z.reset(v.z);
    }
}

/// Filter of the vehicle's inertial sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImuFilter {
    gyro: AxisFilter,
    accel: AxisFilter,
    started: bool,
}

impl ImuFilter {
    /// Cut-off of the accelerometer, Hz: it only corrects slowly and proves support.
    pub const ACCEL_CUTOFF: f32 = 30.0;

    /// A filter for samples at `rate_hz` with the gyro's cut-off `gyro_hz`.
    pub fn new(gyro_hz: f32, rate_hz: f32) -> Self {
        Self {
            gyro: AxisFilter::new(Coefficients::low_pass(gyro_hz, rate_hz)),
            accel: AxisFilter::new(Coefficients::low_pass(Self::ACCEL_CUTOFF, rate_hz)),
            started: false,
        }
    }

    /// Takes one sample (rad/s, m/s²) and gives the filtered one; a sample that is not finite is left out.
    pub fn step(&mut self, gyro: Vec3, accel: Vec3) -> Option<(Vec3, Vec3)> {
        if !(gyro.is_finite() && accel.is_finite()) {
            return None;
        }
        if !self.started {
            self.gyro.reset(gyro);
            self.accel.reset(accel);
            self.started = true;
        }
        Some((self.gyro.step(gyro), self.accel.step(accel)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_without_a_transient_and_drops_bad_samples() {
        let mut f = ImuFilter::new(90.0, 4000.0);
        let (g, a) = (Vec3::new(0.1, -0.2, 0.3), Vec3::new(0.0, 0.5, -9.8));
        for _ in 0..2000 {
            let (g2, a2) = f.step(g, a).expect("finite");
            assert!((g2 - g).norm() < 1e-3 && (a2 - a).norm() < 1e-2);
        }
        assert!(f.step(Vec3::new(f32::NAN, 0.0, 0.0), a).is_none());
        assert!(f.step(g, a).expect("finite").0.is_finite());
    }
}
