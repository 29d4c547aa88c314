//! The failsafe's descent: level, sinking slowly, [probing](super::ground_probe) for support.

use super::collective;
use crate::chain::setpoint::Setpoint;
use crate::maths::scalar::clamp;
use crate::mode::context::Context;
use crate::pilot::rc::{StickMode, Sticks};

/// Target sink rate, m/s.
const SINK_RATE: f32 = 0.8;
/// Share of the weight removed to start sinking, until the sink rate.
const SINK_SHARE: f32 = 0.15;

/// Level and sinking, at the roll, pitch and yaw rate of `steer`.
pub fn descent(context: &Context, steer: Option<Sticks>) -> Setpoint {
    let short = clamp(1.0 - context.contact_force.sink() / SINK_RATE, 0.0, 1.0);
    let share = clamp(1.0 - SINK_SHARE * short - context.ground_probe.share(), 0.0, 1.0);
    let thrust = share * context.contact_force.weight();
    let steer = Sticks {
        stick_mode: StickMode::Angle,
        ..steer.unwrap_or_default()
    };
    match collective::from_sticks(&steer, &context.params, context.full_thrust()) {
        Setpoint::Angle {
            roll,
            pitch,
            yaw_rate,
            ..
        } => Setpoint::Angle {
            roll,
            pitch,
            yaw_rate,
            thrust,
        },
        other => other,
    }
}
