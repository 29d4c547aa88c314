//! Largest force on a tendon.

use crate::maths::scalar;
use crate::params::Params;

/// Usable share of the stall torque: near it a servo neither moves nor cools.
const STALL_SHARE: f32 = 0.85;
/// Largest tilt error of an arm at rest, rad: 0.5° of mounting, 4 mrad of the reference attitude and of filtered noise.
const TILT_ERROR: f32 = 0.0127;
/// Largest angle error of a servo at rest, rad: its dead band of 2 µs in a travel of 1900 µs for 270°.
const SERVO_ERROR: f32 = 0.005;
/// Least demanded share of the limit; with stiffer tendons the force is unknown.
const ASKED_SHARE_MIN: f32 = 0.5;

/// Largest force on a tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceLimit {
    /// Force never exceeded, N.
    pub force: f32,
    /// Largest force that the clamp loop may demand, N: the error of the measured tilt adds to the tendon's force.
    pub asked: f32,
    /// Limited by the servo's stall torque, not by `servo_torque_max`; reported at start-up.
    pub capped_by_servo: bool,
}

impl ForceLimit {
    /// From the parameters.
    pub fn from_params(p: &Params) -> Self {
        let servo = STALL_SHARE * p.servo_stall;
        let capped_by_servo = servo < p.servo_torque_max;
        let torque = if capped_by_servo {
            servo
        } else {
            p.servo_torque_max
        };
        let force = scalar::clamp(torque / p.reel_radius, 0.0, 1e4);
        let wrong = p.tendon_stiffness * (p.tendon_lever * TILT_ERROR + p.reel_radius * SERVO_ERROR);
        Self {
            force,
            asked: scalar::clamp(force - wrong, ASKED_SHARE_MIN * force, force),
            capped_by_servo,
        }
    }
}
