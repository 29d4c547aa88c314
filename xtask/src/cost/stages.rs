//! Stages: names, cost targets, the best peer's cost.

/// Permitted cost of an M4F over an M7's target.
pub const M4F_ALLOWANCE: f64 = 1.3;
/// Largest ratio of the costliest call to the mean.
pub const SPREAD: f64 = 1.05;

pub struct Stage {
    /// Name in the image's output.
    pub name: &'static str,
    pub what: &'static str,
    /// Parts of a call; the figures are per part.
    pub parts: f64,
    /// Most instructions on an M7.
    pub target: Option<f64>,
    pub peer: &'static str,
}

const fn stage(name: &'static str, what: &'static str, target: Option<f64>, peer: &'static str) -> Stage {
    Stage {
        name,
        what,
        parts: 1.0,
        target,
        peer,
    }
}

pub const STAGES: [Stage; 18] = [
    Stage {
        parts: 3.0,
        ..stage("biquads", "low pass, one biquad-axis", Some(16.0), "22 (PX4)")
    },
    stage("filter", "IMU filter: 4 readings, 6 axes", None, "none compares"),
    stage(
        "estimator",
        "estimator, quaternion out",
        Some(300.0),
        "425 (Betaflight), 445 (Crazyflie), both with Euler",
    ),
    stage(
        "aim",
        "direction that the sticks want, one step in ten",
        None,
        "none compares",
    ),
    stage("attitude", "attitude control", Some(150.0), "260 (Crazyflie)"),
    stage(
        "rate",
        "rate PID, 3 axes, D filter, anti-windup, notch",
        Some(250.0),
        "198 (PX4, minimal), 990 (Betaflight), 996 (ArduPilot)",
    ),
    stage(
        "control",
        "control: aim, attitude, rates, loop switching, resting limits",
        None,
        "none compares",
    ),
    stage("tilt", "tilt and slope of four arms", Some(200.0), "none has it"),
    stage(
        "allocation",
        "Jacobian, allocation, desaturation",
        Some(600.0),
        "1636 (ArduPilot-style), about 35000 (PX4)",
    ),
    stage(
        "commands",
        "thrust curve, battery, 4 commands",
        Some(120.0),
        "496 (Crazyflie), 908 (ArduPilot)",
    ),
    stage(
        "arm-sensor",
        "bias of one arm's tilt, four steps in ten",
        None,
        "none has it",
    ),
    stage(
        "mixing",
        "mixing: tilt, allocation, commands, arms' readings",
        None,
        "none compares",
    ),
    stage(
        "whole",
        "whole step",
        Some(1800.0),
        "4700 (Betaflight F745, RPM notches, no tilt)",
    ),
    stage(
        "position",
        "position estimate, three steps in four: the inertial sensor alone",
        None,
        "none compares",
    ),
    stage(
        "position-flow",
        "the same, with new flow and range",
        None,
        "none compares",
    ),
    stage(
        "position-pose",
        "the same, with a new pose",
        None,
        "none compares",
    ),
    stage("hold", "law of the hold, 100 Hz", None, "none compares"),
    stage("ground", "bytes of flow and range, 50 Hz", None, "none compares"),
];
