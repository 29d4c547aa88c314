//! Test stand of the flight level alone (inertial sensor to motors) under given setpoints.

use crate::board::{Board, Port};
use crate::clock::VirtualTime;
use crate::mixers::{Mixer, Variant};
use crate::plant::Plant;
use crate::plant::contact::Pose;
use crate::scenario::Scenario;
use crate::sensors::imu::Misfit;
use crate::target_angles;
use embassy_time::Instant;
use sophie_control::allocation::wrench::Configuration;
use sophie_control::chain::MixingStep;
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::params::{MotorMap, Params};
use sophie_tasks::links::Links;

/// Unjudged take-off, s.
const SETTLE: f64 = 5.0;
/// Height to hold, m.
const HEIGHT: f64 = 3.0;
/// Held by [`Rig::fly`], and its largest thrust, N.
const WEIGHT: f64 = 17.7;
const THRUST_MAX: f64 = 30.0;
/// Rest for the gyroscope's calibration, ms.
const REST_MS: usize = 4000;

/// Demand at a time, s.
pub struct Maneuver {
    /// Roll, rad.
    pub roll: f32,
    /// Yaw rate, rad/s.
    pub yaw_rate: f32,
}

/// Hover.
pub fn level(_: f64) -> Maneuver {
    Maneuver {
        roll: 0.0,
        yaw_rate: 0.0,
    }
}

/// Errors after take-off, degrees, and thrust, N.
#[derive(Debug, Default, Clone, Copy)]
pub struct Errors {
    /// Largest roll error.
    pub worst_roll: f64,
    /// Largest pitch.
    pub worst_pitch: f64,
    /// Largest yaw.
    pub worst_yaw: f64,
    /// RMS roll error.
    pub rms_roll: f64,
    /// RMS yaw.
    pub rms_yaw: f64,
    /// Range of rotor 1's asked thrust, N.
    pub swing: f64,
}

/// The vehicle with its flight level.
pub struct Rig {
    time: VirtualTime,
    board: &'static Board,
    /// Its links.
    pub links: &'static Links,
    /// The vehicle.
    pub plant: Plant,
    ms: u64,
}

/// The stack's parameters match gain and infill.
pub fn vehicle(configuration: Configuration, gain_k: f64, infill: f64, mixer: Variant) -> Scenario {
    let mut s = Scenario::default_mission();
    s.vehicle.gain_k = gain_k;
    s.vehicle.infill = infill;
    s.vehicle.configuration = configuration;
    s.params.gain_k = gain_k as f32;
    s.params.infill = infill as f32;
    s.mixer = mixer;
    s
}

impl Rig {
    /// The vehicle of `scenario` at rest on the ground.
    pub fn new(scenario: &Scenario) -> Self {
        let plant = scenario.plant();
        let board = Board::of(scenario);
        let (variant, configuration) = (scenario.mixer, scenario.vehicle.configuration);
        Self::assembled(plant, board, scenario.params, move |p: &_| {
            Mixer::new(variant, configuration, p)
        })
    }

    /// The same with an inertial sensor mounted with the errors of `misfit`.
    pub fn misfitted(scenario: &Scenario, misfit: Misfit) -> Self {
        let rig = Self::new(scenario);
        rig.board.misfit(misfit);
        rig
    }

    /// The same with motors wired by `map`, independent of the parameters.
    pub fn wired(scenario: &Scenario, map: MotorMap) -> Self {
        let rig = Self::new(scenario);
        rig.board.wire(map);
        rig
    }

