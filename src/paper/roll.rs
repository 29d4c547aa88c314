//! Figs. 7 and 8, Table III: the 25° roll manoeuvre, its arms and its sideways force.

use sophie_control::mixer::Variant;
use sophie_control::wrench::Configuration;
use sophie_hil::scenario::Scenario;
use sophie_hil::study::rig::{Flown, Moment, Wish, fly};

use super::flights::{curve, delta_alpha, delta_thrust, vehicle};
use super::model::{Axis, Chart, Class, Comparison, Look, Section, Series, Table, num};
use super::parallel;
use super::printed::{Printed, Roll};

/// How long the roll is held, s.
const HELD: f64 = 1.2;
/// The whole manoeuvre, s.
const SECONDS: f64 = 3.0;

/// How the roll is commanded.
#[derive(Clone, Copy, PartialEq)]
enum Command {
    /// A step into loops with this rate gain (1/s), attitude gain 12 1/s, no prefilter: as hard as the paper's.
    Hard(f64),
    /// The stack's own gains and prefilter.
    Soft,
}

/// A manoeuvre.
#[derive(Clone, Copy)]
struct Job {
    infill: f64,
    mixer: Variant,
    command: Command,
    coupled: bool,
}

fn scenario(job: Job) -> Scenario {
    let mut s = vehicle(
        Configuration::B,
        f64::from(sophie_control::params::Params::default().gain_k),
        job.infill,
        job.mixer,
    );
    s.vehicle.coupled_arms = job.coupled;
    if let Command::Hard(rate_p) = job.command {
        (s.params.attitude_p, s.params.rate_p) = (12.0, rate_p as f32);
        (s.params.setpoint_cutoff, s.params.rate_max) = (100.0, 12.0);
    }
    s
}

fn manoeuvre(job: Job, angle: f64) -> Flown {
    fly(&scenario(job), None, SECONDS, |t| Wish {
        roll: if t < HELD { angle } else { 0.0 },
        ..Wish::default()
    })
}

/// What Table III asks of a flight.
#[derive(Clone, Copy)]
struct Found {
    /// Largest Δα, rad.
    delta_alpha: f64,
    /// Largest ΔT over the thrust of a left and a right rotor.
    thrust_share: f64,
    /// Largest φ + Δα, rad.
    effective: f64,
    /// Largest roll, rad.
    roll: f64,
    /// Largest sideways force of the leaning arms over the largest of the rolled thrust.
    kappa: f64,
}

/// While the roll is commanded.
fn found(flown: &Flown) -> Option<Found> {
    let rolled: Vec<&Moment> = flown.moments.iter().filter(|m| m.t < HELD).collect();
    let most = |f: &dyn Fn(&Moment) -> f64| rolled.iter().map(|m| f(m)).fold(f64::NEG_INFINITY, f64::max);
    let lift = |m: &Moment| m.thrust.iter().zip(m.tilt).map(|(t, a)| t * a.cos()).sum::<f64>();
    flown.lost.is_none().then(|| Found {
        delta_alpha: most(&delta_alpha),
        thrust_share: most(&|m| delta_thrust(m) / (0.5 * m.thrust.iter().sum::<f64>())),
        effective: most(&|m| m.attitude[0] + delta_alpha(m)),
        roll: most(&|m| m.attitude[0]),
        kappa: most(&sideways) / most(&|m| m.attitude[0].sin() * lift(m)),
    })
}

/// Sideways force of the leaning thrusts, N, to the right.
pub fn sideways(m: &Moment) -> f64 {
    let side = |i: usize| if i < 2 { 1.0 } else { -1.0 };
    (0..4).map(|i| side(i) * m.thrust[i] * m.tilt[i].sin()).sum()
}

