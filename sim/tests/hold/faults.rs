//! Flow, range, poses and pipe position that fail at any moment of autonomous perching and departure.

mod sample;

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use sample::FaultSample;
use sophie_control::navigation::external_pose::PoseFault as Called;
use sophie_control::navigation::flow_range::FlowRangeFault;
use sophie_sim::sensors::flow::FlowFault;
use sophie_sim::sensors::pose::PoseFault;

use super::autonomous::mission;
use super::*;

/// Duration of the fault, s.
const FAILS: f64 = 8.0;
/// Largest lean, rad, and speed, m/s, in autonomous flight, and least height at any time, m. A vehicle that is held
/// level against a wrong wind estimate reaches this speed within the four seconds until the pilot flies.
const LEAN: f64 = 0.36;
const SPEED: f64 = 3.5;
const LOW: f64 = 0.6;

/// Part of a sound flight in which the fault begins.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// From the beginning of the approach until shortly before the touch.
    Approach,
    /// The last three seconds before it.
    Touch,
    /// From the touch until it is perched.
    Closing,
    /// While the arms open, and on the way up.
    Release,
}

const PARTS: [Part; 4] = [Part::Approach, Part::Touch, Part::Closing, Part::Release];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    Flow(FlowFault),
    Pose(PoseFault),
}

const FAULTS: [Fault; 20] = [
    Fault::Flow(FlowFault::Silent),
    Fault::Flow(FlowFault::Dark),
    Fault::Flow(FlowFault::Mirrored),
    Fault::Flow(FlowFault::Scaled),
    Fault::Flow(FlowFault::Frozen),
    Fault::Flow(FlowFault::Jumps),
    Fault::Flow(FlowFault::RangeSilent),
    Fault::Flow(FlowFault::RangeFrozen),
    Fault::Flow(FlowFault::RangeJumps),
    Fault::Flow(FlowFault::RangeLong),
    Fault::Flow(FlowFault::RangeShort),
    Fault::Pose(PoseFault::Silent),
    Fault::Pose(PoseFault::Frozen),
    Fault::Pose(PoseFault::Jumps),
    Fault::Pose(PoseFault::Mirrored),
    Fault::Pose(PoseFault::Scaled),
    Fault::Pose(PoseFault::Turned),
    Fault::Pose(PoseFault::TargetSilent),
    Fault::Pose(PoseFault::TargetJumps),
    Fault::Pose(PoseFault::TargetFar),
];

impl Fault {
    /// Text that the pilot reads, and the time within which it must appear if the vehicle still approaches, s; `None`
    /// for a wrong scale, found only after a climb or descent over one surface (docs/hold.md).
    fn named(self) -> Option<(&'static str, f64)> {
        let stale = Reason::PositionStale.text();
        let named = match self {
            Self::Flow(FlowFault::RangeLong | FlowFault::RangeShort) => return None,
            Self::Flow(FlowFault::Silent | FlowFault::Dark | FlowFault::RangeSilent) => (stale, 2.5),
            Self::Flow(FlowFault::Frozen) => (FlowRangeFault::FlowFrozen.text(), 1.0),
            Self::Flow(FlowFault::Mirrored | FlowFault::Scaled | FlowFault::Jumps) => {
                (FlowRangeFault::FlowDisagrees.text(), 6.0)
            }
            Self::Flow(FlowFault::RangeFrozen) => (FlowRangeFault::RangeFrozen.text(), 1.0),
            Self::Flow(FlowFault::RangeJumps) => (FlowRangeFault::RangeJumps.text(), 6.0),
            Self::Pose(PoseFault::Silent) => (stale, 2.5),
            Self::Pose(PoseFault::Frozen) => (Called::Frozen.text(), 1.0),
            Self::Pose(PoseFault::Jumps) => (Called::Jumps.text(), 1.0),
            Self::Pose(PoseFault::Mirrored | PoseFault::Scaled | PoseFault::Turned) => {
                (Called::Disagrees.text(), 6.0)
            }
            Self::Pose(PoseFault::TargetSilent) => (Reason::TargetStale.text(), 2.5),
            Self::Pose(PoseFault::TargetJumps) => (Reason::TargetJumps.text(), 1.0),
            Self::Pose(PoseFault::TargetFar) => (Reason::TargetFar.text(), 1.0),
        };
        Some(named)
    }

