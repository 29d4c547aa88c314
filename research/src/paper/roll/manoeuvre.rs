//! The roll manoeuvre, Table III's numbers, and the searches for its two free ones.

use std::f32::consts::TAU;

use crate::study::rig::{Demand, Flown, Moment, fly};
use sophie_control::allocation::wrench::Configuration;
use sophie_sim::mixers::Variant;
use sophie_sim::scenario::Scenario;

use super::super::flights::{delta_alpha, delta_thrust, vehicle};
use super::super::printed::Printed;

/// Time of each held roll, s.
pub const HELD: f64 = 1.2;
/// Time of the turn, s: a vehicle lost later has shown its Δα.
const TURN: f64 = 0.5;
/// The whole manoeuvre, s.
pub const SECONDS: f64 = 3.0;

/// The roll command.
#[derive(Clone, Copy, PartialEq)]
pub enum Command {
    /// Step with this rate gain (1/s), attitude gain 12 1/s, no prefilter: hard as the paper's.
    Hard(f64),
    /// The stack's own gains and prefilter.
    Soft,
}

/// Dynamics of the arms besides their thrust.
#[derive(Clone, Copy, PartialEq)]
pub enum Arms {
    /// Massless, damping ratio 0.7: the paper's statics.
    Static,
    /// Massless, damped to the printed Δα at ρ 8 %.
    Fitted(f64),
    /// With tip mass, as in every other flight.
    Heavy,
}

impl Arms {
    pub const fn damping(self) -> f64 {
        match self {
            Self::Static => 0.7,
            Self::Fitted(zeta) => zeta,
            Self::Heavy => 0.15,
        }
    }

    pub fn words(self) -> String {
        let what = match self {
            Self::Static => "static",
            Self::Fitted(_) => "fitted",
            Self::Heavy => "with tip mass",
        };
        format!("{what}, ζ {:.2}", self.damping())
    }
}

/// A manoeuvre.
#[derive(Clone, Copy)]
pub struct Job {
    pub infill: f64,
    pub mixer: Variant,
    pub command: Command,
    pub arms: Arms,
}

fn scenario(job: Job) -> Scenario {
    let mut s = vehicle(
        Configuration::B,
        f64::from(sophie_control::params::Params::default().gain_k),
        job.infill,
        job.mixer,
    );
    s.vehicle.coupled_arms = job.arms == Arms::Heavy;
    s.vehicle.arm_damping = job.arms.damping();
    if let Command::Hard(rate_p) = job.command {
        (s.params.attitude_p, s.params.rate_roll_p) = (12.0, rate_p as f32);
        (s.params.setpoint_lpf_hz, s.params.rate_max) = (100.0 / TAU, 12.0);
    }
    s
}

pub fn manoeuvre(job: Job, angle: f64) -> Flown {
    fly(&scenario(job), None, SECONDS, |t| Demand {
        roll: if t < HELD { angle } else { 0.0 },
        ..Demand::default()
    })
}

/// Quantities of Table III in a flight.
#[derive(Clone, Copy)]
pub struct Found {
    /// Largest Δα, rad.
    pub delta_alpha: f64,
    /// Largest ΔT over the thrust of both rotors.
    pub thrust_share: f64,
    /// Largest φ + Δα, rad.
    pub effective: f64,
    /// Largest roll, rad.
    pub roll: f64,
    /// Largest sideways force of leaning arms over that of the rolled thrust.
    pub kappa: f64,
}

/// Over the commanded roll.
pub fn found(flown: &Flown) -> Option<Found> {
    let rolled: Vec<&Moment> = flown.moments.iter().filter(|m| m.t < HELD).collect();
    let most = |f: &dyn Fn(&Moment) -> f64| rolled.iter().map(|m| f(m)).fold(f64::NEG_INFINITY, f64::max);
    let lift = |m: &Moment| m.thrust.iter().zip(m.tilt).map(|(t, a)| t * a.cos()).sum::<f64>();
    flown.lost.is_none_or(|t| t > TURN).then(|| Found {
        delta_alpha: most(&delta_alpha),
        thrust_share: most(&|m| delta_thrust(m) / (0.5 * m.thrust.iter().sum::<f64>())),
        effective: most(&|m| m.attitude[0] + delta_alpha(m)),
        roll: most(&|m| m.attitude[0]),
        kappa: most(&sideways) / most(&|m| m.attitude[0].sin() * lift(m)),
    })
}

/// Sideways force, N, right positive.
pub fn sideways(m: &Moment) -> f64 {
    let side = |i: usize| if i < 2 { 1.0 } else { -1.0 };
    (0..4).map(|i| side(i) * m.thrust[i] * m.tilt[i].sin()).sum()
}

/// Rate gain (1/s) for ΔT/T = `share` at ρ 8 %, massless arms.
pub fn hard_gain(angle: f64, share: f64) -> f64 {
    let reached = |gain: f64| {
        let job = Job {
            infill: 8.0,
            mixer: Variant::Rigid,
            command: Command::Hard(gain),
            arms: Arms::Static,
        };
        found(&manoeuvre(job, angle)).map_or(f64::NAN, |f| f.thrust_share)
    };
    let (mut low, mut high) = (4.0, 40.0);
    for _ in 0..7 {
        let gain = 0.5 * (low + high);
        if reached(gain) < share {
            low = gain
        } else {
            high = gain
        }
    }
    0.5 * (low + high)
}

/// Damping ratio of massless arms for the printed Δα_max of the hard step at ρ 8 %.
pub fn fitted_damping(p: &Printed, angle: f64, command: Command) -> f64 {
    let printed = p
        .table_3
        .iter()
        .find(|r| r.infill_percent == 8.0)
        .map_or(f64::NAN, |r| r.delta_alpha_max_deg);
    let (mut low, mut high) = (0.1, 0.7);
    for _ in 0..10 {
        let zeta = 0.5 * (low + high);
        let job = Job {
            infill: 8.0,
            mixer: Variant::Rigid,
            command,
            arms: Arms::Fitted(zeta),
        };
        let bent = found(&manoeuvre(job, angle)).map_or(f64::NAN, |f| f.delta_alpha.to_degrees());
        if bent > printed { low = zeta } else { high = zeta }
    }
    0.5 * (low + high)
}
