//! Shared by the flown sections.

use crate::study::rig::{Flown, Moment, rms};
use sophie_control::allocation::wrench::Configuration;
use sophie_sim::mixers::Variant;
use sophie_sim::plant::flexible::ArmBending;
use sophie_sim::plant::tendon::assume_bending;
use sophie_sim::scenario::Scenario;

use crate::results::model::{Cell, num};

/// Gusts: RMS force (N) and moment (N·m) per axis.
pub const GUSTS: (f64, f64) = (0.35, 0.015);
/// The paper's two senses of rotation.
pub const BOTH: [Configuration; 2] = [Configuration::A, Configuration::B];

/// In still air; infill (%) and gain K also in the stack's parameters. Arms turn on a hinge, as the paper's do: its tables
/// know no other.
pub fn vehicle(configuration: Configuration, gain_k: f64, infill: f64, mixer: Variant) -> Scenario {
    let mut s = Scenario::default_mission();
    (s.vehicle.gain_k, s.vehicle.infill, s.vehicle.configuration) = (gain_k, infill, configuration);
    (s.params.gain_k, s.params.infill) = (gain_k as f32, infill as f32);
    (s.world.gust_force, s.world.gust_moment) = (0.0, 0.0);
    s.vehicle.arm_bending = ArmBending::Hinge;
    assume_bending(&mut s.params, s.vehicle.arm_bending);
    s.mixer = mixer;
    s
}

/// Adds the gusts of the comparisons.
pub fn in_gusts(mut s: Scenario) -> Scenario {
    (s.world.gust_force, s.world.gust_moment) = GUSTS;
    s
}

/// RMS of target less truth about an axis (0 roll, 1 pitch, 2 yaw), degrees; `None` if lost.
pub fn error(flown: &Flown, axis: usize) -> Option<f64> {
    let of = |m: &Moment| {
        let error = m.attitude[axis] - m.target[axis];
        error.sin().atan2(error.cos())
    };
    flown.lost.is_none().then(|| rms(&flown.moments, of).to_degrees())
}

/// Range of rotor 1's asked thrust (N).
pub fn swing(flown: &Flown) -> Option<f64> {
    let asked = flown.moments.iter().map(|m| m.asked[0]);
    let (low, high) = asked.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), t| {
        (l.min(t), h.max(t))
    });
    flown.lost.is_none().then_some(high - low)
}

/// A number, or the word for a lost vehicle.
pub fn or_lost(value: Option<f64>, digits: usize) -> Cell {
    value.map_or_else(|| Cell::from("lost"), |v| num(v, digits))
}

/// Time of the loss, or a dash.
pub fn lost_when(flown: &Flown) -> Cell {
    match flown.lost {
        None => Cell::from("–"),
        Some(t) if t < 0.0 => Cell::from("at take-off"),
        Some(t) => Cell::from(format!("after {t:.1} s")),
    }
}

/// `name`, and the loss if there was one.
pub fn named(name: &str, flown: &Flown) -> String {
    match flown.lost {
        None => name.to_owned(),
        Some(t) if t < 0.0 => format!("{name}: lost at take-off"),
        Some(t) => format!("{name}: lost after {t:.1} s"),
    }
}

/// A curve over time, every `every` ms.
pub fn curve(flown: &Flown, every: usize, value: impl Fn(&Moment) -> f64) -> Vec<(f64, f64)> {
    flown
        .moments
        .iter()
        .step_by(every)
        .map(|m| (m.t, value(m)))
        .collect()
}

/// Mean tilt, left less right arms, rad.
pub fn delta_alpha(m: &Moment) -> f64 {
    0.5 * (m.tilt[0] + m.tilt[1] - m.tilt[2] - m.tilt[3])
}

/// Mean thrust, left less right rotor, N.
pub fn delta_thrust(m: &Moment) -> f64 {
    0.5 * (m.thrust[0] + m.thrust[1] - m.thrust[2] - m.thrust[3])
}
