//! Experiments on the flight level alone: take-off, `demand`, the truth every millisecond.

use glam::DVec3;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::chain::setpoint::Setpoint;
use sophie_sim::mixers::Mixer;
use sophie_sim::plant::GRAVITY;
use sophie_sim::scenario::Scenario;
use sophie_sim::target_angles;
use sophie_sim::test_stands::flight_level::{HeightHold, Rig};

use super::allocation::Studied;

/// For the gyroscope's calibration, s.
const REST: f64 = 4.0;
/// From take-off to the experiment, s.
pub const SETTLE: f64 = 6.0;
/// Limit of the height hold, N.
const THRUST_MAX: f64 = 40.0;
/// s: yaw is gated, and the heading may slip.
const SPOOL_UP: f64 = 2.0;
/// Roll or pitch of a lost vehicle, rad.
const UPSET: f64 = 1.4;
/// Heading error of a lost vehicle, rad.
const SPUN: f64 = 1.05;
/// Yaw rate of a lost vehicle, rad/s.
const SPIN: f64 = 4.0;

/// Demand and disturbance at a time of the experiment.
#[derive(Clone, Copy, Debug, Default)]
pub struct Demand {
    /// Roll, rad.
    pub roll: f64,
    /// Yaw rate, rad/s.
    pub yaw_rate: f64,
    /// External moment, N·m, body.
    pub moment: DVec3,
    /// External force, N, NED.
    pub push: DVec3,
}

/// One millisecond of the experiment.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Time of the experiment, s.
    pub t: f64,
    /// True roll, pitch, yaw, rad.
    pub attitude: [f64; 3],
    /// Roll, pitch and heading, rad; heading is the initial one plus every turn since, regardless of the controller.
    pub target: [f64; 3],
    /// True velocity, m/s, NED.
    pub velocity: DVec3,
    /// True body rates, rad/s.
    pub rate: DVec3,
    /// rad.
    pub tilt: PerArm<f64>,
    /// By the arm's sensor, rad; NaN if none.
    pub tilt_measured: PerArm<f64>,
    /// Arm bias learnt by the mixer, rad.
    pub bias: PerArm<f64>,
    /// True thrust, N.
    pub thrust: PerArm<f64>,
    /// Thrust asked for, N.
    pub asked: PerArm<f64>,
}

/// A flown experiment.
#[derive(Clone, Debug)]
pub struct Flown {
    /// Every millisecond of the experiment.
    pub moments: Vec<Moment>,
    /// Time of the loss from the start, s; negative before.
    pub lost: Option<f64>,
}

fn rig(scenario: &Scenario, studied: Option<Studied>) -> Rig {
    let (variant, configuration) = (scenario.mixer, scenario.vehicle.configuration);
    match studied {
        None => Rig::calibrated(scenario, move |p| Mixer::new(variant, configuration, p)),
        Some(kind) => Rig::calibrated(scenario, move |p| kind.allocation(configuration, p)),
    }
}

/// Upset, spinning, or far off a kept heading.
fn lost(rig: &Rig, heading: Option<f64>) -> bool {
    let [roll, pitch, yaw] = rig.plant.euler();
    let off = heading.map_or(0.0, |wanted| libm::remainder(yaw - wanted, std::f64::consts::TAU));
    let upset = roll.abs() > UPSET || pitch.abs() > UPSET || off.abs() > SPUN;
    let omega = rig.plant.pose().omega;
    upset || !omega.is_finite() || omega.z.abs() > SPIN
}

/// At `t` s, with the demanded `heading` (rad).
fn moment(rig: &Rig, t: f64, heading: f64) -> Moment {
    let wide = |v: PerArm<f32>| v.map(f64::from);
    let mix = rig.links.mix.latest().map(|m| m.value).unwrap_or_default();
    let target = rig.links.target.latest().map(|v| target_angles::angles(v.value));
    let measured = rig.links.tilts().values();
    Moment {
        t,
        attitude: rig.plant.euler(),
        target: target.map_or([f64::NAN; 3], |[roll, pitch, _]| [roll, pitch, heading]),
        velocity: rig.plant.pose().velocity,
        rate: rig.plant.pose().omega,
        tilt: rig.plant.tilt(),
        tilt_measured: measured.map(|a| a.map_or(f64::NAN, f64::from)),
        bias: wide(mix.tilt_bias),
        thrust: rig.plant.thrust(),
        asked: wide(mix.thrusts),
    }
}

fn aimed_heading(rig: &Rig) -> f64 {
    let target = rig.links.target.latest();
    rig.plant.euler()[2] + target.map_or(0.0, |v| f64::from(v.value.ahead))
}

/// Hovers `scenario`'s vehicle at 3 m, then follows `demand` for `seconds` instead of its steps; `studied` replaces the
/// mixer. Deterministic to the bit.
pub fn fly(
    scenario: &Scenario,
    studied: Option<Studied>,
    seconds: f64,
    demand: impl Fn(f64) -> Demand,
) -> Flown {
    let mut rig = rig(scenario, studied);
    for _ in 0..(REST * 1e3) as usize {
        rig.step(Setpoint::Idle);
    }
    let mut hold = HeightHold::new(scenario.vehicle.body.mass * GRAVITY, THRUST_MAX);
    let mut flown = Flown {
        moments: Vec::with_capacity((seconds * 1e3) as usize),
        lost: None,
    };
    let mut heading = None;
    for i in 0..((SETTLE + seconds) * 1e3) as usize {
        let since_take_off = i as f64 * 1e-3;
        let t = since_take_off - SETTLE;
        let thrust = hold.thrust(rig.plant.pose(), since_take_off);
        let demand = if t >= 0.0 { demand(t) } else { Demand::default() };
        (rig.plant.moment, rig.plant.push) = (demand.moment, demand.push);
        rig.step(Setpoint::Angle {
            roll: demand.roll as f32,
            pitch: 0.0,
            yaw_rate: demand.yaw_rate as f32,
            thrust,
        });
        if t >= 0.0 {
            let wanted = heading.get_or_insert_with(|| aimed_heading(&rig));
            *wanted += demand.yaw_rate * 1e-3;
            flown.moments.push(moment(&rig, t, *wanted));
        }
        if since_take_off > SPOOL_UP && lost(&rig, heading) {
            flown.lost = Some(t);
            break;
        }
    }
    flown
}

/// RMS of `value` over the moments.
pub fn rms(moments: &[Moment], value: impl Fn(&Moment) -> f64) -> f64 {
    let sum: f64 = moments.iter().map(|m| value(m).powi(2)).sum();
    (sum / moments.len().max(1) as f64).sqrt()
}
