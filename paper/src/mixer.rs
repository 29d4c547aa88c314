//! The printed mixer matrix and Algorithm 1: what they are, what mends them, and what flies.

use std::f64::consts::TAU;

use crate::study::allocation::Studied;
use crate::study::rig::{Flown, Wish, fly};
use sophie_control::deflection::ArmModel;
use sophie_control::effectiveness::{Effectiveness, Geometry, Inverse, Load};
use sophie_control::mixer::{Allocation, Conditions};
use sophie_control::params::Params;
use sophie_control::wrench::{Configuration, FORE, SIDE, Wrench, YAW};
use sophie_sim::mixers::{Mixer, Variant};
use sophie_sim::plant::GRAVITY;

use super::flights::{curve, error, in_gusts, lost_when, named, or_lost, swing, vehicle};
use super::model::{Axis, Chart, Class, Comparison, Look, Section, Series, Table, num};
use super::printed::Printed;
use super::statics::{AtThrust, frozen_bound, root};
use sophie_sim::parallel;

/// Rows f_z, τ_φ, τ_θ, τ_ψ of a mixer matrix over C_T.
type Matrix = [[f64; 4]; 4];

/// The matrix with the arms at `tilt` rad and a yaw row.
fn matrix(tilt: f64, yaw: [f64; 4]) -> Matrix {
    let p = Params::default();
    let (d, b) = (f64::from(p.arm_d), f64::from(p.arm_b));
    [
        [tilt.cos(); 4],
        SIDE.map(|s| d * f64::from(s)),
        FORE.map(|s| b * f64::from(s)),
        yaw,
    ]
}

/// Rank and size of the determinant, the rows over those of the stiff, level frame's length, by elimination with row
/// pivoting.
fn rank(mut m: Matrix) -> (usize, f64) {
    let p = Params::default();
    for (row, unit) in m.iter_mut().zip([1.0, p.arm_d, p.arm_b, p.torque_ratio]) {
        row.iter_mut().for_each(|x| *x /= 2.0 * f64::from(unit));
    }
    let (mut rank, mut determinant) = (0, 1.0);
    for column in 0..4 {
        let pivot = (rank..4).max_by(|a, b| m[*a][column].abs().total_cmp(&m[*b][column].abs()));
        let Some(pivot) = pivot.filter(|r| m[*r][column].abs() > 1e-6) else {
            determinant = 0.0;
            continue;
        };
        m.swap(rank, pivot);
        determinant *= m[rank][column].abs();
        let top = m[rank];
        for row in m.iter_mut().skip(rank + 1) {
            let factor = row[column] / top[column];
            for (x, t) in row.iter_mut().zip(top) {
                *x -= factor * t;
            }
        }
        rank += 1;
    }
    (rank, determinant)
}

/// Yaw patterns (N) of the one-step loop: T(k+1) = M(α(T(k)))⁻¹ w from hover with a pattern of `start` N.
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

/// Largest less smallest thrust (N) of rotor 1 under a constant small yaw demand, the mixer alone with its own model of
/// motor and arm.
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
                battery_ratio: 1.0,
                dt: 1e-3,
            },
        );
        if i > 15_000 {
            (low, high) = (low.min(mix.thrusts[0]), high.max(mix.thrusts[0]));
        }
    }
    f64::from(high - low)
}

/// Time over which the rotors' swing is shown, s.
const WINDOW: f64 = 3.0;

/// A mixer to be flown.
#[derive(Clone, Copy)]
enum Flies {
    Stack(Variant),
    Studied(Studied),
}

const FLOWN: [(&str, Flies); 5] = [
    ("rigid", Flies::Stack(Variant::Rigid)),
    (
        "paper: Algorithm 1 in the printed matrix, yaw row mended",
        Flies::Stack(Variant::Paper),
    ),
    (
        "Algorithm 1 with the sideways thrust in its yaw row",
        Flies::Studied(Studied::Verbatim),
    ),
    ("inverse at the frozen arm angle", Flies::Stack(Variant::Frozen)),
    (
        "flexible (quasi-static), what flies",
        Flies::Stack(Variant::Flexible),
    ),
];

