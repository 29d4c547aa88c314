//! Fixed rates and deadlines: measured, counted, and never made up for by a burst.

use embassy_time::{Duration, Instant, Timer};

use crate::links::Links;
use crate::timing::Run;
pub use crate::timing::Timing;

/// How urgent a task is: each level preempts those below it, tasks of one level take turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// From data-ready to the motor frame.
    Flight,
    /// Fixed rates of 50 to 500 Hz.
    Steady,
    /// What may wait.
    Background,
}

impl Level {
    /// Name for logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Flight => "flight",
            Self::Steady => "steady",
            Self::Background => "background",
        }
    }
}

/// Every task whose timing is watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum TaskId {
    /// Inertial sensor, 1 kHz after decimation.
    Imu,
    /// Attitude estimator, 1 kHz.
    Estimator,
    /// Attitude and rate control, 1 kHz.
    Control,
    /// Allocation, 1 kHz.
    Mixer,
    /// Motor output, 1 kHz.
    Motors,
    /// Pressure sensors and battery, 500 Hz.
    Analog,
    /// Clamp loop, 100 Hz.
    Clamp,
    /// Servo output, 50 to 333 Hz.
    Servos,
    /// Receiver, as frames come.
    Rc,
    /// Mode logic, 100 Hz.
    Commander,
    /// Arm sensors, 100 Hz.
    Arms,
    /// Telemetry to the pilot, 20 Hz.
    Telemetry,
    /// Deadline supervision and watchdog, 100 Hz.
    Supervisor,
}

impl TaskId {
    /// Number of tasks.
    pub const COUNT: usize = 13;

    /// Every task.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Imu,
        Self::Estimator,
        Self::Control,
        Self::Mixer,
        Self::Motors,
        Self::Analog,
        Self::Clamp,
        Self::Servos,
        Self::Rc,
        Self::Commander,
        Self::Arms,
        Self::Telemetry,
        Self::Supervisor,
    ];

    /// Name for logs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Imu => "imu",
            Self::Estimator => "estimator",
            Self::Control => "control",
            Self::Mixer => "mixer",
            Self::Motors => "motors",
            Self::Analog => "analog",
            Self::Clamp => "clamp",
            Self::Servos => "servos",
            Self::Rc => "rc",
            Self::Commander => "commander",
            Self::Arms => "arms",
            Self::Telemetry => "telemetry",
            Self::Supervisor => "supervisor",
        }
    }

    /// The level that the task runs on.
    pub const fn level(self) -> Level {
        match self {
            Self::Imu | Self::Estimator | Self::Control | Self::Mixer | Self::Motors => Level::Flight,
            Self::Analog | Self::Clamp | Self::Servos | Self::Rc | Self::Commander | Self::Supervisor => {
                Level::Steady
            }
            Self::Arms | Self::Telemetry => Level::Background,
        }
    }
}

/// Records one run of an event-driven task: released when its input was measured, run from `started` to now.
pub fn record_run(links: &Links, task: TaskId, released: Instant, started: Instant, deadline: Duration) {
    record_run_until(links, task, released, started, Instant::now(), deadline);
}

/// Records one run whose deadline is for what it did at `ended`, not for what it waits for afterwards.
pub fn record_run_until(
    links: &Links,
    task: TaskId,
    released: Instant,
    started: Instant,
    ended: Instant,
    deadline: Duration,
) {
    links.record(
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

/// Start of a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tick {
    /// When the period's work should have started.
    pub released: Instant,
    /// When it started.
    pub started: Instant,
    /// Time since the start before, s, limited to half and four times the period.
    pub dt: f32,
}

/// The loop of every periodic task.
///
/// embassy's `Ticker` fires every missed tick at once after a stall, which feeds a control law a burst of
/// steps with no time between them. This one drops them, counts them as overruns, and restarts the period.
/// Dropped periods keep the phase: the next release is the next multiple of the period.
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
    /// A loop of `period` whose work must end within `deadline` of its release. The first release is now.
    pub fn new(links: &'a Links, task: TaskId, period: Duration, deadline: Duration) -> Self {
        Self {
            links,
            task,
            period,
            deadline,
            next: Instant::now(),
            current: None,
            skipped: 0,
        }
    }

    /// Ends the run before, if any, and waits for the next release.
    pub async fn next(&mut self) -> Tick {
        let period_s = self.period.as_micros() as f32 * 1e-6;
        let previous = self.current.take();
        if let Some(tick) = previous {
            self.links.record(
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
        let dt = sophie_control::math::clamp(dt, 0.5 * period_s, 4.0 * period_s);
        let tick = Tick {
            released,
            started,
            dt,
        };
        self.current = Some(tick);
        tick
    }
}
