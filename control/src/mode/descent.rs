//! The failsafe's descent: level, sinking slowly, probing for support.

use super::context::Context;
use super::{Setpoint, demand};
use crate::math::clamp;
use crate::rc::{StickMode, Sticks};
use crate::support::{HINT_FORCE, Support};

/// Target sink rate, m/s.
const SINK_RATE: f32 = 0.8;
/// Share of the weight taken off the collective to start sinking, returned as the sink rate is reached.
const SINK_SHARE: f32 = 0.15;
/// Fastest reduction of the collective by the probe, share of the weight per second. In free air the apparent support
/// shrinks with it, and the thrust returns.
const PROBE_RATE: f32 = 0.5;

/// Share of the weight taken away by the probe, 0..1.
#[derive(Clone, Copy, Debug, Default)]
pub struct Probe(f32);

impl Probe {
    /// Reduces the thrust while something seems to carry a vehicle in the failsafe, and returns it otherwise.
    pub fn step(&mut self, failsafe: bool, support: &Support, dt: f32) {
        let hint = failsafe && support.force() > HINT_FORCE;
        let rate = match (hint, support.resting()) {
            (true, true) => 3.0 * PROBE_RATE,
            (true, false) => PROBE_RATE,
            (false, _) => -4.0 * PROBE_RATE,
        };
        self.0 = clamp(self.0 + rate * dt, 0.0, 1.0);
    }
}

/// Level and sinking, at the roll, pitch and yaw rate of `steer`.
pub fn descent(context: &Context, steer: Option<Sticks>) -> Setpoint {
    let short = clamp(1.0 - context.support.sink() / SINK_RATE, 0.0, 1.0);
    let share = clamp(1.0 - SINK_SHARE * short - context.probe.0, 0.0, 1.0);
    let thrust = share * context.support.weight();
    let steer = Sticks {
        stick_mode: StickMode::Angle,
        ..steer.unwrap_or_default()
    };
    match demand::from_sticks(&steer, &context.params) {
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
