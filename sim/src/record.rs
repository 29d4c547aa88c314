//! Record of a flight for table, report and log file.

use sophie_control::allocation::wrench::PerArm;
use sophie_control::mode::Mode;

use crate::scenario::{Rule, Scenario};

/// A flown flight.
#[derive(Clone, Debug)]
pub struct FlightRecord {
    /// The flown scenario.
    pub scenario: Scenario,
    /// Outcome, with the reason of a failure.
    pub outcome: Outcome,
    /// What each rule of the judge says; the scenario's own decides the outcome.
    pub verdicts: Vec<Verdict>,
    /// Samples at [`SAMPLE_HZ`].
    pub samples: Vec<Sample>,
    /// One entry per step begun.
    pub phases: Vec<Phase>,
    /// In order of time.
    pub events: Vec<Event>,
    /// Chosen arms of proven grips.
    pub grip: Vec<Grip>,
    /// Strikes of turning propellers, in order; the judge does not mind them.
    pub strikes: Vec<Strike>,
    /// Simulated time, s.
    pub sim_seconds: f64,
    /// Wall time, s.
    pub wall_seconds: f64,
    /// Missed deadlines, all tasks.
    pub overruns: u32,
    /// Digest of all samples, bit for bit.
    pub digest: u64,
}

/// Samples per simulated second.
pub const SAMPLE_HZ: f64 = 100.0;

/// A rule's verdict.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// The rule.
    pub rule: Rule,
    /// First fault that it found, with its time, in one line; `None`: none as far as the flight went.
    pub fault: Option<String>,
}

/// How a flight ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// All steps done.
    pub accomplished: bool,
    /// Who or what ended it.
    pub ended: Ended,
    /// One line: `mission accomplished`, or what failed and when.
    pub reason: String,
}

/// Who or what ends a flight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The pilot, with every step done.
    Done,
    /// The pilot: a step takes too long, or the stack does not obey.
    GivenUp,
    /// The referee: tipped over, spun, sunk below the ground or flown away.
    Lost,
    /// The judge, by the plant's true state.
    Judged,
    /// The scenario's time limit.
    TimeLimit,
    /// The electronics cannot run on.
    Stopped,
}

/// True and estimated state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// Simulated time, s.
    pub t: f64,
    /// State of the stack.
    pub mode: Mode,
    /// True position NED, m.
    pub position: [f64; 3],
    /// True velocity NED, m/s.
    pub velocity: [f64; 3],
    /// True roll, pitch, yaw, rad.
    pub attitude: [f64; 3],
    /// Estimated roll, pitch, yaw, rad.
    pub attitude_estimate: [f64; 3],
    /// Target roll, pitch, yaw, rad; NaN without a target.
    pub attitude_setpoint: [f64; 3],
    /// True angular rate, rad/s, body.
    pub rate: [f64; 3],
    /// True tilt, rad.
    pub tilt: PerArm<f64>,
    /// By the arm's sensor, rad; NaN without a fresh one.
    pub tilt_measured: PerArm<f64>,
    /// By the mixer's model, rad.
    pub tilt_model: PerArm<f64>,
    /// True thrust, N.
    pub thrust: PerArm<f64>,
    /// Commanded thrust, N.
    pub thrust_asked: PerArm<f64>,
    /// True tension, N.
    pub tension: PerArm<f64>,
    /// Commanded tension, N.
    pub tension_asked: PerArm<f64>,
    /// True pressure at the sensor, Pa.
    pub pressure: PerArm<f64>,
    /// Measured pressure, Pa; NaN if not fresh.
    pub pressure_measured: PerArm<f64>,
    /// Battery voltage under load, V.
    pub battery_voltage: f64,
    /// Throttle of the pilot, 0..1.
    pub throttle: f64,
    /// The rotors saturated.
    pub saturated: bool,
    /// Position by the stack's estimate, in the true axes, m; `None` without one.
    pub position_estimate: Option<[f64; 3]>,
    /// Position of the newest pose that the stack has, late as it is, in the true axes, m; `None` without one.
    pub pose: Option<[f64; 3]>,
    /// True distance along the body's down axis to pipe or ground, m; NaN without.
    pub range: f64,
    /// The newest range that the stack has, m; `None` without a fresh one.
    pub range_measured: Option<f64>,
    /// The newest flow that the stack has, rad/s about the forward and the right axis; `None` without a fresh one.
    pub flow: Option<[f64; 2]>,
}

/// A flown step of the mission.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Such as `take-off`.
    pub name: String,
    /// Start, s.
    pub start: f64,
    /// End, s.
    pub end: f64,
    /// The step was done.
    pub done: bool,
    /// Largest angle between true and target attitude (roll, pitch), rad.
    pub worst_attitude_error: f64,
    /// Largest tilt of any arm, rad, signed.
    pub worst_tilt: f64,
    /// Share of the time, 0..1.
    pub saturation: f64,
    /// Battery voltage at the end, V.
    pub battery_voltage: f64,
    /// Missed deadlines during the step.
    pub overruns: u32,
}

/// An event.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Time, s.
    pub t: f64,
    /// Description, one line.
    pub text: String,
}

/// Grip of one arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// Arm, 1 to 4.
    pub arm: u8,
    /// Measured pressure at the proof, Pa.
    pub pressure: f64,
    /// True pressure at the proof, Pa.
    pub pressure_true: f64,
    /// Torque of the servo at the proof, N·m.
    pub torque: f64,
    /// Time from start of closing to pressure within tolerance, s.
    pub closure: f64,
}

/// A turning propeller that met something.
#[derive(Clone, Debug, PartialEq)]
pub struct Strike {
    /// Arm, 1 to 4.
    pub arm: u8,
    /// Part that reached into the disc.
    pub against: Struck,
    /// Begin, s.
    pub start: f64,
    /// End, s.
    pub end: f64,
    /// How far it reached in, m, at most.
    pub depth: f64,
}

/// What a propeller met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Struck {
    /// The pipe.
    Pipe,
    /// The arm that carries it.
    OwnArm,
}

impl Struck {
    /// For tables: `the pipe`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pipe => "the pipe",
            Self::OwnArm => "its own arm",
        }
    }
}

/// Shows a flight while it runs.
pub trait Observer {
    /// Step `index` of `count` began.
    fn step_began(&mut self, t: f64, index: usize, count: usize, name: &str);
    /// A step ended.
    fn step_ended(&mut self, t: f64, phase: &Phase);
    /// A few times a simulated second; `height` over the ground, m.
    fn progress(&mut self, t: f64, mode: Mode, height: f64);
    /// Something happened.
    fn event(&mut self, event: &Event);
}

/// Shows nothing.
pub struct Silent;

impl Observer for Silent {
    fn step_began(&mut self, _: f64, _: usize, _: usize, _: &str) {}
    fn step_ended(&mut self, _: f64, _: &Phase) {}
    fn progress(&mut self, _: f64, _: Mode, _: f64) {}
    fn event(&mut self, _: &Event) {}
}
