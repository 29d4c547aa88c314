//! What the server says of the vehicle: one picture of it, in the units and axes of the flight stack.

use sophie_control::allocation::motor_pulses::MotorPulses;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::arming::ArmingInhibits;
use sophie_control::battery::{Battery, ServoBattery};
use sophie_control::calibration::AccelFit;
use sophie_control::chain::Attitude;
use sophie_control::gripper::grip::GripState;
use sophie_control::mode::{Mode, Reason};
use sophie_control::params::Params;
use sophie_control::pilot::bench_orders::BenchView;
use sophie_control::pilot::rc::Sticks;
use sophie_control::pilot::remote::RemoteAnswer;

/// The commander's view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Condition {
    /// What the vehicle is doing.
    pub mode: Mode,
    /// Why arming is refused, the failsafe acts or the last mode was left.
    pub reason: Option<Reason>,
    /// What does not stop the flight but must be known; empty where there is nothing.
    pub warning: &'static str,
    /// Everything that forbids arming.
    pub inhibits: ArmingInhibits,
}

/// The vehicle at one time; `None` and NaN stand for what is not known or too old.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vehicle {
    /// The commander's view.
    pub condition: Option<Condition>,
    /// The estimate.
    pub attitude: Option<Attitude>,
    /// The pilot's wishes.
    pub sticks: Option<Sticks>,
    /// The flight battery.
    pub battery: Option<Battery>,
    /// Usable charge of a fresh battery, A·s.
    pub capacity: f32,
    /// The servo battery, if one is measured.
    pub servo_battery: Option<ServoBattery>,
    /// Motor commands, shares of full drive, 0 for a stopped one.
    pub motors: Option<PerArm<f32>>,
    /// The pulses that these are.
    pub motor_pulses: MotorPulses,
    /// Pulses of the tendon servos, µs.
    pub servos: Option<PerArm<f32>>,
    /// Tilt of the arms by their own sensors, rad, tip up.
    pub tilt: PerArm<f32>,
    /// Angle to which the servos are sent, rad from release.
    pub reel: PerArm<f32>,
    /// The grip.
    pub grip: Option<GripState>,
    /// What is made of the accelerometer's readings.
    pub accel_fit: AccelFit,
    /// Longest time from data-ready to the motor frame since the start, thousandths of its period.
    pub load: u16,
    /// What became of orders.
    pub answers: Answers,
}

/// What the commander answers to orders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answers {
    /// The bench.
    pub bench: BenchView,
    /// Number of the newest order beside the pilot's, of whichever line.
    pub newest: u32,
    /// That order is still renewed.
    pub renewed: bool,
    /// What has become of the one that was answered last.
    pub remote: RemoteAnswer,
}

impl Answers {
    /// The number of the next order beside the pilot's; `None` while another waits for its answer: two at a time would
    /// hide each other from the commander.
    pub fn next(&self) -> Option<u32> {
        let waits = self.renewed && self.remote.number != self.newest;
        (!waits).then(|| self.newest.wrapping_add(1).max(1))
    }
}

impl Default for Vehicle {
    fn default() -> Self {
        Self {
            condition: None,
            attitude: None,
            sticks: None,
            battery: None,
            capacity: 0.0,
            servo_battery: None,
            motors: None,
            motor_pulses: MotorPulses::DIGITAL,
            servos: None,
            tilt: [f32::NAN; 4],
            reel: [f32::NAN; 4],
            grip: None,
            accel_fit: AccelFit::of(&Params::DEFAULT),
            load: 0,
            answers: Answers::default(),
        }
    }
}

impl Vehicle {
    /// What it is doing.
    pub fn mode(&self) -> Option<Mode> {
        self.condition.map(|condition| condition.mode)
    }

    /// Rotors stand and nothing may start them: what must not happen in flight may happen.
    pub fn at_rest(&self) -> bool {
        matches!(self.mode(), Some(Mode::Disarmed | Mode::Calibrating))
    }
}