fn hover(flies: Flies, gain_k: f64, infill: f64) -> Flown {
    let (mixer, studied) = match flies {
        Flies::Stack(variant) => (variant, None),
        Flies::Studied(kind) => (Variant::Flexible, Some(kind)),
    };
    fly(
        &in_gusts(vehicle(Configuration::B, gain_k, infill, mixer)),
        studied,
        20.0,
        |_| Wish::default(),
    )
}

/// The mixer.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("mixer", "The mixer matrix and Algorithm 1");
    let d = Params::default();
    let (k, infill) = (f64::from(d.gain_k), p.text.infill_percent);
    let thrust = p.mass() * GRAVITY / 4.0;
    let here = AtThrust::new(infill, k, thrust);
    let bound = frozen_bound(f64::from(d.motor_tau), TAU * f64::from(d.notch_hz), 0.15);
    let multiplier = |infill: f64, k: f64| AtThrust::new(infill, k, thrust).one_step(1.0);
    let k_diverges = root(0.1, 9.0, |k| multiplier(infill, k).abs() - 1.0).unwrap_or(f64::NAN);
    let k_cycles = root(0.1, 9.0, |k| multiplier(infill, k).abs() - bound).unwrap_or(f64::NAN);

    matrices(&mut s, p, &here);

    // The one-step loop: closed form against the loop itself.
    let gains: Vec<f64> = (2..=18).map(|i| 0.5 * f64::from(i)).collect();
    let measured = |infill: f64, k: f64| {
        let steps = one_step_loop(infill, k, 0.02, 1);
        steps.last().map_or(f64::NAN, |last| last / 0.02)
    };
    let mut worst: f64 = 0.0;
    let mut lines = vec![];
    for (i, infill) in [6.0, 6.9, 8.0, 10.0].into_iter().enumerate() {
        let closed = gains.iter().map(|k| (*k, multiplier(infill, *k).abs())).collect();
        let run: Vec<(f64, f64)> = gains.iter().map(|k| (*k, measured(infill, *k).abs())).collect();
        for (k, m) in &run {
            worst = worst.max((m / multiplier(infill, *k).abs() - 1.0).abs());
        }
        lines.push(Series::new(
            format!("ρ {infill} %, closed form"),
            i,
            Look::Line,
            closed,
        ));
        lines.push(Series::new(
            if i == 0 { "the loop itself" } else { "" },
            i,
            Look::Dots,
            run,
        ));
    }
    let iterations: Vec<Series> = [(1.0, 0), (2.0, 2), (3.0, 1), (k, 3)]
        .iter()
        .map(|(k, colour)| {
            let run = one_step_loop(infill, *k, 0.02, 30);
            let points = run.iter().enumerate().map(|(i, t)| (i as f64, *t)).collect();
            Series::new(format!("K {k}"), *colour, Look::Line, points)
        })
        .collect();
    let swings = parallel::each(&gains, |k| {
        (
            mixer_swing(Variant::Frozen, *k),
            mixer_swing(Variant::Flexible, *k),
        )
    });
    // The onset in the mixer itself, by halving.
    let k_found = root(1.0, 3.0, |k| mixer_swing(Variant::Frozen, k) - 0.1).unwrap_or(f64::NAN);
    let of = |f: fn(&(f64, f64)) -> f64| gains.iter().zip(&swings).map(|(k, s)| (*k, f(s))).collect();
    s.text(format!(
        "Algorithm 1 takes α from the thrust of the step before. With the sideways thrust in the yaw row, as the physics \
         needs, a yaw pattern is multiplied at every step by m = -b T cos α (dα/dT) / (b sin α + χ k_q) = {:.2} at the \
         default: it diverges where |m| > 1, for ρ {infill} % from K {k_diverges:.2} on. The loop itself agrees with this \
         within {:.1} %. As printed, with α in the force rows only, there is no such loop, and no compensation of yaw \
         either.",
        here.one_step(1.0),
        100.0 * worst
    ));
    s.text(format!(
        "Inverting at the angle that the arm really has (motor lag and bending mode known exactly) is no cure: a changed \
         thrust bends its arm a moment later and yaws m times more. The loop (τs + 1)(s² + 2ζωs + ω²) + |m| ω² = 0 has a \
         right root from |m| = {bound:.3} on (τ {} s, {} Hz, ζ 0.15), for ρ {infill} % from K {k_cycles:.2}; the mixer itself \
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
                series: lines,
                levels: vec![(1.0, "diverges above".to_owned())],
                ..Chart::default()
            },
            Chart {
                title: format!("Yaw pattern over the steps, ρ {infill} %"),
                x: Axis::new("step (1 ms each)"),
                y: Axis::new("yaw pattern (N a rotor)"),
                series: iterations,
                ..Chart::default()
            },
            Chart {
                title: format!("Swing of rotor 1, mixer alone, ρ {infill} %"),
                x: Axis::new("gain K"),
                y: Axis::new("largest less smallest thrust (N)").with(&[0.0]),
                series: vec![
                    Series::new("frozen inverse", 1, Look::Dots, of(|s| s.0)),
                    Series::new("flexible", 0, Look::Dots, of(|s| s.1)),
                ],
                uprights: vec![(k_cycles, format!("closed form: K {k_cycles:.2}"))],
                ..Chart::default()
            },
        ],
    );

    let jobs: Vec<(usize, f64)> = [1.0, k]
        .iter()
        .flat_map(|k| (0..FLOWN.len()).map(move |i| (i, *k)))
        .collect();
    let flights = parallel::each(&jobs, |(i, k)| hover(FLOWN[*i].1, *k, infill));
    let mut t = Table::new(
        "The mixers flown: 20 s of hover in gusts of 0.35 N and 0.015 N·m RMS, configuration B",
        &[
            "mixer",
            "K",
            "roll RMS °",
            "pitch RMS °",
            "yaw RMS °",
            "swing of rotor 1 N",
            "lost",
        ],
    );
    for ((i, k), flown) in jobs.iter().zip(&flights) {
        t.row([
            FLOWN[*i].0.into(),
            num(*k, 2),
            or_lost(error(flown, 0), 2),
            or_lost(error(flown, 1), 2),
            or_lost(error(flown, 2), 2),
            or_lost(swing(flown), 2),
            lost_when(flown),
        ]);
    }
    s.table(t);
    let shown: Vec<(usize, &Flown)> = jobs
        .iter()
        .zip(&flights)
        .filter(|((_, at), _)| *at == k)
        .map(|((i, _), f)| (*i, f))
        .collect();
    let traces = |f: &dyn Fn(&crate::study::rig::Moment) -> f64| {
        shown
            .iter()
            .map(|(i, f_)| Series::new(named(FLOWN[*i].0, f_), *i, Look::Line, curve(f_, 10, f)))
            .collect::<Vec<_>>()
    };
    s.figure(
        &format!(
            "The flights of the table at K {k}; rigid and paper lie on each other. Of the thrust the first {WINDOW} s are \
             shown: the frozen inverse runs its rotors from limit to limit."
        ),
        vec![
            Chart {
                title: "Yaw in gusts".to_owned(),
                x: Axis::between("time (s)", 0.0, 20.0),
                y: Axis::new("heading (°)"),
                series: traces(&|m| m.attitude[2].to_degrees()),
                ..Chart::default()
            },
            Chart {
                title: "Thrust asked of rotor 1".to_owned(),
                x: Axis::between("time (s)", 0.0, WINDOW),
                y: Axis::new("thrust (N)"),
                series: traces(&|m| m.asked[0]),
                levels: vec![(thrust, "hover".to_owned())],
                ..Chart::default()
            },
        ],
    );
    let outcome = |i: usize| {
        shown
            .iter()
            .find(|(j, _)| *j == i)
            .map_or("not flown".to_owned(), |(_, f)| match f.lost {
                Some(_) => "loses yaw".to_owned(),
                None => format!("holds yaw within {:.1}° RMS", error(f, 2).unwrap_or(f64::NAN)),
            })
    };
    s.finding = format!(
        "The printed matrix is singular (rank 3); the text's own sense of rotation mends it. Completed with the sideways \
         thrust that the paper leaves out of yaw, Algorithm 1's one-step-old α diverges ({}), the inverse at the frozen \
         angle limit-cycles ({}), the quasi-static one does neither ({}).",
        outcome(2),
        outcome(3),
        outcome(4)
    );
    s
}

