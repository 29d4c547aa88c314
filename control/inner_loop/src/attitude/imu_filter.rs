//! Low-passes the inertial sensor at its own rate and decimates to the control rate.
//!
//! [`ImuFilter::batch`] runs at 1 kHz in the task `imu` with the samples of the last millisecond (4 kHz, or the part's
//! nearest rate; rad/s and m/s² in body axes). A missed sample delays the rates by its period.

use crate::attitude::messages::ImuReading;
use crate::maths::filter::Coefficients;
use crate::maths::vector::Vec3;

/// Second-order low pass on three axes, transposed direct form II.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisFilter {
    gain: f32,
    a1: f32,
    a2: f32,
    s1: Vec3,
    s2: Vec3,
}

impl AxisFilter {
    /// Butterworth low pass with cut-off `hz` at the sampling rate `rate_hz`, at rest.
    pub fn low_pass(hz: f32, rate_hz: f32) -> Self {
        let (gain, a1, a2) = Coefficients::low_pass(hz, rate_hz).as_low_pass();
        Self {
            gain,
            a1,
            a2,
            s1: Vec3::ZERO,
            s2: Vec3::ZERO,
        }
    }

    /// One sample.
    #[inline(always)]
    pub fn step(&mut self, v: Vec3) -> Vec3 {
        // The numerator is 1, 2, 1: one product serves all taps.
        let x = v * self.gain;
        let y = x + self.s1;
        self.s1 = x + x - y * self.a1 + self.s2;
        self.s2 = x - y * self.a2;
        y
    }

