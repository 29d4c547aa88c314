//! First stage: filters the inertial sensor at its own rate, outputs at 1 kHz.

use crate::chain::{CONTROL_RATE_HZ, ImuReading, ImuSample, StepClock};
use crate::imu_filter::ImuFilter;
use crate::math;
use crate::params::Params;
use crate::vector::Vec3;

/// Filter, accelerometer bias and decimation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensing {
    filter: ImuFilter,
    accel_bias: Vec3,
    /// Readings per step, and since the last.
    per_step: u32,
    collected: u32,
    clock: StepClock,
}

impl Sensing {
    /// For a sensor that samples at `rate_hz`.
    pub fn new(p: &Params, rate_hz: f32) -> Self {
        Self {
            filter: ImuFilter::new(p.gyro_cutoff, rate_hz),
            accel_bias: Vec3::new(p.accel_bias_x, p.accel_bias_y, p.accel_bias_z),
            per_step: (math::clamp(rate_hz / CONTROL_RATE_HZ, 1.0, 64.0) + 0.5) as u32,
            collected: 0,
            clock: StepClock::default(),
        }
    }

    /// Takes readings, oldest first, the newest ready at `at_us` µs, and updates the last `sample`. True once a step's
    /// finite readings have come.
    // Not inlined: a caller built for size would slow it down.
    #[inline(never)]
    pub fn take(&mut self, at_us: u64, readings: &[ImuReading], sample: &mut ImuSample) -> bool {
        let mut newest = ImuReading {
            gyro: sample.gyro,
            accel: sample.accel,
        };
        let finite = self.filter.batch(readings, self.accel_bias, &mut newest);
        sample.gyro = newest.gyro;
        sample.accel = newest.accel;
        self.collected += finite;
        if self.collected < self.per_step {
            return false;
        }
        self.collected = 0;
        sample.dt = self.clock.step(at_us);
        true
    }
}
