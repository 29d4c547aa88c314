//! Control laws of the SOPHIE flight stack.
//!
//! Pure functions and small structs: no I/O, async, allocation or hardware. Units are SI, except the infill ratio in
//! percent, as in the paper. Body frame FRD (x forward, y right, z down), world frame NED, quaternions w-first; rotors
//! and arms in the paper's order: 1 front-left, 2 rear-left, 3 front-right, 4 rear-right. An arm's tilt is positive
//! with the tip up, thrust leaning inward.

#![no_std]
#![deny(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic
)]
// Tests compare floats exactly where exactness is the point.
#![cfg_attr(not(test), deny(clippy::float_cmp))]

pub mod air_pressure;
pub mod approach;
pub mod arming;
pub mod attitude;
pub mod battery;
pub mod bench;
pub mod calibration;
pub mod chain;
pub mod decimal;
pub mod deflection;
pub mod desaturation;
pub mod effectiveness;
pub mod estimator;
pub mod filter;
pub mod fsr;
pub mod grip;
pub mod grip_fault;
pub mod grip_fit;
pub mod grip_memory;
pub mod gripper;
pub mod ground;
pub mod imu_filter;
pub mod math;
pub mod mixer;
pub mod mode;
pub mod motor_map;
pub mod motor_pulses;
pub mod mounting;
pub mod params;
pub mod position;
pub mod position_hold;
pub mod rate;
pub mod rc;
pub mod remote;
pub mod seat;
pub mod setpoint;
pub mod support;
pub mod target;
pub mod tendon;
pub mod thrust_curve;
pub mod tilt;
pub mod vector;
pub mod wrench;
