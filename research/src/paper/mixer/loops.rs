//! Inversion at a frozen arm angle: Algorithm 1's one-step loop, and the limit cycle.

use std::f64::consts::TAU;

use sophie_control::allocation::arm_deflection::ArmModel;
use sophie_control::allocation::effectiveness::{Effectiveness, Geometry, Inverse, Load};
use sophie_control::allocation::mixer::{Allocation, Conditions};
use sophie_control::allocation::wrench::{Configuration, Wrench, YAW};
use sophie_control::params::Params;
use sophie_sim::mixers::{Mixer, Variant};
use sophie_sim::parallel;
use sophie_sim::plant::GRAVITY;

use super::super::printed::Printed;
use super::super::statics::{AtThrust, frozen_bound, root};
use crate::results::model::{Axis, Chart, Section, Series, SeriesStyle};

const ZETA: f64 = 0.15;
/// Yaw pattern, N.
const START: f32 = 0.02;

/// Yaw patterns (N) of T(k+1) = M(α(T(k)))⁻¹ w from hover with `start` N.
fn one_step_loop(infill: f64, gain_k: f64, start: f32, steps: usize) -> Vec<f64> {
    let p = Params::default();
    let model = ArmModel::new(infill as f32, gain_k as f32, 0.5 * p.thrust_max);
    let geometry = Geometry::from_params(&p, Configuration::B);
    let weight = p.mass * GRAVITY as f32;
    let mut thrusts = YAW.map(|y| 0.25 * weight + start * y);
    let mut out = vec![f64::from(start)];
    for _ in 0..steps {
        let e = Effectiveness::frozen(&geometry, &thrusts.map(|t| model.angle(t)));
        let w = Wrench {
            thrust: weight,
            ..Wrench::default()
        };
        let Some(inverse) = Inverse::new(&e) else {
            break;
        };
        thrusts = inverse
            .solve(Load::of(&geometry, w))
            .map(|t| t.clamp(p.thrust_idle, p.thrust_max));
        let pattern: f32 = thrusts.iter().zip(&YAW).map(|(t, y)| 0.25 * t * y).sum();
        out.push(f64::from(pattern));
    }
    out
}

/// Range of rotor 1's thrust (N) under a small yaw demand, in the mixer's model of motor and arm.
fn mixer_swing(variant: Variant, gain_k: f64) -> f64 {
    let p = Params {
        gain_k: gain_k as f32,
        yaw_thrust_max: 5.0,
        ..Params::default()
    };
    let mut mixer = Mixer::new(variant, Configuration::B, &p);
    let w = Wrench {
        thrust: p.mass * GRAVITY as f32,
        yaw: 0.01,
        ..Wrench::default()
    };
    let (mut low, mut high) = (f32::MAX, f32::MIN);
    for i in 0..20_000 {
        let mix = mixer.mix(
            &w,
            Conditions {
                yaw: true,
                thrust_ratio: 1.0,
                dt: 1e-3,
            },
        );
        if i > 15_000 {
            (low, high) = (low.min(mix.thrusts[0]), high.max(mix.thrusts[0]));
        }
    }
    f64::from(high - low)
}

struct Hover {
    infill: f64,
    gain_k: f64,
    /// N per rotor.
    thrust: f64,
}

impl Hover {
    /// Factor of a step of Algorithm 1 on a yaw pattern.
    fn multiplier(&self, infill: f64, gain_k: f64) -> f64 {
        AtThrust::new(infill, gain_k, self.thrust).one_step(1.0)
    }

    fn gain_of(&self, bound: f64) -> f64 {
        let over = |k: f64| self.multiplier(self.infill, k).abs() - bound;
        root(0.1, 9.0, over).unwrap_or(f64::NAN)
    }
}

