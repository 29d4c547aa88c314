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

pub use sophie_inner_loop::{allocation, attitude, chain, maths, params};

pub mod approach;
pub mod arming;
pub mod battery;
pub mod calibration;
pub mod contact;
pub mod gripper;
pub mod mode;
pub mod navigation;
pub mod oscillation;
pub mod pilot;
pub mod position_hold;
#[cfg(test)]
mod test_noise;
pub mod thrust_factor;
pub mod vibration;
