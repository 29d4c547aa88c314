//! Dangers common to all states, 100 Hz.
//!
//! | trouble | on the ground | in the air | on the pipe |
//! |---|---|---|---|
//! | arm switch off | stop | stop | stop, arms stay closed |
//! | radio lost | stop | level, over one place if that is known, sink, stop on what carries | keep closing, keep the grip |
//! | inertial sensor silent | stop | stop | stop, arms stay closed |
//! | tipped over, or turned faster than the gyro reads | stop | stop | stop, arms stay closed |
//! | battery critical, or not measured | - | sink, the pilot still steers | reported; release refused |
//! | data-ready line silent | stop | sink, the pilot still steers | reported; release refused |

use crate::arming::ArmingInhibit;
use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar::deg;
use crate::mode::inputs::Inputs;
use crate::mode::reason::Reason;
use crate::params::Params;

/// Sensor silence that stops the rotors for good, s; control has already.
pub const IMU_LOST_TIME: f32 = 0.05;
/// Tilt beyond which the vehicle has tipped over, rad.
pub const TIPPED_TILT: f32 = deg(100.0);
/// Time beyond [`TIPPED_TILT`], s.
pub const TIPPED_TIME: f32 = 0.5;
/// Largest rate that the gyro surely measures, share of its full scale: the rest is left to bias and filter.
const GYRO_SATURATED: f32 = 0.98;
/// Angle turned at full scale after which the attitude is unknown, rad: a vehicle at twice that rate has turned by as
/// much again unmeasured.
const UNSEEN_TURN: f32 = deg(30.0);
/// Time below the critical voltage, or without a fresh one, s: longer than a gust's current peak. If the battery ceases
/// to be measured, the vehicle lands 1.5 s after the last voltage, 0.5 s of it by the link's limit; a flight of ten
/// minutes draws 0.25 % of the charge meanwhile.
pub const BATTERY_TIME: f32 = 1.0;

#[derive(Clone, Copy, Debug, Default)]
pub struct Dangers {
    imu: HoldTimer,
    tipped: HoldTimer,
    saturated: HoldTimer,
    turned_unseen: bool,
    battery: HoldTimer,
    /// The voltage is stale: the guard cannot see an empty battery, so it assumes one.
    battery_blind: bool,
    /// Set by the port after its own delay.
    line_silent: bool,
}

impl Dangers {
    /// One step of `dt` s.
    pub fn step(&mut self, i: &Inputs, p: &Params, dt: f32) {
        self.imu.step(i.motion.is_none(), dt);
        let tipped = i
            .motion
            .is_some_and(|m| m.q.down_in_body().z < crate::maths::scalar::cos(TIPPED_TILT));
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
            .step(i.battery.is_none_or(|v| v < p.battery_critical), dt);
        self.battery_blind = i.battery.is_none();
        self.line_silent = i.hardware.contains(ArmingInhibit::ImuLineSilent);
    }

    pub fn imu_silent(&self) -> bool {
        self.imu.time() >= IMU_LOST_TIME
    }

    pub fn tipped_over(&self) -> bool {
        self.tipped.time() >= TIPPED_TIME || self.turned_unseen
    }

    /// The battery is below its critical voltage, or its voltage is unknown.
    pub fn battery_critical(&self) -> bool {
        self.battery().is_some()
    }

    /// The battery's fault.
    pub fn battery(&self) -> Option<Reason> {
        let why = if self.battery_blind {
            Reason::BATTERY_SILENT
        } else {
            Reason::BatteryCritical
        };
        (self.battery.time() >= BATTERY_TIME).then_some(why)
    }

    pub fn line_silent(&self) -> bool {
        self.line_silent
    }

    /// Reason to land under the sticks, or not to leave a pipe, by priority.
    pub fn landing(&self) -> Option<Reason> {
        let line = self.line_silent.then_some(Reason::LINE_SILENT);
        self.battery().or(line)
    }
}
