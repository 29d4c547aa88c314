//! Section IV-A, Figs. 4 and 5: the rotational stability derivatives, and where yaw authority turns round.

use crate::study::allocation::Studied;
use crate::study::perturbation::Trial;
use crate::study::rig::{Flown, Wish, fly};
use glam::DVec3;
use sophie_control::params::Params;
use sophie_control::wrench::{Configuration, FORE, SIDE, YAW};
use sophie_sim::mixers::Variant;
use sophie_sim::plant::GRAVITY;

use super::flights::{BOTH, curve, named, vehicle};
use super::model::{Axis, Chart, Look, Section, Series, Table, Tile, num};
use super::printed::Printed;
use super::statics::{AtThrust, root};
use sophie_sim::parallel;

/// Step of the perturbation, N.
const STEP: f64 = 0.05;
/// The perturbation of Fig. 5: moment (N·m) and its duration (s).
const KICK: (f64, f64) = (0.02, 0.5);

/// C_φ, C_θ, C_ψ of the plant itself: the moment per pattern with arms that follow, against stiff and level ones.
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

/// The stability derivatives.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("stability", "Figs. 4 and 5, Section IV-A: stability derivatives");
    let k = f64::from(Params::default().gain_k);
    let hover = p.mass() * GRAVITY / 4.0;
    let infills = [4.0, 6.0, 6.9, 8.0, 10.0];

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
    let jobs: Vec<(Configuration, f64, f64)> = BOTH
        .iter()
        .flat_map(|c| {
            [1.0, k]
                .into_iter()
                .flat_map(move |k| infills.into_iter().map(move |i| (*c, k, i)))
        })
        .collect();
    let plant = parallel::each(&jobs, |(c, k, i)| of_the_plant(*i, *k, f64::from(c.chi()), hover));
    let mut worst: f64 = 0.0;
    for ((c, k, infill), [roll, pitch, yaw]) in jobs.iter().zip(&plant) {
        let at = AtThrust::new(*infill, *k, hover);
        let closed = at.yaw_derivative(f64::from(c.chi()));
        worst = worst.max((closed - yaw).abs() / closed.abs());
        let verdict = match closed {
            c if c < 0.0 => "stable",
            c if c < 1.0 => "weakened",
            _ => "turned round",
        };
        t.row([
            format!("{c:?}").into(),
            num(*k, 2),
            num(*infill, 1),
            num(closed, 3),
            num(*yaw, 3),
            num(at.pitch_derivative(f64::from(c.chi())), 4),
            num(*pitch, 4),
            num(at.roll_derivative(), 4),
            num(*roll, 4),
            verdict.into(),
        ]);
    }
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

    let thrusts: Vec<f64> = (4..=80).map(|i| 0.1 * f64::from(i)).collect();
    let probes: Vec<f64> = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0].to_vec();
    let chart = |c: Configuration| {
        let chi = f64::from(c.chi());
        let mut series = vec![];
        for (i, infill) in infills.into_iter().enumerate() {
            let line = thrusts
                .iter()
                .map(|t| (*t, AtThrust::new(infill, k, *t).yaw_derivative(chi)))
                .collect();
            series.push(Series::new(format!("ρ {infill} %"), i, Look::Line, line));
            let dots = parallel::each(&probes, |t| (*t, of_the_plant(infill, k, chi, *t)[2]));
            series.push(Series::new(
                if i == 0 { "plant, perturbed" } else { "" },
                i,
                Look::Dots,
                dots,
            ));
        }
        let levels = if c == Configuration::A {
            vec![(1.0, "above 1 a yaw command turns round".to_owned())]
        } else {
            vec![(1.0, "above 1 a yaw command turns round (low throttle)".to_owned())]
        };
        Chart {
            title: format!("C_ψ of configuration {c:?}, K {k}"),
            x: Axis::new("thrust of each rotor (N)"),
            y: Axis::new("C_ψ"),
            series,
            levels,
            uprights: vec![(hover, "hover".to_owned())],
            ..Chart::default()
        }
    };
    s.figure(
        "Lines: closed form; dots: the plant. Below 0 the bending arms help a yaw command (the paper's \"stable\"), between \
         0 and 1 they weaken it, above 1 they turn it round. At ρ 4 % the plant leaves Eq. 1 at 7 N, where the parabola is \
         about to turn down. The paper's sign holds in hover: B negative, A positive.",
        BOTH.map(chart).to_vec(),
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

/// Where yaw authority vanishes, over infill and thrust.
fn reversal_map(s: &mut Section, hover: f64, k: f64) {
    let rhos: Vec<f64> = (0..=12).map(|i| 4.0 + 0.5 * f64::from(i)).collect();
    let map = |chi: f64, title: String| {
        let mut tiles = vec![];
        for rho in &rhos {
            for i in 0..16 {
                let thrust = 0.25 + 0.5 * f64::from(i);
                let authority = chi * AtThrust::new(*rho, k, thrust).quasi_static(chi);
                tiles.push(Tile {
                    at: (*rho, thrust),
                    size: (0.5, 0.5),
                    shade: if authority < 0.0 {
                        -1.0
                    } else {
                        (authority / 4.0).min(1.0)
                    },
                    text: format!("{authority:.1}"),
                });
            }
        }
        let line = |f: &dyn Fn(AtThrust) -> f64| {
            rhos.iter()
                .map(|rho| {
                    (
                        *rho,
                        root(0.1, 7.9, |t| f(AtThrust::new(*rho, k, t))).unwrap_or(f64::NAN),
                    )
                })
                .collect::<Vec<_>>()
        };
        Chart {
            title,
            x: Axis::between("infill ρ (%)", 3.75, 10.25),
            y: Axis::between("thrust of each rotor (N)", 0.0, 8.0),
            series: vec![
                Series::new(
                    "frozen authority turns round",
                    1,
                    Look::Dashed,
                    line(&|a| a.frozen(chi)),
                ),
                Series::new(
                    "quasi-static authority turns round",
                    0,
                    Look::Line,
                    line(&|a| a.quasi_static(chi)),
                ),
            ],
            levels: vec![(hover, "hover".to_owned())],
            tiles,
            ..Chart::default()
        }
    };
    s.figure(
        "Yaw authority in units of the stiff frame's, once the arms have followed; red: a yaw command turns the vehicle the \
         other way. In B everything from about 20 % throttle up is usable, and only a frozen inverse meets its reversal \
         near the 30 % throttle of the landing; in A hover itself lies beyond the reversal.",
        vec![
            map(1.0, format!("Configuration B, K {k}")),
            map(-1.0, format!("Configuration A, K {k}")),
        ],
    );
}

/// Time responses to a yaw perturbation.
fn responses(s: &mut Section, k: f64, infill: f64) {
    let kick = |t: f64| Wish {
        moment: if t < KICK.1 {
            DVec3::new(0.0, 0.0, KICK.0)
        } else {
            DVec3::ZERO
        },
        ..Wish::default()
    };
    let cases: [(&str, Configuration, f64, Variant, Option<Studied>); 7] = [
        ("B, K 1, rigid mixer", Configuration::B, 1.0, Variant::Rigid, None),
        (
            "B, K 7.75, rigid mixer",
            Configuration::B,
            k,
            Variant::Rigid,
            None,
        ),
        (
            "B, K 7.75, flexible mixer",
            Configuration::B,
            k,
            Variant::Flexible,
            None,
        ),
        ("A, K 1, rigid mixer", Configuration::A, 1.0, Variant::Rigid, None),
        (
            "A, K 1.5, rigid mixer",
            Configuration::A,
            1.5,
            Variant::Rigid,
            None,
        ),
        (
            "A, K 2.1, rigid mixer",
            Configuration::A,
            2.1,
            Variant::Rigid,
            None,
        ),
        (
            "A, K 7.75, sign-aware mixer",
            Configuration::A,
            k,
            Variant::Flexible,
            Some(Studied::SignAware),
        ),
    ];
    let flights: Vec<Flown> = parallel::each(&cases, |(_, c, k, mixer, studied)| {
        fly(&vehicle(*c, *k, infill, *mixer), *studied, 8.0, kick)
    });
    let chart = |title: &str, range: std::ops::Range<usize>| Chart {
        title: title.to_owned(),
        x: Axis::between("time (s)", 0.0, 8.0),
        y: Axis::new("heading (°)"),
        series: range
            .filter_map(|i| {
                let ((name, ..), flown) = cases.get(i).zip(flights.get(i))?;
                Some(Series::new(
                    named(name, flown),
                    i,
                    Look::Line,
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
