//! Flies a scenario: world, board, tasks and pilot in lockstep under virtual time.

pub mod aircraft;
mod failure_detail;
mod judge;
pub mod live;
mod recorder;
pub mod stack;
mod strikes;

use std::time::Instant as WallInstant;

use glam::DVec3;
use sophie_control::params::RcProtocol;

use self::aircraft::Aircraft;
use self::judge::Judge;
use self::recorder::{Ending, Recorder};
use self::stack::Stack;
use crate::devices::sbus::Receiver;
use crate::pilot::{Pilot, PilotOutput, VisibleState};
use crate::plant::Plant;
use crate::record::{Ended, FlightRecord, Observer, Outcome};
use crate::scenario::{LAPSE_TIME, Scenario, Step};

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
    /// The last millisecond of a hold's time on the pipe.
    lapse_ends: bool,
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
    fly_with(scenario, || Stack::new(scenario), observer).0
}

/// Flies `scenario` with the aircraft made by `make`; returns record and aircraft.
pub fn fly_with<A: Aircraft>(
    scenario: &Scenario,
    make: impl FnOnce() -> A,
    observer: &mut dyn Observer,
) -> (FlightRecord, A) {
    let mut world = World::new(scenario, make);
    let record = world.fly(scenario, observer);
    (record, world.stack)
}

/// Runs the vehicle of `scenario` on the ground without a transmitter until `over` returns true; `make` as in
/// [`fly_with`]. Returns the aircraft.
///
/// # Errors
/// One line: why the aircraft cannot run on.
pub fn stand_with<A: Aircraft>(
    scenario: &Scenario,
    make: impl FnOnce() -> A,
    mut over: impl FnMut(&A) -> bool,
) -> Result<A, String> {
    let mut world = World::new(scenario, make);
    while !over(&world.stack) {
        world.step(false)?;
    }
    Ok(world.stack)
}

/// Plant, aircraft and pilot in lockstep, a millisecond at a time.
pub(crate) struct World<A> {
    plant: Plant,
    pub(crate) stack: A,
    pilot: Pilot,
    uplink: Uplink,
    /// Since power-up, ms.
    ms: u64,
}

impl<A: Aircraft> World<A> {
    /// A world before power-up. `make` as in [`fly_with`].
    pub(crate) fn new(scenario: &Scenario, make: impl FnOnce() -> A) -> Self {
        Self {
            plant: scenario.plant(),
            stack: make(),
            pilot: Pilot::new(scenario),
            uplink: Uplink::new(scenario),
            ms: 0,
        }
    }

    /// Steps by a millisecond. Without `transmitter` the pilot's sticks and display are cut off.
    ///
    /// # Errors
    /// One line: why the aircraft cannot run on.
    pub(crate) fn step(&mut self, transmitter: bool) -> Result<PilotOutput, String> {
        self.ms += 1;
        let mut telemetry = [0u8; TELEMETRY_BYTES];
        let mut output = PilotOutput::default();
        self.stack.step_world(&mut self.plant);
        let received = self.stack.take_telemetry(&mut telemetry);
        if transmitter {
            if !self.uplink.answers()
                && let Some(said) = self.stack.status()
            {
                self.pilot.hear(said.mode, said.reason);
            }
            let seen = seen(&self.plant, self.ms as f64 * 1e-3);
            output = self.pilot.step(1e-3, seen, &telemetry[..received]);
            self.uplink.send(&output, &mut self.stack);
        }
        let ran = self.stack.run_until(self.ms * 1000);
        ran.map(|()| output)
    }

