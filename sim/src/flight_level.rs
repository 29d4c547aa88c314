//! A vehicle whose setpoints a test or a study gives: the flight level alone, without pilot and commander.

use crate::aim;
use crate::board::{Board, Port};
use crate::clock::VirtualTime;
use crate::mixers::{Mixer, Variant};
use crate::plant::Plant;
use crate::scenario::Scenario;
use embassy_time::Instant;
use rand_pcg::Pcg64Mcg;
use sophie_control::wrench::Configuration;
use sophie_tasks::links::{Links, Setpoint};

/// Seconds of a flight that are not judged: take-off.
const SETTLE: f64 = 5.0;

/// What is asked of the vehicle at a time, s.
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
    /// Largest difference to the roll that was asked for.
    pub worst_roll: f64,
    /// Largest pitch.
    pub worst_pitch: f64,
    /// Largest yaw.
    pub worst_yaw: f64,
    /// Root mean square of the difference to the roll that was asked for.
    pub rms_roll: f64,
    /// Root mean square of the yaw.
    pub rms_yaw: f64,
    /// Largest less smallest thrust asked of rotor 1.
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

/// The default vehicle with another gain, infill, configuration and allocation; the stack knows the first two.
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
        let time = VirtualTime::new();
        let mut rng = Pcg64Mcg::new(u128::from(scenario.seed) * 2 + 1);
        let plant = Plant::new(scenario, rng.clone());
        let board: &'static Board = Box::leak(Box::new(Board::configured(&scenario.params, &mut rng)));
        let links: &'static Links = Box::leak(Box::new(Links::new(scenario.params)));
        let (variant, configuration) = (scenario.mixer, scenario.vehicle.configuration);
        let mixer = move |p: &_| Mixer::new(variant, configuration, p);
        time.spawn(sophie_tasks::imu::run(links, Port(board)));
        time.spawn(sophie_tasks::estimator::run(links));
        time.spawn(sophie_tasks::control::run(links));
        time.spawn(sophie_tasks::mixer::run(links, mixer));
        time.spawn(sophie_tasks::motors::run(links, Port(board)));
        time.spawn(sophie_tasks::arms::run(links, Port(board)));
        time.spawn(sophie_tasks::analog::run(links, Port(board)));
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

    /// Calibrates, climbs to 3 m under a simple height hold and does what `wish` says for `seconds`.
    ///
    /// # Panics
    /// If the gyroscope is not calibrated after 4 s of rest.
    pub fn fly(&mut self, seconds: f64, wish: impl Fn(f64) -> Maneuver) -> Errors {
        for _ in 0..4000 {
            self.step(Setpoint::Idle);
        }
        assert!(
            self.links.attitude.latest().is_some_and(|a| a.value.calibrated),
            "not calibrated at rest"
        );
        let mut e = Errors::default();
        let (mut sum, mut n) = (0.0, 0.0);
        let (mut low, mut high) = (f64::MAX, f64::MIN);
        for i in 0..(seconds * 1000.0) as usize {
            let t = i as f64 * 1e-3;
            let pose = *self.plant.pose();
            let climb = (3.0 + pose.position.z).clamp(-1.0, 1.0);
            let error = climb + pose.velocity.z;
            sum = (sum + error * 1e-3).clamp(-2.0, 2.0);
            let thrust = (17.7 + 5.0 * error + 2.0 * sum) * (t / 1.0).min(1.0);
            let Maneuver { roll, yaw_rate } = wish(t);
            self.step(Setpoint::Angle {
                roll,
                pitch: 0.0,
                yaw_rate,
                thrust: thrust.clamp(0.0, 30.0) as f32,
            });
            if t < SETTLE {
                continue;
            }
            let [r, p, y] = self.plant.euler();
            let target = self
                .links
                .target
                .latest()
                .map_or(0.0, |v| aim::angles(v.value)[0]);
            n += 1.0;
            e.worst_roll = e.worst_roll.max((r - target).abs());
            e.worst_pitch = e.worst_pitch.max(p.abs());
            e.worst_yaw = e.worst_yaw.max(y.abs());
            e.rms_roll += (r - target).powi(2);
            e.rms_yaw += y.powi(2);
            let thrust = self
                .links
                .mix
                .latest()
                .map_or(0.0, |m| f64::from(m.value.thrusts[0]));
            low = low.min(thrust);
            high = high.max(thrust);
        }
        Errors {
            worst_roll: e.worst_roll.to_degrees(),
            worst_pitch: e.worst_pitch.to_degrees(),
            worst_yaw: e.worst_yaw.to_degrees(),
            rms_roll: (e.rms_roll / n).sqrt().to_degrees(),
            rms_yaw: (e.rms_yaw / n).sqrt().to_degrees(),
            swing: high - low,
        }
    }
}
