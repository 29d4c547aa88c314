//! A vehicle whose setpoints an experiment gives: the flight level alone, without pilot and commander.

use embassy_time::Instant;
use glam::DVec3;
use rand_pcg::Pcg64Mcg;
use sophie_control::params::Params;
use sophie_control::wrench::PerArm;
use sophie_tasks::links::{Links, Setpoint};

use super::allocation::Studied;
use sophie_sim::aim;
use sophie_sim::board::{Board, Port};
use sophie_sim::clock::VirtualTime;
use sophie_sim::mixers::Mixer;
use sophie_sim::plant::{GRAVITY, Plant};
use sophie_sim::scenario::Scenario;

/// Time at rest before take-off, s: the gyroscope is calibrated.
const REST: f64 = 4.0;
/// Time from take-off until the experiment begins, s.
pub const SETTLE: f64 = 6.0;
/// Height of the hover, m.
const HEIGHT: f64 = 3.0;
/// Roll or pitch from which the vehicle counts as lost, rad.
const UPSET: f64 = 1.4;
/// Heading error from which the vehicle counts as lost, rad.
const SPUN: f64 = 1.05;
/// Yaw rate from which it does, rad/s.
const SPIN: f64 = 4.0;

/// What is asked of the vehicle and done to it, at a time (s) of the experiment.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wish {
    /// Roll, rad.
    pub roll: f64,
    /// Yaw rate, rad/s.
    pub yaw_rate: f64,
    /// Moment from outside, N·m, body.
    pub moment: DVec3,
    /// Force from outside, N, NED.
    pub push: DVec3,
}

/// One millisecond of the experiment.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Time since the experiment began, s.
    pub t: f64,
    /// True roll, pitch, yaw, rad.
    pub attitude: [f64; 3],
    /// Roll and pitch aimed at, and the heading that was asked for, rad: the one aimed at at the start and every turn since,
    /// whatever the controller made of it.
    pub target: [f64; 3],
    /// True velocity, m/s, NED.
    pub velocity: DVec3,
    /// True body rates, rad/s.
    pub rate: DVec3,
    /// True tilt of each arm, rad.
    pub tilt: PerArm<f64>,
    /// Tilt by the arm's own sensor, rad; NaN where there is none.
    pub tilt_measured: PerArm<f64>,
    /// Bias of each arm that the mixer has learnt, rad.
    pub bias: PerArm<f64>,
    /// True thrust, N.
    pub thrust: PerArm<f64>,
    /// Thrust asked for, N.
    pub asked: PerArm<f64>,
}

/// A flown experiment.
#[derive(Clone, Debug)]
pub struct Flown {
    /// Every millisecond from the start of the experiment.
    pub moments: Vec<Moment>,
    /// When the vehicle was lost, s before or after the start of the experiment.
    pub lost: Option<f64>,
}

/// The vehicle.
struct Rig {
    time: VirtualTime,
    board: &'static Board,
    links: &'static Links,
    plant: Plant,
    ms: u64,
}

