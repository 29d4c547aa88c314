//! Recorded sensors through filter, attitude and position estimate: the flown stages at their own rates.

use std::path::Path;

use sophie_control::attitude::estimator::Estimator;
use sophie_control::chain::{Attitude, ImuSample, Sensing};
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::navigation::estimate::Estimate;
use sophie_control::navigation::flow_range_sample::GroundView;
use sophie_control::navigation::inertial::{Inertial, STEP_MAX};
use sophie_control::navigation::position_estimator::{FLIES, Fault, PositionEstimator};
use sophie_control::params::Params;

use crate::event::Event;
use crate::sensors::Sensors;
use crate::truth::{Errors, Truth};

/// Period of the position estimate, µs: that of the task.
const PERIOD: u64 = 5_000;
/// Number of intervals of the inertial sensor that give its rate, and the rates of the filter, Hz.
const INTERVALS: usize = 1_000;
const RATES: (f32, f32) = (190.0, 8_500.0);
/// Most measurements that are kept while that rate is looked for.
const BEGIN_MAX: usize = 1_000_000;
/// End of a fault's text for the pilot, which is left out here.
const LEFT_OUT: &str = ", left out";

/// Range of the recording, and parameters.
#[derive(Clone, Debug)]
pub struct Options {
    /// Of the vehicle.
    pub params: Params,
    /// Earlier flow and range are dropped, s from the file's first line.
    pub from_s: f64,
}

/// A fault, by its name, and its time, s from the file's first line.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// The pilot's text, without the advice.
    pub name: &'static str,
    /// Begin.
    pub from_s: f64,
    /// End.
    pub to_s: f64,
}

/// Results of a replay.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// From the first line to the last, s.
    pub seconds: f64,
    /// Accepted samples, flows and ranges, and the rate of the samples, Hz.
    pub counts: [u64; 3],
    /// Of the inertial sensor.
    pub rate_hz: f32,
    /// Time of the attitude's calibration, s; `None` if the vehicle never lay still.
    pub calibrated_s: Option<f64>,
    /// Time of the first estimate, s.
    pub estimate_s: Option<f64>,
    /// Share of the time with an estimate: of the time in the air, if the recording has the rotors' thrust.
    pub estimate_share: f64,
    /// That time, s.
    pub flown_s: f64,
    /// The last estimate.
    pub last: Option<Estimate>,
    /// The faults, in the order of their reports.
    pub faults: Vec<Named>,
    /// Silences of the inertial sensor after which the estimate restarts.
    pub gaps: u32,
    /// The longest of them, s.
    pub longest_gap_s: f64,
    /// Error against the truth, if the recording has one.
    pub errors: Option<Errors>,
}

/// Runs a recording.
///
/// # Errors
/// One line: place, value, allowed values.
pub fn replay(path: &Path, options: &Options, truth: Option<Truth>) -> Result<Outcome, String> {
    let mut sensors = Sensors::open(path)?;
    let (begin, rate_hz) = begin(&mut sensors)?;
    let mut replay = Replay::new(options, rate_hz, truth);
    for (at, event) in begin {
        replay.take(at, event);
    }
    while let Some((at, event)) = sensors.next()? {
        replay.take(at, event);
    }
    if options.from_s > 0.0 && options.from_s > replay.out.seconds {
        let why = format!(
            "--from {}, allowed 0 to {} s, its length",
            options.from_s, replay.out.seconds
        );
        return Err(sensors.whole(&why));
    }
    Ok(replay.finish())
}

/// The first measurements, and the rate of the inertial sensor among them, Hz: the middle one of its intervals.
fn begin(sensors: &mut Sensors) -> Result<(Vec<(u64, Event)>, f32), String> {
    let (mut before, mut intervals, mut begin) = (None, vec![], vec![]);
    while intervals.len() < INTERVALS
        && begin.len() < BEGIN_MAX
        && let Some((at, event)) = sensors.next()?
    {
        if matches!(event, Event::Inertial(_)) {
            intervals.extend(before.replace(at).map(|before| at - before));
        }
        begin.push((at, event));
    }
    intervals.sort_unstable();
    let Some(middle) = intervals.get(intervals.len() / 2) else {
        return Err(sensors.whole("fewer than two inertial samples, allowed is a recording with them"));
    };
    let hz = 1e6 / *middle as f32;
    let (least, most) = RATES;
    if (least..=most).contains(&hz) {
        Ok((begin, hz))
    } else {
        let why = format!("inertial samples at {hz:.1} Hz, allowed 200 to 8000 Hz");
        Err(sensors.whole(&why))
    }
}