    fn sensor(self) -> PositionSensor {
        match self {
            Self::Flow(_) => PositionSensor::Flow,
            Self::Pose(_) => PositionSensor::Pose,
        }
    }
}

/// Begin and end of each part in a sound flight, s; `None` if that flight fails.
fn parts(seed: u64, sensor: PositionSensor) -> Option<[(f64, f64); 4]> {
    let sound = fly(&mission(seed, sensor, false), &mut Silent);
    if !sound.outcome.accomplished {
        println!("{seed} {sensor:?}: {}", sound.outcome.reason);
        return None;
    }
    let first = |mode: Mode| sound.samples.iter().find(|s| s.mode == mode).map(|s| s.t);
    let (begun, touched) = (first(Mode::Approach)?, first(Mode::Contact)?);
    let (perched, released) = (first(Mode::Perched)?, first(Mode::Releasing)?);
    let near = (touched - 3.0).max(begun);
    Some([
        (begun, near),
        (near, touched),
        (touched, perched),
        (released, released + 4.0),
    ])
}

/// Flies the mission of `seed` with `fault` from `at` s on; returns the violated requirement, if any.
fn flown(seed: u64, fault: Fault, part: Part, at: f64) -> Option<String> {
    let mut s = mission(seed, fault.sensor(), false);
    s.sensors.pose_fails_at = at;
    s.sensors.pose_fails_for = FAILS;
    match fault {
        Fault::Flow(fault) => s.sensors.flow_fault = fault,
        Fault::Pose(fault) => s.sensors.pose_fault = fault,
    }
    let record = fly(&s, &mut Silent);
    let why = &record.outcome.reason;
    let during = || record.samples.iter().filter(|s| s.t >= at && s.t < at + FAILS);
    let alone = |s: &&Sample| matches!(s.mode, Mode::Approach | Mode::Hold | Mode::Escaping);
    let most = |of: fn(&Sample) -> f64| during().filter(alone).map(of).fold(0.0, f64::max);
    let lean = most(|s| libm::hypot(s.attitude[0], s.attitude[1]));
    let speed = most(|s| DVec3::from_array(s.velocity).length());
    let low = during().map(|s| -s.position[2]).fold(f64::INFINITY, f64::min);
    let named = fault.named().and_then(|(text, _)| {
        let said = record.events.iter().find(|e| e.t >= at && e.text.ends_with(text));
        said.map(|e| e.t - at)
    });
    println!(
        "{seed} {fault:?} {part:?} at {at:.1} s: {why}; named after {named:.1?} s, {:.0} deg, {speed:.2} m/s, {low:.2} m",
        lean.to_degrees()
    );
    // The vehicle has perched and departed, or the pilot flies it.
    let departs = record.samples.iter().any(|s| s.t < at && s.mode == Mode::Perched);
    let ends_well = record.outcome.accomplished || (why.contains("handed back") && !departs);
    let bounded = lean < LEAN && speed < SPEED && low > LOW;
    let missed = fault.named().is_some_and(|(_, within)| {
        let owed = |s: &Sample| matches!(s.mode, Mode::Approach | Mode::Hold);
        let flies = during().take_while(|s| s.t < at + within).all(owed);
        let until = record.samples.last().is_some_and(|s| s.t >= at + within);
        flies && until && part == Part::Approach && named.is_none_or(|after| after > within)
    });
    (!ends_well || !bounded || missed).then(|| {
        format!("{seed} {fault:?} {part:?} at {at:.2} s: {why}, {named:?} {lean:.2} {speed:.2} {low:.2}")
    })
}

#[test]
fn a_fault_at_any_moment_is_named_and_harms_nothing() {
    let wrong = FaultSample::of(1, &[2], 12).judge();
    // Four of 1,400 did harm (docs/lab, source faults, draws 1 and 11 to 13): two of twelve come once in 1,800 samples.
    assert!(wrong.len() <= 1, "{wrong:#?}");
}

