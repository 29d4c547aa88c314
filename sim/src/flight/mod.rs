//! Flies a scenario: world, board, tasks and pilot in lockstep under virtual time.

pub mod aircraft;
mod judge;
mod recorder;
pub mod stack;
mod why;

use std::time::Instant as WallInstant;

use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use sophie_control::params::RcProtocol;

use self::aircraft::Aircraft;
use self::judge::Judge;
use self::recorder::{Ending, Recorder};
use self::stack::Stack;
use crate::pilot::{Pilot, PilotOutput, Seen};
use crate::plant::Plant;
use crate::record::{FlightRecord, Observer, Outcome};
use crate::sbus::Receiver;
use crate::scenario::{Scenario, Step};

/// Milliseconds between two calls of [`Observer::progress`].
const PROGRESS_MS: u64 = 250;
const TELEMETRY_BYTES: usize = 256;

struct Snapshot<'a, A> {
    /// Since power-up, ms.
    ms: u64,
    /// The pilot's step and its index.
    step: Option<(usize, &'a Step)>,
    plant: &'a Plant,
    stack: &'a A,
}

impl<A> Snapshot<'_, A> {
    /// Time since power-up, s.
    fn t(&self) -> f64 {
        self.ms as f64 * 1e-3
    }
}

/// Flies `scenario` in virtual time with `observer` attached.
///
/// Scenario and seed determine the record to the bit, whatever other threads do, except [`FlightRecord::wall_seconds`].
pub fn fly(scenario: &Scenario, observer: &mut dyn Observer) -> FlightRecord {
    fly_with(scenario, |seeds| Stack::new(scenario, seeds), observer).0
}

/// Flies `scenario` with the aircraft made by `make`; returns record and aircraft.
///
/// `make` gets the random numbers of the aircraft's parts: drawn as [`crate::board::Board::configured`] does, they give
/// the same parts.
pub fn fly_with<A: Aircraft>(
    scenario: &Scenario,
    make: impl FnOnce(&mut Pcg64Mcg) -> A,
    observer: &mut dyn Observer,
) -> (FlightRecord, A) {
    let wall = WallInstant::now();
    let mut seeds = Pcg64Mcg::seed_from_u64(scenario.seed);
    let mut plant = Plant::new(scenario, Pcg64Mcg::from_rng(&mut seeds));
    let mut stack = make(&mut seeds);
    let mut pilot = Pilot::new(scenario, Pcg64Mcg::from_rng(&mut seeds));
    let mut recorder = Recorder::new(scenario);
    let mut judge = Judge::new(scenario);
    let mut telemetry = [0u8; TELEMETRY_BYTES];
    let mut uplink = Uplink::new(scenario);

    let limit_ms = (scenario.time_limit * 1e3) as u64;
    let mut outcome = Outcome {
        accomplished: false,
        reason: format!("time limit of {:.0} s reached", scenario.time_limit),
    };
    let mut began = (usize::MAX, 0.0);
    let mut ms = 0;
    while ms < limit_ms {
        ms += 1;
        let t = ms as f64 * 1e-3;
        stack.step_world(&mut plant);
        let received = stack.take_telemetry(&mut telemetry);
        if !uplink.answers()
            && let Some(said) = stack.status()
        {
            pilot.hear(said.mode, said.reason);
        }
        let output = pilot.step(1e-3, seen(&plant, t), &telemetry[..received]);
        uplink.send(&output, &mut stack);
        if let Err(why) = stack.run_until(ms * 1000) {
            outcome.reason = format!("{why} (at {t:.1} s)");
            break;
        }

        let step = scenario.steps.get(output.step).map(|s| (output.step, s));
        if output.step != began.0 {
            began = (output.step, t);
        }
        let judged = judge.step(&Snapshot {
            ms,
            step,
            plant: &plant,
            stack: &stack,
        });
        plant.push = push(step, t - began.1);
        reset(step, began, ms, &mut stack);
        let now = Snapshot {
            ms,
            step,
            plant: &plant,
            stack: &stack,
        };
        recorder.step(&now, pilot.throttle(), observer);
        if ms.is_multiple_of(PROGRESS_MS) {
            observer.progress(t, stack.mode(), -plant.pose().position.z);
        }
        if let Some(reason) = judged {
            outcome.reason = format!("{reason} (at {t:.1} s)");
            break;
        }
        if let Some(end) = output.outcome {
            outcome = end;
            break;
        }
    }
    if !outcome.accomplished {
        let step = scenario.steps.get(began.0);
        outcome.reason += &why::detail(scenario, step, recorder.samples(), &outcome.reason);
    }
    let ending = Ending {
        outcome,
        t: ms as f64 * 1e-3,
        wall_seconds: wall.elapsed().as_secs_f64(),
    };
    let record = recorder.finish(scenario, &stack, ending, observer);
    (record, stack)
}

enum Uplink {
    Crsf,
    Sbus(Receiver),
}

impl Uplink {
    fn new(scenario: &Scenario) -> Self {
        match scenario.params.rc_protocol {
            RcProtocol::Crsf => Self::Crsf,
            RcProtocol::Sbus => Self::Sbus(Receiver::default()),
        }
    }

    /// Whether telemetry exists; without it the pilot reads the vehicle's log instead of his display.
    fn answers(&self) -> bool {
        matches!(self, Self::Crsf)
    }

    fn send(&mut self, output: &PilotOutput, stack: &mut impl Aircraft) {
        match self {
            Self::Crsf => {
                if let Some(frame) = &output.rc_bytes {
                    stack.receive(frame);
                }
            }
            Self::Sbus(receiver) => {
                if let Some(frame) = receiver.step(1e-3, output.channels) {
                    stack.receive(&frame);
                }
            }
        }
    }
}

fn seen(plant: &Plant, t: f64) -> Seen {
    let pose = plant.pose();
    let [roll, pitch, yaw] = plant.euler();
    Seen {
        t,
        position: pose.position,
        velocity: pose.velocity,
        roll,
        pitch,
        yaw,
    }
}

/// Sideways push: middle third of the hold, or during a reset.
fn push(step: Option<(usize, &Step)>, step_time: f64) -> DVec3 {
    match step {
        Some((_, Step::Hold { seconds, push }))
            if (seconds / 3.0..2.0 * seconds / 3.0).contains(&step_time) =>
        {
            DVec3::new(0.0, *push, 0.0)
        }
        Some((_, Step::Reset { push, .. })) => DVec3::new(0.0, *push, 0.0),
        _ => DVec3::ZERO,
    }
}

/// Performs the reset of a step that has one, once.
fn reset(step: Option<(usize, &Step)>, (index, begun): (usize, f64), ms: u64, stack: &mut impl Aircraft) {
    let Some((
        _,
        Step::Reset {
            cause, after, off, ..
        },
    )) = step
    else {
        return;
    };
    let t = ms as f64 * 1e-3;
    let done = stack.reset().filter(|r| r.step == index);
    match done {
        None if t - begun >= *after => stack.cut(*cause, index, t),
        Some(reset) if !stack.runs() && t - reset.at >= *off => stack.start(ms * 1000),
        _ => {}
    }
}