/// The stages and their results so far.
struct Replay {
    sensing: Sensing,
    sample: ImuSample,
    estimator: Estimator,
    attitude: Attitude,
    position: PositionEstimator,
    view: GroundView,
    lift: f32,
    carried: f32,
    from_us: f64,
    first_us: Option<u64>,
    inertial_us: Option<u64>,
    stepped_us: Option<u64>,
    fault: Option<Fault>,
    /// Steps of the position estimate since S: in the air and at all, and those of each with an estimate.
    steps: [[u64; 2]; 2],
    truth: Option<Truth>,
    out: Outcome,
}

impl Replay {
    fn new(options: &Options, rate_hz: f32, truth: Option<Truth>) -> Self {
        let p = &options.params;
        Self {
            sensing: Sensing::new(p, rate_hz),
            sample: ImuSample::default(),
            estimator: Estimator::new(p),
            attitude: Attitude::default(),
            position: PositionEstimator::new(p),
            view: GroundView::default(),
            lift: 0.0,
            carried: FLIES * GRAVITY * p.mass,
            from_us: options.from_s * 1e6,
            first_us: None,
            inertial_us: None,
            stepped_us: None,
            fault: None,
            steps: [[0; 2]; 2],
            out: Outcome {
                rate_hz,
                errors: truth.as_ref().map(|_| Errors::default()),
                ..Outcome::default()
            },
            truth,
        }
    }

    /// Since the first line, µs.
    fn since(&self, at: u64) -> u64 {
        at - self.first_us.unwrap_or(at)
    }

    fn take(&mut self, at: u64, event: Event) {
        self.first_us.get_or_insert(at);
        self.out.seconds = self.since(at) as f64 * 1e-6;
        let wanted = self.since(at) as f64 >= self.from_us;
        let [samples, flows, ranges] = &mut self.out.counts;
        match event {
            Event::Lift(lift) => self.lift = lift,
            Event::Flow(flow) if wanted => {
                *flows += 1;
                self.view.flow = Some(flow);
            }
            Event::Range(range) if wanted => {
                *ranges += 1;
                self.view.range = Some(range);
            }
            Event::Flow(_) | Event::Range(_) => {}
            Event::Inertial(reading) => {
                *samples += 1;
                if let Some(before) = self.inertial_us.replace(at) {
                    let gap = (at - before) as f64 * 1e-6;
                    if gap > f64::from(STEP_MAX) {
                        self.out.gaps += 1;
                        self.out.longest_gap_s = self.out.longest_gap_s.max(gap);
                    }
                }
                if self.sensing.take(at, &[reading], &mut self.sample) {
                    self.step(at, wanted);
                }
            }
        }
    }

    /// A step of the attitude, and of the position at the end of its period.
    fn step(&mut self, at: u64, wanted: bool) {
        self.estimator.estimate(&self.sample, &mut self.attitude);
        let seconds = self.since(at) as f64 * 1e-6;
        if self.attitude.calibrated {
            self.out.calibrated_s.get_or_insert(seconds);
        }
        let due = self.stepped_us.is_none_or(|last| at / PERIOD > last / PERIOD);
        if !due {
            return;
        }
        self.stepped_us = Some(at);
        let felt = Inertial {
            at_us: at,
            q: self.attitude.q,
            accel: self.attitude.accel,
        };
        let estimate = self.position.step(&felt, self.lift, None, Some(&self.view));
        self.note_fault(seconds);
        if let (Some(truth), Some(errors)) = (&mut self.truth, &mut self.out.errors) {
            let q = self.attitude.calibrated.then_some(self.attitude.q);
            errors.take(&truth.at(at), q, estimate.as_ref());
        }
        if estimate.is_some() {
            self.out.estimate_s.get_or_insert(seconds);
            self.out.last = estimate;
        }
        if wanted {
            let flies = self.lift > self.carried;
            let [flown, all] = &mut self.steps;
            for ([steps, with], counts) in [(flown, flies), (all, true)] {
                *steps += u64::from(counts);
                *with += u64::from(counts && estimate.is_some());
            }
        }
    }

    fn note_fault(&mut self, now: f64) {
        let fault = self.position.fault();
        if let Some(last) = self.out.faults.last_mut().filter(|_| self.fault.is_some()) {
            last.to_s = now;
        }
        if fault != self.fault
            && let Some(fault) = fault
        {
            let text = fault.text();
            self.out.faults.push(Named {
                name: text.strip_suffix(LEFT_OUT).unwrap_or(text),
                from_s: now,
                to_s: now,
            });
        }
        self.fault = fault;
    }

    fn finish(self) -> Outcome {
        let [flown, all] = self.steps;
        let [steps, with] = if flown[0] > 0 { flown } else { all };
        Outcome {
            estimate_share: with as f64 / steps.max(1) as f64,
            flown_s: steps as f64 * PERIOD as f64 * 1e-6,
            ..self.out
        }
    }
}
