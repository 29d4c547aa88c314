//! One arm closes on a pipe, as on the paper's test bench: the body is fixed, arm, tendon, servo, skin and pressure
//! sensor are the plant's, gripper and tendon drive are the flight stack's, each at its rate.

use std::collections::VecDeque;

use glam::{DQuat, DVec3};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use sophie_control::fsr::{Fsr, FsrScale};
use sophie_control::grip::ArmState;
use sophie_control::gripper::{ArmGripper, ArmInput, Config, Pressure};
use sophie_control::params::Params;
use sophie_control::tendon::{Reel, TendonDrive};

use crate::plant::arm::{Arm, ArmSpec, TIP_MASS};
use crate::plant::contact::{ARM_LENGTH, ArmSkin, BELLY_Z, Pipe, Pose};
use crate::plant::tendon::{ServoSpec, Tendon, TendonSpec};
use crate::plant::{GRAVITY, STEP};
use crate::sensors::fsr::FsrSensor;

/// Time at rest before the closing, s.
const REST: f64 = 1.0;
/// Fore-aft distance of the belly pads from the pipe's crown line, m, and how deep they sink: a quarter of 10 N each.
const PADS: (f64, f64) = (0.03, 0.6e-3);
/// RMS of the arm sensor's noise, rad.
const TILT_NOISE: f64 = 0.004;
/// Time constant of the rotor, s.
const ROTOR_TAU: f64 = 0.05;

/// A closing to be tried.
#[derive(Clone, Copy, Debug)]
pub struct Closing {
    /// Infill of the arm, %.
    pub infill: f64,
    /// Outer diameter of the pipe, m.
    pub diameter: f64,
    /// The servo fitted; the stack knows it.
    pub servo: ServoSpec,
    /// Thrust of the arm's rotor while it closes, N.
    pub thrust: f64,
    /// Time from the start of the closing, s.
    pub seconds: f64,
    /// Seed of the sensors' noise.
    pub seed: u64,
}

/// A sample of the closing.
#[derive(Clone, Copy, Debug)]
pub struct BenchSample {
    /// Time since the closing began, s.
    pub t: f64,
    /// True pressure at the sensor, Pa.
    pub pressure: f64,
    /// True torque of the servo, N·m.
    pub torque: f64,
    /// Tilt of the arm, rad.
    pub tilt: f64,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Closed {
    /// Samples every 10 ms.
    pub samples: Vec<BenchSample>,
    /// Time to the pressure within its tolerance for good, s; none when the grip was not proven.
    pub closure: Option<f64>,
    /// Mean torque over the last second, N·m, with the rotor stopped.
    pub steady: f64,
    /// Largest torque, N·m.
    pub peak: f64,
    /// State at the end.
    pub state: ArmState,
}

/// Closes one arm. Once it holds, its rotor is stopped within 1.5 s, as on a perch.
#[must_use]
pub fn close(what: &Closing) -> Closed {
    let params = Params {
        infill: what.infill as f32,
        servo_stall: what.servo.stall as f32,
        servo_slew_1: what.servo.slew as f32,
        servo_range: what.servo.range as f32,
        ..Params::default()
    };
    let mut rng = Pcg64Mcg::seed_from_u64(what.seed);
    let radius = 0.5 * what.diameter;
    let mut arm = Arm::new(
        0,
        ArmSpec::new(what.infill, f64::from(params.gain_k), 1.0, 0.0, 0.15),
    );
    let mut tendon = Tendon::new(what.servo, TendonSpec::default());
    let mut skin = ArmSkin::new(0);
    let mut sensor = FsrSensor::new(&mut rng);
    let pose = Pose {
        position: DVec3::ZERO,
        attitude: DQuat::IDENTITY,
        velocity: DVec3::ZERO,
        omega: DVec3::ZERO,
    };
    let pipe = Pipe {
        north: 0.0,
        half_length: 1.0,
        east: 0.0,
        down: BELLY_Z + (radius * radius - PADS.0 * PADS.0).sqrt() - PADS.1,
        radius,
        friction: 0.6,
    };
    let (config, scale, reel) = (
        Config::from_params(&params),
        FsrScale::from_params(&params, 0),
        Reel::from_params(&params, 0),
    );
    let (mut fsr, mut gripper, mut drive) = (Fsr::default(), ArmGripper::default(), TendonDrive::new());
    let mut driven = drive.hold(&reel);
    let (mut sensed, mut tilts, mut measured) = (Pressure::Stale, VecDeque::new(), None);
    let (mut asked, mut thrust) = (what.thrust, what.thrust);
    let mut grip = sophie_control::grip::ArmGrip::default();
    let mut out = Closed {
        samples: vec![],
        closure: None,
        steady: 0.0,
        peak: 0.0,
        state: ArmState::Free,
    };
    let inertia = TIP_MASS * ARM_LENGTH * ARM_LENGTH;
    for step in 1..=((REST + what.seconds) / STEP) as u64 {
        let t = step as f64 * STEP - REST;
        let (alpha, rate) = (arm.tilt, arm.rate);
        thrust += (asked - thrust) * STEP / ROTOR_TAU;
        let load = skin.step(STEP, alpha, rate, &pose, &pipe);
        let moment = tendon.step(STEP, f64::from(driven.pulse_us), alpha) + load.moment_alpha;
        arm.load(thrust, moment, DVec3::new(0.0, 0.0, GRAVITY), true);
        arm.integrate(STEP, arm.generalised / inertia);
        if grip.state == ArmState::Holding {
            out.closure = out.closure.or(grip.closure.map(f64::from));
            asked = (asked - what.thrust * STEP / 1.5).max(0.0);
        }
        if step.is_multiple_of(4) {
            let counts = sensor.sample(load.pressure, 0.002, &mut rng);
            sensed = fsr
                .step(&scale, counts, 0.002)
                .map_or(Pressure::Faulty, Pressure::Known);
        }
        if step.is_multiple_of(20) {
            let noise: f64 = StandardNormal.sample(&mut rng);
            tilts.push_back(alpha + TILT_NOISE * noise);
            if tilts.len() > 2 {
                measured = tilts.pop_front().map(|late: f64| late as f32);
            }
            let input = ArmInput {
                close: t >= 0.0,
                pressure: sensed,
                thrust: asked as f32,
                tension: Some(driven.tension),
                tilt: measured,
            };
            grip = gripper.step(&config, &input, 0.01);
            if t >= 0.0 {
                let torque = tendon.servo_torque();
                out.samples.push(BenchSample {
                    t,
                    pressure: load.pressure,
                    torque,
                    tilt: alpha,
                });
                out.peak = out.peak.max(torque);
            }
        }
        if step.is_multiple_of(40) {
            driven = drive.step(&reel, grip.force, measured, 0.02);
        }
    }
    let last: Vec<f64> = out.samples.iter().rev().take(100).map(|s| s.torque).collect();
    out.steady = last.iter().sum::<f64>() / last.len().max(1) as f64;
    out.state = grip.state;
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::ServoProfile;

    #[test]
    fn a_soft_arm_closes_and_its_torque_is_the_static_one() {
        // 0.6 times the moment of the arm bent to the pipe's curvature and of 950 Pa on its skin: 5.0 kgcm.
        let closed = close(&Closing {
            infill: 6.0,
            diameter: 0.30,
            servo: ServoProfile::Paper.into(),
            thrust: 2.5,
            seconds: 10.0,
            seed: 1,
        });
        assert!(closed.state == ArmState::Holding && closed.closure.is_some());
        assert!(
            (closed.steady * 10.197 / 5.0 - 1.0).abs() < 0.1,
            "{}",
            closed.steady
        );
    }
}
