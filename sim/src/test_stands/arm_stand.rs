//! Test stand of one arm that closes on a pipe, as in the paper: the body is fixed, gripper and tendon drive are the
//! flight stack's, the other parts the plant's.

use std::collections::VecDeque;

use glam::{DQuat, DVec3};
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;
use sophie_control::gripper::contact_pressure::{Fsr, FsrScale};
use sophie_control::gripper::grip::{ArmGrip, ArmState};
use sophie_control::gripper::tendon::{Drive, Reel, TendonDrive};
use sophie_control::gripper::{ArmGripper, ArmInput, Config, Pressure, tendon_stiffness};
use sophie_control::params::Params;

use crate::normal::StandardNormal;
use crate::plant::beam::rest::pipe_under;
use crate::plant::beam::{BeamArm, BeamSpec, Masses};
use crate::plant::body::BodySpec;
use crate::plant::contact::{Pipe, Pose};
use crate::plant::flexible::ArmBending;
use crate::plant::flexible::{Carrier, Drive as Driven, Flexible, Nearby};
use crate::plant::hinged::HingedArm;
use crate::plant::hinged::link::ArmSpec;
use crate::plant::load::Acceleration;
use crate::plant::load::Load;
use crate::plant::tendon::{ServoSpec, Tendon, TendonSpec};
use crate::plant::{GRAVITY, STEP};
use crate::sensors::fsr::{FsrBreak, FsrErrors, FsrSensor};
use crate::streams::Streams;

/// Rest before the closing, s.
const REST: f64 = 1.0;
/// Damping ratio of a [`Closing`]'s arm.
const DAMPING: f64 = 0.15;
/// RMS noise of the arm sensor, rad.
const TILT_NOISE: f64 = 0.004;
/// Parts of a [`Closing`]: time constant of the rotor, s, and friction of the pipe.
const ROTOR_TAU: f64 = 0.05;
const FRICTION: f64 = 0.6;
/// Stop of a holding arm's rotor, s, as on a perch.
const SPOOL_TIME: f64 = 1.5;
/// Holding time after the rotor's stop, s, and gripper runs in half a second.
const AFTER: f64 = 0.5;
const STEADY_SAMPLES: usize = 50;
/// Plant steps per sample, 500 Hz.
const FSR_STEPS: u64 = 4;
/// Plant steps per run, 100 Hz.
const GRIPPER_STEPS: u64 = 20;
const BODY: Pose = Pose {
    position: DVec3::ZERO,
    attitude: DQuat::IDENTITY,
    velocity: DVec3::ZERO,
    omega: DVec3::ZERO,
};

const CARRIER: Carrier = Carrier {
    omega: DVec3::ZERO,
    gravity: DVec3::new(0.0, 0.0, GRAVITY),
    coupled: true,
};
const FIXED: Acceleration = Acceleration {
    linear: DVec3::ZERO,
    angular: DVec3::ZERO,
};

/// A closing to be tried.
#[derive(Clone, Copy, Debug)]
pub struct Closing {
    /// Infill of the arm, %.
    pub infill: f64,
    /// Outer diameter, m.
    pub diameter: f64,
    /// The servo fitted; the stack's parameters match it.
    pub servo: ServoSpec,
    /// Thrust of the arm's rotor while it closes, N.
    pub thrust: f64,
    /// Time from the start of closing, s.
    pub seconds: f64,
    /// Seed of the sensors' noise.
    pub seed: u64,
}

/// An arm before a pipe.
#[derive(Clone, Debug)]
pub struct StandArm {
    /// Index, 0 to 3.
    pub arm: usize,
    /// The arm as built: Eq. 1, and its beam if it bends as one.
    pub spec: ArmSpec,
    /// The beam.
    pub beam: Option<BeamSpec>,
    /// The servo fitted.
    pub servo: ServoSpec,
    /// Its tendon with the reel.
    pub tendon: TendonSpec,
    /// Errors of its pressure sensor.
    pub fsr: FsrErrors,
    /// Time constant of the rotor, s.
    pub rotor_tau: f64,
    /// Parameters of the stack; they may differ from the true arm.
    pub params: Params,
    /// Outer diameter, m.
    pub diameter: f64,
    /// Friction of the pipe.
    pub friction: f64,
    /// Thrust of the arm's rotor while it closes, N.
    pub thrust: f64,
    /// Fault of the pressure sensor.
    pub broken: Option<FsrBreak>,
}

impl StandArm {
    /// Whether arm, servo, reel and sensor scale are equal.
    #[must_use]
    pub fn is_like(&self, other: &Self) -> bool {
        let reel = |arm: &Self| Reel::from_params(&arm.params, arm.arm);
        let scale = |arm: &Self| FsrScale::from_params(&arm.params, arm.arm);
        self.spec == other.spec
            && self.beam == other.beam
            && self.servo == other.servo
            && self.tendon == other.tendon
            && self.fsr == other.fsr
            && reel(self) == reel(other)
            && scale(self) == scale(other)
    }
}

