//! Dangers common to all states, 100 Hz.
//!
//! | trouble | on the ground | in the air | on the pipe |
//! |---|---|---|---|
//! | arm switch off | stop | stop | stop, arms stay closed |
//! | radio lost | stop | level, over one place if that is known, sink, stop on what carries | keep closing, keep the grip |
//! | inertial sensor silent | stop | stop | stop, arms stay closed |
//! | tipped over, or turned faster than the gyro reads | stop | stop | stop, arms stay closed |
//! | battery critical | - | sink, the pilot still steers | reported; release refused |
//! | data-ready line silent | stop | sink, the pilot still steers | reported; release refused |

use super::{Inputs, Reason};
use crate::arming::ArmingInhibit;
use crate::math::deg;
use crate::params::Params;
use crate::support::Held;

/// Sensor silence that stops the rotors for good, s; control has already.
pub const IMU_LOST_TIME: f32 = 0.05;
/// Tilt beyond which the vehicle has tipped over, rad.
pub const TIPPED_TILT: f32 = deg(100.0);
/// Time beyond [`TIPPED_TILT`], s.
pub const TIPPED_TIME: f32 = 0.5;
/// Largest rate that the gyro surely measures, share of its full scale: less bias and filter.
const GYRO_SATURATED: f32 = 0.98;
/// Turn at full scale after which the attitude is unknown, rad: twice as fast, it has turned as far again unseen.
const UNSEEN_TURN: f32 = deg(30.0);
/// Time below the critical voltage, s: longer than a gust's current peak.
pub const BATTERY_TIME: f32 = 1.0;

#[derive(Clone, Copy, Debug, Default)]
pub struct Dangers {
    imu: Held,
    tipped: Held,
    saturated: Held,
    turned_unseen: bool,
    battery: Held,
    /// Set by the port after its own delay.
    line_silent: bool,
}

impl Dangers {
    /// One step of `dt` s.
    pub fn step(&mut self, i: &Inputs, p: &Params, dt: f32) {
        self.imu.step(i.motion.is_none(), dt);
        let tipped = i
            .motion
            .is_some_and(|m| m.q.down_in_body().z < crate::math::cos(TIPPED_TILT));
        self.tipped.step(tipped, dt);
        // Axes turn by right angles between part and vehicle.
        let full_scale = deg(p.imu_gyro_range.number());
        let most = GYRO_SATURATED * full_scale;
        let saturated = i
            .motion
            .is_some_and(|m| m.rate.to_array().iter().any(|x| x.abs() >= most));
        let time = self.saturated.step(saturated, dt);
        self.turned_unseen = saturated && time * full_scale >= UNSEEN_TURN;
        self.battery
            .step(i.battery.is_some_and(|v| v < p.battery_critical), dt);
        self.line_silent = i.hardware.contains(ArmingInhibit::ImuLineSilent);
    }

    pub fn imu_silent(&self) -> bool {
        self.imu.time() >= IMU_LOST_TIME
    }

    pub fn tipped_over(&self) -> bool {
        self.tipped.time() >= TIPPED_TIME || self.turned_unseen
    }

    pub fn battery_critical(&self) -> bool {
        self.battery.time() >= BATTERY_TIME
    }

    pub fn line_silent(&self) -> bool {
        self.line_silent
    }

    /// Reason to land under the sticks, or not to leave a pipe, by priority.
    pub fn landing(&self) -> Option<Reason> {
        if self.battery_critical() {
            Some(Reason::BatteryCritical)
        } else if self.line_silent {
            Some(Reason::LINE_SILENT)
        } else {
            None
        }
    }
}
