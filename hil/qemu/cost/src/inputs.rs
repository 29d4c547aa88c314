//! Inputs of the control path that take every branch, equal on every machine: half-second stretches of hover, gusts,
//! hard turns, saturated rotors, low thrust with yaw given up, a sagging battery. Rates and sticks are held for a
//! while, with noise. A few readings are NaN.

use sophie_conformance::fold::Noise;
use sophie_control::attitude::attitude_loop::AttitudeSetpoint;
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::chain::{ArmReading, Command, ImuReading, Surroundings};
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::Vec3;

/// 4 kHz.
pub const READINGS: usize = 4;
/// The estimator calibrates.
pub const REST: u32 = 2500;
pub const FLIGHT: u32 = 12_000;
const STRETCH: u32 = 500;
const HOLD: u32 = 40;
/// Step of ten with new sticks; arms are read in the first four.
const STICKS: usize = 5;
/// One reading in this many is NaN.
const BAD: u32 = 4001;

#[derive(Clone, Copy)]
pub struct Inputs {
    /// Time of the newest reading, µs.
    pub at_us: u64,
    /// Raw rates (rad/s) and specific forces (m/s²).
    pub batch: [ImuReading; READINGS],
    /// Stick command, renewed in one step of ten.
    pub command: Command,
    /// Its attitude, and whether it is new.
    pub sticks: AttitudeSetpoint,
    pub renewed: bool,
    pub resting: bool,
    /// Battery voltage over nominal.
    pub battery_ratio: f32,
    /// Battery ratio and arm readings, each in one step of ten.
    pub surroundings: Surroundings,
    /// Arm read in this step, and its tilt, rad.
    pub arm: Option<(usize, f32)>,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Angle,
    Resting,
    Escape,
}

struct Stretch {
    rate: f32,
    noise: f32,
    stick: f32,
    thrust: (f32, f32),
    kind: Kind,
    battery: f32,
}

const fn stretch(rate: f32, noise: f32, stick: f32, thrust: (f32, f32), battery: f32) -> Stretch {
    Stretch {
        rate,
        noise,
        stick,
        thrust,
        kind: Kind::Angle,
        battery,
    }
}

const STRETCHES: [Stretch; 9] = [
    // Hover, then gusts.
    stretch(0.1, 0.05, 0.05, (17.7, 1.0), 1.05),
    stretch(1.0, 0.3, 0.2, (17.7, 3.0), 1.0),
    // Hard turns; full throttle, where roll and pitch are given up too.
    stretch(3.0, 1.0, 1.0, (18.0, 8.0), 0.95),
    stretch(4.0, 2.0, 1.5, (30.0, 6.0), 0.85),
    // Around the yaw gate, and down to zero.
    stretch(0.5, 0.2, 0.3, (8.0, 3.0), 1.1),
    stretch(2.0, 0.5, 0.8, (2.0, 2.0), 1.2),
    // Extremes on a nearly empty battery.
    stretch(3.0, 1.5, 2.0, (17.0, 17.0), 0.7),
    // On the pipe (yaw given up, integrators held, moments limited), then off it.
    Stretch {
        kind: Kind::Resting,
        ..stretch(0.3, 0.3, 0.1, (6.0, 5.0), 0.95)
    },
    Stretch {
        kind: Kind::Escape,
        ..stretch(1.0, 0.3, 0.2, (22.0, 3.0), 0.95)
    },
];

pub struct Sequence {
    noise: Noise,
    step: u32,
    reading: u32,
    rate: Vec3,
    sticks: Vec3,
    thrust: f32,
    at_us: u64,
    command: Command,
    arms: ArmReading,
}

impl Sequence {
    pub const fn new() -> Self {
        Self {
            noise: Noise::new(7),
            step: 0,
            reading: 0,
            rate: Vec3::ZERO,
            sticks: Vec3::ZERO,
            thrust: 0.0,
            at_us: 0,
            command: Command {
                setpoint: Setpoint::Idle,
                at_us: 0,
                gentle: false,
            },
            arms: ArmReading {
                at_us: 0,
                tilt: [None; 4],
            },
        }
    }

    pub fn next(&mut self) -> Inputs {
        let step = self.step;
        self.step += 1;
        let resting = step < REST;
        let kind = step.saturating_sub(REST) / STRETCH;
        let [first, ..] = &STRETCHES;
        let s = STRETCHES.get(kind as usize % STRETCHES.len()).unwrap_or(first);
        if !resting && step.is_multiple_of(HOLD) {
            self.rate = self.vector() * s.rate;
            self.sticks = self.vector() * s.stick;
            self.thrust = s.thrust.0 + s.thrust.1 * self.noise.unit();
        }
        let noise = if resting { 0.01 } else { s.noise };
        let batch = core::array::from_fn(|_| self.read(noise));
        // 1 ms ± 2 %.
        self.at_us += (1000.0 + 20.0 * self.noise.unit()) as u64;
        let turn = (step % 10) as usize;
        let sticks = AttitudeSetpoint {
            roll: self.sticks.x,
            pitch: self.sticks.y,
            yaw_rate: self.sticks.z,
        };
        if !resting && turn == STICKS {
            self.command = Command {
                setpoint: setpoint(s.kind, sticks, self.thrust),
                at_us: self.at_us,
                gentle: false,
            };
        }
        if turn == 0 {
            self.arms = ArmReading {
                at_us: self.at_us,
                tilt: core::array::from_fn(|_| Some(0.2 * self.noise.unit())),
            };
        }
        let arm = self.arms.tilt.get(turn).and_then(|tilt| Some((turn, (*tilt)?)));
        let battery_ratio = s.battery + 0.02 * self.noise.unit();
        Inputs {
            at_us: self.at_us,
            batch,
            command: self.command,
            sticks,
            renewed: turn == STICKS,
            resting: matches!(self.command.setpoint, Setpoint::Resting { .. }),
            battery_ratio,
            surroundings: Surroundings {
                battery_ratio: Some(battery_ratio),
                thrust_root: Some(1.02),
                arms: Some(self.arms),
            },
            arm,
        }
    }

    /// A reading off the held rate by `noise` rad/s and five times as many m/s².
    fn read(&mut self, noise: f32) -> ImuReading {
        self.reading += 1;
        let mut gyro = self.rate + self.vector() * noise;
        let accel = Vec3::new(0.0, 0.0, -GRAVITY) + self.vector() * (5.0 * noise);
        if self.reading.is_multiple_of(BAD) {
            gyro.y = f32::NAN;
        }
        ImuReading { gyro, accel }
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.noise.unit(), self.noise.unit(), self.noise.unit())
    }
}

const fn setpoint(kind: Kind, sticks: AttitudeSetpoint, thrust: f32) -> Setpoint {
    let AttitudeSetpoint {
        roll,
        pitch,
        yaw_rate,
    } = sticks;
    match kind {
        Kind::Angle => Setpoint::Angle {
            roll,
            pitch,
            yaw_rate,
            thrust,
        },
        Kind::Resting => Setpoint::Resting { roll, pitch, thrust },
        Kind::Escape => Setpoint::Escape {
            roll,
            pitch,
            yaw_rate,
            thrust,
        },
    }
}