impl From<&Closing> for StandArm {
    fn from(what: &Closing) -> Self {
        let params = Params {
            infill: what.infill as f32,
            servo_stall: what.servo.stall as f32,
            servo_slew_1: what.servo.slew as f32,
            servo_range: what.servo.range as f32,
            ..Params::default()
        };
        let spec = ArmSpec::new(what.infill, f64::from(params.gain_k), 1.0, 0.0, DAMPING);
        Self {
            arm: 0,
            spec,
            beam: Some(BeamSpec::of(&spec, Masses::of(&BodySpec::default()), DAMPING)),
            servo: what.servo,
            tendon: TendonSpec::of(ArmBending::Beam),
            fsr: FsrErrors::default(),
            rotor_tau: ROTOR_TAU,
            params,
            diameter: what.diameter,
            friction: FRICTION,
            thrust: what.thrust,
            broken: None,
        }
    }
}

/// Result of [`try_grip`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tried {
    /// Final state and fault.
    pub grip: ArmGrip,
    /// Largest force asked of the tendon while holding, N; over the whole run if it never held.
    pub asked: f64,
    /// Mean servo torque over the last half second, N·m.
    pub steady: f64,
    /// Largest true pressure, Pa.
    pub peak: f64,
}

/// Closes `arm` until it has held with its rotor stopped for `AFTER`, the gripper gives up, or `longest` s have passed.
#[must_use]
pub fn try_grip(arm: &StandArm, longest: f64) -> Tried {
    let mut stand = ArmStand::new(arm, 1);
    let (mut asked, mut peak, mut last) = (0.0_f64, 0.0_f64, VecDeque::new());
    let (mut stopped, mut held) = (0.0, false);
    for step in 1..=((REST + longest) / STEP) as u64 {
        peak = peak.max(stand.step(step, arm.thrust));
        if !step.is_multiple_of(GRIPPER_STEPS) {
            continue;
        }
        let holding = stand.grip.state == ArmState::Holding;
        // The force that holds counts: during closing it may be briefly larger.
        asked = if holding && !held { 0.0 } else { asked };
        held |= holding;
        asked = asked.max(f64::from(stand.grip.force));
        last.push_back(stand.tendon.servo_torque());
        if last.len() > STEADY_SAMPLES {
            last.pop_front();
        }
        stopped = if holding && stand.thrust_asked <= 0.0 {
            stopped + GRIPPER_STEPS as f64 * STEP
        } else {
            0.0
        };
        if stopped >= AFTER || matches!(stand.grip.state, ArmState::ForceLimited | ArmState::Faulty) {
            break;
        }
    }
    Tried {
        grip: stand.grip,
        asked,
        steady: last.iter().sum::<f64>() / last.len().max(1) as f64,
        peak,
    }
}

/// A sample of the closing.
#[derive(Clone, Copy, Debug)]
pub struct ClosingSample {
    /// From the start of closing, s.
    pub t: f64,
    /// True pressure at the sensor, Pa.
    pub pressure: f64,
    /// True torque of the servo, N·m.
    pub torque: f64,
    /// Tilt of the arm, rad.
    pub tilt: f64,
}

/// Result of [`close`].
#[derive(Clone, Debug)]
pub struct Closed {
    /// Samples every 10 ms.
    pub samples: Vec<ClosingSample>,
    /// Until the pressure stays within tolerance, s; `None` without proof of grip.
    pub closure: Option<f64>,
    /// Mean torque over the last second, rotor stopped, N·m.
    pub steady: f64,
    /// Largest torque, N·m.
    pub peak: f64,
    /// State at the end.
    pub state: ArmState,
}

/// Closes one arm; once it holds, its rotor stops within 1.5 s.
#[must_use]
pub fn close(what: &Closing) -> Closed {
    let mut stand = ArmStand::new(&what.into(), what.seed);
    let mut out = Closed {
        samples: vec![],
        closure: None,
        steady: 0.0,
        peak: 0.0,
        state: ArmState::Free,
    };
    for step in 1..=((REST + what.seconds) / STEP) as u64 {
        let t = step as f64 * STEP - REST;
        let tilt = stand.arm.tilt();
        if stand.grip.state == ArmState::Holding {
            out.closure = out.closure.or(stand.grip.closure.map(f64::from));
        }
        let pressure = stand.step(step, what.thrust);
        if step.is_multiple_of(GRIPPER_STEPS) && t >= 0.0 {
            let torque = stand.tendon.servo_torque();
            out.samples.push(ClosingSample {
                t,
                pressure,
                torque,
                tilt,
            });
            out.peak = out.peak.max(torque);
        }
    }
    let last: Vec<f64> = out.samples.iter().rev().take(100).map(|s| s.torque).collect();
    out.steady = last.iter().sum::<f64>() / last.len().max(1) as f64;
    out.state = stand.grip.state;
    out
}

struct ArmStand {
    tilt_noise: Pcg64Mcg,
    pipe: Pipe,
    arm: Box<dyn Flexible>,
    tendon: Tendon,
    sensor: FsrSensor,
    /// Thrust, N.
    thrust: f64,
    thrust_asked: f64,
    /// Tilts delayed by the arm sensor, rad.
    tilts: VecDeque<f64>,

