//! The mission over infill, arms and seeds: every flight must be accomplished.

use sophie_control::pilot::rc::ArmChoice::{self, All, Front, Rear};
use sophie_sim::flight::fly;
use sophie_sim::record::Silent;
use sophie_sim::scenario::Scenario;
use sophie_test_support::flights;

/// Flights of each vehicle, unless `SOPHIE_SEEDS` says how many: 8 in `.ci/run`, 20 in `.ci/campaign`.
const SEEDS: u64 = 2;

/// Flies all seeds, infill in %; fails with every reason.
fn campaign(infill: f64, arms: ArmChoice) {
    let seeds = std::env::var("SOPHIE_SEEDS").map_or(SEEDS, |n| n.parse().expect("SOPHIE_SEEDS: a number"));
    let mut scenario = Scenario::default_mission();
    scenario.vehicle.infill = infill;
    scenario.params.infill = infill as f32;
    scenario.arms = arms;
    let mut failures = Vec::new();
    for seed in 1..=seeds {
        scenario.seed = seed;
        let record = fly(&scenario, &mut Silent);
        let proven = flights::proven(&record);
        if !record.outcome.accomplished || record.overruns > 0 || proven.is_err() {
            failures.push(format!(
                "seed {seed}: {}, {} overruns, {}",
                record.outcome.reason,
                record.overruns,
                proven.err().unwrap_or_default()
            ));
        }
    }
    assert!(
        failures.is_empty(),
        "{} of {seeds} failed:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

macro_rules! campaigns {
    ($($name:ident: $infill:literal, $arms:ident;)+) => {
        $( #[test] fn $name() { campaign($infill, $arms); } )+
    };
}

campaigns! {
    four_arms_at_6_percent: 6.0, All;
    four_arms_at_6_9_percent: 6.9, All;
    four_arms_at_8_percent: 8.0, All;
    four_arms_at_10_percent: 10.0, All;
    front_pair_at_6_percent: 6.0, Front;
    front_pair_at_6_9_percent: 6.9, Front;
    front_pair_at_8_percent: 8.0, Front;
    front_pair_at_10_percent: 10.0, Front;
    rear_pair_at_6_percent: 6.0, Rear;
    rear_pair_at_6_9_percent: 6.9, Rear;
    rear_pair_at_8_percent: 8.0, Rear;
    rear_pair_at_10_percent: 10.0, Rear;
}
