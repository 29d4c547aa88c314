//! Reel and drive against hand calculations.

mod drive;
mod reel;

use super::drive::ANGLE_MAX;
use super::*;
use crate::params::Params;

fn params() -> Params {
    Params {
        reel_radius: 0.015,
        tendon_lever: 0.025,
        tendon_stiffness: 8000.0,
        servo_range: 4.71,
        servo_slew_1: 6.16,
        servo_stall: 3.432,
        servo_torque_max: 2.452,
        ..Params::default()
    }
}

fn close(a: f32, b: f32, tolerance: f32) -> bool {
    (a - b).abs() <= tolerance
}
