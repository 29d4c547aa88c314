//! Velocity commanded by the sticks in a hold.

use super::collective;
use crate::chain::setpoint::Setpoint;
use crate::maths::scalar::{GRAVITY, clamp_abs, tan};
use crate::maths::vector::Vec3;
use crate::mode::context::Context;
use crate::pilot::rc::Sticks;
use crate::position_hold::{CLIMB_MAX, SPEED_MAX, VelocityCommand};

/// Velocity commanded by the sticks; `climb` is a share of the largest climb rate, -1..1.
pub fn velocity_from_sticks(s: &Sticks, climb: f32, context: &Context) -> VelocityCommand {
    let lean = |stick: f32| GRAVITY * tan(clamp_abs(stick * context.params.stick_angle, 1.0));
    let yaw_rate = match collective::from_sticks(s, &context.params, context.full_thrust()) {
        Setpoint::Angle { yaw_rate, .. } => yaw_rate,
        _ => 0.0,
    };
    VelocityCommand {
        velocity: Vec3::new(-s.pitch * SPEED_MAX, s.roll * SPEED_MAX, -climb * CLIMB_MAX),
        yaw_rate,
        lean: [-lean(s.pitch), lean(s.roll)],
    }
}
