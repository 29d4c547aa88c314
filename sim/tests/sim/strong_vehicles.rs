//! The pilot model flies vehicles of other strength.

use sophie_sim::flight::fly;
use sophie_sim::record::{FlightRecord, Silent};
use sophie_sim::scenario::{Overrides, Scenario};

/// With this mass (kg) and largest rotor thrust (N); returns thrust to weight too.
fn flown(mass: f64, thrust: f64, steps: &str) -> (FlightRecord, f64) {
    let text = format!("{steps}\n[vehicle]\nmass_kg = {mass}\nthrust_max_n = {thrust}\n");
    let scenario = Scenario::parse(&text, "strong.toml", &Overrides::default()).unwrap();
    (fly(&scenario, &mut Silent), 4.0 * thrust / (mass * 9.806_65))
}

fn highest(record: &FlightRecord) -> f64 {
    record.samples.iter().map(|s| -s.position[2]).fold(0.0, f64::max)
}

#[test]
fn a_hop_goes_to_its_height_and_back_at_every_thrust_to_weight() {
    let steps =
        "steps = [{ do = 'arm' }, { do = 'take-off' }, { do = 'hover' }, { do = 'land' }, { do = 'disarm' }]";
    for (mass, thrust) in [
        (1.805, 5.8),
        (2.6, 8.3),
        (1.805, 11.0),
        (1.805, 13.3),
        (1.805, 18.0),
        (1.805, 20.0),
        (1.3, 20.0),
    ] {
        let (record, ratio) = flown(mass, thrust, steps);
        let highest = highest(&record);
        println!("{ratio:.2}: {} highest {highest:.2} m", record.outcome.reason);
        assert!(
            record.outcome.accomplished,
            "{ratio:.2}: {}",
            record.outcome.reason
        );
        assert!((2.85..3.9).contains(&highest), "{ratio:.2}: {highest} m");
    }
}

#[test]
fn the_default_mission_is_flown_by_strong_vehicles() {
    for (mass, thrust) in [(1.805, 11.0), (1.805, 15.0)] {
        let (record, ratio) = flown(mass, thrust, "");
        println!(
            "{ratio:.2}: {} highest {:.2} m",
            record.outcome.reason,
            highest(&record)
        );
        assert!(
            record.outcome.accomplished,
            "{ratio:.2}: {}",
            record.outcome.reason
        );
    }
}
