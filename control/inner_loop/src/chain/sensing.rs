//! First stage: filters the inertial sensor at its own rate, outputs at 1 kHz.

use super::step_clock::{CONTROL_RATE_HZ, StepClock};
use crate::attitude::imu_filter::ImuFilter;
use crate::attitude::messages::{ImuReading, ImuSample};
use crate::attitude::mounting::Mounting;
use crate::maths::scalar::{self, GRAVITY};
use crate::maths::vector::Vec3;
use crate::params::Params;

/// Filter, decimation, and what calibration has found: accelerometer's bias and scale, mounting.
///
/// v = M S⁻¹ (b − bias) for the specific force b in board axes. Scale and mounting commute with the filter, which
/// treats all axes alike: they are applied once a step and not to each reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensing {
    filter: ImuFilter,
    accel_bias: Vec3,
    /// One over the accelerometer's scale.
    accel_gain: Vec3,
    /// `None` as the board's file has it: nothing to turn.
    mounting: Option<Mounting>,
    /// Readings of a step, and those since the last.
    per_step: u32,
    collected: u32,
    clock: StepClock,
    /// Square of the specific force that clips, (m/s²)², and that from which on it is looked at: any while steps count.
    clips_at: f32,
    looks_at: f32,
    /// Steps for which the last reading that clipped still counts.
    clipped: u32,
}

/// Steps for which the force counts as clipped after a reading that did, half a second: it is out of the filter in a tenth
/// of that, and a display that is sent five times a second shows it. One reading a step is looked at: a shake that clips in
/// 2 % of the time is missed for half a second once in 25,000 times.
const CLIP_STEPS: u32 = 500;
/// Specific force that clips, share of full scale: of one axis it is at least that of all.
const CLIPS: f32 = 0.999;

impl Sensing {
    /// For a sensor that samples at `rate_hz`.
    pub fn new(p: &Params, rate_hz: f32) -> Self {
        let mounting = Mounting::from(p.imu_mounting);
        let full_scale = CLIPS * GRAVITY * p.imu_accel_range.number();
        Self {
            filter: ImuFilter::new(p.gyro_cutoff, rate_hz),
            accel_bias: Vec3::new(p.accel_bias_x, p.accel_bias_y, p.accel_bias_z),
            accel_gain: Vec3::new(p.accel_scale_x, p.accel_scale_y, p.accel_scale_z).map(|scale| 1.0 / scale),
            mounting: (mounting != Mounting::AS_BUILT).then_some(mounting),
            per_step: (scalar::clamp(rate_hz / CONTROL_RATE_HZ, 1.0, 64.0) + 0.5) as u32,
            collected: 0,
            clock: StepClock::default(),
            clips_at: full_scale * full_scale,
            looks_at: full_scale * full_scale,
            clipped: 0,
        }
    }

    /// Takes readings, oldest first, the newest ready at `at_us` µs, and updates the last `sample`. True once a step's
    /// finite readings have come.
    // Not inlined: a caller built for size would slow it down.
    #[inline(never)]
    pub fn take(&mut self, at_us: u64, readings: &[ImuReading], sample: &mut ImuSample) -> bool {
        let mut newest = ImuReading::default();
        let finite = self.filter.batch(readings, self.accel_bias, &mut newest);
        if finite == 0 {
            return false;
        }
        sample.gyro = newest.gyro;
        sample.accel = newest.accel.scale_by(self.accel_gain);
        if let Some(mounting) = self.mounting {
            turn(&mounting, sample);
        }
        let collected = self.collected + finite;
        if collected < self.per_step {
            self.collected = collected;
            return false;
        }
        self.collected = 0;
        if let [looked_at, ..] = readings {
            let force = looked_at.accel.norm_squared();
            if force >= self.looks_at {
                self.count_clipped(force, sample);
            }
        }
        sample.dt = self.clock.step(at_us);
        true
    }
}

impl Sensing {
    /// A reading of the squared `force`, (m/s²)², clips, or one did lately.
    #[cold]
    #[inline(never)]
    fn count_clipped(&mut self, force: f32, sample: &mut ImuSample) {
        self.clipped = if force >= self.clips_at {
            CLIP_STEPS
        } else {
            self.clipped.saturating_sub(1)
        };
        sample.clipped = self.clipped > 0;
        self.looks_at = if sample.clipped { 0.0 } else { self.clips_at };
    }
}

/// From board axes to the vehicle's.
#[inline(never)]
fn turn(mounting: &Mounting, sample: &mut ImuSample) {
    sample.gyro = mounting.to_vehicle(sample.gyro);
    sample.accel = mounting.to_vehicle(sample.accel);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::ImuMounting;

    /// The sample of one step at rest, of a part that reads `read`.
    fn sample(p: &Params, read: ImuReading) -> ImuSample {
        let mut sensing = Sensing::new(p, 4000.0);
        let mut sample = ImuSample::default();
        assert!(sensing.take(1000, &[read; 4], &mut sample));
        sample
    }

    #[test]
    fn what_was_calibrated_takes_out_what_the_part_reads_wrong() {
        let (rate, force) = (Vec3::new(0.1, -0.2, 0.3), Vec3::new(0.5, -1.0, -9.7));
        let (bias, scale) = (Vec3::new(0.2, -0.3, 0.4), Vec3::new(1.03, 0.97, 0.92));
        for imu_mounting in ImuMounting::ALL.iter().copied() {
            let mounting = Mounting::from(imu_mounting);
            let read = ImuReading {
                gyro: mounting.to_board(rate),
                accel: mounting.to_board(force).scale_by(scale) + bias,
            };
            let p = Params {
                imu_mounting,
                accel_bias_x: bias.x,
                accel_bias_y: bias.y,
                accel_bias_z: bias.z,
                accel_scale_x: scale.x,
                accel_scale_y: scale.y,
                accel_scale_z: scale.z,
                ..Params::DEFAULT
            };
            let found = sample(&p, read);
            assert!((found.gyro - rate).norm() < 1e-5, "{imu_mounting:?} {found:?}");
            assert!((found.accel - force).norm() < 1e-4, "{imu_mounting:?} {found:?}");
            // Without what was calibrated it is not.
            let wrong = sample(&Params::DEFAULT, read);
            assert!((wrong.accel - force).norm() > 0.3, "{imu_mounting:?}");
        }
    }

    #[test]
    fn the_defaults_change_no_bit_of_what_the_filter_gives() {
        let read = ImuReading {
            gyro: Vec3::new(0.1, -0.0, 3e-30),
            accel: Vec3::new(-0.0, 1e-38, -9.81),
        };
        let mut filter = ImuFilter::new(Params::DEFAULT.gyro_cutoff, 4000.0);
        let mut newest = ImuReading::default();
        filter.batch(&[read; 4], Vec3::ZERO, &mut newest);
        let found = sample(&Params::DEFAULT, read);
        let bits = |v: Vec3| v.to_array().map(f32::to_bits);
        assert_eq!(bits(found.gyro), bits(newest.gyro));
        assert_eq!(bits(found.accel), bits(newest.accel));
    }
}