/// κ by Eq. 11 and exactly, from a Δα (rad) between two pairs with ΔT/(T1+T3) = `share`, at the roll `roll` (rad). The
/// exact one is the ratio of (T1 sin α1 - T3 sin α3) to (T1 cos α1 + T3 cos α3) sin φ, arms symmetric about level.
fn kappas(delta_alpha: f64, share: f64, roll: f64) -> (f64, f64) {
    let (t1, t3) = (0.5 * (1.0 + share), 0.5 * (1.0 - share));
    let half = 0.5 * delta_alpha;
    let exact = (t1 * half.sin() + t3 * half.sin()) / ((t1 + t3) * half.cos() * roll.sin());
    (delta_alpha * share / roll.sin(), exact)
}

/// The roll manoeuvre.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("table3", "Figs. 7 and 8, Table III: the 25° roll");
    let angle = p.text.roll_deg.to_radians();
    let share = p.text.delta_thrust_share;
    printed_against_itself(&mut s, p, angle, share);

    // How hard the loops must be for the paper's ΔT/T at its middle infill, with the paper's statics.
    let gain = hard_gain(angle, share);
    let hard = Command::Hard(gain);
    let infills: Vec<f64> = p.table_3.iter().map(|r| r.infill_percent).collect();
    let cases = [
        ("rigid, hard step", Variant::Rigid, hard),
        ("flexible, hard step", Variant::Flexible, hard),
        ("flexible, prefiltered", Variant::Flexible, Command::Soft),
    ];
    let mut jobs: Vec<(usize, Job)> = vec![];
    for coupled in [false, true] {
        for infill in &infills {
            for (i, (_, mixer, command)) in cases.iter().enumerate() {
                jobs.push((
                    i,
                    Job {
                        infill: *infill,
                        mixer: *mixer,
                        command: *command,
                        coupled,
                    },
                ));
            }
        }
    }
    let flights = parallel::each(&jobs, |(_, job)| manoeuvre(*job, angle));
    let of = |case: usize, infill: f64, coupled: bool| {
        let at = jobs
            .iter()
            .position(|(i, j)| *i == case && j.infill == infill && j.coupled == coupled);
        at.and_then(|i| flights.get(i))
    };

    let mut t = Table::new(
        "The manoeuvre flown, configuration B",
        &[
            "arms",
            "ρ %",
            "mixer and command",
            "φ_max °",
            "ΔT/T max",
            "Δα_max °",
            "κ Eq. 11",
            "κ flown",
            "(φ+Δα)_max °",
            "ratio to the first",
        ],
    );
    for coupled in [false, true] {
        for infill in &infills {
            let first = of(0, *infill, coupled).and_then(found);
            for (i, (name, ..)) in cases.iter().enumerate() {
                let arms = if coupled {
                    "carry their tip mass"
                } else {
                    "follow thrust alone"
                };
                let Some(f) = of(i, *infill, coupled).and_then(found) else {
                    t.row([arms.into(), num(*infill, 0), (*name).into(), num(f64::NAN, 0)]);
                    continue;
                };
                t.row([
                    arms.into(),
                    num(*infill, 0),
                    (*name).into(),
                    num(f.roll.to_degrees(), 1),
                    num(f.thrust_share, 2),
                    num(f.delta_alpha.to_degrees(), 1),
                    num(f.delta_alpha * f.thrust_share / angle.sin(), 3),
                    num(f.kappa, 3),
                    num(f.effective.to_degrees(), 1),
                    num(first.map_or(f64::NAN, |x| x.effective / f.effective), 2),
                ]);
            }
        }
    }
    s.text(format!(
        "Flown, with a step to 25° held for {HELD} s. \"Hard\" is what the paper's ΔT/T = 3/5 takes: an attitude gain of 12 \
         1/s and a rate gain of {gain:.1} 1/s, found by halving so that arms which follow their thrust alone reach 3/5 at ρ 8 \
         %; the stack flies 4.5 and 10 behind a prefilter. ΔT/T is of one left and one right rotor: of all four, 3/5 would \
         be {:.1} N a side, beyond the rotor.",
        share * 2.0 * p.mass() * 9.806_65 / 4.0
    ));
    s.table(t);
    let rows: Vec<Comparison> = p
        .table_3
        .iter()
        .flat_map(|row| compare(row, &of, share))
        .collect();
    s.compare("Table III against the flights", rows);
    figures(&mut s, &of, &cases.map(|c| c.0));

    let middle = |coupled| {
        of(0, 8.0, coupled)
            .and_then(found)
            .map_or(f64::NAN, |f| f.delta_alpha.to_degrees())
    };
    let (free, carried) = (middle(false), middle(true));
    s.text(format!(
        "What that says about K: with arms that carry {} kg at their tips the same command bends them by {carried:.1}° at ρ 8 \
         % where the paper's statics give {free:.1}°, because the arm that is pushed up also has to push its motor up. A \
         table of Δα in a fast roll therefore does not identify the static gain K; a bench does (sophie fit-arm).",
        sophie_hil::plant::arm::TIP_MASS
    ));
    s.finding = format!(
        "With the paper's statics a step hard enough for ΔT/T = 3/5 bends the arms by {free:.1}° at ρ 8 % (printed {:.1}°). \
         The mixer has no part in the ratio column: the roll lever of a hinged arm does not depend on α, so only a softer \
         command lowers φ + Δα. Two of the printed ratios are larger than any command that still reaches 25° allows.",
        p.table_3.get(1).map_or(f64::NAN, |r| r.delta_alpha_max_deg)
    );
    s
}

