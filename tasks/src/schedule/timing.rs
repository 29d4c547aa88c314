//! Timing of a task: totals since power-up, and histograms since they were last taken.
//!
//! Times are whole microseconds, the clock's resolution: lateness from release to start, execution from start to end,
//! response from release to end. Execution includes preemption and bus waits, separated by the executor trace
//! (docs/timing.md).

use embassy_time::{Duration, Instant};

use crate::schedule::histogram::Histogram;

/// One run of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Measurement of its input, or start of its period.
    pub released: Instant,
    /// Start of the run.
    pub started: Instant,
    /// Completion of what its deadline applies to.
    pub ended: Instant,
    /// Time allowed from release to end.
    pub deadline: Duration,
    /// Periods skipped before it.
    pub skipped: u32,
}

/// Timing of one task since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timing {
    /// Completed runs.
    pub runs: u32,
    /// Runs that missed their deadline, and skipped periods.
    pub overruns: u32,
    /// Longest time from release to start, µs.
    pub worst_lateness_us: u32,
    /// Longest time from release to end, µs.
    pub worst_response_us: u32,
    /// Longest time from start to end, µs.
    pub worst_execution_us: u32,
    /// Deadline of the last run, µs after its release.
    pub deadline_us: u32,
}

/// Measured quantity of a histogram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// From release to start.
    Lateness,
    /// From start to end.
    Execution,
    /// From release to end.
    Response,
}

/// Everything recorded of one task.
///
/// A run of the flight level is noted at its end, and settled into totals and histograms once the motor frame is out:
/// noting takes a quarter of the instructions.
#[derive(Debug)]
pub struct Record {
    /// Since power-up, without the noted run.
    totals: Timing,
    lateness: Histogram,
    execution: Histogram,
    response: Histogram,
    /// The last run, until settled.
    noted: Option<Run>,
}

impl Record {
    /// An empty record.
    pub const fn new() -> Self {
        Self {
            totals: Timing {
                runs: 0,
                overruns: 0,
                worst_lateness_us: 0,
                worst_response_us: 0,
                worst_execution_us: 0,
                deadline_us: 0,
            },
            lateness: Histogram::EMPTY,
            execution: Histogram::EMPTY,
            response: Histogram::EMPTY,
            noted: None,
        }
    }

    /// Notes a run; true if a deadline was missed.
    #[inline]
    pub fn note(&mut self, run: &Run) -> bool {
        if self.noted.is_some() {
            self.settle();
        }
        self.noted = Some(*run);
        run.skipped > 0 || run.ended.saturating_duration_since(run.released) > run.deadline
    }

    /// Adds the noted run, if any.
    #[inline(never)]
    pub fn settle(&mut self) {
        if let Some(run) = self.noted.take() {
            self.add(&run);
        }
    }

    /// Totals since power-up.
    pub fn totals(&mut self) -> Timing {
        self.settle();
        self.totals
    }

    /// Longest response of those that were added, µs.
    pub const fn worst_response(&self) -> u32 {
        self.totals.worst_response_us
    }

    /// Adds a run; true if a deadline was missed.
    pub fn add(&mut self, run: &Run) -> bool {
        let lateness = between(run.released, run.started);
        let execution = between(run.started, run.ended);
        let response = between(run.released, run.ended);
        let deadline = us(run.deadline);
        let missed = run.skipped + u32::from(response > deadline);
        let t = &mut self.totals;
        t.runs = t.runs.wrapping_add(1);
        t.overruns = t.overruns.saturating_add(missed);
        t.worst_lateness_us = t.worst_lateness_us.max(lateness);
        t.worst_response_us = t.worst_response_us.max(response);
        t.worst_execution_us = t.worst_execution_us.max(execution);
        t.deadline_us = deadline;
        self.lateness.add(lateness);
        self.execution.add(execution);
        self.response.add(response);
        missed > 0
    }

    /// Takes the histogram of `quantity`, which restarts.
    pub fn take(&mut self, quantity: Quantity) -> Histogram {
        self.settle();
        let histogram = match quantity {
            Quantity::Lateness => &mut self.lateness,
            Quantity::Execution => &mut self.execution,
            Quantity::Response => &mut self.response,
        };
        core::mem::replace(histogram, Histogram::EMPTY)
    }
}

impl Default for Record {
    fn default() -> Self {
        Self::new()
    }
}

fn between(from: Instant, to: Instant) -> u32 {
    us(to.saturating_duration_since(from))
}

/// Whole microseconds, saturating.
pub(crate) fn us(time: Duration) -> u32 {
    u32::try_from(time.as_micros()).unwrap_or(u32::MAX)
}
