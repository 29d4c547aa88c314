//! Flights with a servo battery that is measured: at its end on the pipe, before a perch, before arming.

use sophie_control::mode::Mode;
use sophie_sim::flight::fly;
use sophie_sim::record::{FlightRecord, Silent};
use sophie_sim::scenario::{Overrides, Scenario};
use sophie_sim::streams::Streams;

fn flown(text: &str) -> FlightRecord {
    let scenario = Scenario::parse(text, "servos.toml", &Overrides::default()).unwrap();
    fly(&scenario, &mut Silent)
}

/// Time at which the display first showed `text`, s.
fn said(record: &FlightRecord, text: &str) -> Option<f64> {
    record.events.iter().find(|e| e.text == text).map(|e| e.t)
}

/// Reading of the simulated divider over the true voltage.
fn gain(seed: u64) -> f64 {
    1.0 + Streams::new(seed).within("battery.servos", -0.01, 0.01)
}

const NEAR_END: &str = "warning: servo battery near its end";
const LOW: &str = "servo battery low";

#[test]
fn a_perched_vehicle_warns_in_time_to_let_go() {
    let text = include_str!("../../../tests/scenarios/servo-battery-end.toml");
    for seed in [1, 2] {
        // Trimmed by a meter: of cells this flat 1 % of voltage is a tenth of the charge.
        let divider = format!("servo_batt_div = {}", 11.0 / gain(seed));
        let record = flown(&format!(
            "seed = {seed}\n{}",
            text.replace("servo_batt_div = 11", &divider)
        ));
        assert!(record.outcome.accomplished, "{}", record.outcome.reason);
        let (near_end, low) = (said(&record, NEAR_END).unwrap(), said(&record, LOW).unwrap());
        println!("seed {seed}: near its end at {near_end:.0} s, low at {low:.0} s");
        let mode = |t: f64| record.samples.iter().find(|s| s.t >= t).unwrap().mode;
        assert_eq!((mode(near_end), mode(low)), (Mode::Perched, Mode::Perched));
        assert!(low - near_end > 60.0, "{near_end} to {low} s");
        // A pilot who does not release then has servos without power, and the arms do not open.
        let late = text.replace("seconds = 200", "seconds = 260");
        let record = flown(&format!("seed = {seed}\n{late}"));
        println!("seed {seed}: {}", record.outcome.reason);
        assert!(!record.outcome.accomplished);
    }
}

#[test]
fn no_perch_begins_on_a_low_servo_battery_and_nothing_is_said_of_one_that_no_one_measures() {
    // In the air the idle servos draw it below its low voltage.
    let low = format!("servo_batt_div = 11\nservo_batt_low = {}", 6.815 * gain(1));
    let flight = |params: &str| {
        flown(&format!(
            "time_limit_s = 120\nsteps = [{{ do = 'arm' }}, {{ do = 'take-off' }}, {{ do = 'hover', seconds = 10 }}, \
             {{ do = 'fly-to-pipe' }}, {{ do = 'touch' }}, {{ do = 'perch' }}]\n\
             [vehicle]\nservo_charge_percent = 4\n[params]\n{params}\n"
        ))
    };
    let record = flight(&low);
    assert!(said(&record, LOW).is_some(), "{:?}", record.events);
    assert!(record.samples.iter().any(|s| s.mode == Mode::Flight));
    assert!(
        record
            .samples
            .iter()
            .all(|s| s.mode != Mode::Contact && s.mode != Mode::Clamping)
    );
    let record = flight("");
    assert!(
        record.samples.iter().any(|s| s.mode == Mode::Clamping),
        "{}",
        record.outcome.reason
    );
    assert_eq!((said(&record, LOW), said(&record, NEAR_END)), (None, None));
}

#[test]
fn arming_is_refused_with_an_empty_servo_battery_and_with_servos_that_have_no_marks() {
    for (setting, why) in [
        (
            "[vehicle]\nservo_charge_percent = 1\n[params]\nservo_batt_div = 11",
            LOW,
        ),
        ("[params]\nservo_marks = 123", "servo not calibrated"),
    ] {
        let record = flown(&format!(
            "time_limit_s = 20\nsteps = [{{ do = 'arm' }}, {{ do = 'disarm' }}]\n{setting}\n"
        ));
        assert!(said(&record, why).is_some(), "{:?}", record.events);
        assert!(record.samples.iter().all(|s| s.mode != Mode::Armed), "{why}");
    }
}