/// Table III's columns against each other.
fn printed_against_itself(s: &mut Section, p: &Printed, angle: f64, share: f64) {
    let mut rows = vec![];
    for row in &p.table_3 {
        let (eq_11, exact) = kappas(row.delta_alpha_max_deg.to_radians(), share, angle);
        rows.push(Comparison {
            what: format!("κ by Eq. 11 from its own Δα, ρ {} %", row.infill_percent),
            unit: "",
            printed: row.kappa,
            here: eq_11,
            class: Class::Inconsistent,
            why: "Eq. 11 with the printed Δα_max, 3/5 and 25°; the column is not what its equation gives (0.488 looks like a \
                  transposed 0.448)"
                .to_owned(),
        });
        rows.push(Comparison {
            what: format!("κ with the exact force, ρ {} %", row.infill_percent),
            unit: "",
            printed: row.kappa,
            here: exact,
            class: Class::Inconsistent,
            why: "the sideways force is T1 sin α1 - T3 sin α3, of first order in Δα; Eqs. 8 and 11 keep only Δα ΔT"
                .to_owned(),
        });
    }
    for row in &p.table_3 {
        let most = (p.text.roll_deg + row.delta_alpha_max_deg) / p.text.roll_deg;
        rows.push(Comparison {
            what: format!("largest ratio that still reaches 25°, ρ {} %", row.infill_percent),
            unit: "",
            printed: row.ratio,
            here: most,
            class: if row.ratio > most { Class::Inconsistent } else { Class::Prediction },
            why: "(25° + Δα_max)/25°: a roll that reaches 25° has (φ + Δα)* of at least 25° once Δα has gone, and no more \
                  than 25° + Δα_max without corrections"
                .to_owned(),
        });
    }
    s.compare("Table III against itself", rows);
}

