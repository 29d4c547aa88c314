//! Flights without radio or with an empty battery: descent, touchdown, on the perch.

use std::path::Path;

use sophie_control::mode::Mode;
use sophie_sim::flight::fly;
use sophie_sim::record::{FlightRecord, Sample, Silent};
use sophie_sim::scenario::{Overrides, Scenario};

/// Height of the centre of mass on the ground, m.
const STANDS: f64 = 0.05;

const CRASH: f64 = 2.0;

/// Seeds 1, 3 and 4: with 2 the touch is escaped from, with the radio on as off.
fn flights(file: &str, look: impl Fn(&FlightRecord)) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../tests/scenarios")
        .join(file);
    for seed in [1, 3, 4] {
        let overrides = Overrides {
            seed: Some(seed),
            ..Overrides::default()
        };
        let scenario = Scenario::load(&path, &overrides).unwrap();
        let record = fly(&scenario, &mut Silent);
        println!("{file}, seed {seed}: {}", record.outcome.reason);
        assert_eq!(record.outcome.accomplished, scenario.expect.accomplished);
        let words = scenario.expect.reason.as_deref().unwrap_or_default();
        assert!(record.outcome.reason.contains(words));
        assert_eq!(record.overruns, 0);
        look(&record);
    }
}

fn times(record: &FlightRecord, name: &str) -> (f64, f64) {
    let phase = record.phases.iter().find(|p| p.name == name).unwrap();
    (phase.start, phase.end)
}

fn modes(record: &FlightRecord, from: f64) -> Vec<Mode> {
    let mut modes: Vec<Mode> = after(record, from).map(|s| s.mode).collect();
    modes.dedup();
    modes
}

fn after(record: &FlightRecord, from: f64) -> impl Iterator<Item = &Sample> {
    record.samples.iter().filter(move |s| s.t >= from)
}

/// Requires a failsafe descent: level, no crash, rotors stop only on the ground.
fn sinks_and_stands(record: &FlightRecord) {
    let sinking: Vec<&Sample> = record
        .samples
        .iter()
        .filter(|s| s.mode == Mode::Failsafe)
        .collect();
    let worst = |f: fn(&Sample) -> f64| sinking.iter().map(|s| f(s)).fold(0.0, f64::max);
    let (lean, sink) = (
        worst(|s| s.attitude[0].abs().max(s.attitude[1].abs())),
        worst(|s| s.velocity[2]),
    );
    println!("  lean {:.1} deg, sink {sink:.2} m/s", lean.to_degrees());
    assert!(lean < 5f64.to_radians() && sink < CRASH, "{lean} rad, {sink} m/s");
    let end = sinking.last().unwrap();
    assert!(end.position[2] > -STANDS, "stopped {} m up", -end.position[2]);
    let last = record.samples.last().unwrap();
    assert!(last.mode == Mode::Disarmed && last.position[2] > -STANDS);
    assert!(libm::hypot(last.attitude[0], last.attitude[1]) < 3f64.to_radians());
    assert!(last.thrust.iter().all(|t| *t < 0.2), "{:?}", last.thrust);
}

#[test]
fn a_radio_lost_for_good_in_hover_ends_on_the_ground() {
    flights("radio-lost.toml", |record| {
        let (off, back) = times(record, "radio-off");
        assert_eq!(modes(record, off), [Mode::Flight, Mode::Failsafe, Mode::Disarmed]);
        let failsafe = after(record, off).find(|s| s.mode == Mode::Failsafe).unwrap();
        assert!(
            (0.49..0.53).contains(&(failsafe.t - off)),
            "{} s",
            failsafe.t - off
        );
        let down = after(record, off).find(|s| s.mode == Mode::Disarmed).unwrap();
        assert!(
            down.t < off + 10.0 && back > off + 30.0,
            "{} s, {back} s",
            down.t - off
        );
        sinks_and_stands(record);
    });
}

#[test]
fn a_gap_of_0_8_s_is_flown_on_from_without_the_pilot_moving_a_stick() {
    flights("radio-gap.toml", |record| {
        let (off, _) = times(record, "radio-off");
        assert_eq!(
            modes(record, off),
            [
                Mode::Flight,
                Mode::Failsafe,
                Mode::Flight,
                Mode::Landed,
                Mode::Disarmed
            ]
        );
        let gap = after(record, off).filter(|s| s.mode == Mode::Failsafe).count();
        assert!((25..35).contains(&gap), "{gap} samples of 10 ms");
        let lowest = after(record, off)
            .take_while(|s| s.t < off + 3.0)
            .map(|s| -s.position[2])
            .fold(f64::MAX, f64::min);
        assert!(lowest > 2.3, "sank to {lowest} m");
    });
}

