//! Simulated seconds per wall second, stack and plant on one core: median and spread of several default missions
//! (`cargo bench -p sophie-sim`).

#![allow(clippy::print_stdout, reason = "the figure is what it is for")]

use sophie_sim::flight::fly;
use sophie_sim::record::Silent;
use sophie_sim::scenario::Scenario;

const FLIGHTS: u64 = 9;

fn main() {
    let mut ratios = Vec::new();
    for seed in 1..=FLIGHTS {
        let scenario = Scenario {
            seed,
            ..Scenario::default_mission()
        };
        let record = fly(&scenario, &mut Silent);
        ratios.push(record.sim_seconds / record.wall_seconds);
    }
    ratios.sort_by(f64::total_cmp);
    let (low, median, high) = (ratios[0], ratios[ratios.len() / 2], ratios[ratios.len() - 1]);
    println!(
        "default mission, seeds 1 to {FLIGHTS}: {median:.0} simulated s a wall s (median; {low:.0} to {high:.0})"
    );
}