    /// Flies the steps of `scenario`.
    pub(crate) fn fly(&mut self, scenario: &Scenario, observer: &mut dyn Observer) -> FlightRecord {
        let wall = WallInstant::now();
        let mut recorder = Recorder::new(scenario);
        let mut judge = Judge::new(scenario);
        let limit_ms = (scenario.time_limit * 1e3) as u64;
        let mut outcome = Outcome {
            accomplished: false,
            ended: Ended::TimeLimit,
            reason: format!("time limit of {:.0} s reached", scenario.time_limit),
        };
        let mut began = (usize::MAX, 0.0);
        while self.ms < limit_ms {
            let stepped = self.step(true);
            let (ms, t) = (self.ms, self.ms as f64 * 1e-3);
            let output = match stepped {
                Ok(output) => output,
                Err(why) => {
                    outcome.ended = Ended::Stopped;
                    outcome.reason = format!("{why} (at {t:.1} s)");
                    break;
                }
            };
            let step = scenario.steps.get(output.step).map(|s| (output.step, s));
            if output.step != began.0 {
                began = (output.step, t);
            }
            let step_time = t - began.1;
            let judged = judge.step(&self.snapshot(step, step_time));
            self.plant.push = push(step, step_time);
            self.plant.hasten(lapse(step, step_time));
            reset(step, began, ms, &mut self.stack);
            recorder.step(&self.snapshot(step, step_time), self.pilot.throttle(), observer);
            if ms.is_multiple_of(PROGRESS_MS) {
                observer.progress(t, self.stack.mode(), -self.plant.pose().position.z);
            }
            if let Some(reason) = judged {
                outcome.ended = Ended::Judged;
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
            outcome.reason += &failure_detail::detail(scenario, step, recorder.samples(), &outcome.reason);
        }
        let ending = Ending {
            outcome,
            verdicts: judge.verdicts(),
            t: self.ms as f64 * 1e-3,
            wall_seconds: wall.elapsed().as_secs_f64(),
        };
        recorder.finish(scenario, &self.stack, ending, observer)
    }

    /// Ends the mission's effects on the vehicle: no push, and a board that was off starts.
    pub(crate) fn leave_alone(&mut self) {
        self.plant.push = DVec3::ZERO;
        if !self.stack.runs() {
            self.stack.start(self.ms * 1000);
        }
    }

    /// False once the simulation has diverged.
    pub(crate) fn is_finite(&self) -> bool {
        let pose = self.plant.pose();
        pose.position.is_finite() && pose.omega.is_finite()
    }

    fn snapshot<'a>(&'a self, step: Option<(usize, &'a Step)>, step_time: f64) -> Snapshot<'a, A> {
        Snapshot {
            ms: self.ms,
            step,
            plant: &self.plant,
            stack: &self.stack,
            lapse_ends: lapse_ends(step, step_time),
        }
    }
}

enum Uplink {
    Crsf,
    Sbus(Receiver),
}

impl Uplink {
    fn new(scenario: &Scenario) -> Self {
        match scenario.params.rc_protocol {
            RcProtocol::Crsf => Self::Crsf,
            RcProtocol::Sbus => Self::Sbus(Receiver::new(scenario.sensors.sbus_slots as usize)),
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
                let bytes = receiver.step(1e-3, output.channels);
                if !bytes.is_empty() {
                    stack.receive(&bytes);
                }
            }
        }
    }
}

fn seen(plant: &Plant, t: f64) -> VisibleState {
    let pose = plant.pose();
    let [roll, pitch, yaw] = plant.euler();
    VisibleState {
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
        Some((_, Step::Hold { seconds, push, .. }))
            if (seconds / 3.0..2.0 * seconds / 3.0).contains(&step_time) =>
        {
            DVec3::new(0.0, *push, 0.0)
        }
        Some((_, Step::Reset { push, .. })) => DVec3::new(0.0, *push, 0.0),
        _ => DVec3::ZERO,
    }
}

/// How many times as fast as the motion slow processes run: a hold's lapse within [`LAPSE_TIME`] after it.
fn lapse(step: Option<(usize, &Step)>, step_time: f64) -> f64 {
    match step {
        Some((_, Step::Hold { seconds, lapse, .. }))
            if *lapse > 0.0 && (*seconds..seconds + LAPSE_TIME).contains(&step_time) =>
        {
            (lapse / LAPSE_TIME).max(1.0)
        }
        _ => 1.0,
    }
}

/// The last two milliseconds of a hold with a lapse.
fn lapse_ends(step: Option<(usize, &Step)>, step_time: f64) -> bool {
    let Some((_, Step::Hold { seconds, lapse, .. })) = step else {
        return false;
    };
    *lapse > 0.0 && step_time >= Step::hold_time(*seconds, *lapse) - 2e-3
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Belly pads of the default mission, perched and clamped: mean of their sum, N, and least of a side's, N, before the
    /// push and under it.
    #[test]
    fn the_belly_presses_with_most_of_the_weight_and_a_push_lifts_no_side() {
        for seed in [1, 2, 3] {
            let mut scenario = Scenario::default_mission();
            scenario.seed = seed;
            let mut world = World::new(&scenario, || Stack::new(&scenario));
            let (mut sums, mut sides) = (Vec::new(), [f64::INFINITY; 2]);
            let mut began = None;
            loop {
                let output = world.step(true).unwrap();
                let (t, step) = (world.ms as f64 * 1e-3, scenario.steps.get(output.step));
                let Some(hold @ Step::Hold { .. }) = step else {
                    assert!(began.is_none() || sums.len() > 1000, "the hold ended");
                    if began.is_some() || output.outcome.is_some() {
                        break;
                    }
                    continue;
                };
                let since = t - *began.get_or_insert(t);
                world.plant.push = push(Some((output.step, hold)), since);
                let pads = world.plant.pad_forces();
                let pushed = usize::from(world.plant.push != DVec3::ZERO);
                sums.push(pads.iter().sum::<f64>());
                sides[pushed] = sides[pushed].min((pads[0] + pads[1]).min(pads[2] + pads[3]));
            }
            let mean = sums.iter().sum::<f64>() / sums.len() as f64;
            println!("seed {seed}: {mean:.1} N, least of a side {sides:.1?} N");
            assert!((13.0..17.0).contains(&mean), "{mean}");
            assert!(sides[0] > 4.0 && sides[1] > 2.0, "{sides:?}");
        }
    }
}
