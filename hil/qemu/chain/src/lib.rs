//! The four stages of the flight step in series, without tasks and links between them: what counts their instructions
//! and compares their bits runs this. What flies are the tasks that own the same stages ([`sophie_control::chain`]); a
//! recorded mission gives the same bits both ways (`sim/tests/sim/flight_step.rs`).

#![no_std]

use sophie_control::allocation::mixer::Flexible;
use sophie_control::attitude::attitude_loop::Target;
use sophie_control::attitude::estimator::Estimator;
use sophie_control::attitude::rate_loop::Feedback;
use sophie_control::chain::{
    Attitude, Command, Control, Demand, ImuReading, ImuSample, MixOutput, Mixing, MixingStep, Sensing,
    Surroundings,
};
use sophie_control::params::Params;

/// Messages of the last step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flow {
    /// Data-ready time of the newest sample, µs.
    pub at_us: u64,
    /// From sensing to the estimator.
    pub sample: ImuSample,
    /// From the estimator to control.
    pub attitude: Attitude,
    /// From control to mixing.
    pub demand: Demand,
    /// From control to the log.
    pub target: Target,
    /// From mixing to the motors, and back to control.
    pub mix: MixOutput,
}

/// The four stages in series.
#[derive(Clone, Debug)]
pub struct FlightChain<A = Flexible> {
    /// First stage.
    pub sensing: Sensing,
    /// Second stage.
    pub estimator: Estimator,
    /// Third stage.
    pub control: Control,
    /// Fourth stage.
    pub mixing: Mixing<A>,
    /// Messages between them.
    pub flow: Flow,
    feedback: Feedback,
}

impl<A: MixingStep> FlightChain<A> {
    /// A chain at rest for samples at `rate_hz`.
    pub fn new(p: &Params, rate_hz: f32, allocation: A) -> Self {
        Self {
            sensing: Sensing::new(p, rate_hz),
            estimator: Estimator::new(p),
            control: Control::new(p),
            mixing: Mixing::new(p, allocation),
            flow: Flow::default(),
            feedback: Feedback::NOTHING,
        }
    }

    /// First stage: takes readings, oldest first, the newest ready at `at_us` µs; true if a step is due.
    #[inline(always)]
    pub fn sense(&mut self, at_us: u64, readings: &[ImuReading]) -> bool {
        let due = self.sensing.take(at_us, readings, &mut self.flow.sample);
        if due {
            self.flow.at_us = at_us;
        }
        due
    }

    /// Second stage.
    #[inline(always)]
    pub fn estimate(&mut self) {
        self.estimator
            .estimate(&self.flow.sample, &mut self.flow.attitude);
    }

    /// Third stage.
    #[inline(always)]
    pub fn control(&mut self, command: &Command) {
        self.flow.demand = self.control.step(&self.flow.attitude, command, &self.feedback);
        self.flow.target = self.control.target();
    }

    /// Fourth stage.
    #[inline(always)]
    pub fn mix(&mut self, surroundings: &Surroundings) {
        let Flow {
            at_us, demand, mix, ..
        } = &mut self.flow;
        self.mixing.step(*at_us, demand, surroundings, mix);
        self.feedback = self.flow.mix.feedback();
    }

    /// All stages; true if a step was due.
    #[inline(always)]
    pub fn step(
        &mut self,
        at_us: u64,
        readings: &[ImuReading],
        command: &Command,
        surroundings: &Surroundings,
    ) -> bool {
        let due = self.sense(at_us, readings);
        if due {
            self.estimate();
            self.control(command);
            self.mix(surroundings);
        }
        due
    }
}
