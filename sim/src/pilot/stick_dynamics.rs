//! Sticks with a limited bandwidth, switches without.

use core::f64::consts::PI;

use sophie_control::pilot::rc::{ArmChoice, StickMode, Sticks};

/// Wanted stick positions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StickTarget {
    /// Right positive, -1..1.
    pub roll: f64,
    /// Nose up positive, -1..1.
    pub pitch: f64,
    /// Clockwise from above positive, -1..1.
    pub yaw: f64,
    /// 0..1.
    pub throttle: f64,
    /// Arm switch on.
    pub arm_switch: bool,
    /// Perch switch on.
    pub perch_switch: bool,
    /// Hold switch on.
    pub hold_switch: bool,
}

/// The sticks and switches.
#[derive(Clone, Debug)]
pub struct StickDynamics {
    bandwidth: f64,
    arms: ArmChoice,
    /// Positions: roll, pitch, yaw, throttle.
    sticks: [f64; 4],
}

impl StickDynamics {
    /// Sticks with a bandwidth of `bandwidth` Hz; the arms' switch is set before the flight.
    pub fn new(bandwidth: f64, arms: ArmChoice) -> Self {
        Self {
            bandwidth,
            arms,
            sticks: [0.0; 4],
        }
    }

    /// Positions: roll, pitch, yaw, throttle.
    pub fn at(&self) -> [f64; 4] {
        self.sticks
    }

    /// Moves towards `target` for `dt` s.
    pub fn move_to(&mut self, target: &StickTarget, dt: f64) -> Sticks {
        let k = dt / (dt + 1.0 / (2.0 * PI * self.bandwidth));
        let goals = [target.roll, target.pitch, target.yaw, target.throttle];
        let lows = [-1.0, -1.0, -1.0, 0.0];
        for ((stick, goal), low) in self.sticks.iter_mut().zip(goals).zip(lows) {
            *stick += k * (goal.clamp(low, 1.0) - *stick);
            // Close enough is there: gesture and throttle stop are reached.
            if (goal - *stick).abs() < 1e-3 {
                *stick = goal.clamp(low, 1.0);
            }
        }
        let [roll, pitch, yaw, throttle] = self.sticks.map(|x| x as f32);
        Sticks {
            roll,
            pitch,
            yaw,
            throttle,
            arm_switch: target.arm_switch,
            perch_switch: target.perch_switch,
            hold_switch: target.hold_switch,
            stick_mode: StickMode::Angle,
            arms: self.arms,
        }
    }
}
