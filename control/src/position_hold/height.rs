//! Height loop: height error to climb rate to thrust, with disturbance feed-forward.

use super::CLIMB_MAX;
use crate::maths::scalar;

/// Gains: height error to climb rate, 1/s; climb error to acceleration, 1/s, and to its trim, 1/s².
const HEIGHT_GAIN: f32 = 1.5;
const CLIMB_GAIN: f32 = 3.0;
const TRIM_GAIN: f32 = 1.0;
/// Largest trim, m/s²: the error of the thrust model.
const TRIM_MAX: f32 = 1.5;
/// Largest disturbance fed forward, m/s².
const DISTURBANCE_MAX: f32 = 3.0;
/// Largest distance of the held height from the vehicle, m.
pub const LEASH: f32 = 0.5;
/// Rate at which the thrust is withdrawn while contact carries the vehicle, and at which it returns, 1/s.
const SETTLE_RATE: f32 = 0.5;
const LIFT_RATE: f32 = 2.0;

/// Input of the height loop; down is positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// From the vehicle down to the held height, m.
    pub error: f32,
    /// Commanded velocity, m/s.
    pub commanded: f32,
    /// Commanded acceleration, m/s²: without it the vehicle falls behind the held height and then overtakes it.
    pub gained: f32,
    /// Velocity, m/s.
    pub velocity: f32,
    /// Acceleration that the rotors do not explain, m/s².
    pub disturbance: f32,
    /// The pilot commands a descent in contact with a surface: the rotors hand over the weight.
    pub landing: bool,
}

/// The loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height {
    /// Upwards, m/s².
    trim: f32,
    /// Share of the thrust that is left.
    settled: f32,
}

impl Default for Height {
    fn default() -> Self {
        Self {
            trim: 0.0,
            settled: 1.0,
        }
    }
}

impl Height {
    /// Acceleration setpoint upwards beyond gravity, m/s², in a step of `dt` s.
    pub fn step(&mut self, s: &State, dt: f32) -> f32 {
        let commanded = scalar::clamp_abs(s.commanded + HEIGHT_GAIN * s.error, CLIMB_MAX);
        let short = s.velocity - commanded;
        let rate = if s.landing { -SETTLE_RATE } else { LIFT_RATE };
        self.settled = scalar::clamp(self.settled + rate * dt, 0.0, 1.0);
        if !s.landing {
            self.trim = scalar::clamp_abs(self.trim + TRIM_GAIN * short * dt, TRIM_MAX);
        }
        CLIMB_GAIN * short + self.trim + scalar::clamp_abs(s.disturbance, DISTURBANCE_MAX) - s.gained
    }

    /// Share of the thrust to give, 0..1.
    pub fn settled(&self) -> f32 {
        self.settled
    }
}
