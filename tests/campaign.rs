//! The whole mission over infill, arms and seeds: every flight must be accomplished.

use sophie_hil::flight::fly;
use sophie_hil::record::Silent;
use sophie_hil::scenario::Scenario;

/// Seeds flown in each cell.
const SEEDS: u64 = 20;

/// Flies the default mission with `infill` (%) and `two` arms or four over all seeds; fails with every reason.
fn campaign(infill: f64, two: bool) {
    let mut scenario = Scenario::default_mission();
    scenario.vehicle.infill = infill;
    scenario.params.infill = infill as f32;
    if two {
        scenario.arms = sophie_control::rc::ArmChoice::Front;
    }
    let mut failures = Vec::new();
    for seed in 1..=SEEDS {
        scenario.seed = seed;
        let record = fly(&scenario, &mut Silent);
        let chosen = if two { 2 } else { 4 };
        let gripped = record.grip.len() == chosen;
        if !record.outcome.accomplished || record.overruns > 0 || !gripped {
            failures.push(format!(
                "seed {seed}: {}, {} overruns",
                record.outcome.reason, record.overruns
            ));
        }
    }
    assert!(
        failures.is_empty(),
        "{} of {SEEDS} failed:\n{}",
        failures.len(),
        failures.join("\n")
    );
}

macro_rules! campaigns {
    ($($name:ident: $infill:literal, $two:literal;)+) => {
        $( #[test] fn $name() { campaign($infill, $two); } )+
    };
}

campaigns! {
    four_arms_at_6_percent: 6.0, false;
    four_arms_at_6_9_percent: 6.9, false;
    four_arms_at_8_percent: 8.0, false;
    four_arms_at_10_percent: 10.0, false;
    two_arms_at_6_percent: 6.0, true;
    two_arms_at_6_9_percent: 6.9, true;
    two_arms_at_8_percent: 8.0, true;
    two_arms_at_10_percent: 10.0, true;
}