    /// The same under `allocation`, with the accelerometer's bench-measured bias in the parameters.
    pub fn calibrated<A: MixingStep + 'static>(
        scenario: &Scenario,
        allocation: impl FnOnce(&Params) -> A + 'static,
    ) -> Self {
        let plant = scenario.plant();
        let board = Board::of(scenario);
        let [accel_bias_x, accel_bias_y, accel_bias_z] = board.accel_bias;
        let params = Params {
            accel_bias_x,
            accel_bias_y,
            accel_bias_z,
            ..scenario.params
        };
        Self::assembled(plant, board, params, allocation)
    }

    fn assembled<A: MixingStep + 'static>(
        plant: Plant,
        board: Board,
        params: Params,
        allocation: impl FnOnce(&Params) -> A + 'static,
    ) -> Self {
        let time = VirtualTime::new();
        let board: &'static Board = Box::leak(Box::new(board));
        let links: &'static Links = Box::leak(Box::new(Links::new(params)));
        time.spawn(sophie_tasks::flight::imu::run(links, Port(board)));
        time.spawn(sophie_tasks::flight::estimator::run(links));
        time.spawn(sophie_tasks::flight::control::run(links));
        time.spawn(sophie_tasks::flight::mixer::run(links, allocation));
        time.spawn(sophie_tasks::flight::motors::run(links, Port(board)));
        time.spawn(sophie_tasks::perching::arms::run(links, Port(board)));
        time.spawn(sophie_tasks::perching::analog::run(links, Port(board)));
        Self {
            time,
            board,
            links,
            plant,
            ms: 0,
        }
    }

    /// A millisecond with `setpoint`.
    pub fn step(&mut self, setpoint: Setpoint) {
        self.board.step_world(&mut self.plant);
        self.ms += 1;
        self.links
            .setpoint
            .send(Instant::from_micros(self.ms * 1000), setpoint);
        self.time.run_until(self.ms * 1000);
    }

    /// Calibrates, climbs to 3 m and follows `wish` for `seconds`.
    ///
    /// # Panics
    /// If the gyroscope is not calibrated after 4 s of rest.
    pub fn fly(&mut self, seconds: f64, wish: impl Fn(f64) -> Maneuver) -> Errors {
        for _ in 0..REST_MS {
            self.step(Setpoint::Idle);
        }
        assert!(
            self.links.attitude.latest().is_some_and(|a| a.value.calibrated),
            "not calibrated at rest"
        );
        let mut hold = HeightHold::new(WEIGHT, THRUST_MAX);
        let mut judged = Judged::default();
        for i in 0..(seconds * 1000.0) as usize {
            let t = i as f64 * 1e-3;
            let thrust = hold.thrust(self.plant.pose(), t);
            let Maneuver { roll, yaw_rate } = wish(t);
            self.step(Setpoint::Angle {
                roll,
                pitch: 0.0,
                yaw_rate,
                thrust,
            });
            if t >= SETTLE {
                judged.add(self);
            }
        }
        judged.errors()
    }
}

/// Holds 3 m; thrust ramps up in the first second.
pub struct HeightHold {
    weight: f64,
    thrust_max: f64,
    /// Integral of the height error, m·s.
    sum: f64,
}

impl HeightHold {
    /// `weight` and `thrust_max` in N.
    pub fn new(weight: f64, thrust_max: f64) -> Self {
        Self {
            weight,
            thrust_max,
            sum: 0.0,
        }
    }

    /// Thrust (N) at `t` s after take-off, every millisecond.
    pub fn thrust(&mut self, pose: &Pose, t: f64) -> f32 {
        let error = (HEIGHT + pose.position.z).clamp(-1.0, 1.0) + pose.velocity.z;
        self.sum = (self.sum + error * 1e-3).clamp(-2.0, 2.0);
        let thrust = (self.weight + 5.0 * error + 2.0 * self.sum) * t.min(1.0);
        thrust.clamp(0.0, self.thrust_max) as f32
    }
}

/// Accumulated errors, rad and N.
struct Judged {
    worst: [f64; 3],
    square_roll: f64,
    square_yaw: f64,
    lowest: f64,
    highest: f64,
    count: f64,
}

impl Default for Judged {
    fn default() -> Self {
        Self {
            worst: [0.0; 3],
            square_roll: 0.0,
            square_yaw: 0.0,
            lowest: f64::MAX,
            highest: f64::MIN,
            count: 0.0,
        }
    }
}

impl Judged {
    fn add(&mut self, rig: &Rig) {
        let [roll, pitch, yaw] = rig.plant.euler();
        let target = rig.links.target.latest();
        let off = roll - target.map_or(0.0, |v| target_angles::angles(v.value)[0]);
        for (worst, angle) in self.worst.iter_mut().zip([off, pitch, yaw]) {
            *worst = worst.max(angle.abs());
        }
        self.square_roll += off * off;
        self.square_yaw += yaw * yaw;
        let mix = rig.links.mix.latest();
        let thrust = mix.map_or(0.0, |m| f64::from(m.value.thrusts[0]));
        self.lowest = self.lowest.min(thrust);
        self.highest = self.highest.max(thrust);
        self.count += 1.0;
    }

    fn errors(&self) -> Errors {
        let [worst_roll, worst_pitch, worst_yaw] = self.worst.map(f64::to_degrees);
        Errors {
            worst_roll,
            worst_pitch,
            worst_yaw,
            rms_roll: (self.square_roll / self.count).sqrt().to_degrees(),
            rms_yaw: (self.square_yaw / self.count).sqrt().to_degrees(),
            swing: self.highest - self.lowest,
        }
    }
}
