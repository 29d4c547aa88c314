//! The default mission over many seeds: number accomplished, and reasons of the others (docs/lab/2026-11-24-missions.md).
//!
//! `cargo run --release -p sophie-sim --example seeds -- FIRST COUNT [RHO [GUST [ARMS]]]`: infill in %, gusts in N RMS,
//! 4 arms or 2.

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use sophie_control::mode::Mode;
use sophie_control::pilot::rc::ArmChoice;
use sophie_sim::flight::fly;
use sophie_sim::parallel;
use sophie_sim::record::{FlightRecord, Silent};
use sophie_sim::scenario::Scenario;

/// Gusts act so far from the centre of mass, m.
const GUST_LEVER: f64 = 0.04;

struct Flown {
    seed: u64,
    escapes: usize,
    failure: Option<String>,
}

fn flown(scenario: &Scenario) -> Flown {
    let FlightRecord { outcome, events, .. } = fly(scenario, &mut Silent);
    let escaping = format!("mode {}", Mode::Escaping.name());
    Flown {
        seed: scenario.seed,
        escapes: events.iter().filter(|e| e.text == escaping).count(),
        failure: (!outcome.accomplished).then_some(outcome.reason),
    }
}

fn main() {
    let args: Vec<f64> = std::env::args()
        .skip(1)
        .map(|a| a.parse().expect("a number"))
        .collect();
    let of = |i: usize, default: f64| args.get(i).copied().unwrap_or(default);
    let (first, count) = (of(0, 1.0) as u64, of(1, 100.0) as u64);
    let mut scenario = Scenario::default_mission();
    scenario.vehicle.infill = of(2, scenario.vehicle.infill);
    scenario.params.infill = scenario.vehicle.infill as f32;
    scenario.world.gust_force = of(3, scenario.world.gust_force);
    scenario.world.gust_moment = GUST_LEVER * scenario.world.gust_force;
    if of(4, 4.0) < 4.0 {
        scenario.arms = ArmChoice::Front;
    }
    let seeds: Vec<u64> = (first..first + count).collect();
    let flights = parallel::each(&seeds, |&seed| {
        flown(&Scenario {
            seed,
            ..scenario.clone()
        })
    });
    for flight in &flights {
        if let Some(why) = &flight.failure {
            println!("seed {}: {why} ({} escapes)", flight.seed, flight.escapes);
        }
    }
    println!(
        "{} of {count} accomplished, {} with an escape",
        flights.iter().filter(|f| f.failure.is_none()).count(),
        flights.iter().filter(|f| f.escapes > 0).count(),
    );
}
