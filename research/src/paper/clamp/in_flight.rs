//! Two and four arms, in whole missions.

use sophie_charts::units::kgcm;
use sophie_control::pilot::rc::ArmChoice;
use sophie_sim::flight;
use sophie_sim::parallel;
use sophie_sim::record::{Grip, Silent};
use sophie_sim::scenario::Scenario;

use crate::results::model::{Section, Table, num};

/// Flies them.
pub fn fly(s: &mut Section) {
    let jobs: Vec<(f64, ArmChoice)> = [6.0, 6.9, 8.0]
        .into_iter()
        .flat_map(|i| [ArmChoice::All, ArmChoice::Front].map(|a| (i, a)))
        .collect();
    let records = parallel::each(&jobs, |(infill, arms)| {
        let mut scenario = Scenario::default_mission();
        (scenario.vehicle.infill, scenario.params.infill) = (*infill, *infill as f32);
        scenario.arms = *arms;
        flight::fly(&scenario, &mut Silent)
    });
    let mut t = Table::new(
        "Whole missions: the vehicle lands on a 300 mm pipe and closes",
        &[
            "ρ %",
            "arms",
            "closure s",
            "U at proof kgcm",
            "true pressure N/m²",
            "outcome",
        ],
    );
    for ((infill, arms), r) in jobs.iter().zip(&records) {
        let four = *arms == ArmChoice::All;
        t.row([
            num(*infill, 1),
            if four { "four" } else { "two (front)" }.into(),
            range(&r.grip, 2, |g| g.closure).into(),
            range(&r.grip, 2, |g| kgcm(g.torque)).into(),
            range(&r.grip, 0, |g| g.pressure_true).into(),
            r.outcome.reason.clone().into(),
        ]);
    }
    s.table(t);
}

fn range(grips: &[Grip], digits: usize, value: impl Fn(&Grip) -> f64) -> String {
    let (low, high) = grips
        .iter()
        .map(value)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
    if low.is_finite() {
        format!("{low:.digits$} to {high:.digits$}")
    } else {
        "–".to_owned()
    }
}
