//! A failed flight's reason names the quantity that ended it and its required value.

use sophie_control::mode::Reason;
use sophie_sim::flight::fly;
use sophie_sim::record::{Event, FlightRecord, Silent};
use sophie_sim::scenario::{Overrides, Scenario};

fn flown(text: &str, overrides: &Overrides) -> FlightRecord {
    fly(
        &Scenario::parse(text, "reasons.toml", overrides).unwrap(),
        &mut Silent,
    )
}

const HOP: &str = "steps = [{ do = 'arm' }, { do = 'take-off' }, { do = 'hover', seconds = 60 }, { do = 'land' }, { do = 'disarm' }]\n";

fn reason(text: &str) -> String {
    let record = flown(text, &Overrides::default());
    println!("{}", record.outcome.reason);
    assert!(!record.outcome.accomplished && !record.outcome.reason.contains('\n'));
    record.outcome.reason
}

#[test]
fn the_reason_for_a_weak_vehicle_is_its_thrust_to_weight() {
    // Arms bent by full thrust: 2 % less than 4 T / W.
    for (mass, thrust, ratio) in [(3.0, 7.7, "1.03"), (3.0, 7.5, "1.00"), (3.0, 7.0, "0.93")] {
        let line = reason(&format!(
            "{HOP}[vehicle]\nmass_kg = {mass}\nthrust_max_n = {thrust}\n"
        ));
        assert!(line.starts_with("take-off: "), "{line}");
        let row = format!("check: thrust to weight {ratio}, at least 1.3");
        assert!(
            line.contains(&row) && line.contains("check: hover throttle"),
            "{line}"
        );
    }
}

#[test]
fn the_reason_for_an_oscillating_vehicle_is_its_swings() {
    for params in [
        "attitude_p = 12\nrate_roll_p = 40\nrate_pitch_p = 40",
        "attitude_p = 12\nrate_pitch_p = 40",
    ] {
        // Each leaves the ground, where its feet shake it, within the pilot's patience.
        let line = reason(&format!("seed = 2\n{HOP}[params]\n{params}\n"));
        assert!(line.contains("swings by") && line.contains("deg/s"), "{line}");
    }
}

/// Gains with which pitch has a gain margin below 1 (`sophie check`).
#[test]
fn a_pitch_loop_that_swings_is_noticed_and_calmed_in_flight() {
    let text = format!("seed = 2\n{HOP}[params]\nattitude_p = 12\nrate_pitch_p = 25\n");
    let record = flown(&text, &Overrides::default());
    assert!(record.outcome.accomplished, "{}", record.outcome.reason);
    let said = |event: &Event| event.text.ends_with(Reason::Swings.text());
    let noticed = record
        .events
        .iter()
        .find(|event| said(event))
        .map(|event| event.t);
    let noticed = noticed.expect("the swing is named");
    let rms = |from: f64, to: f64| {
        let rates = record.samples.iter().filter(|s| (from..to).contains(&s.t));
        let rates: Vec<f64> = rates.map(|s| s.rate[1].to_degrees()).collect();
        (rates.iter().map(|r| r * r).sum::<f64>() / rates.len() as f64).sqrt()
    };
    let (before, after) = (rms(noticed - 1.0, noticed), rms(noticed + 5.0, noticed + 25.0));
    println!("{before} {after}");
    assert!(before > 50.0 && after < 0.2 * before, "{before} {after}");
}

#[test]
fn a_failure_without_oscillation_names_no_swings() {
    let line = reason(&format!("{HOP}[vehicle]\nbattery_charge_percent = 8\n"));
    assert!(
        !line.contains("swings") && !line.contains("thrust to weight"),
        "{line}"
    );
}

#[test]
fn the_reason_for_a_weak_grip_names_the_force_needed() {
    let line = reason("[vehicle]\nservo = 'mg996r'\ninfill = 10\n");
    assert!(line.contains("force limit reached without grip"), "{line}");
    for words in ["of 950 N/m2", "N needed", "52.2 N"] {
        assert!(line.contains(words), "{words} is missing in: {line}");
    }
}
#[test]
fn the_stack_stays_below_its_own_force_limit() {
    for diameter in [0.2, 0.18, 0.25] {
        for seed in 1..=4 {
            let overrides = Overrides {
                infill: Some(10.0),
                seed: Some(seed),
                ..Default::default()
            };
            let record = flown(&format!("[world]\npipe_diameter_m = {diameter}\n"), &overrides);
            let most = record.samples.iter().flat_map(|s| s.tension).fold(0.0, f64::max);
            let asked = record
                .samples
                .iter()
                .flat_map(|s| s.tension_asked)
                .fold(0.0, f64::max);
            println!(
                "{diameter} m, seed {seed}: {most:.3} N of {asked:.3} asked; {}",
                record.outcome.reason
            );
            assert!(
                !record.outcome.reason.contains("tendon"),
                "{}",
                record.outcome.reason
            );
        }
    }
}
