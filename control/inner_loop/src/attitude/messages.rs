//! Messages of the inertial sensor and of the estimator.

use crate::maths::vector::{Quat, Vec3};

/// One sample of the vehicle's inertial sensor in board axes: the vehicle's, unless `imu_mounting` turns them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImuReading {
    /// Angular rate, rad/s.
    pub gyro: Vec3,
    /// Specific force, m/s²: (0, 0, -9.81) at rest and level.
    pub accel: Vec3,
}

impl ImuReading {
    /// True if the sum of the components, and so each, is finite.
    #[inline(always)]
    pub fn is_finite(&self) -> bool {
        (self.gyro + self.accel).is_finite()
    }
}

/// Filtered inertial sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImuSample {
    /// Angular rate, rad/s, body, low-passed, bias included.
    pub gyro: Vec3,
    /// Newest specific force, m/s², body, low-passed.
    pub accel: Vec3,
    /// Time since the last sample, s, limited.
    pub dt: f32,
    /// The accelerometer has been at its full scale within the last half a second.
    pub clipped: bool,
}

/// Estimated motion of the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude {
    /// Body to world.
    pub q: Quat,
    /// Angular rate without bias, rad/s, body.
    pub rate: Vec3,
    /// Specific force, m/s², body.
    pub accel: Vec3,
    /// Estimated gyro bias, rad/s.
    pub gyro_bias: Vec3,
    /// Calibration at rest has ended.
    pub calibrated: bool,
    /// The accelerometer has been at its full scale: the attitude is the gyro's alone.
    pub clipped: bool,
    /// Time since the last estimate, s.
    pub dt: f32,
}