/// The loops, closed form and run.
pub fn show(s: &mut Section, p: &Printed, thrust: f64) {
    let d = Params::default();
    let hover = Hover {
        infill: p.text.infill_percent,
        gain_k: f64::from(d.gain_k),
        thrust,
    };
    let infill = hover.infill;
    let gains: Vec<f64> = (2..=18).map(|i| 0.5 * f64::from(i)).collect();
    let multipliers = Multipliers::over(&hover, &gains);
    s.text(format!(
        "Algorithm 1 takes α from the thrust of the step before. With the sideways thrust in the yaw row, as the physics \
         needs, a yaw pattern is multiplied at every step by m = -b T cos α (dα/dT) / (b sin α + χ k_q) = {:.2} at the \
         default: it diverges where |m| > 1, for ρ {infill} % from K {:.2} on. The loop itself agrees with this \
         within {:.1} %. As printed, with α in the force rows only, there is no such loop, and no compensation of yaw \
         either.",
        hover.multiplier(infill, hover.gain_k),
        hover.gain_of(1.0),
        100.0 * multipliers.worst
    ));
    let bound = frozen_bound(f64::from(d.motor_tau), TAU * f64::from(d.notch_hz), ZETA);
    let k_cycles = hover.gain_of(bound);
    let k_found = root(1.0, 3.0, |k| mixer_swing(Variant::Frozen, k) - 0.1).unwrap_or(f64::NAN);
    s.text(format!(
        "Inverting at the angle that the arm really has (motor lag and bending mode known exactly) is no cure: a changed \
         thrust bends its arm a moment later and yaws m times more. The loop (τs + 1)(s² + 2ζωs + ω²) + |m| ω² = 0 has a \
         right root from |m| = {bound:.3} on (τ {} s, {} Hz, ζ {ZETA}), for ρ {infill} % from K {k_cycles:.2}; the mixer itself \
         begins to swing at K {k_found:.2}. What flies \
         inverts the static Jacobian about the low-passed thrust and has no such loop.",
        d.motor_tau, d.notch_hz
    ));
    s.figure(
        "In order: the multiplier of one step of Algorithm 1 with a whole yaw row, closed form and loop; the yaw pattern \
         over the steps, which within the rotor's limits ends in a full-scale oscillation or stuck at a limit; the frozen \
         inverse's limit cycle, which appears where the closed form says. The flexible mixer has none.",
        vec![
            Chart {
                title: "One-step loop in hover".to_owned(),
                x: Axis::new("gain K"),
                y: Axis::new("|m| of the yaw pattern").with(&[0.0]),
                series: multipliers.series,
                levels: vec![(1.0, "diverges above".to_owned())],
                ..Chart::default()
            },
            patterns(&hover),
            swings(&gains, infill, k_cycles),
        ],
    );
}

struct Multipliers {
    series: Vec<Series>,
    /// Largest relative difference of closed form and loop.
    worst: f64,
}

impl Multipliers {
    fn over(hover: &Hover, gains: &[f64]) -> Self {
        let measured = |infill: f64, k: f64| {
            let steps = one_step_loop(infill, k, START, 1);
            steps.last().map_or(f64::NAN, |last| last / 0.02)
        };
        let (mut series, mut worst) = (vec![], 0.0_f64);
        for (i, infill) in [6.0, 6.9, 8.0, 10.0].into_iter().enumerate() {
            let closed = |k: f64| hover.multiplier(infill, k).abs();
            let line = gains.iter().map(|k| (*k, closed(*k))).collect();
            let run: Vec<(f64, f64)> = gains.iter().map(|k| (*k, measured(infill, *k).abs())).collect();
            for (k, m) in &run {
                worst = worst.max((m / closed(*k) - 1.0).abs());
            }
            let name = format!("ρ {infill} %, closed form");
            series.push(Series::new(name, i, SeriesStyle::Line, line));
            let name = if i == 0 { "the loop itself" } else { "" };
            series.push(Series::new(name, i, SeriesStyle::Dots, run));
        }
        Self { series, worst }
    }
}

fn patterns(hover: &Hover) -> Chart {
    let of_gain = |(k, colour): (f64, usize)| {
        let run = one_step_loop(hover.infill, k, START, 30);
        let points = run.iter().enumerate().map(|(i, t)| (i as f64, *t)).collect();
        Series::new(format!("K {k}"), colour, SeriesStyle::Line, points)
    };
    Chart {
        title: format!("Yaw pattern over the steps, ρ {} %", hover.infill),
        x: Axis::new("step (1 ms each)"),
        y: Axis::new("yaw pattern (N a rotor)"),
        series: [(1.0, 0), (2.0, 2), (3.0, 1), (hover.gain_k, 3)]
            .map(of_gain)
            .into(),
        ..Chart::default()
    }
}

/// Range of rotor 1's thrust over gain; the closed form's onset is `k_cycles`.
fn swings(gains: &[f64], infill: f64, k_cycles: f64) -> Chart {
    let swing = |name: &str, colour: usize, variant: Variant| {
        let points = parallel::each(gains, |k| (*k, mixer_swing(variant, *k)));
        Series::new(name, colour, SeriesStyle::Dots, points)
    };
    Chart {
        title: format!("Swing of rotor 1, mixer alone, ρ {infill} %"),
        x: Axis::new("gain K"),
        y: Axis::new("largest less smallest thrust (N)").with(&[0.0]),
        series: vec![
            swing("frozen inverse", 1, Variant::Frozen),
            swing("flexible", 0, Variant::Flexible),
        ],
        uprights: vec![(k_cycles, format!("closed form: K {k_cycles:.2}"))],
        ..Chart::default()
    }
}
