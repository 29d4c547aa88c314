//! Task declarations: name, level, period, deadline, and supervision.
//!
//! The task enum, the timing records, the supervisor's list and the table of docs/timing.md are generated from this
//! data, on which links and loops depend. A task's port is given at its spawn.

pub mod histogram;
pub mod timing;

use embassy_time::Duration;

/// Priority of a task: each level preempts those below it; tasks of one level are cooperative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// From data-ready to the motor frame.
    Flight,
    /// Fixed rates of 50 to 500 Hz.
    Steady,
    /// Without hard deadlines.
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

/// Supervision of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watch {
    /// A stalled task causes a watchdog reset.
    Watched,
    /// Not supervised: the vehicle flies without it.
    Unwatched,
}

/// Declaration of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Task {
    /// Name for logs.
    pub name: &'static str,
    /// Description.
    pub what: &'static str,
    /// The level that it runs on.
    pub level: Level,
    /// Time between two runs; the longest if it varies.
    pub period: Duration,
    /// Offset of its periods on the board's clock, so that a task runs after its data source; `None` for a task
    /// triggered by an input.
    pub phase: Option<Duration>,
    /// Time limit from release to the end of a run. docs/timing.md defines the release.
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

            /// Declaration of the task.
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
    /// Receiver, with each frame. The failsafe handles a lost radio.
    Rc "rc": Steady, each 20000 us, within 2000 us, Unwatched;
    /// Module of optical flow and range, with each frame. Manual flight does not need it.
    Ground "ground": Steady, each 20000 us, within 2000 us, Unwatched;
    /// Mode logic.
    Commander "commander": Steady, each 10000 us at 300 us, within 10000 us, Watched;
    /// Position, velocity and wind, for position hold. Idle without poses or flow; manual flight does not need it.
    Position "position": Steady, each 5000 us at 150 us, within 5000 us, Unwatched;
    /// Arm sensors. Their bus may stall; the mixer works without them.
    Arms "arms": Background, each 10000 us at 0 us, within 10000 us, Unwatched;
    /// Barometer, on a bus shared with arm sensors. Without it the fallback height is inertial.
    Barometer "barometer": Background, each 40000 us at 5000 us, within 40000 us, Unwatched;
    /// Telemetry to the pilot.
    Telemetry "telemetry": Background, each 50000 us at 0 us, within 50000 us, Unwatched;
    /// MAVLink to ground stations.
    Mavlink "mavlink": Background, each 20000 us at 0 us, within 20000 us, Unwatched;
    /// Renewal of a running actuator test; other console work has no fixed rate.
    Console "console": Background, each 50000 us, within 50000 us, Unwatched;
    /// Deadline supervision; feeds the watchdog. A stalled supervisor causes a reset.
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

    /// Time between two runs; the longest if it varies.
    pub const fn period(self) -> Duration {
        self.task().period
    }

    /// Offset of its periods on the board's clock; 0 for a task triggered by an input.
    pub const fn phase(self) -> Duration {
        match self.task().phase {
            Some(phase) => phase,
            None => Duration::MIN,
        }
    }

    /// Time limit from release to the end of a run.
    pub const fn deadline(self) -> Duration {
        self.task().deadline
    }
}