    config: Config,
    scale: FsrScale,
    reel: Reel,
    fsr: Fsr,
    gripper: ArmGripper,
    drive: TendonDrive,
    rotor_tau: f64,
    drive_steps: u64,
    /// Last outputs of the stack.
    pressure: Pressure,
    tilt: Option<f32>,
    grip: ArmGrip,
    order: Drive,
}

impl ArmStand {
    fn new(what: &StandArm, seed: u64) -> Self {
        let params = &what.params;
        let streams = Streams::new(seed);
        let mut sensor = FsrSensor::new(what.arm, streams).with_errors(what.fsr);
        sensor.set_broken(what.broken);
        let reel = Reel::from_params(params, what.arm);
        let drive = TendonDrive::new();
        let order = drive.hold(&reel);
        let arm: Box<dyn Flexible> = match what.beam {
            Some(beam) => Box::new(BeamArm::new(what.arm, beam)),
            None => Box::new(HingedArm::new(what.arm, what.spec)),
        };
        Self {
            tilt_noise: streams.of("tilt"),
            pipe: pipe_under(0.5 * what.diameter, what.friction),
            arm,
            tendon: Tendon::new(what.servo, what.tendon),
            sensor,
            thrust: what.thrust,
            thrust_asked: what.thrust,
            tilts: VecDeque::new(),
            config: Config::from_params(params),
            scale: FsrScale::from_params(params, what.arm),
            reel,
            fsr: Fsr::default(),
            gripper: ArmGripper::default(),
            drive,
            rotor_tau: what.rotor_tau,
            drive_steps: (1.0 / (f64::from(params.servo_frame_rate) * STEP))
                .round()
                .max(1.0) as u64,
            pressure: Pressure::Stale,
            tilt: None,
            grip: ArmGrip::default(),
            order,
        }
    }

    /// Returns the true pressure, Pa. The arm closes after [`REST`]; once it holds, its rotor of `thrust` N stops.
    fn step(&mut self, step: u64, thrust: f64) -> f64 {
        let tilt = self.arm.tilt();
        let pressure = self.move_arm();
        if self.grip.state == ArmState::Holding {
            self.thrust_asked = (self.thrust_asked - thrust * STEP / SPOOL_TIME).max(0.0);
        }
        self.run_stack(step, step as f64 * STEP - REST >= 0.0, pressure, tilt);
        self.drive_servo(step);
        pressure
    }

    /// Returns the true pressure, Pa.
    fn move_arm(&mut self) -> f64 {
        self.thrust += (self.thrust_asked - self.thrust) * STEP / self.rotor_tau;
        let nearby = Nearby {
            pipe: Some(self.pipe),
            ..Nearby::default()
        };
        let body = &mut Load::default();
        let pressure = self.arm.touch(STEP, &BODY, &nearby, body);
        let pulse = f64::from(self.order.pulse_us);
        // No spin: a fixed body turns no rotor's axis but by the arm's own motion.
        let drive = Driven {
            dt: STEP,
            thrust: self.thrust,
            tendon: self.tendon.step(STEP, 1.0, pulse, self.arm.tilt()),
            ..Driven::default()
        };
        self.arm.drive(&drive, &CARRIER, body);
        self.arm.advance(
            STEP,
            &FIXED,
            &Carrier {
                coupled: false,
                ..CARRIER
            },
        );
        pressure
    }

    /// Runs filter and gripper when due; `pressure` (Pa) and `tilt` (rad) are true.
    fn run_stack(&mut self, step: u64, close: bool, pressure: f64, tilt: f64) {
        if step.is_multiple_of(FSR_STEPS) {
            self.sensor.bend(tilt);
            let counts = self.sensor.sample(pressure, 0.002);
            self.pressure = self
                .fsr
                .step(&self.scale, counts, 0.002)
                .map_or(Pressure::Faulty, Pressure::Known);
        }
        if step.is_multiple_of(GRIPPER_STEPS) {
            let noise: f64 = StandardNormal.sample(&mut self.tilt_noise);
            self.tilts.push_back(tilt + TILT_NOISE * noise);
            if self.tilts.len() > 2 {
                self.tilt = self.tilts.pop_front().map(|late| late as f32);
            }
            let input = ArmInput {
                close,
                pressure: self.pressure,
                turn_on: self.scale.turn_on(),
                thrust: self.thrust_asked as f32,
                tension: Some(self.order.tension),
                tilt: self.tilt,
            };
            self.grip = self.gripper.step(&self.config, &input, 0.01);
        }
    }

    fn drive_servo(&mut self, step: u64) {
        if step.is_multiple_of(self.drive_steps) {
            let dt = (self.drive_steps as f64 * STEP) as f32;
            let reel = self.reel.softened(tendon_stiffness(self.grip.response));
            self.order = self.drive.step(&reel, self.grip.force, self.tilt, dt);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::tendon::ServoProfile;

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
