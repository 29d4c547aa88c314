//! Sensor models.

pub mod analog;
pub mod arm_imu;
pub mod barometer;
pub mod flow;
pub mod fsr;
pub mod imu;
pub mod pose;
pub mod soft_mount;
