//! Section IV-A, Figs. 4 and 5: rotational stability derivatives, and the reversal of yaw authority.

use crate::study::allocation::Studied;
use crate::study::perturbation::Trial;
use crate::study::rig::{Demand, Flown, fly};
use glam::DVec3;
use sophie_control::allocation::wrench::{Configuration, FORE, SIDE, YAW};
use sophie_control::params::Params;
use sophie_sim::mixers::Variant;
use sophie_sim::plant::GRAVITY;

use super::flights::{BOTH, curve, named, vehicle};
use super::printed::Printed;
use super::statics::{AtThrust, root};
use crate::results::model::{Axis, Chart, Section, Series, SeriesStyle, Table, Tile, num};
use sophie_sim::parallel;

/// Perturbation, N.
const STEP: f64 = 0.05;
/// Fig. 5: moment (N·m) and duration (s).
const KICK: (f64, f64) = (0.02, 0.5);

/// C_φ, C_θ, C_ψ of the plant: moment per pattern, following arms against rigid level ones.
pub fn of_the_plant(infill: f64, gain_k: f64, chi: f64, thrust: f64) -> [f64; 3] {
    let slope = |trial: Trial, pattern: [f32; 4], axis: usize| {
        let at = |step: f64| trial.wrench(pattern.map(|p| thrust + step * f64::from(p)))[axis];
        (at(STEP) - at(-STEP)) / (2.0 * STEP)
    };
    let soft = Trial { infill, gain_k, chi };
    let stiff = Trial { gain_k: 0.0, ..soft };
    let c = |pattern, axis| 1.0 - slope(soft, pattern, axis) / slope(stiff, pattern, axis);
    [c(SIDE, 1), c(FORE, 2), c(YAW, 3)]
}

/// %.
const INFILLS: [f64; 5] = [4.0, 6.0, 6.9, 8.0, 10.0];

/// The stability derivatives.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("stability", "Figs. 4 and 5, Section IV-A: stability derivatives");
    let k = f64::from(Params::default().gain_k);
    let hover = p.mass() * GRAVITY / 4.0;
    let worst = in_hover(&mut s, k, hover);
    s.figure(
        "Lines: closed form; dots: the plant. Below 0 the bending arms help a yaw command (the paper's \"stable\"), between \
         0 and 1 they weaken it, above 1 they turn it round. At ρ 4 % the plant leaves Eq. 1 at 7 N, where the parabola is \
         about to turn down. The paper's sign holds in hover: B negative, A positive.",
        BOTH.map(|c| over_thrust(c, k, hover)).to_vec(),
    );
    reversal_map(&mut s, hover, k);
    responses(&mut s, k, p.text.infill_percent);

    let at = |k: f64| AtThrust::new(p.text.infill_percent, k, hover);
    let k_one = root(0.2, 9.0, |k| at(k).yaw_derivative(-1.0) - 1.0).unwrap_or(f64::NAN);
    s.finding = format!(
        "The paper's result stands: in hover B is stable (C_ψ {:.2} at ρ {} %) and A is not ({:+.2}). Closed form and \
         perturbed plant agree within {:.2} %. What the paper does not say: A only diverges where C_ψ > 1, that is from K \
         {k_one:.2} on, and B's own authority turns round at low throttle.",
        at(k).yaw_derivative(1.0),
        p.text.infill_percent,
        at(k).yaw_derivative(-1.0),
        100.0 * worst
    );
    s
}

struct Hovering {
    configuration: Configuration,
    gain_k: f64,
    infill: f64,
}

