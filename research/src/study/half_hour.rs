//! Half an hour on the pipe, flown in full and in the minute that the rule of holding gives it
//! ([`sophie_sim::scenario::LAPSE_TIME`]): line and skin that creep, sensors that drift, servos that warm up.

use sophie_control::allocation::wrench::PerArm;
use sophie_sim::flight;
use sophie_sim::record::{Sample, Silent};
use sophie_sim::scenario::draw::{self, Value};
use sophie_sim::scenario::{LAPSE_TIME, Rule, Scenario, Step, keys};
use sophie_sim::streams::Streams;

/// Half an hour, s.
const HALF_HOUR: f64 = 1800.0;
/// Capacity of the servo battery, A·s: 5 Ah, twice what the time takes.
const CAPACITY: f64 = 18_000.0;
/// Keys of the processes that take minutes and of what drives them; the other numbers are the default mission's.
const SLOW: [&str; 6] = [
    "world.temperature_c",
    "vehicle.arm_relaxation_percent",
    "vehicle.tendon_creep_percent",
    "vehicle.servo_heat_k",
    "sensors.fsr_drift_percent",
    "sensors.fsr_temperature_percent_k",
];

/// How the half-hour passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Each millisecond of it.
    Full,
    /// Within a minute, the slow processes as many times as fast.
    Lapse,
}

/// The end of the time on the pipe.
#[derive(Clone, Debug)]
pub struct Hung {
    /// The mission was accomplished by the rule of holding.
    pub accomplished: bool,
    /// Why it ended.
    pub reason: String,
    /// True pressure at each sensor, Pa.
    pub pressure: PerArm<f64>,
    /// True tension of each tendon, N.
    pub tension: PerArm<f64>,
    /// Pressure at each sensor when the time began, Pa.
    pub before: PerArm<f64>,
}

/// The default mission of `seed` with slow processes as drawn for it and half an hour on the pipe.
fn mission(seed: u64, pace: Pace) -> Scenario {
    let mut scenario = Scenario {
        seed,
        judge: Rule::Holding,
        ..Scenario::default_mission()
    };
    for drawn in draw::draw(Streams::new(seed)) {
        if let (true, Value::Numbers(numbers)) = (SLOW.contains(&drawn.key), &drawn.value) {
            keys::set(&mut scenario, drawn.key, numbers);
        }
    }
    for step in &mut scenario.steps {
        if let Step::Hold { seconds, lapse, .. } = step {
            match pace {
                // The rule pushes at the end of a lapse: its last minute passes once as fast.
                Pace::Full => (*seconds, *lapse) = (*seconds + HALF_HOUR - LAPSE_TIME, LAPSE_TIME),
                Pace::Lapse => *lapse = HALF_HOUR,
            }
        }
    }
    scenario.time_limit += HALF_HOUR;
    // The minute leaves the batteries out, and the default one of the servos is empty within a quarter of an hour.
    scenario.vehicle.servo_capacity = CAPACITY;
    scenario
}

/// Flies `seed` at `pace`; `None` if it does not hang on the pipe.
#[must_use]
pub fn fly(seed: u64, pace: Pace) -> Option<Hung> {
    let record = flight::fly(&mission(seed, pace), &mut Silent);
    let hold = record.phases.iter().find(|phase| phase.name == "hold")?;
    let within = |sample: &&Sample| (hold.start..hold.end).contains(&sample.t);
    let begin = record.samples.iter().find(within)?;
    let end = record.samples.iter().rev().find(within)?;
    Some(Hung {
        accomplished: record.outcome.accomplished,
        reason: record.outcome.reason.clone(),
        pressure: end.pressure,
        tension: end.tension,
        before: begin.pressure,
    })
}