#[test]
#[ignore = "two hundred missions: .ci/campaign flies them, docs/hold.md has the results"]
fn a_fault_at_any_moment_is_named_and_harms_nothing_with_many_seeds() {
    let wrong = FaultSample::of(2, &[1, 2, 3, 4, 5, 6, 7, 8], 200).judge();
    println!("{} of 200: {wrong:#?}", wrong.len());
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "two hundred missions, or those of the variables: docs/hold.md has the results of several samples"]
fn sampled_faults_are_named_and_harm_nothing() {
    let sample = FaultSample::asked();
    let wrong = sample.judge();
    println!("{} of {}: {wrong:#?}", wrong.len(), sample.count);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Seeds in which the vertical estimate must not act alone: it pressed an arm onto the pipe by 1,600 to 4,000 N/m², or
/// delayed the return beyond 45 s.
#[test]
fn a_range_that_becomes_too_long_is_not_flown_by() {
    let long = Fault::Flow(FlowFault::RangeLong);
    let cases = [
        (4, Part::Approach, 27.267),
        (32, Part::Approach, 29.457),
        (15, Part::Release, 77.958),
        (27, Part::Release, 76.894),
        (23, Part::Release, 83.443),
        // At the gate, with a reading of 10 cm at 6 cm, and in another search.
        (30, Part::Touch, 59.257),
        (77, Part::Touch, 67.543),
        (39, Part::Touch, 58.411),
        (10, Part::Approach, 59.898),
        (344, Part::Touch, 58.092),
    ];
    let wrong: Vec<_> = cases
        .into_iter()
        .filter_map(|(seed, part, at)| flown(seed, long, part, at))
        .collect();
    // 5 of 48 sampled ones press an arm (docs/lab, pipe and ground): three of ten come once in 14 times.
    assert!(wrong.len() <= 2, "{wrong:#?}");
}

/// Seeds in which the vehicle must not turn with the heading of the poses: it touched across the pipe with 1,581 and
/// 1,761 N/m² on an arm, or followed for six seconds.
#[test]
fn a_heading_that_turns_is_not_flown_by() {
    let cases = [
        (1, Part::Touch, 25.329_789_777),
        (3, Part::Touch, 26.794_111_526),
        (7, Part::Approach, 28.317_039_866),
    ];
    let turned = Fault::Pose(PoseFault::Turned);
    let wrong: Vec<_> = cases
        .into_iter()
        .filter_map(|(seed, part, at)| flown(seed, turned, part, at))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// A fault before the lift-off must not enter the accelerometer bias: it pressed an arm onto the pipe, or the vehicle
/// drifted at 3.7 to 4.4 m/s.
#[test]
fn a_fault_before_the_lift_off_changes_no_bias() {
    let (jumps, mirrored) = (FlowFault::RangeJumps, FlowFault::Mirrored);
    let cases = [
        (2, jumps),
        (14, jumps),
        (4, mirrored),
        (12, mirrored),
        (18, mirrored),
    ];
    let wrong: Vec<_> = cases
        .into_iter()
        .filter_map(|(seed, fault)| {
            let [.., (released, off)] = parts(seed, PositionSensor::Flow)?;
            flown(seed, Fault::Flow(fault), Part::Release, 0.5 * (released + off))
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Seeds in which poses must not bend the estimated acceleration: the vehicle came within 0.06 and 0.04 m of the ground
/// before the pilot took over.
#[test]
fn poses_scaled_from_the_lift_off_on_sink_nothing() {
    let cases = [(22, 45.803_724_506_577_75), (38, 45.755_855_610_382_05)];
    let scaled = Fault::Pose(PoseFault::Scaled);
    let wrong: Vec<_> = cases
        .into_iter()
        .filter_map(|(seed, at)| flown(seed, scaled, Part::Release, at))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Every other one too long.
#[test]
#[ignore = "forty missions: .ci/campaign flies them"]
fn a_range_that_becomes_too_short_harms_nothing() {
    let of = |seed| Some((seed, parts(seed, PositionSensor::Flow)?));
    let known: Vec<_> = (1..=8).filter_map(of).collect();
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let mut wrong = vec![];
    for i in 0..40 {
        let fault = [FlowFault::RangeLong, FlowFault::RangeShort][i % 2];
        let (seed, times) = known[rng.random_range(0..known.len())];
        let part = i / 2 % PARTS.len();
        let (from, to) = times[part];
        let at = rng.random_range(from..=to);
        wrong.extend(flown(seed, Fault::Flow(fault), PARTS[part], at));
    }
    println!("{} of 40: {wrong:#?}", wrong.len());
    assert!(wrong.is_empty(), "{wrong:#?}");
}
