//! Every task once: its name, level, period, deadline, and whether the supervisor watches it.
//!
//! This is data, below the links and the loops that use it: the enum, the records of timing, the supervisor's list and
//! the table of docs/timing.md follow from it. Which port a task takes is said where it is spawned.

pub mod histogram;
pub mod timing;

use embassy_time::Duration;

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

/// Whether a task's standing still leaves the watchdog unfed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watch {
    /// It does.
    Watched,
    /// It does not: the vehicle flies without it.
    Unwatched,
}

/// What is declared of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task {
    /// Name for logs.
    pub name: &'static str,
    /// What it does.
    pub what: &'static str,
    /// The level that it runs on.
    pub level: Level,
    /// Time between two runs; the longest where it varies.
    pub period: Duration,
    /// When its periods begin by the board's clock, so that a task runs after the one that it reads; `None` for a task
    /// that follows an input.
    pub phase: Option<Duration>,
    /// Time from release by which a run must have ended. What it counts from: docs/timing.md.
    pub deadline: Duration,
    /// Whether the supervisor watches it.
    pub watch: Watch,
}

macro_rules! optional {
    () => {
        None
    };
    ($value:expr) => {
        Some($value)
    };
}

macro_rules! tasks {
    ($(
        $(#[doc = $what:literal])+
        $id:ident $name:literal: $level:ident, each $period:literal us $(at $phase:literal us)?, within $deadline:literal us, $watch:ident;
    )*) => {
        /// Every task whose timing is measured.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(usize)]
        pub enum TaskId {
            $($(#[doc = $what])+ $id,)*
        }

        impl TaskId {
            /// Every task, in the order of the declaration.
            pub const ALL: [Self; [$(Self::$id),*].len()] = [$(Self::$id),*];

            /// What is declared of the task.
            pub const fn task(self) -> Task {
                match self {
                    $(Self::$id => Task {
                        name: $name,
                        what: concat!($($what),+),
                        level: Level::$level,
                        period: Duration::from_micros($period),
                        phase: optional!($(Duration::from_micros($phase))?),
                        deadline: Duration::from_micros($deadline),
                        watch: Watch::$watch,
                    },)*
                }
            }
        }
    };
}

tasks! {
    /// Inertial sensor: samples filtered and decimated.
    Imu "imu": Flight, each 1000 us, within 200 us, Watched;
    /// Attitude estimator.
    Estimator "estimator": Flight, each 1000 us, within 300 us, Watched;
    /// Attitude and rate control.
    Control "control": Flight, each 1000 us, within 400 us, Watched;
    /// Allocation.
    Mixer "mixer": Flight, each 1000 us, within 500 us, Watched;
    /// Motor output; its response is that of the whole chain.
    Motors "motors": Flight, each 1000 us, within 600 us, Watched;
    /// Pressure sensors and battery.
    Analog "analog": Steady, each 2000 us at 0 us, within 2000 us, Watched;
    /// Clamp loops.
    Clamp "clamp": Steady, each 10000 us at 600 us, within 10000 us, Watched;
    /// Servo output; a frame by `servo_frame_rate`, 20 ms at most.
    Servos "servos": Steady, each 20000 us at 900 us, within 20000 us, Watched;
    /// Receiver, as frames come. A lost radio is the failsafe's business.
    Rc "rc": Steady, each 20000 us, within 2000 us, Unwatched;
    /// Module of optical flow and range, as its frames come. Without it the pilot flies as ever.
    Ground "ground": Steady, each 20000 us, within 2000 us, Unwatched;
    /// Mode logic.
    Commander "commander": Steady, each 10000 us at 300 us, within 10000 us, Watched;
    /// Position, velocity and wind, for the hold. Without poses or flow it does nothing, and the pilot flies as ever.
    Position "position": Steady, each 5000 us at 150 us, within 5000 us, Unwatched;
    /// Arm sensors. Their bus may stall; the mixer does without.
    Arms "arms": Background, each 10000 us at 0 us, within 10000 us, Unwatched;
    /// Barometer, whose bus arm sensors share. Without it the height of last resort is the inertial sensor's.
    Barometer "barometer": Background, each 40000 us at 5000 us, within 40000 us, Unwatched;
    /// Telemetry to the pilot.
    Telemetry "telemetry": Background, each 50000 us at 0 us, within 50000 us, Unwatched;
    /// MAVLink: what is due to ground stations.
    Mavlink "mavlink": Background, each 20000 us at 0 us, within 20000 us, Unwatched;
    /// Bench commands, renewed while one lasts; what else the console does has no rate.
    Console "console": Background, each 50000 us, within 50000 us, Unwatched;
    /// Deadline supervision and watchdog, which bites when it stands still.
    Supervisor "supervisor": Steady, each 10000 us at 1200 us, within 10000 us, Unwatched;
}

impl TaskId {
    /// Number of tasks.
    pub const COUNT: usize = Self::ALL.len();

    /// Name for logs.
    pub const fn name(self) -> &'static str {
        self.task().name
    }

    /// The level that the task runs on.
    pub const fn level(self) -> Level {
        self.task().level
    }

    /// Time between two runs; the longest where it varies.
    pub const fn period(self) -> Duration {
        self.task().period
    }

    /// When its periods begin by the board's clock; 0 for a task that follows an input.
    pub const fn phase(self) -> Duration {
        match self.task().phase {
            Some(phase) => phase,
            None => Duration::MIN,
        }
    }

    /// Time from release by which a run must have ended.
    pub const fn deadline(self) -> Duration {
        self.task().deadline
    }
}