#[test]
fn a_sinking_vehicle_is_taken_back_with_the_roll_stick() {
    flights("radio-taken-back.toml", |record| {
        let (off, back) = times(record, "radio-off");
        let taken = after(record, back).find(|s| s.mode == Mode::Flight).unwrap();
        // Not resumed in the 0.5 s with frames before the step ended.
        assert!((0.0..0.5).contains(&(taken.t - back)), "{} s", taken.t - back);
        assert!(taken.t - off > 2.5 && taken.position[2] < -1.5);
        assert!(after(record, off).all(|s| s.attitude[0].abs() < 25f64.to_radians()));
    });
}

#[test]
fn a_radio_lost_while_the_arms_close_does_not_stop_them() {
    flights("radio-lost-clamping.toml", |record| {
        let (off, back) = times(record, "radio-off");
        let (_, held) = times(record, "hold");
        assert!(after(record, off).next().unwrap().mode == Mode::Clamping);
        let perched = after(record, off).find(|s| s.mode == Mode::Perched).unwrap();
        assert!(perched.t < back - 1.0, "without the pilot");
        for s in after(record, perched.t + 3.0).take_while(|s| s.t < held) {
            assert_eq!(s.mode, Mode::Perched, "{} s", s.t);
        }
        assert_eq!(record.grip.len(), 4);
    });
}

#[test]
fn a_radio_lost_on_the_perch_changes_nothing_there() {
    flights("radio-lost-perched.toml", |record| {
        let (off, back) = times(record, "radio-off");
        let silent: Vec<&Sample> = after(record, off).take_while(|s| s.t < back).collect();
        assert!(silent.len() > 790 && silent.iter().all(|s| s.mode == Mode::Perched));
        let place = silent[0].position;
        for s in silent {
            assert!(s.thrust.iter().all(|t| *t < 0.05), "a rotor turns at {} s", s.t);
            assert!(
                s.pressure.iter().all(|p| (800.0..1100.0).contains(p)),
                "{:?}",
                s.pressure
            );
            let slip = (0..3)
                .map(|i| (s.position[i] - place[i]).abs())
                .fold(0.0, f64::max);
            assert!(slip < 0.01, "slipped {slip} m");
        }
        let lost = record.events.iter().find(|e| e.text == "radio lost").unwrap();
        assert!((0.45..0.6).contains(&(lost.t - off)));
    });
}

#[test]
fn an_empty_battery_ends_on_the_ground_before_the_voltage_collapses() {
    flights("battery-empty.toml", |record| {
        sinks_and_stands(record);
        let critical = f64::from(record.scenario.params.battery_critical);
        let first = after(record, 0.0).find(|s| s.mode == Mode::Failsafe).unwrap();
        assert!(
            (critical - 0.2..critical + 0.1).contains(&first.battery_voltage),
            "{} V",
            first.battery_voltage
        );
        let last = record.samples.last().unwrap();
        let drift = libm::hypot(
            last.position[0] - first.position[0],
            last.position[1] - first.position[1],
        );
        assert!(drift < 0.5, "{drift} m");
    });
}

#[test]
fn a_failsafe_sinks_from_high_up_as_slowly_as_from_low_down() {
    for height in [3, 10] {
        for seed in 1..=5 {
            let text = format!(
                // Far from the pipe, onto which a vehicle of 10 m may drift.
                "seed = {seed}\nsteps = [{{ do = 'arm' }}, {{ do = 'take-off', height_m = {height} }}, \
                 {{ do = 'radio-off', seconds = 60 }}, {{ do = 'disarm' }}]\n[world]\npipe_north_m = 8.0"
            );
            let scenario = Scenario::parse(&text, "high", &Overrides::default()).unwrap();
            let record = fly(&scenario, &mut Silent);
            let sinking = record.samples.iter().filter(|s| s.mode == Mode::Failsafe);
            let sink = sinking.map(|s| s.velocity[2]).fold(0.0, f64::max);
            println!(
                "{height} m, seed {seed}: {sink:.2} m/s, {}",
                record.outcome.reason
            );
            assert!(
                (0.4..1.2).contains(&sink),
                "{sink} m/s from {height} m with seed {seed}"
            );
        }
    }
}