    /// Settles at the constant input `v`.
    pub fn reset(&mut self, v: Vec3) {
        self.s1 = v * (1.0 - self.gain);
        self.s2 = v * (self.gain - self.a2);
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
    /// Cut-off of the accelerometer, Hz: for slow correction and support.
    pub const ACCEL_CUTOFF: f32 = 30.0;

    /// For samples at `rate_hz`, with the gyro's cut-off `gyro_hz`.
    pub fn new(gyro_hz: f32, rate_hz: f32) -> Self {
        Self {
            gyro: AxisFilter::low_pass(gyro_hz, rate_hz),
            accel: AxisFilter::low_pass(Self::ACCEL_CUTOFF, rate_hz),
            started: false,
        }
    }

    /// Filters the finite readings of a batch, oldest first, less `accel_bias` (m/s²) of specific force. Writes the
    /// newest output into `newest`; returns the finite count.
    #[inline(always)]
    pub fn batch(&mut self, readings: &[ImuReading], accel_bias: Vec3, newest: &mut ImuReading) -> u32 {
        if !self.started {
            self.start_at_first(readings, accel_bias);
        }
        // Local copies stay in registers.
        let (mut filter, mut last) = (*self, *newest);
        let mut finite = 0;
        for ImuReading { gyro, accel } in readings {
            let unbiased = ImuReading {
                gyro: *gyro,
                accel: *accel - accel_bias,
            };
            if unbiased.is_finite() {
                last = filter.smooth(unbiased);
                finite += 1;
            }
        }
        (*self, *newest) = (filter, last);
        finite
    }

    #[cold]
    #[inline(never)]
    fn start_at_first(&mut self, readings: &[ImuReading], accel_bias: Vec3) {
        let finite = |r: &&ImuReading| (r.gyro + (r.accel - accel_bias)).is_finite();
        if let Some(first) = readings.iter().find(finite) {
            self.gyro.reset(first.gyro);
            self.accel.reset(first.accel - accel_bias);
            self.started = true;
        }
    }

    #[inline(always)]
    fn smooth(&mut self, reading: ImuReading) -> ImuReading {
        ImuReading {
            gyro: self.gyro.step(reading.gyro),
            accel: self.accel.step(reading.accel),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(f: &mut ImuFilter, gyro: Vec3, accel: Vec3) -> Option<ImuReading> {
        let mut newest = ImuReading::default();
        (f.batch(&[ImuReading { gyro, accel }], Vec3::ZERO, &mut newest) == 1).then_some(newest)
    }

    #[test]
    fn starts_without_a_transient_and_drops_bad_samples() {
        let mut f = ImuFilter::new(90.0, 4000.0);
        let (g, a) = (Vec3::new(0.1, -0.2, 0.3), Vec3::new(0.0, 0.5, -9.8));
        for _ in 0..2000 {
            let out = one(&mut f, g, a).expect("finite");
            assert!((out.gyro - g).norm() < 1e-3 && (out.accel - a).norm() < 1e-2);
        }
        assert!(one(&mut f, Vec3::new(f32::NAN, 0.0, 0.0), a).is_none());
        let out = one(&mut f, g, a).expect("finite");
        assert!(out.gyro.to_array().iter().all(|x| x.is_finite()));
    }

    #[test]
    fn a_batch_starts_at_its_first_good_reading_and_gives_its_last() {
        let bias = Vec3::new(0.0, 0.0, 0.2);
        let bad = ImuReading {
            gyro: Vec3::new(0.0, f32::INFINITY, 0.0),
            accel: Vec3::ZERO,
        };
        let good = ImuReading {
            gyro: Vec3::new(0.1, -0.2, 0.3),
            accel: Vec3::new(0.0, 0.5, -9.8),
        };
        let mut f = ImuFilter::new(90.0, 4000.0);
        let kept = good;
        let mut newest = kept;
        assert!(f.batch(&[bad; 3], bias, &mut newest) == 0 && newest == kept);
        assert!(f.batch(&[bad, good, good, bad], bias, &mut newest) == 2);
        assert!((newest.gyro - good.gyro).norm() < 1e-4, "{newest:?}");
        assert!((newest.accel - (good.accel - bias)).norm() < 1e-3, "{newest:?}");
    }

    /// Gain and delay (s) of the gyro's filter at `hz`, at its 1 kHz output.
    fn response(hz: f64, rate_hz: f64) -> (f64, f64) {
        let mut f = ImuFilter::new(90.0, rate_hz as f32);
        let per_output = (rate_hz / 1000.0) as usize;
        let turn = core::f64::consts::TAU * hz;
        let (mut in_phase, mut quadrature, mut n) = (0.0, 0.0, 0);
        // The second second, a whole number of turns, is measured.
        for i in 1..=(2.0 * rate_hz) as usize {
            let t = i as f64 / rate_hz;
            let x = f64::sin(turn * t) as f32;
            let out = one(&mut f, Vec3::new(x, 0.0, 0.0), Vec3::ZERO).expect("finite");
            if i.is_multiple_of(per_output) && t > 1.0 {
                in_phase += f64::from(out.gyro.x) * f64::sin(turn * t);
                quadrature += f64::from(out.gyro.x) * f64::cos(turn * t);
                n += 1;
            }
        }
        assert!(n == 1000, "{n}");
        let (a, b) = (2.0 * in_phase / 1000.0, 2.0 * quadrature / 1000.0);
        (f64::hypot(a, b), f64::atan2(-b, a) / turn)
    }

    #[test]
    fn the_output_is_the_same_whatever_the_sensor_s_rate() {
        for rate in [1000.0, 2000.0, 4000.0, 8000.0] {
            for hz in [2.0, 10.0, 30.0, 90.0] {
                // Second-order Butterworth at 90 Hz.
                let x: f64 = hz / 90.0;
                let gain = 1.0 / f64::sqrt(1.0 + x.powi(4));
                let delay =
                    f64::atan2(core::f64::consts::SQRT_2 * x, 1.0 - x * x) / (core::f64::consts::TAU * hz);
                let (g, d) = response(hz, rate);
                assert!((g - gain).abs() < 0.01, "{hz} Hz at {rate} Hz: gain {g}, {gain}");
                assert!(
                    (d - delay).abs() < 0.1e-3,
                    "{hz} Hz at {rate} Hz: delay {d} s, {delay} s"
                );
            }
            // Nothing aliases.
            if rate > 1000.0 {
                assert!(response(900.0, rate).0 < 0.02, "{rate} Hz");
            }
        }
    }
}
