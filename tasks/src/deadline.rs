//! Fixed rates and deadlines: misses are counted, not made up for by a burst.

use embassy_time::{Duration, Instant, Timer};

use crate::links::Links;
use crate::schedule::TaskId;
use crate::schedule::timing::Run;

/// Records a run of an event-driven task, released by its input's measurement, until now.
pub fn record_run(links: &Links, task: TaskId, released: Instant, started: Instant, deadline: Duration) {
    record_run_until(links, task, released, started, Instant::now(), deadline);
}

/// Notes such a run ahead of the motor frame; [`TimingRecords::settle`](crate::links::timing_records::TimingRecords::settle) adds it later.
#[inline]
pub fn note_run(links: &Links, task: TaskId, released: Instant, started: Instant, deadline: Duration) {
    links.timing.note(
        task,
        &Run {
            released,
            started,
            ended: Instant::now(),
            deadline,
            skipped: 0,
        },
    );
}

/// Records a run whose deadline applies to `ended`, before its next wait.
pub fn record_run_until(
    links: &Links,
    task: TaskId,
    released: Instant,
    started: Instant,
    ended: Instant,
    deadline: Duration,
) {
    links.timing.record(
        task,
        &Run {
            released,
            started,
            ended,
            deadline,
            skipped: 0,
        },
    );
}

/// First instant from `now` at `phase` of the board's clock's periods.
pub fn begins_next(now: Instant, period: Duration, phase: Duration) -> Instant {
    let period = period.as_ticks().max(1);
    let passed = (now.as_ticks() % period + period - phase.as_ticks() % period) % period;
    let left = if passed == 0 { 0 } else { period - passed };
    now + Duration::from_ticks(left)
}

/// Start of a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// Scheduled start.
    pub released: Instant,
    /// Actual start.
    pub started: Instant,
    /// Time since the last start, s, limited to half and four times the period.
    pub dt: f32,
}

/// Loop of a periodic task.
///
/// embassy's `Ticker` fires every missed tick at once after a stall: a burst of steps without time between. This one
/// counts missed periods as overruns and keeps the phase.
pub struct FixedRate<'a> {
    links: &'a Links,
    task: TaskId,
    period: Duration,
    deadline: Duration,
    next: Instant,
    current: Option<Tick>,
    skipped: u32,
}

impl<'a> FixedRate<'a> {
    /// The loop of `task` as declared.
    pub fn of(links: &'a Links, task: TaskId) -> Self {
        Self::new(links, task, task.period(), task.deadline())
    }

    /// A loop of `period` whose work must end within `deadline` of its release. Periods begin at the task's phase of
    /// the board's clock: readers run after writers, however spawned.
    pub fn new(links: &'a Links, task: TaskId, period: Duration, deadline: Duration) -> Self {
        Self {
            links,
            task,
            period,
            deadline,
            next: begins_next(Instant::now(), period, task.phase()),
            current: None,
            skipped: 0,
        }
    }

    /// Ends the last run, if any, and waits for the next release.
    pub async fn next(&mut self) -> Tick {
        let period_s = self.period.as_micros() as f32 * 1e-6;
        let previous = self.current.take();
        if let Some(tick) = previous {
            self.links.timing.record(
                self.task,
                &Run {
                    released: tick.released,
                    started: tick.started,
                    ended: Instant::now(),
                    deadline: self.deadline,
                    skipped: self.skipped,
                },
            );
        }
        self.skipped = 0;
        Timer::at(self.next).await;
        let started = Instant::now();
        let late = started.saturating_duration_since(self.next);
        let missed = late.as_ticks() / self.period.as_ticks().max(1);
        if missed > 0 {
            self.skipped = u32::try_from(missed).unwrap_or(u32::MAX);
            self.next += self.period * self.skipped;
        }
        let released = self.next;
        self.next += self.period;
        let dt = previous.map_or(period_s, |p| {
            started.saturating_duration_since(p.started).as_micros() as f32 * 1e-6
        });
        let dt = sophie_control::maths::scalar::clamp(dt, 0.5 * period_s, 4.0 * period_s);
        let tick = Tick {
            released,
            started,
            dt,
        };
        self.current = Some(tick);
        tick
    }
}
