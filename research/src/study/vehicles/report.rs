//! A family of vehicles as a section, and as JSON.

use std::collections::BTreeMap;

use serde_json::json;

use super::Flown;
use crate::results::model::{Axis, Chart, Section, Series, SeriesStyle, Table, num};

/// Counts of a family.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Flown.
    pub vehicles: usize,
    /// Missions accomplished.
    pub accomplished: usize,
    /// The check lets pass.
    pub passed: usize,
    /// Of these, accomplished.
    pub passed_accomplished: usize,
    /// Accomplished although the check refuses.
    pub refused_accomplished: usize,
}

impl Counts {
    /// Of `flown`.
    #[must_use]
    pub fn of(flown: &[Flown]) -> Self {
        let count = |which: &dyn Fn(&Flown) -> bool| flown.iter().filter(|f| which(f)).count();
        Self {
            vehicles: flown.len(),
            accomplished: count(&|f| f.outcome.accomplished),
            passed: count(&Flown::passes),
            passed_accomplished: count(&|f| f.passes() && f.outcome.accomplished),
            refused_accomplished: count(&|f| !f.passes() && f.outcome.accomplished),
        }
    }

    /// Share of the vehicles that pass the check which accomplish the mission; NaN if none passes.
    #[must_use]
    pub fn reliable(&self) -> f64 {
        self.passed_accomplished as f64 / self.passed as f64
    }

    /// Share of the vehicles that accomplish the mission which the check refuses; NaN if none does.
    #[must_use]
    pub fn wronged(&self) -> f64 {
        self.refused_accomplished as f64 / self.accomplished as f64
    }
}

/// Causes of failure and how often each ended a flight, most frequent first.
#[must_use]
pub fn causes(flown: &[Flown]) -> Vec<(String, usize)> {
    let mut counted = BTreeMap::<String, usize>::new();
    for cause in flown.iter().filter_map(Flown::cause) {
        *counted.entry(cause).or_default() += 1;
    }
    let mut causes: Vec<_> = counted.into_iter().collect();
    causes.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    causes
}

/// The family as JSON text, newline-terminated. Each vehicle has its scenario, which `sophie fly` takes.
#[must_use]
pub fn json(flown: &[Flown], seed: u64, spread: f64) -> String {
    let counts = Counts::of(flown);
    let value = json!({
        "seed": seed,
        "spread": spread,
        "vehicles": counts.vehicles,
        "accomplished": counts.accomplished,
        "check_passed": counts.passed,
        "check_passed_accomplished": counts.passed_accomplished,
        "check_refused_accomplished": counts.refused_accomplished,
        "causes": causes(flown).into_iter().collect::<BTreeMap<_, _>>(),
        "flown": flown.iter().map(|f| json!({
            "seed": f.sampled.seed,
            "accomplished": f.outcome.accomplished,
            "reason": f.outcome.reason,
            "check": f.check,
            "scenario": f.sampled.text,
        })).collect::<Vec<_>>(),
    });
    // Numbers and string keys only: cannot fail.
    serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
}

/// The family with its tables and pictures.
#[must_use]
pub fn section(flown: &[Flown], seed: u64, spread: f64) -> Section {
    let counts = Counts::of(flown);
    let mut s = Section::new("vehicles", "Varied vehicles");
    s.table(agreement(&counts));
    s.table(failures(flown));
    s.table(failed(flown));
    s.figure(
        "Each vehicle, by what was drawn of it.",
        vec![
            scatter(flown, "infill, %", "gain K", |f| {
                (
                    f.sampled.scenario.vehicle.infill,
                    f.sampled.scenario.vehicle.gain_k,
                )
            }),
            scatter(flown, "pipe, m", "friction", |f| {
                (
                    f.sampled.scenario.world.pipe_diameter,
                    f.sampled.scenario.world.pipe_friction,
                )
            }),
            scatter(flown, "gusts, N RMS", "pilot's delay, s", |f| {
                (
                    f.sampled.scenario.world.gust_force,
                    f.sampled.scenario.pilot.delay,
                )
            }),
        ],
    );
    s.finding = format!(
        "{} of {} vehicles from seed {seed} accomplish the mission (spread {spread}), {} of the {} that the design check \
         lets pass; it refuses {} that can.",
        counts.accomplished,
        counts.vehicles,
        counts.passed_accomplished,
        counts.passed,
        counts.refused_accomplished
    );
    s
}

fn agreement(counts: &Counts) -> Table {
    let mut t = Table::new("Check and flights", &["", "accomplished", "failed"]);
    let refused = counts.vehicles - counts.passed;
    for (what, accomplished, all) in [
        ("check passes", counts.passed_accomplished, counts.passed),
        ("check refuses", counts.refused_accomplished, refused),
    ] {
        t.row([
            what.into(),
            num(accomplished as f64, 0),
            num((all - accomplished) as f64, 0),
        ]);
    }
    t
}

fn failures(flown: &[Flown]) -> Table {
    let mut t = Table::new("What ended the others", &["cause", "vehicles"]);
    for (cause, count) in causes(flown) {
        t.row([cause.into(), num(count as f64, 0)]);
    }
    t
}

fn failed(flown: &[Flown]) -> Table {
    let mut t = Table::new(
        "Those that pass the check and fail",
        &["seed", "infill, %", "K", "pipe, m", "friction", "reason"],
    );
    for f in flown.iter().filter(|f| f.passes() && !f.outcome.accomplished) {
        let of = &f.sampled.scenario;
        t.row([
            num(f.sampled.seed as f64, 0),
            num(of.vehicle.infill, 1),
            num(of.vehicle.gain_k, 1),
            num(of.world.pipe_diameter, 2),
            num(of.world.pipe_friction, 2),
            f.outcome.reason.clone().into(),
        ]);
    }
    t
}

fn scatter(flown: &[Flown], x: &str, y: &str, at: impl Fn(&Flown) -> (f64, f64)) -> Chart {
    let series = [
        ("accomplished", 2, true, true),
        ("failed", 1, true, false),
        ("refused by the check, accomplished", 0, false, true),
        ("refused by the check, failed", 5, false, false),
    ]
    .map(|(name, colour, passes, accomplished)| {
        let these = flown
            .iter()
            .filter(|f| f.passes() == passes && f.outcome.accomplished == accomplished);
        Series::new(name, colour, SeriesStyle::Dots, these.map(&at).collect())
    });
    Chart {
        title: format!("{y} over {x}"),
        x: Axis::new(x),
        y: Axis::new(y),
        series: series.into_iter().filter(|s| !s.points.is_empty()).collect(),
        ..Chart::default()
    }
}
