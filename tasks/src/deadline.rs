//! Fixed rates and deadlines: measured, counted, and never made up for by a burst.

use embassy_time::{Duration, Instant, Timer};

use crate::links::Links;

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
}

/// Timing of one task since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timing {
    /// Completed runs.
    pub runs: u32,
    /// Runs that ended after their deadline, and periods that were skipped altogether.
    pub overruns: u32,
    /// Longest time from release to start, µs.
    pub worst_lateness_us: u32,
    /// Longest time from release to end, µs.
    pub worst_response_us: u32,
    /// Longest time from start to end, µs.
    pub worst_execution_us: u32,
}

impl Timing {
    /// Nothing measured yet.
    pub const fn new() -> Self {
        Self {
            runs: 0,
            overruns: 0,
            worst_lateness_us: 0,
            worst_response_us: 0,
            worst_execution_us: 0,
        }
    }

    /// Adds a run that was released at `released`, started at `started`, ended at `ended` and had to end
    /// `deadline` after its release; `skipped` periods before it were lost.
    fn add(&mut self, released: Instant, started: Instant, ended: Instant, deadline: Duration, skipped: u32) {
        let us = |d: Duration| u32::try_from(d.as_micros()).unwrap_or(u32::MAX);
        let response = ended.saturating_duration_since(released);
        self.runs = self.runs.wrapping_add(1);
        self.overruns = self
            .overruns
            .saturating_add(skipped + u32::from(response > deadline));
        self.worst_lateness_us = self
            .worst_lateness_us
            .max(us(started.saturating_duration_since(released)));
        self.worst_response_us = self.worst_response_us.max(us(response));
        self.worst_execution_us = self
            .worst_execution_us
            .max(us(ended.saturating_duration_since(started)));
    }
}

/// Records one run of an event-driven task: released when its input was measured, run from `started` to now.
pub fn record_run(links: &Links, task: TaskId, released: Instant, started: Instant, deadline: Duration) {
    let ended = Instant::now();
    links.record(task, |t| t.add(released, started, ended, deadline, 0));
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
/// steps with no time between them. This one drops them, counts them as overruns, and starts afresh.
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
            let (ended, deadline, skipped) = (Instant::now(), self.deadline, self.skipped);
            self.links.record(self.task, |t| {
                t.add(tick.released, tick.started, ended, deadline, skipped)
            });
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
