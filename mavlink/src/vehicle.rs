//! The vehicle's state for the server, in the units and frames of the flight stack.

use sophie_control::allocation::motor_pulses::MotorPulses;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::arming::ArmingInhibits;
use sophie_control::battery::{Battery, ServoBattery};
use sophie_control::calibration::procedure::Readings;
use sophie_control::chain::Attitude;
use sophie_control::gripper::grip::GripState;
use sophie_control::mode::{Mode, Reason};
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_control::pilot::actuator_test::ActuatorTestView;
use sophie_control::pilot::rc::Sticks;
use sophie_control::pilot::remote::RemoteAnswer;
use sophie_control::vibration::Vibration;

/// State of the commander.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Condition {
    /// Flight mode.
    pub mode: Mode,
    /// Reason of refused arming, of the failsafe, or of the last change of mode.
    pub reason: Option<Reason>,
    /// A defect that does not stop the flight; empty if there is no defect.
    pub warning: &'static str,
    /// The failing arming checks.
    pub inhibits: ArmingInhibits,
}

/// The state of the vehicle at one time; `None` and NaN stand for a value that is unknown or too old.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vehicle {
    /// State of the commander.
    pub condition: Option<Condition>,
    /// Attitude estimate.
    pub attitude: Option<Attitude>,
    /// The pilot's sticks and switches.
    pub sticks: Option<Sticks>,
    /// The flight battery.
    pub battery: Option<Battery>,
    /// Usable charge of a fresh battery, A·s.
    pub capacity: f32,
    /// The servo battery; `None` if it is not measured.
    pub servo_battery: Option<ServoBattery>,
    /// Motor commands, share of full drive; 0 for a stopped motor.
    pub motors: Option<PerArm<f32>>,
    /// Pulse range of the motors, to convert the commands.
    pub motor_pulses: MotorPulses,
    /// Pulses of the tendon servos, µs.
    pub servos: Option<PerArm<f32>>,
    /// Tilt of the arms by their own sensors, rad, positive tip up.
    pub tilt: PerArm<f32>,
    /// Commanded angle of the servos, rad from release.
    pub reel: PerArm<f32>,
    /// State of the grip.
    pub grip: Option<GripState>,
    /// The sensors, as calibrations take them.
    pub readings: Readings,
    /// The air around the board.
    pub air: Option<AirPressure>,
    /// Vibration of the last second.
    pub vibration: Option<Vibration>,
    /// Name of the board.
    pub board: &'static str,
    /// Revision of the chip, as text; zeros where it is not known.
    pub chip: [u8; 24],
    /// Identity of the image, and of its table of parameters.
    pub build: [u32; 2],
    /// Longest time since the start from data-ready to the motor frame, thousandths of the period.
    pub load: u16,
    /// The commander's answers.
    pub answers: Answers,
}

/// The commander's answers to orders.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answers {
    /// State of the actuator tests.
    pub actuator_test: ActuatorTestView,
    /// Number of the newest remote order of any line.
    pub newest: u32,
    /// That order is still being sent.
    pub renewed: bool,
    /// Reply to the last remote command.
    pub remote: RemoteAnswer,
}

impl Answers {
    /// Number of the next remote order; `None` while another one waits for its answer: the link to the commander holds
    /// one.
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
            readings: Readings::default(),
            air: None,
            vibration: None,
            board: "",
            chip: [0; 24],
            build: [0; 2],
            load: 0,
            answers: Answers::default(),
        }
    }
}

impl Vehicle {
    /// The mode; `None` while the commander is silent.
    pub fn mode(&self) -> Option<Mode> {
        self.condition.map(|condition| condition.mode)
    }

    /// True while the rotors stand and cannot start: parameters may change, the board may restart.
    pub fn at_rest(&self) -> bool {
        matches!(self.mode(), Some(Mode::Disarmed | Mode::Calibrating))
    }
}
