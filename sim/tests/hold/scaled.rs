//! A range with a scale of 1.6 or 0.6: the stack names it in a climb, and never a sound range.

use sophie_control::navigation::flow_range::FlowRangeFault;
use sophie_sim::sensors::flow::FlowFault;

use super::autonomous::{campaign, mission};
use super::flow::by_flow;
use super::*;

const FAULTS: [FlowFault; 2] = [FlowFault::RangeLong, FlowFault::RangeShort];
/// Begin of the fault in flight, and its duration, s.
const AT: f64 = 20.0;
const FOR: f64 = 30.0;

/// Time at which it was named, s; `None` if never.
fn named(record: &FlightRecord) -> Option<f64> {
    let text = FlowRangeFault::RangeScaled.text();
    record.events.iter().find(|e| e.text.ends_with(text)).map(|e| e.t)
}

/// Scenario: hold at 1 m, then half a metre higher 3.6 m away.
fn climbs(seed: u64) -> Scenario {
    let mut s = by_flow(seed, 10.0);
    let up = Step::FlyTo {
        north: -2.0,
        east: -3.0,
        height: 1.5,
    };
    s.steps.insert(3, up);
    s
}

fn fails(mut s: Scenario, fault: FlowFault, at: f64, seconds: f64) -> FlightRecord {
    s.sensors.flow_fault = fault;
    (s.sensors.pose_fails_at, s.sensors.pose_fails_for) = (at, seconds);
    fly(&s, &mut Silent)
}

/// A range scaled since power-up is found in the take-off and gives no hold.
fn since_power_up(seed: u64) -> Result<f64, String> {
    let mut last = 0.0f64;
    for fault in FAULTS {
        let record = fails(by_flow(seed, 5.0), fault, 0.0, 999.0);
        let flies = record
            .samples
            .iter()
            .find(|s| s.mode == Mode::Flight)
            .map_or(0.0, |s| s.t);
        let after = named(&record).ok_or(format!("{seed} {fault:?}: not named"))?;
        if let Some(held) = record.samples.iter().find(|s| s.mode == Mode::Hold) {
            return Err(format!("{seed} {fault:?}: held at {:.1} s", held.t));
        }
        last = last.max(after - flies);
    }
    Ok(last)
}

#[test]
fn a_range_scaled_since_power_up_is_named_in_the_take_off_and_gives_no_hold() {
    for seed in 1..=2 {
        let after = since_power_up(seed).unwrap();
        assert!(after < 6.0, "{after:.1}");
    }
}

#[test]
#[ignore = "120 flights: .ci/campaign flies them, docs/hold.md has the results"]
fn a_scaled_range_is_named_in_a_climb_with_every_seed() {
    let seeds: Vec<u64> = (1..=20).collect();
    let flights = sophie_sim::parallel::each(&seeds, |&seed| {
        let climbed = FAULTS.map(|fault| {
            let record = fails(climbs(seed), fault, AT, FOR);
            (named(&record).map(|t| t - AT), never_held(seed, &record))
        });
        (
            climbed,
            named(&fails(by_flow(seed, 30.0), FAULTS[0], AT, FOR)),
            since_power_up(seed),
        )
    });
    let mut wrong = vec![];
    for ((climbed, held, power_up), seed) in flights.into_iter().zip(seeds) {
        println!(
            "{seed}: climbing {climbed:.1?}, held too long at {held:.1?}, since power-up {power_up:.1?}"
        );
        let missed = |(named, never): (Option<f64>, bool)| !never && named.is_none_or(|t| t > 18.0);
        if climbed.into_iter().any(missed) || power_up.is_err() {
            wrong.push(seed);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
#[ignore = "some 250 flights: .ci/campaign flies them"]
fn a_sound_range_is_never_called_scaled() {
    let by_hand = |seed| {
        let mut s = Scenario::default_mission();
        s.seed = seed;
        s.sensors.position = PositionSensor::Flow;
        s
    };
    type Kind = (&'static str, fn(u64) -> Scenario);
    let kinds: [Kind; 4] = [
        ("held", |seed| by_flow(seed, 60.0)),
        ("climbing", climbs),
        ("autonomous", |seed| mission(seed, PositionSensor::Flow, false)),
        ("by hand", by_hand),
    ];
    let seeds = campaign();
    let mut blamed = vec![];
    for (name, scenario) in kinds {
        let found = sophie_sim::parallel::each(&seeds, |&seed| named(&fly(&scenario(seed), &mut Silent)));
        let found = found
            .into_iter()
            .zip(&seeds)
            .filter_map(|(t, seed)| Some((name, *seed, t?)));
        blamed.extend(found);
    }
    assert!(blamed.is_empty(), "{blamed:.1?}");
}
