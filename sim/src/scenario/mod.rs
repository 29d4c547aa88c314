//! A mission: vehicle, world, pilot, steps, seed.
//!
//! Scenarios are TOML files; `tests/scenarios/mission.toml` has every key with its default. Keys name their units;
//! values here are SI.

mod arm;
mod defaults;
mod error;
pub mod keys;
mod load;
mod nearest;
mod read;
mod read_steps;
pub mod settings;
mod steps;
#[cfg(test)]
mod tests;

pub use defaults::MISSION;
pub use error::{Place, ScenarioError};
pub use load::Overrides;
pub use steps::{STEPS, StepKind, StepNumber};

use sophie_control::params::Params;
use sophie_control::rc::ArmChoice;
use sophie_control::wrench::{Configuration, PerArm};
use sophie_tasks::start::StartCause;

use crate::plant::body::BodySpec;
use crate::plant::rotor::RotorSpec;

/// A flight to fly.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Name for titles.
    pub name: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Longest simulated time, s; the flight fails beyond it.
    pub time_limit: f64,
    /// The vehicle as built.
    pub vehicle: Vehicle,
    /// Parameters of the flight stack: the builder's model of the vehicle.
    pub params: Params,
    /// Allocation used by the stack.
    pub mixer: sophie_mixers::Variant,
    /// Arms that close on the pipe.
    pub arms: ArmChoice,
    /// Air and pipe.
    pub world: World,
    /// The pilot's limits.
    pub pilot: Pilot,
    /// The pilot's steps, in order.
    pub steps: Vec<Step>,
    /// Expected outcome, for tests.
    pub expect: Expect,
}

/// The vehicle as built, for the plant.
#[derive(Clone, Debug)]
pub struct Vehicle {
    /// Arm infill, %.
    pub infill: f64,
    /// Gain on the elastic term of Eq. 1.
    pub gain_k: f64,
    /// Configuration of the rotors' senses.
    pub configuration: Configuration,
    /// A1, A2, B1, B2 of Eq. 1, °/N, °/(N %), °/N², °/(N² %): Table I or a fitted arm.
    pub arm_coefficients: [f64; 4],
    /// Thrust at which the nominal arm is level over the rotor's largest; sets α0.
    pub arm_level_share: f64,
    /// Factor on each arm's elastic tilt; nominal 1.
    pub arm_gain: PerArm<f64>,
    /// Offset of each arm's tilt, rad; nominal 0.
    pub arm_offset: PerArm<f64>,
    /// Arms carry their tip mass (true) or follow the thrust alone, as in the paper's statics (false).
    pub coupled_arms: bool,
    /// Damping ratio of the bending mode in hover.
    pub arm_damping: f64,
    /// Battery charge at power-up, 0..1.
    pub battery_charge: f64,
    /// The tendon servo.
    pub servo: ServoProfile,
    /// Mass and inertia.
    pub body: BodySpec,
    /// Motors and propellers, all alike.
    pub rotor: RotorSpec,
}

/// The tendon servo fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ServoProfile {
    /// 35 kgcm, the paper's claim.
    Paper,
    /// MG996R, datasheet at 4.8 V: 9.4 kgcm.
    Mg996r,
}

/// Air and pipe. The origin is the take-off point, on the ground, nose north.
#[derive(Clone, Debug)]
pub struct World {
    /// RMS gust force per axis, N.
    pub gust_force: f64,
    /// RMS gust moment per axis, N·m.
    pub gust_moment: f64,
    /// Outer diameter of the pipe, m.
    pub pipe_diameter: f64,
    /// North and east of the perch spot, m. The pipe runs north-south.
    pub pipe_position: [f64; 2],
    /// Height of the pipe's top over the ground, m.
    pub pipe_top: f64,
    /// Coefficient of friction, vehicle on pipe.
    pub pipe_friction: f64,
}

/// The pilot's limits.
#[derive(Clone, Debug)]
pub struct Pilot {
    /// Reaction delay, s.
    pub delay: f64,
    /// Bandwidth of the pilot's sticks, Hz.
    pub bandwidth: f64,
    /// RMS error of the seen position, m.
    pub eye_noise: f64,
}

/// A step of the mission.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Wait for the calibration, then arm with switch and stick gesture.
    Arm,
    /// Climb to a height over the ground.
    TakeOff {
        /// Height, m.
        height: f64,
    },
    /// Hold the spot.
    Hover {
        /// Duration, s.
        seconds: f64,
    },
    /// The paper's roll manoeuvre: +angle, -angle, level; each side ends once reached.
    Roll {
        /// Roll angle, rad.
        angle: f64,
        /// Longest time per side, s.
        seconds: f64,
    },
    /// Fly to 1 m over the pipe's top.
    FlyToPipe,
    /// Descend onto the pipe until contact.
    Touch,
    /// Set the throttle and start closing; done once the arms close.
    Clamp {
        /// Throttle while closing, 0..1; about 0.3 in the paper.
        throttle: f64,
    },
    /// Set the throttle, start closing, wait for the proven grip and stopped motors.
    Perch {
        /// Throttle while closing, 0..1.
        throttle: f64,
    },
    /// Stay clamped under a push.
    Hold {
        /// Duration, s.
        seconds: f64,
        /// Sideways push at the centre of mass, N, during the middle third.
        push: f64,
    },
    /// Spool up and turn the perch switch off; done once displayed.
    Open,
    /// Spool up, release the tendons, wait for free arms, lift off by 1 m.
    Release,
    /// Fly to a point relative to the take-off point.
    FlyTo {
        /// North, m.
        north: f64,
        /// East, m.
        east: f64,
        /// Height over the ground, m.
        height: f64,
    },
    /// Descend to the ground below.
    Land,
    /// Disarm and wait for stopped motors.
    Disarm,
    /// Transmitter off: no frames, display dark. Done once the display shows the mode again.
    RadioOff {
        /// Duration, s.
        seconds: f64,
    },
    /// Reset of the board; done once the display shows it disarmed.
    Reset {
        /// Cause: decides whether retained memory is lost.
        cause: StartCause,
        /// From the start of the step, s.
        after: f64,
        /// Time without power, s.
        off: f64,
        /// Sideways push at the centre of mass, N, during the step.
        push: f64,
    },
}

/// Expected outcome, for tests.
#[derive(Clone, Debug)]
pub struct Expect {
    /// The mission is accomplished.
    pub accomplished: bool,
    /// Words of the reason if not.
    pub reason: Option<String>,
}