/// The rate gain (1/s) at which a step with arms that follow thrust alone reaches ΔT/T = `share` at ρ 8 %.
fn hard_gain(angle: f64, share: f64) -> f64 {
    let reached = |gain: f64| {
        let job = Job {
            infill: 8.0,
            mixer: Variant::Rigid,
            command: Command::Hard(gain),
            coupled: false,
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

fn compare<'a>(
    row: &Roll,
    of: &impl Fn(usize, f64, bool) -> Option<&'a Flown>,
    share: f64,
) -> Vec<Comparison> {
    let get = |case, coupled| of(case, row.infill_percent, coupled).and_then(found);
    let (Some(free), Some(soft)) = (get(0, false), get(2, false)) else {
        return vec![];
    };
    let carried = get(0, true);
    let of_rho = |what: &str| format!("{what}, ρ {} %", row.infill_percent);
    vec![
        Comparison {
            what: of_rho("Δα_max, arms follow thrust alone"),
            unit: "°",
            printed: row.delta_alpha_max_deg,
            here: free.delta_alpha.to_degrees(),
            class: Class::Calibrated,
            why: format!(
                "K from this very column, the command's hardness from ΔT/T = {share} at ρ 8 %; what is left is the arm's \
                 swing (ζ 0.15) and the rotor's lag"
            ),
        },
        Comparison {
            what: of_rho("Δα_max, arms carry their tip mass"),
            unit: "°",
            printed: row.delta_alpha_max_deg,
            here: carried.map_or(f64::NAN, |f| f.delta_alpha.to_degrees()),
            class: Class::Prediction,
            why: "the same command on the vehicle that the rest of this stack flies".to_owned(),
        },
        Comparison {
            what: of_rho("κ, exact, arms follow thrust alone"),
            unit: "",
            printed: row.kappa,
            here: free.kappa,
            class: Class::Prediction,
            why: "largest sideways force of the leaning arms over the largest of the rolled thrust"
                .to_owned(),
        },
        Comparison {
            what: of_rho("(φ+Δα)_max over (φ+Δα)*_max"),
            unit: "",
            printed: row.ratio,
            here: free.effective / soft.effective,
            class: Class::Prediction,
            why: "hard step with the rigid mixer over the stack's own prefiltered command".to_owned(),
        },
    ]
}

fn figures<'a>(s: &mut Section, of: &impl Fn(usize, f64, bool) -> Option<&'a Flown>, names: &[&str; 3]) {
    let chart = |title: &str, coupled: bool, y: &str, value: &dyn Fn(&Moment) -> f64| Chart {
        title: title.to_owned(),
        x: Axis::between("time (s)", 0.0, SECONDS),
        y: Axis::new(y),
        series: names
            .iter()
            .enumerate()
            .filter_map(|(i, name)| {
                Some(Series::new(
                    *name,
                    i,
                    Look::Line,
                    curve(of(i, 8.0, coupled)?, 5, value),
                ))
            })
            .collect(),
        ..Chart::default()
    };
    let arms = |title: &str, coupled: bool| {
        let mut series = vec![];
        for (case, look, word) in [(0, Look::Line, "hard"), (2, Look::Dashed, "prefiltered")] {
            let Some(flown) = of(case, 8.0, coupled) else {
                continue;
            };
            let mean = |i: usize, j: usize| move |m: &Moment| (0.5 * (m.tilt[i] + m.tilt[j])).to_degrees();
            series.push(Series::new(
                format!("left arms, {word}"),
                3,
                look,
                curve(flown, 5, mean(0, 1)),
            ));
            series.push(Series::new(
                format!("right arms, {word}"),
                2,
                look,
                curve(flown, 5, mean(2, 3)),
            ));
        }
        Chart {
            title: title.to_owned(),
            x: Axis::between("time (s)", 0.0, SECONDS),
            y: Axis::new("α (°)"),
            series,
            ..Chart::default()
        }
    };
    let roll = |m: &Moment| m.attitude[0].to_degrees();
    let effective = |m: &Moment| (m.attitude[0] + delta_alpha(m)).to_degrees();
    s.figure(
        "The manoeuvre of Fig. 8 at ρ 8 %. Upper row: arms that follow their thrust alone, as in the paper's statics. Lower \
         row: arms that carry their own tip mass. The arms bend only while the vehicle is being turned: Δα and 25° never \
         stand together.",
        vec![
            chart("Roll φ, statics", false, "φ (°)", &roll),
            arms("Arms, statics", false),
            chart("Effective angle φ + Δα, statics", false, "φ + Δα (°)", &effective),
            chart("Roll φ, tip mass", true, "φ (°)", &roll),
            arms("Arms, tip mass", true),
            chart("Effective angle φ + Δα, tip mass", true, "φ + Δα (°)", &effective),
        ],
    );
}
