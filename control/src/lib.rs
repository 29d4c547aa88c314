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

pub mod allocation;
pub mod approach;
pub mod arming;
pub mod attitude;
pub mod battery;
pub mod calibration;
pub mod chain;
pub mod contact;
pub mod gripper;
pub mod maths;
pub mod mode;
pub mod navigation;
pub mod params;
pub mod pilot;
pub mod position_hold;
