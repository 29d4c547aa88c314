//! Figs. 7 and 8, Table III: the 25° roll manoeuvre, its arms and its sideways force.

use std::f32::consts::TAU;

use crate::study::rig::{Flown, Moment, Wish, fly};
use sophie_control::wrench::Configuration;
use sophie_sim::mixers::Variant;
use sophie_sim::scenario::Scenario;

use super::flights::{curve, delta_alpha, delta_thrust, lost_when, vehicle};
use super::model::{Axis, Chart, Class, Comparison, Look, Section, Series, Table, num};
use super::printed::{Printed, Roll};
use sophie_sim::parallel;

/// How long the roll is held, s.
const HELD: f64 = 1.2;
/// Time in which the vehicle is being turned, s: one that is lost later has shown its Δα.
const TURN: f64 = 0.5;
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

/// What the arms do besides following their thrust.
#[derive(Clone, Copy, PartialEq)]
enum Arms {
    /// Nothing: damping ratio 0.7, no mass of their own. The paper's statics.
    Static,
    /// They swing, at the damping ratio that meets the printed Δα at ρ 8 %.
    Fitted(f64),
    /// They carry their tip mass, as in every other flight.
    Heavy,
}

impl Arms {
    const fn damping(self) -> f64 {
        match self {
            Self::Static => 0.7,
            Self::Fitted(zeta) => zeta,
            Self::Heavy => 0.15,
        }
    }

