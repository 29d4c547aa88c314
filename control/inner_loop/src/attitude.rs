//! Attitude: estimate from the inertial sensor, attitude loop and rate loop, 1 kHz.

pub mod attitude_loop;
pub mod estimator;
pub mod gains;
pub mod imu_filter;
pub mod messages;
pub mod motion;
pub mod mounting;
pub mod rate_loop;