/// Returns the largest relative difference of closed form and plant about yaw.
fn in_hover(s: &mut Section, k: f64, hover: f64) -> f64 {
    let mut t = Table::new(
        "Derivatives in hover: closed form and plant perturbed by 0.05 N",
        &[
            "configuration",
            "K",
            "ρ %",
            "C_ψ closed",
            "C_ψ plant",
            "C_θ closed",
            "C_θ plant",
            "C_φ closed",
            "C_φ plant",
            "yaw",
        ],
    );
    let mut jobs = vec![];
    for configuration in BOTH {
        for gain_k in [1.0, k] {
            jobs.extend(INFILLS.map(|infill| Hovering {
                configuration,
                gain_k,
                infill,
            }));
        }
    }
    let chi = |job: &Hovering| f64::from(job.configuration.chi());
    let plant = parallel::each(&jobs, |job| of_the_plant(job.infill, job.gain_k, chi(job), hover));
    let mut worst: f64 = 0.0;
    for (job, [roll, pitch, yaw]) in jobs.iter().zip(&plant) {
        let at = AtThrust::new(job.infill, job.gain_k, hover);
        let closed = at.yaw_derivative(chi(job));
        worst = worst.max((closed - yaw).abs() / closed.abs());
        t.row([
            format!("{:?}", job.configuration).into(),
            num(job.gain_k, 2),
            num(job.infill, 1),
            num(closed, 3),
            num(*yaw, 3),
            num(at.pitch_derivative(chi(job)), 4),
            num(*pitch, 4),
            num(at.roll_derivative(), 4),
            num(*roll, 4),
            verdict(closed).into(),
        ]);
    }
    explain(s, t);
    worst
}

fn verdict(yaw_derivative: f64) -> &'static str {
    match yaw_derivative {
        c if c < 0.0 => "stable",
        c if c < 1.0 => "weakened",
        _ => "turned round",
    }
}

fn explain(s: &mut Section, t: Table) {
    s.text(
        "The paper's Eqs. 2 to 4 let a commanded moment τ act as (1 - C) τ. For four tilted rotors on arms that follow \
         their thrust, C_ψ = -χ (b/k_q) d(T sin α)/dT + [1 - d(T cos α)/dT], C_θ = [1 - d(T cos α)/dT] + χ (k_q/b) d(T sin \
         α)/dT, and C_φ = (z_h/d) d(T sin α)/dT with the hinges z_h below the centre of mass. Beside the closed form stands \
         the plant itself: its arms are let come to rest, its moments taken, with no formula of the stack in between. \
         Eq. 4 needs I_x where it prints I_z.",
    );
    s.table(t);
    s.text(
        "\"Naturally fulfilled\" for pitch and roll is not borne out: C_φ is positive (nil with hinges at the height of \
         the centre of mass, for the thrust stays perpendicular to its arm) and C_θ has the sign of χ. Both are a few \
         hundredths and harmless.",
    );
}

fn over_thrust(c: Configuration, k: f64, hover: f64) -> Chart {
    let thrusts: Vec<f64> = (4..=80).map(|i| 0.1 * f64::from(i)).collect();
    let probes: Vec<f64> = (1..=7).map(f64::from).collect();
    let chi = f64::from(c.chi());
    let mut series = vec![];
    for (i, infill) in INFILLS.into_iter().enumerate() {
        let line = thrusts
            .iter()
            .map(|t| (*t, AtThrust::new(infill, k, *t).yaw_derivative(chi)))
            .collect();
        series.push(Series::new(format!("ρ {infill} %"), i, SeriesStyle::Line, line));
        let dots = parallel::each(&probes, |t| (*t, of_the_plant(infill, k, chi, *t)[2]));
        let name = if i == 0 { "plant, perturbed" } else { "" };
        series.push(Series::new(name, i, SeriesStyle::Dots, dots));
    }
    let level = match c {
        Configuration::A => "above 1 a yaw command turns round",
        Configuration::B => "above 1 a yaw command turns round (low throttle)",
    };
    Chart {
        title: format!("C_ψ of configuration {c:?}, K {k}"),
        x: Axis::new("thrust of each rotor (N)"),
        y: Axis::new("C_ψ"),
        series,
        levels: vec![(1.0, level.to_owned())],
        uprights: vec![(hover, "hover".to_owned())],
        ..Chart::default()
    }
}

fn reversal_map(s: &mut Section, hover: f64, k: f64) {
    s.figure(
        "Yaw authority in units of the stiff frame's, once the arms have followed; red: a yaw command turns the vehicle the \
         other way. In B everything from about 20 % throttle up is usable, and only a frozen inverse meets its reversal \
         near the 30 % throttle of the landing; in A hover itself lies beyond the reversal.",
        vec![
            authority(Configuration::B, hover, k),
            authority(Configuration::A, hover, k),
        ],
    );
}

