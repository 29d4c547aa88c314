//! Records samples, phases, events and grips, with a digest of them.

use glam::DVec3;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::mode::Mode;

use super::Snapshot;
use super::aircraft::{Aircraft, ReportedStatus};
use super::strikes::Strikes;
use crate::plant::Plant;
use crate::record::{Event, FlightRecord, Grip, Observer, Outcome, Phase, SAMPLE_HZ, Sample, Verdict};
use crate::scenario::{Scenario, Step};

const SAMPLE_MS: u64 = (1000.0 / SAMPLE_HZ) as u64;

/// The record under way.
pub struct Recorder {
    samples: Vec<Sample>,
    phases: Vec<Phase>,
    events: Vec<Event>,
    grip: Vec<Grip>,
    strikes: Strikes,
    steps: usize,
    chosen: PerArm<bool>,
    reel_radius: f64,
    current: Option<Current>,
    mode: Mode,
    reason: String,
    warning: String,
    proven: bool,
    resets: u32,
    digest: Digest,
}

struct Current {
    index: usize,
    phase: Phase,
    overruns_before: u32,
    samples: u32,
    saturated: u32,
}

/// How a flight ended.
pub struct Ending {
    /// Whether and why the mission was accomplished or not.
    pub outcome: Outcome,
    /// What each rule of the judge found.
    pub verdicts: Vec<Verdict>,
    /// Time since power-up, s.
    pub t: f64,
    /// Wall time of the simulation, s.
    pub wall_seconds: f64,
}

struct PhaseEnd {
    /// Since power-up, s.
    t: f64,
    done: bool,
    /// Battery, V.
    voltage: f64,
    /// Missed deadlines since power-up.
    overruns: u32,
}

impl Recorder {
    /// An empty record of `scenario`.
    pub fn new(scenario: &Scenario) -> Self {
        Self {
            samples: Vec::new(),
            phases: Vec::new(),
            events: Vec::new(),
            grip: Vec::new(),
            strikes: Strikes::default(),
            steps: scenario.steps.len(),
            chosen: scenario.arms.mask(),
            reel_radius: f64::from(scenario.params.reel_radius),
            current: None,
            mode: Mode::Calibrating,
            reason: String::new(),
            warning: String::new(),
            proven: false,
            resets: 0,
            digest: Digest::new(),
        }
    }

    /// Records the present moment, the pilot's throttle at `throttle`, 0..1.
    pub fn step(&mut self, now: &Snapshot<'_, impl Aircraft>, throttle: f64, observer: &mut dyn Observer) {
        let (t, plant, stack) = (now.t(), now.plant, now.stack);
        if now.step.map(|(i, _)| i) != self.current.as_ref().map(|c| c.index) {
            let end = PhaseEnd {
                t,
                done: true,
                voltage: plant.battery_voltage(),
                overruns: stack.overruns(),
            };
            self.end_phase(&end, observer);
            if let Some((index, step)) = now.step {
                observer.step_began(t, index, self.steps, step.name());
                self.begin_phase(t, index, step, stack);
            }
        }
        self.watch_stack(t, plant, stack, observer);
        if now.ms.is_multiple_of(SAMPLE_MS) {
            let sample = sample(t, plant, stack, throttle);
            self.digest.add(&sample);
            self.account(&sample);
            self.samples.push(sample);
            for text in self.strikes.step(t, plant.struck()) {
                self.say(t, text, observer);
            }
        }
    }

    /// The samples so far.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Ends the record.
    pub fn finish(
        mut self,
        scenario: &Scenario,
        stack: &impl Aircraft,
        ending: Ending,
        observer: &mut dyn Observer,
    ) -> FlightRecord {
        let Ending {
            outcome,
            verdicts,
            t,
            wall_seconds,
        } = ending;
        let end = PhaseEnd {
            t,
            done: outcome.accomplished,
            voltage: self.samples.last().map_or(0.0, |s| s.battery_voltage),
            overruns: stack.overruns(),
        };
        self.end_phase(&end, observer);
        self.say(t, outcome.reason.clone(), observer);
        FlightRecord {
            scenario: scenario.clone(),
            outcome,
            verdicts,
            samples: self.samples,
            phases: self.phases,
            events: self.events,
            grip: self.grip,
            strikes: self.strikes.all,
            sim_seconds: t,
            wall_seconds,
            overruns: stack.overruns(),
            digest: self.digest.0,
        }
    }

    fn begin_phase(&mut self, t: f64, index: usize, step: &Step, stack: &impl Aircraft) {
        self.current = Some(Current {
            index,
            phase: Phase {
                name: step.name().to_owned(),
                start: t,
                end: t,
                done: false,
                worst_attitude_error: 0.0,
                worst_tilt: 0.0,
                saturation: 0.0,
                battery_voltage: 0.0,
                overruns: 0,
            },
            overruns_before: stack.overruns(),
            samples: 0,
            saturated: 0,
        });
    }

    fn end_phase(&mut self, end: &PhaseEnd, observer: &mut dyn Observer) {
        let Some(mut current) = self.current.take() else {
            return;
        };
        current.phase.end = end.t;
        current.phase.done = end.done;
        current.phase.battery_voltage = end.voltage;
        current.phase.overruns = end.overruns - current.overruns_before;
        current.phase.saturation = f64::from(current.saturated) / f64::from(current.samples.max(1));
        observer.step_ended(end.t, &current.phase);
        self.phases.push(current.phase);
    }

