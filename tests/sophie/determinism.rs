//! A seed determines the flight to the bit, whatever other threads do.

use std::thread;

use sophie_sim::flight::fly;
use sophie_sim::record::Silent;
use sophie_sim::scenario::{Scenario, Step};

fn hop(seed: u64) -> Scenario {
    let steps = vec![
        Step::Arm,
        Step::TakeOff { height: 2.0 },
        Step::Hover { seconds: 3.0 },
        Step::Land,
        Step::Disarm,
    ];
    Scenario {
        seed,
        steps,
        ..Scenario::default_mission()
    }
}

fn digest(seed: u64) -> u64 {
    flown(&hop(seed))
}

/// Includes contact, tendons, pressure, proof.
fn perch_digest(seed: u64) -> u64 {
    let steps = vec![
        Step::Arm,
        Step::TakeOff { height: 2.5 },
        Step::FlyToPipe,
        Step::Touch,
        Step::Perch { throttle: 0.3 },
        Step::Hold {
            seconds: 3.0,
            push: 1.5,
            lapse: 0.0,
        },
    ];
    flown(&Scenario {
        seed,
        steps,
        ..Scenario::default_mission()
    })
}

fn flown(scenario: &Scenario) -> u64 {
    let record = fly(scenario, &mut Silent);
    assert!(record.outcome.accomplished, "{}", record.outcome.reason);
    record.digest
}

#[test]
fn two_runs_of_a_seed_are_equal_to_the_bit_and_two_seeds_are_not() {
    assert_eq!(digest(1), digest(1));
    assert_ne!(digest(1), digest(2));
}

#[test]
fn flights_in_parallel_threads_do_not_disturb_each_other() {
    let alone: Vec<u64> = (1..=4).map(digest).collect();
    let together: Vec<_> = (1..=4).map(|seed| thread::spawn(move || digest(seed))).collect();
    let together: Vec<u64> = together.into_iter().map(|t| t.join().expect("flight")).collect();
    assert_eq!(alone, together);
}

#[test]
fn perches_in_parallel_threads_are_equal_to_the_bit() {
    let threads: Vec<_> = [1, 2, 1, 2]
        .into_iter()
        .map(|seed| thread::spawn(move || perch_digest(seed)))
        .collect();
    let together: Vec<u64> = threads.into_iter().map(|t| t.join().expect("flight")).collect();
    let alone = [perch_digest(1), perch_digest(2)];
    assert_eq!(together, [alone, alone].concat());
}

#[test]
fn a_second_flight_in_one_thread_starts_afresh() {
    let first = digest(3);
    digest(4);
    assert_eq!(first, digest(3));
}
