//! The largest force on a tendon: by the parameters, and by what the servo can give.

use crate::math;
use crate::params::Params;

/// Share of the stall torque that a servo is trusted to give: near stall it neither moves nor cools.
const STALL_SHARE: f32 = 0.85;
/// Largest error of the tilt of an arm at rest, rad: half a degree of the sensor's mounting, 4 mrad of the attitude that
/// it is measured against and of noise behind the filters.
const TILT_ERROR: f32 = 0.0127;
/// Largest error of a servo's angle at rest, rad: its dead band of 2 µs in a travel of 1900 µs for 270°.
const SERVO_ERROR: f32 = 0.005;
/// Share of the force limit that is asked for at least: tendons so stiff that less were left have no known force.
const ASKED_SHARE_MIN: f32 = 0.5;

/// Largest force on a tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceLimit {
    /// Force along the tendon that is never passed, N.
    pub force: f32,
    /// Force that the clamp loop may ask for, N: what is asked is wound by the arm's measured tilt, so the tendon
    /// has more by what that is wrong.
    pub asked: f32,
    /// The servo cannot give the torque that the parameters allow (`servo_torque_max`): its stall torque
    /// limits the force. To be reported at start-up.
    pub capped_by_servo: bool,
}

impl ForceLimit {
    /// The limit by the parameters.
    pub fn from_params(p: &Params) -> Self {
        let servo = STALL_SHARE * p.servo_stall;
        let capped_by_servo = servo < p.servo_torque_max;
        let torque = if capped_by_servo {
            servo
        } else {
            p.servo_torque_max
        };
        let force = math::clamp(torque / p.reel_radius, 0.0, 1e4);
        let wrong = p.tendon_stiffness * (p.tendon_lever * TILT_ERROR + p.reel_radius * SERVO_ERROR);
        Self {
            force,
            asked: math::clamp(force - wrong, ASKED_SHARE_MIN * force, force),
            capped_by_servo,
        }
    }
}