fn matrices(s: &mut Section, p: &Printed, hover: &AtThrust) {
    let k_q = f64::from(Params::default().torque_ratio);
    let tilt = hover.sin.atan2(hover.cos);
    let row = |signs: [f64; 4]| signs.map(|x| x * k_q);
    let yaw = YAW.map(f64::from);
    let mut t = Table::new(
        "Mixer matrices and their rank",
        &[
            "yaw row",
            "signs of rotors 1 to 4",
            "rank",
            "determinant over the stiff frame's",
        ],
    );
    let at = |thrust: f64| AtThrust::new(6.9, f64::from(Params::default().gain_k), thrust);
    let reversal = root(1.0, 6.0, |t| at(t).frozen(1.0)).unwrap_or(f64::NAN);
    let full = |a: AtThrust, chi: f64| yaw.map(|y| y * a.frozen(chi) * k_q);
    let all = [
        ("as printed", matrix(tilt, row(p.mixer_matrix.yaw_row))),
        (
            "Algorithm 1: CW, CW, CCW, CCW",
            matrix(tilt, row(p.mixer_matrix.algorithm_1_row)),
        ),
        (
            "the text: 1 and 4 against 2 and 3",
            matrix(tilt, row([-1.0, 1.0, 1.0, -1.0])),
        ),
        (
            "with the sideways thrust, B in hover",
            matrix(tilt, full(*hover, 1.0)),
        ),
        (
            "with the sideways thrust, A in hover",
            matrix(tilt, full(*hover, -1.0)),
        ),
        (
            "with the sideways thrust, B at the frozen reversal",
            matrix(tilt, full(at(reversal), 1.0)),
        ),
    ];
    let mut ranks = vec![];
    for (what, m) in all {
        let (rank, determinant) = rank(m);
        let signs = m[3].map(|x| match x {
            x if x.abs() < 1e-6 => "0",
            x if x < 0.0 => "-",
            _ => "+",
        });
        ranks.push(rank);
        t.row([
            what.into(),
            signs.join(" ").into(),
            num(rank as f64, 0),
            num(determinant, 3),
        ]);
    }
    let mut entries = Table::new(
        "The matrices in hover, divided by C_T: f_z pure, moments in m",
        &["matrix", "row", "rotor 1", "rotor 2", "rotor 3", "rotor 4"],
    );
    for (what, m) in [&all[0], &all[2], &all[3]] {
        for (name, row) in ["f_z", "τ_φ", "τ_θ", "τ_ψ"].into_iter().zip(m) {
            entries.row([
                (*what).into(),
                name.into(),
                num(row[0], 4),
                num(row[1], 4),
                num(row[2], 4),
                num(row[3], 4),
            ]);
        }
    }
    s.table(entries);
    s.table(t);
    s.compare(
        "What a mixer for four axes needs",
        vec![Comparison {
            what: "rank of the matrix as printed".to_owned(),
            unit: "",
            printed: 4.0,
            here: ranks.first().map_or(f64::NAN, |r| *r as f64),
            class: Class::Inconsistent,
            why: "four controls need rank 4; the printed yaw row is the pitch row over again, Algorithm 1's senses of \
                  rotation are the roll row"
                .to_owned(),
        }],
    );
    s.text(format!(
        "The last matrix is that of {reversal:.2} N a rotor, where b sin α = -k_q: what a frozen inverse divides by changes its \
         sign there."
    ));
}
