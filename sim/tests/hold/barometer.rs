//! Barometric height as the last source: range or poses end, the air pressure continues.

use sophie_control::mode::{Mode, Reason};
use sophie_control::navigation::baro_height::PressureFault;
use sophie_sim::flight::fly;
use sophie_sim::record::{FlightRecord, Sample, Silent};
use sophie_sim::scenario::{PositionSensor, Scenario, Step};
use sophie_sim::sensors::barometer::BarometerFault;

use super::{held, says, ways};

/// Begin of the source's failure, s, and its duration, s.
const AT: f64 = 22.0;
const FOR: f64 = 8.0;

/// Scenario of a hold of 20 s at 1.2 m by `position`, which is silent for 8 s in the middle.
fn alone(seed: u64, position: PositionSensor, barometer: bool) -> Scenario {
    let mut s = held(seed, 20.0);
    s.steps[1] = Step::TakeOff { height: 1.2 };
    s.sensors.position = position;
    s.sensors.barometer = barometer;
    (s.sensors.pose_fails_at, s.sensors.pose_fails_for) = (AT, FOR);
    s
}

/// Flies it; returns the record and the samples of the hold within `seconds` from the source's failure.
fn flown(s: &Scenario, seconds: f64) -> (FlightRecord, Vec<Sample>) {
    let record = fly(s, &mut Silent);
    let during = |s: &&Sample| (AT..AT + seconds).contains(&s.t);
    let samples: Vec<Sample> = record.samples.iter().filter(during).cloned().collect();
    (record, samples)
}

/// Duration of the hold after the source's failure, s, and the largest change of the height meanwhile, m.
fn kept(s: &Scenario) -> (f64, f64) {
    let (record, samples) = flown(s, FOR);
    let held: Vec<Sample> = samples.into_iter().take_while(|s| s.mode == Mode::Hold).collect();
    assert!(held.len() > 10 && says(&record, Reason::PositionStale));
    let [_, height] = ways(&held);
    (held.last().map_or(0.0, |s| s.t) - AT, height)
}

#[test]
fn with_a_barometer_the_height_lasts_where_range_or_poses_end() {
    for position in [PositionSensor::Flow, PositionSensor::Pose] {
        let (short, off) = kept(&alone(8, position, false));
        let (long, near) = kept(&alone(8, position, true));
        println!("{position:?}: without {off:.2} m in {short:.1} s, with {near:.2} m in {long:.1} s");
        assert!(
            (3.9..5.0).contains(&short) && long > 7.9,
            "{position:?} {short} {long}"
        );
        assert!(near < 0.6, "{position:?}: {near:.2} m");
    }
}

#[test]
#[ignore = "a hundred and sixty flights, a table of seeds 1 to 20: .ci/campaign flies them"]
fn how_far_the_height_goes_with_most_seeds() {
    println!("| source | barometer | held for | median | worst |\n|---|---|---:|---:|---:|");
    for position in [PositionSensor::Flow, PositionSensor::Pose] {
        for barometer in [false, true] {
            let found = (1..=20).filter_map(|seed| {
                let s = alone(seed, position, barometer);
                let (_, before) = flown(&s, 0.1);
                (before.first()?.mode == Mode::Hold).then(|| kept(&s))
            });
            let mut found: Vec<_> = found.collect();
            found.sort_by(|a, b| a.1.total_cmp(&b.1));
            let least = found.iter().map(|(held, _)| *held).fold(FOR, f64::min);
            let (median, worst) = (found[found.len() / 2].1, found.last().unwrap().1);
            println!(
                "| {position:?}, {} | {barometer} | {least:.1} s | {median:.2} m | {worst:.2} m |",
                found.len()
            );
        }
    }
}

#[test]
fn a_barometer_that_fails_with_the_poses_is_named_or_silent_and_harms_less_than_a_metre() {
    for (fault, named) in [
        (BarometerFault::Silent, None),
        (BarometerFault::Frozen, Some(PressureFault::Frozen)),
        (BarometerFault::Jumps, Some(PressureFault::Jumps)),
        (BarometerFault::Drifts, Some(PressureFault::Disagrees)),
    ] {
        let mut s = alone(8, PositionSensor::Pose, true);
        s.sensors.barometer_fault = fault;
        let (record, samples) = flown(&s, 4.0);
        let [_, height] = ways(&samples);
        let texts: Vec<&str> = record.events.iter().map(|e| e.text.as_str()).collect();
        println!("{fault:?}: {height:.2} m, {texts:?}");
        assert!(height < 1.0, "{fault:?}: {height:.2} m");
        // A second report may be the end of the fault: a drift that ends is a jump.
        let said = |text: &&str| PressureFault::ALL.into_iter().find(|f| text.ends_with(f.text()));
        let found = texts.iter().find_map(said);
        assert_eq!(found, named, "{fault:?}");
    }
}

#[test]
fn beside_poses_a_barometer_changes_nothing_of_a_flight() {
    let flown = |barometer| {
        let mut s = held(3, 6.0);
        s.sensors.barometer = barometer;
        fly(&s, &mut Silent)
    };
    let (with, without) = (flown(true), flown(false));
    assert!(with.outcome.accomplished, "{}", with.outcome.reason);
    let places = |r: &FlightRecord| r.samples.iter().map(|s| s.position).collect::<Vec<_>>();
    assert_eq!(places(&with), places(&without));
}
