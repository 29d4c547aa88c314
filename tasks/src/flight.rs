//! The flight level, 1 kHz: from the inertial sample to the motors' frame.

pub mod control;
pub mod estimator;
pub mod imu;
pub mod mixer;
pub mod motors;
