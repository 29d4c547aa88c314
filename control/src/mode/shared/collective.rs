//! From sticks to a demand; the collective has no step and stays within its limits.

use crate::allocation::wrench::Wrench;
use crate::chain::setpoint::Setpoint;
use crate::maths::scalar::{clamp, clamp_abs};
use crate::maths::vector::Vec3;
use crate::params::Params;
use crate::pilot::rc::{StickMode, Sticks};

/// Default hand-over time of the collective between two states, s.
pub const HAND_OVER_TIME: f32 = 0.5;

/// Setpoint of the pilot in free flight; `full` is the collective at full throttle, N.
pub fn from_sticks(s: &Sticks, p: &Params, full: f32) -> Setpoint {
    let thrust = s.throttle * full;
    match s.stick_mode {
        StickMode::Angle => Setpoint::Angle {
            roll: s.roll * p.stick_angle,
            pitch: s.pitch * p.stick_angle,
            yaw_rate: s.yaw * p.stick_yaw_rate,
            thrust,
        },
        StickMode::Rate => Setpoint::Rate {
            rate: stick_rates(s, p),
            thrust,
        },
        StickMode::Direct => Setpoint::Direct {
            wrench: Wrench {
                thrust,
                roll: s.roll * p.stick_torque,
                pitch: s.pitch * p.stick_torque,
                yaw: s.yaw * p.stick_yaw_torque,
            },
        },
    }
}

fn stick_rates(s: &Sticks, p: &Params) -> Vec3 {
    Vec3::new(
        s.roll * p.stick_rate,
        s.pitch * p.stick_rate,
        s.yaw * p.stick_yaw_rate,
    )
}

/// Hand-over of the collective between states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Collective {
    /// Last collective, N; `None` while the rotors are stopped or idle.
    last: Option<f32>,
    /// Remaining difference to the previous state, N, and remaining time for it, s.
    offset: f32,
    left: f32,
    /// Duration of a hand-over to begin, s.
    pending: Option<f32>,
    /// Duration of the current hand-over, s.
    time: f32,
}

impl Collective {
    /// Begins a new state: the collective moves from the last one to the state's own within `time` s (> 0).
    pub fn hand_over(&mut self, time: f32) {
        self.pending = Some(time);
    }

    /// Last collective, N; 0 while the rotors are stopped or idle.
    pub fn now(&self) -> f32 {
        self.last.unwrap_or(0.0)
    }

    /// Hands the collective over, limits it to the `full` thrust of four rotors, N, and stops if it is not finite.
    pub fn finish(&mut self, setpoint: Setpoint, full: f32, dt: f32) -> Setpoint {
        let begins = self.pending.take();
        let passes = matches!(
            setpoint,
            Setpoint::Stop | Setpoint::Idle | Setpoint::Spin(_) | Setpoint::StaticThrust(_)
        );
        if passes || !setpoint.is_finite() {
            *self = Self::default();
            return if setpoint.is_finite() {
                setpoint
            } else {
                Setpoint::Stop
            };
        }
        let target = setpoint.thrust();
        if let Some(time) = begins {
            self.offset = self.last.map_or(0.0, |last| last - target);
            (self.time, self.left) = (time, time);
        }
        self.left = clamp(self.left - dt, 0.0, self.time);
        let rest = if self.left > 0.0 {
            self.offset * self.left / self.time
        } else {
            0.0
        };
        let thrust = clamp(target + rest, 0.0, full);
        self.last = Some(thrust);
        with_thrust(setpoint, thrust)
    }
}

fn with_thrust(rotors: Setpoint, thrust: f32) -> Setpoint {
    // Defensive limit near a quarter turn.
    let angle = |x| clamp_abs(x, 1.6);
    match rotors {
        Setpoint::Angle {
            roll,
            pitch,
            yaw_rate,
            ..
        } => Setpoint::Angle {
            roll: angle(roll),
            pitch: angle(pitch),
            yaw_rate,
            thrust,
        },
        Setpoint::Escape {
            roll,
            pitch,
            yaw_rate,
            ..
        } => Setpoint::Escape {
            roll: angle(roll),
            pitch: angle(pitch),
            yaw_rate,
            thrust,
        },
        Setpoint::Rate { rate, .. } => Setpoint::Rate { rate, thrust },
        Setpoint::Direct { wrench } => Setpoint::Direct {
            wrench: Wrench { thrust, ..wrench },
        },
        Setpoint::Resting { roll, pitch, .. } => Setpoint::Resting {
            roll: angle(roll),
            pitch: angle(pitch),
            thrust,
        },
        stopped => stopped,
    }
}