    fn watch_stack(&mut self, t: f64, plant: &Plant, stack: &impl Aircraft, observer: &mut dyn Observer) {
        if stack.resets() != self.resets
            && let Some(reset) = stack.reset()
        {
            self.resets = stack.resets();
            let text = if reset.cause.loses_memory() {
                "power lost"
            } else {
                "board reset"
            };
            self.say(t, text.to_owned(), observer);
        }
        if let Some(ReportedStatus {
            mode,
            reason,
            warning,
        }) = stack.status()
        {
            if mode != self.mode {
                self.mode = mode;
                self.say(t, format!("mode {}", mode.name()), observer);
            }
            if reason != self.reason {
                reason.clone_into(&mut self.reason);
                if !reason.is_empty() {
                    self.say(t, reason.to_owned(), observer);
                }
            }
            if warning != self.warning {
                warning.clone_into(&mut self.warning);
                if !warning.is_empty() {
                    self.say(t, format!("warning: {warning}"), observer);
                }
            }
        }
        let Some(grip) = stack.grip() else {
            return;
        };
        if grip.proven && !self.proven {
            let truth = plant.pressure();
            for (i, (arm, chosen)) in grip.arms.iter().zip(self.chosen).enumerate() {
                if chosen {
                    self.grip.push(Grip {
                        arm: i as u8 + 1,
                        pressure: f64::from(arm.pressure),
                        pressure_true: truth[i],
                        torque: f64::from(arm.force) * self.reel_radius,
                        closure: arm.closure.map_or(f64::NAN, f64::from),
                    });
                }
            }
            self.say(t, "grip proven".to_owned(), observer);
        }
        self.proven = grip.proven;
    }

    fn say(&mut self, t: f64, text: String, observer: &mut dyn Observer) {
        self.note(Event { t, text }, observer);
    }

    fn note(&mut self, event: Event, observer: &mut dyn Observer) {
        observer.event(&event);
        self.events.push(event);
    }

    fn account(&mut self, s: &Sample) {
        let Some(current) = &mut self.current else { return };
        current.samples += 1;
        current.saturated += u32::from(s.saturated);
        let phase = &mut current.phase;
        let flying = s.thrust_asked.iter().any(|t| *t > 1.0);
        for axis in 0..2 {
            let error = (s.attitude[axis] - s.attitude_setpoint[axis]).abs();
            if flying && error > phase.worst_attitude_error {
                phase.worst_attitude_error = error;
            }
        }
        for tilt in s.tilt {
            if tilt.abs() > phase.worst_tilt.abs() {
                phase.worst_tilt = tilt;
            }
        }
    }
}

fn sample(t: f64, plant: &Plant, stack: &impl Aircraft, throttle: f64) -> Sample {
    let pose = plant.pose();
    let estimate = stack.estimate();
    Sample {
        t,
        mode: stack.mode(),
        position: pose.position.to_array(),
        velocity: pose.velocity.to_array(),
        attitude: plant.euler(),
        attitude_estimate: estimate.attitude,
        attitude_setpoint: estimate.setpoint,
        rate: pose.omega.to_array(),
        tilt: plant.tilt(),
        tilt_measured: estimate.tilt_measured,
        tilt_model: estimate.tilt_model,
        thrust: plant.thrust(),
        thrust_asked: estimate.thrust_asked,
        tension: plant.tension(),
        tension_asked: estimate.tension_asked,
        pressure: plant.pressure(),
        pressure_measured: estimate.pressure,
        battery_voltage: plant.battery_voltage(),
        throttle,
        saturated: estimate.saturated,
        position_estimate: estimate.position,
        pose: estimate.pose,
        range: plant
            .pipe()
            .or_ground_along(pose.position, pose.attitude * DVec3::Z)
            .unwrap_or(f64::NAN),
        range_measured: estimate.range,
        flow: estimate.flow,
    }
}

/// FNV-1a over all samples' bits.
struct Digest(u64);

impl Digest {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x0000_0100_0000_01b3);
    }

    fn add(&mut self, s: &Sample) {
        self.word(s.mode as u64);
        self.word(u64::from(s.saturated));
        let scalars = [s.t, s.battery_voltage, s.throttle];
        let vectors = [
            s.position,
            s.velocity,
            s.attitude,
            s.attitude_estimate,
            s.attitude_setpoint,
            s.rate,
        ];
        let arms = [
            s.tilt,
            s.tilt_measured,
            s.tilt_model,
            s.thrust,
            s.thrust_asked,
            s.tension,
            s.tension_asked,
            s.pressure,
            s.pressure_measured,
        ];
        let values = scalars
            .iter()
            .chain(vectors.iter().flatten())
            .chain(arms.iter().flatten());
        for value in values {
            self.word(value.to_bits());
        }
        let places = s.position_estimate.iter().chain(&s.pose).flatten();
        let below = s.range_measured.iter().chain(s.flow.iter().flatten());
        for value in places.chain(below) {
            self.word(value.to_bits());
        }
    }
}