fn authority(c: Configuration, hover: f64, k: f64) -> Chart {
    let chi = f64::from(c.chi());
    let rhos: Vec<f64> = (0..=12).map(|i| 4.0 + 0.5 * f64::from(i)).collect();
    let mut tiles = vec![];
    for rho in &rhos {
        for i in 0..16 {
            let thrust = 0.25 + 0.5 * f64::from(i);
            let authority = chi * AtThrust::new(*rho, k, thrust).quasi_static(chi);
            let shade = if authority < 0.0 {
                -1.0
            } else {
                (authority / 4.0).min(1.0)
            };
            tiles.push(Tile {
                at: (*rho, thrust),
                size: (0.5, 0.5),
                shade,
                text: format!("{authority:.1}"),
            });
        }
    }
    let line = |name: &str, colour: usize, look: SeriesStyle, f: &dyn Fn(AtThrust) -> f64| {
        let zero = |rho: f64| root(0.1, 7.9, |t| f(AtThrust::new(rho, k, t))).unwrap_or(f64::NAN);
        let points = rhos.iter().map(|rho| (*rho, zero(*rho)));
        Series::new(name, colour, look, points.collect())
    };
    Chart {
        title: format!("Configuration {c:?}, K {k}"),
        x: Axis::between("infill ρ (%)", 3.75, 10.25),
        y: Axis::between("thrust of each rotor (N)", 0.0, 8.0),
        series: vec![
            line("frozen authority turns round", 1, SeriesStyle::Dashed, &|a| {
                a.frozen(chi)
            }),
            line("quasi-static authority turns round", 0, SeriesStyle::Line, &|a| {
                a.quasi_static(chi)
            }),
        ],
        levels: vec![(hover, "hover".to_owned())],
        tiles,
        ..Chart::default()
    }
}

struct Perturbed {
    name: &'static str,
    configuration: Configuration,
    gain_k: f64,
    mixer: Variant,
    studied: Option<Studied>,
}

/// B and A with the rigid mixer over gain, and the flown mixer at the gain `k`.
fn perturbed(k: f64) -> [Perturbed; 7] {
    let rigid = |name, configuration, gain_k| Perturbed {
        name,
        configuration,
        gain_k,
        mixer: Variant::Rigid,
        studied: None,
    };
    let (a, b) = (Configuration::A, Configuration::B);
    [
        rigid("B, K 1, rigid mixer", b, 1.0),
        rigid("B, K 7.75, rigid mixer", b, k),
        Perturbed {
            mixer: Variant::Flexible,
            ..rigid("B, K 7.75, flexible mixer", b, k)
        },
        rigid("A, K 1, rigid mixer", a, 1.0),
        rigid("A, K 1.5, rigid mixer", a, 1.5),
        rigid("A, K 2.1, rigid mixer", a, 2.1),
        Perturbed {
            mixer: Variant::Flexible,
            studied: Some(Studied::SignAware),
            ..rigid("A, K 7.75, sign-aware mixer", a, k)
        },
    ]
}

fn responses(s: &mut Section, k: f64, infill: f64) {
    let kick = |t: f64| Demand {
        moment: if t < KICK.1 {
            DVec3::new(0.0, 0.0, KICK.0)
        } else {
            DVec3::ZERO
        },
        ..Demand::default()
    };
    let cases = perturbed(k);
    let flights: Vec<Flown> = parallel::each(&cases, |c| {
        let scenario = vehicle(c.configuration, c.gain_k, infill, c.mixer);
        fly(&scenario, c.studied, 8.0, kick)
    });
    let chart = |title: &str, range: std::ops::Range<usize>| Chart {
        title: title.to_owned(),
        x: Axis::between("time (s)", 0.0, 8.0),
        y: Axis::new("heading (°)"),
        series: range
            .filter_map(|i| {
                let (case, flown) = cases.get(i).zip(flights.get(i))?;
                Some(Series::new(
                    named(case.name, flown),
                    i,
                    SeriesStyle::Line,
                    curve(flown, 10, |m| m.attitude[2].to_degrees()),
                ))
            })
            .collect(),
        uprights: vec![(KICK.1, "end of the perturbation".to_owned())],
        ..Chart::default()
    };
    s.figure(
        "Flown: the heading after a yaw perturbation of 0.02 N·m for 0.5 s, still air. With the rigid mixer A weakens as K \
         grows and is lost once C_ψ > 1. The last curve is beyond the paper: configuration A with an allocation that knows \
         that its yaw authority has turned round.",
        vec![chart("Configuration B", 0..3), chart("Configuration A", 3..7)],
    );
}