    fn words(self) -> String {
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
struct Job {
    infill: f64,
    mixer: Variant,
    command: Command,
    arms: Arms,
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
        (s.params.attitude_p, s.params.rate_p) = (12.0, rate_p as f32);
        (s.params.setpoint_lpf_hz, s.params.rate_max) = (100.0 / TAU, 12.0);
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
    flown.lost.is_none_or(|t| t > TURN).then(|| Found {
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
    let fitted = Arms::Fitted(fitted_damping(p, angle, hard));
    let kinds = [Arms::Static, fitted, Arms::Heavy];
    let mut jobs: Vec<(usize, Job)> = vec![];
    for arms in kinds {
        for infill in &infills {
            for (i, (_, mixer, command)) in cases.iter().enumerate() {
                jobs.push((
                    i,
                    Job {
                        infill: *infill,
                        mixer: *mixer,
                        command: *command,
                        arms,
                    },
                ));
            }
        }
    }
    let flights = parallel::each(&jobs, |(_, job)| manoeuvre(*job, angle));
    let of = |case: usize, infill: f64, arms: Arms| {
        let at = jobs
            .iter()
            .position(|(i, j)| *i == case && j.infill == infill && j.arms == arms);
        at.and_then(|i| flights.get(i))
    };

    let mut t = Table::new(
        "The manoeuvre flown, configuration B; ratio: largest φ+Δα of the first of three over that of this one",
        &[
            "arms",
            "ρ %",
            "mixer, command",
            "φ_max °",
            "ΔT/T",
            "Δα_max °",
            "κ, Eq. 11",
            "κ, exact",
            "(φ+Δα)_max °",
            "ratio",
            "lost",
        ],
    );
    for arms in kinds {
        for infill in &infills {
            let first = of(0, *infill, arms).and_then(found);
            for (i, (name, ..)) in cases.iter().enumerate() {
                let Some(f) = of(i, *infill, arms).and_then(found) else {
                    t.row([
                        arms.words().into(),
                        num(*infill, 0),
                        (*name).into(),
                        num(f64::NAN, 0),
                        num(f64::NAN, 0),
                        num(f64::NAN, 0),
                        num(f64::NAN, 0),
                        num(f64::NAN, 0),
                        num(f64::NAN, 0),
                        num(f64::NAN, 0),
                        of(i, *infill, arms).map_or("–".into(), lost_when),
                    ]);
                    continue;
                };
                t.row([
                    arms.words().into(),
                    num(*infill, 0),
                    (*name).into(),
                    num(f.roll.to_degrees(), 1),
                    num(f.thrust_share, 2),
                    num(f.delta_alpha.to_degrees(), 1),
                    num(f.delta_alpha * f.thrust_share / angle.sin(), 3),
                    num(f.kappa, 3),
                    num(f.effective.to_degrees(), 1),
                    num(first.map_or(f64::NAN, |x| x.effective / f.effective), 2),
                    of(i, *infill, arms).map_or("–".into(), lost_when),
                ]);
            }
        }
    }
    s.text(format!(
        "Flown, with a step to 25° held for {HELD} s. \"Hard\" is what the paper's ΔT/T = 3/5 takes: an attitude gain of 12 \
         1/s and a rate gain of {gain:.1} 1/s, found by halving so that static arms reach 3/5 at ρ 8 %; the stack flies 4.5 and 10 behind a prefilter. ΔT/T is of one left and one right rotor: of all four, 3/5 would \
         be {:.1} N a side, beyond the rotor.",
        share * p.mass() * 9.806_65
    ));
    s.table(t);
    let rows: Vec<Comparison> = p
        .table_3
        .iter()
        .flat_map(|row| compare(row, &of, share, fitted))
        .collect();
    s.compare("Table III against the flights", rows);
    columns(&mut s, p, &of, fitted);
    figures(&mut s, p, &of, &cases.map(|c| c.0), fitted);

    let middle = |arms| {
        of(0, 8.0, arms)
            .and_then(found)
            .map_or(f64::NAN, |f| f.delta_alpha.to_degrees())
    };
    let (rest, heavy) = (middle(Arms::Static), middle(Arms::Heavy));
    let heavy_flexible = of(1, 8.0, Arms::Heavy)
        .and_then(found)
        .map_or(f64::NAN, |f| f.delta_alpha.to_degrees());
    s.text(format!(
        "What that says about K: the same command at ρ 8 % bends the arms by {rest:.1}° if they hardly swing (ζ 0.7: the \
         rotor's lag takes the rest of Eq. 1's static difference), by {heavy:.1}° (rigid mixer) and {heavy_flexible:.1}° (flexible) if \
         they carry {} kg at their tips, because the arm that is pushed up has to push its motor up, and swings; the printed {:.1}° take massless arms of ζ {:.2}. A table of Δα \
         in a fast roll does not identify the static gain K: mass and damping of the arm are in it too. A bench identifies \
         it (sophie fit-arm).",
        sophie_sim::plant::arm::TIP_MASS,
        p.table_3.get(1).map_or(f64::NAN, |r| r.delta_alpha_max_deg),
        fitted.damping()
    ));
    let worst = p.table_3.iter().filter_map(|row| {
        let bent = of(0, row.infill_percent, fitted)
            .and_then(found)?
            .delta_alpha
            .to_degrees();
        Some(100.0 * (bent / row.delta_alpha_max_deg - 1.0).abs())
    });
    let worst = worst.fold(0.0, f64::max);
    s.finding = format!(
        "A step hard enough for ΔT/T = 3/5 bends massless, well damped arms by {rest:.1}° at ρ 8 % and arms that carry their \
         motors by {heavy:.1}° under the rigid and {heavy_flexible:.1}° under the flexible mixer (printed {:.1}°); massless arms of ζ {:.2} meet the whole column within {worst:.0} %. The mixer has no part in the ratio column: the roll lever of a hinged arm \
         does not depend on α, so only a softer command lowers φ + Δα. Two of the printed ratios are larger than the printed \
         Δα_max allows.",
        p.table_3.get(1).map_or(f64::NAN, |r| r.delta_alpha_max_deg),
        fitted.damping()
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

/// The damping ratio of massless arms at which the hard step gives the printed Δα_max at ρ 8 %.
fn fitted_damping(p: &Printed, angle: f64, command: Command) -> f64 {
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

fn compare<'a>(
    row: &Roll,
    of: &impl Fn(usize, f64, Arms) -> Option<&'a Flown>,
    share: f64,
    fitted: Arms,
) -> Vec<Comparison> {
    let get = |case, arms| of(case, row.infill_percent, arms).and_then(found);
    let of_rho = |what: &str| format!("{what}, ρ {} %", row.infill_percent);
    let deg = |f: Option<Found>| f.map_or(f64::NAN, |f| f.delta_alpha.to_degrees());
    let ratio = |arms| match (get(0, arms), get(2, arms)) {
        (Some(hard), Some(soft)) => hard.effective / soft.effective,
        _ => f64::NAN,
    };
    let line = |what: &str, unit, printed, here, class, why: &str| Comparison {
        what: of_rho(what),
        unit,
        printed,
        here,
        class,
        why: why.to_owned(),
    };
    let alpha = row.delta_alpha_max_deg;
    let command = format!("hardness of the step from ΔT/T = {share} at ρ 8 %, K from this column");
    let (class, why) = if row.infill_percent == 8.0 {
        (
            Class::Calibrated,
            format!("damping ratio {:.2} from this very number", fitted.damping()),
        )
    } else {
        (
            Class::Prediction,
            format!(
                "damping ratio {:.2} from the row of 8 %; {command}",
                fitted.damping()
            ),
        )
    };
    let kappa = |arms| get(0, arms).map_or(f64::NAN, |f| f.kappa);
    let force = "largest sideways force of the leaning arms over the largest of the rolled thrust";
    let soft = "hard step with the rigid mixer over the stack's own prefiltered command";
    let rows = vec![
        line(
            "Δα_max, static arms",
            "°",
            alpha,
            deg(get(0, Arms::Static)),
            Class::Prediction,
            &command,
        ),
        line(
            "Δα_max, fitted arms",
            "°",
            alpha,
            deg(get(0, fitted)),
            class,
            &why,
        ),
        line(
            "Δα_max, arms with tip mass",
            "°",
            alpha,
            deg(get(0, Arms::Heavy)),
            Class::Prediction,
            "the same command on the vehicle that the rest of this stack flies",
        ),
        line(
            "κ, exact, fitted arms",
            "",
            row.kappa,
            kappa(fitted),
            Class::Prediction,
            force,
        ),
        line(
            "κ, exact, arms with tip mass",
            "",
            row.kappa,
            kappa(Arms::Heavy),
            Class::Prediction,
            force,
        ),
        line(
            "(φ+Δα)_max ratio, fitted arms",
            "",
            row.ratio,
            ratio(fitted),
            Class::Prediction,
            soft,
        ),
        line(
            "(φ+Δα)_max ratio, arms with tip mass",
            "",
            row.ratio,
            ratio(Arms::Heavy),
            Class::Prediction,
            soft,
        ),
    ];
    // A vehicle that was lost before the turn has nothing to compare.
    rows.into_iter().filter(|r| r.here.is_finite()).collect()
}

/// Table III's columns over infill: printed and flown.
fn columns<'a>(
    s: &mut Section,
    p: &Printed,
    of: &impl Fn(usize, f64, Arms) -> Option<&'a Flown>,
    fitted: Arms,
) {
    let kinds = [
        ("massless, ζ 0.7", Arms::Static),
        ("massless, fitted ζ", fitted),
        ("with tip mass", Arms::Heavy),
    ];
    let chart =
        |title: &str, y: &str, printed: &dyn Fn(&Roll) -> f64, here: &dyn Fn(f64, Arms) -> Option<f64>| {
            let points = p.table_3.iter().map(|r| (r.infill_percent, printed(r))).collect();
            let mut series = vec![Series::new("Table III", 0, Look::Printed, points)];
            for (i, (name, arms)) in kinds.iter().enumerate() {
                let flown = |r: &Roll| {
                    (
                        r.infill_percent,
                        here(r.infill_percent, *arms).unwrap_or(f64::NAN),
                    )
                };
                series.push(Series::new(
                    *name,
                    i,
                    Look::Line,
                    p.table_3.iter().map(flown).collect(),
                ));
                series.push(Series::new(
                    "",
                    i,
                    Look::Dots,
                    p.table_3.iter().map(flown).collect(),
                ));
            }
            Chart {
                title: title.to_owned(),
                x: Axis::new("infill ρ (%)"),
                y: Axis::new(y).with(&[0.0]),
                series,
                ..Chart::default()
            }
        };
    let hard = |infill, arms| of(0, infill, arms).and_then(found);
    s.figure(
        "Table III against the hard step with the rigid mixer; the ratio is over the stack's own prefiltered command.",
        vec![
            chart("Largest difference of tilt", "Δα_max (°)", &|r| r.delta_alpha_max_deg, &|infill, arms| {
                Some(hard(infill, arms)?.delta_alpha.to_degrees())
            }),
            chart("κ", "κ, flown by the exact force", &|r| r.kappa, &|infill, arms| Some(hard(infill, arms)?.kappa)),
            chart("What a softer command saves", "(φ+Δα)_max over (φ+Δα)*_max", &|r| r.ratio, &|infill, arms| {
                Some(hard(infill, arms)?.effective / of(2, infill, arms).and_then(found)?.effective)
            }),
        ],
    );
}

fn figures<'a>(
    s: &mut Section,
    p: &Printed,
    of: &impl Fn(usize, f64, Arms) -> Option<&'a Flown>,
    names: &[&str; 3],
    fitted: Arms,
) {
    let chart = |title: &str, infill: f64, arms: Arms, y: &str, value: &dyn Fn(&Moment) -> f64| Chart {
        title: format!("{title}, ρ {infill} %"),
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
                    curve(of(i, infill, arms)?, 5, value),
                ))
            })
            .collect(),
        ..Chart::default()
    };
    let tilts = |title: &str, infill: f64, arms: Arms| {
        let mut series = vec![];
        for (case, look, word) in [(1, Look::Line, "hard"), (2, Look::Dashed, "prefiltered")] {
            let Some(flown) = of(case, infill, arms) else {
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
            title: format!("{title}, ρ {infill} %"),
            x: Axis::between("time (s)", 0.0, SECONDS),
            y: Axis::new("α (°)"),
            series,
            ..Chart::default()
        }
    };
    let commanded = |chart: Chart| Chart {
        levels: vec![(p.text.roll_deg, "commanded, and the paper's φ_max".to_owned())],
        ..chart
    };
    let bounded = |infill: f64, chart: Chart| {
        let row = p.table_3.iter().find(|r| r.infill_percent == infill);
        let most = row.map(|r| p.text.roll_deg + r.delta_alpha_max_deg);
        Chart {
            levels: most
                .map(|m| (m, format!("25° + printed Δα_max = {m:.1}°")))
                .into_iter()
                .collect(),
            ..chart
        }
    };
    let roll = |m: &Moment| m.attitude[0].to_degrees();
    let effective = |m: &Moment| (m.attitude[0] + delta_alpha(m)).to_degrees();
    let trio = |infill: f64, arms: Arms, word: &str| {
        [
            commanded(chart(&format!("Roll φ, {word}"), infill, arms, "φ (°)", &roll)),
            tilts(&format!("Tilt of the arms, {word}"), infill, arms),
            bounded(
                infill,
                chart(
                    &format!("Effective angle φ + Δα, {word}"),
                    infill,
                    arms,
                    "φ + Δα (°)",
                    &effective,
                ),
            ),
        ]
    };
    let charts = [6.0, 8.0, 10.0]
        .into_iter()
        .flat_map(|infill| trio(infill, fitted, "massless arms"));
    s.figure(
        "The manoeuvre of Fig. 8 (printed for ρ 8 %) with massless arms of the fitted damping; rigid and flexible mixer lie \
         on each other (the tilts are the flexible one's). The arms bend only while the vehicle is being turned: Δα and 25° never stand together.",
        charts.collect(),
    );
    s.figure(
        "The same with arms that carry their own tip mass. The hard gains excite the arms' mode already in hover, which the \
         stack's own gains and prefilter do not; a curve that ends is a vehicle that was lost.",
        trio(8.0, Arms::Heavy, "tip mass").into(),
    );
}