impl Rig {
    fn new(scenario: &Scenario, studied: Option<Studied>) -> Self {
        let time = VirtualTime::new();
        let mut rng = Pcg64Mcg::new(u128::from(scenario.seed) * 2 + 1);
        let plant = Plant::new(scenario, rng.clone());
        // Leaked, as a flight's are: tasks borrow them as `'static`.
        let board: &'static Board = Box::leak(Box::new(Board::new(&mut rng)));
        let [accel_bias_x, accel_bias_y, accel_bias_z] = board.accel_bias;
        let params = Params {
            accel_bias_x,
            accel_bias_y,
            accel_bias_z,
            ..scenario.params
        };
        let links: &'static Links = Box::leak(Box::new(Links::new(params)));
        let configuration = scenario.vehicle.configuration;
        time.spawn(sophie_tasks::imu::run(links, Port(board)));
        time.spawn(sophie_tasks::estimator::run(links));
        time.spawn(sophie_tasks::control::run(links));
        match studied {
            None => {
                let variant = scenario.mixer;
                let mixer = move |p: &_| Mixer::new(variant, configuration, p);
                time.spawn(sophie_tasks::mixer::run(links, mixer));
            }
            Some(kind) => {
                let allocation = move |p: &_| kind.allocation(configuration, p);
                time.spawn(sophie_tasks::mixer::run(links, allocation));
            }
        }
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

    fn step(&mut self, setpoint: Setpoint) {
        self.board.step_world(&mut self.plant);
        self.ms += 1;
        self.links
            .setpoint
            .send(Instant::from_micros(self.ms * 1000), setpoint);
        self.time.run_until(self.ms * 1000);
    }

    /// Upset, spinning, or, once the heading is to be kept, far off it.
    fn lost(&self, heading: Option<f64>) -> bool {
        let [roll, pitch, yaw] = self.plant.euler();
        let off = heading.map_or(0.0, |wanted| (yaw - wanted).sin().atan2((yaw - wanted).cos()));
        let upset = roll.abs() > UPSET || pitch.abs() > UPSET || off.abs() > SPUN;
        let omega = self.plant.pose().omega;
        upset || !omega.is_finite() || omega.z.abs() > SPIN
    }

    fn moment(&self, t: f64, heading: f64) -> Moment {
        let wide = |v: PerArm<f32>| v.map(f64::from);
        let mix = self.links.mix.latest().map(|m| m.value).unwrap_or_default();
        let target = self.links.target.latest().map(|v| aim::angles(v.value));
        let measured = self.links.tilts().values();
        Moment {
            t,
            attitude: self.plant.euler(),
            target: target.map_or([f64::NAN; 3], |[roll, pitch, _]| [roll, pitch, heading]),
            velocity: self.plant.pose().velocity,
            rate: self.plant.pose().omega,
            tilt: self.plant.tilt(),
            tilt_measured: measured.map(|a| a.map_or(f64::NAN, f64::from)),
            bias: wide(mix.tilt_bias),
            thrust: self.plant.thrust(),
            asked: wide(mix.thrusts),
        }
    }
}

/// Takes `scenario`'s vehicle off to a hover at 3 m under a simple height hold, then does what `wish` says for
/// `seconds`. The scenario's own steps are not flown; `studied` takes its mixer's place.
///
/// Deterministic: the same scenario gives the same flight to the bit.
pub fn fly(scenario: &Scenario, studied: Option<Studied>, seconds: f64, wish: impl Fn(f64) -> Wish) -> Flown {
    let mut rig = Rig::new(scenario, studied);
    for _ in 0..(REST * 1e3) as usize {
        rig.step(Setpoint::Idle);
    }
    let weight = scenario.vehicle.body.mass * GRAVITY;
    let mut flown = Flown {
        moments: Vec::with_capacity((seconds * 1e3) as usize),
        lost: None,
    };
    let (mut sum, mut heading) = (0.0, None);
    for i in 0..((SETTLE + seconds) * 1e3) as usize {
        let since_take_off = i as f64 * 1e-3;
        let t = since_take_off - SETTLE;
        let pose = *rig.plant.pose();
        let error = (HEIGHT + pose.position.z).clamp(-1.0, 1.0) + pose.velocity.z;
        sum = (sum + error * 1e-3_f64).clamp(-2.0, 2.0);
        let thrust = (weight + 5.0 * error + 2.0 * sum) * since_take_off.min(1.0);
        let Wish {
            roll,
            yaw_rate,
            moment,
            push,
        } = if t >= 0.0 { wish(t) } else { Wish::default() };
        (rig.plant.moment, rig.plant.push) = (moment, push);
        rig.step(Setpoint::Angle {
            roll: roll as f32,
            pitch: 0.0,
            yaw_rate: yaw_rate as f32,
            thrust: thrust.clamp(0.0, 40.0) as f32,
        });
        if t >= 0.0 {
            let wanted = heading.get_or_insert_with(|| {
                let ahead = rig
                    .links
                    .target
                    .latest()
                    .map_or(0.0, |v| f64::from(v.value.ahead));
                rig.plant.euler()[2] + ahead
            });
            *wanted += yaw_rate * 1e-3;
            flown.moments.push(rig.moment(t, *wanted));
        }
        // Spinning up, the heading may slip while yaw is gated.
        if since_take_off > 2.0 && rig.lost(heading) {
            flown.lost = Some(t);
            break;
        }
    }
    flown
}

/// Root of the mean square of `value` over the moments.
pub fn rms(moments: &[Moment], value: impl Fn(&Moment) -> f64) -> f64 {
    let sum: f64 = moments.iter().map(|m| value(m).powi(2)).sum();
    (sum / moments.len().max(1) as f64).sqrt()
}
