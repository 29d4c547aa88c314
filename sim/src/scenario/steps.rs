//! Steps of a scenario file: names, numbers, allowed order.

use core::f64::consts::PI;

use super::Step;
use super::keys::Range;
use sophie_ports::retained::StartCause;

/// One kind of step.
pub struct StepKind {
    /// Name in file and record.
    pub name: &'static str,
    /// Its numbers.
    pub numbers: &'static [StepNumber],
    /// Makes the step from its numbers, SI.
    pub build: fn([f64; 3]) -> Step,
}

/// A number of a step.
pub struct StepNumber {
    /// Key in the file.
    pub key: &'static str,
    /// Allowed range.
    pub range: Range,
    /// Default, in the unit of the file.
    pub default: f64,
}

const fn number(key: &'static str, range: Range, default: f64) -> StepNumber {
    StepNumber { key, range, default }
}

const HEIGHT: Range = Range::new(0.5, 30.0, "m");
const PLACE: Range = Range::new(-50.0, 50.0, "m");
const PERCH_THROTTLE: StepNumber = number("throttle_percent", Range::new(5.0, 60.0, "%").times(0.01), 30.0);
/// Longest radio silence after which the vehicle surely still flies, s: the link turns stale after 0.5 s; 1 s later
/// only sticks end the failsafe.
const FLIES_ON: f64 = 1.4;

const RESET: &[StepNumber] = &[
    number("after_s", Range::new(0.0, 60.0, "s"), 1.0),
    number("off_s", Range::new(0.02, 60.0, "s"), 0.3),
    number("push_n", Range::new(0.0, 20.0, "N"), 0.0),
];

fn reset(cause: StartCause, [after, off, push]: [f64; 3]) -> Step {
    Step::Reset {
        cause,
        after,
        off,
        push,
    }
}

/// Every kind of step.
pub const STEPS: &[StepKind] = &[
    StepKind {
        name: "arm",
        numbers: &[],
        build: |_| Step::Arm,
    },
    StepKind {
        name: "take-off",
        numbers: &[number("height_m", HEIGHT, 3.0)],
        build: |[height, ..]| Step::TakeOff { height },
    },
    StepKind {
        name: "hover",
        numbers: &[number("seconds", Range::new(0.1, 600.0, "s"), 5.0)],
        build: |[seconds, ..]| Step::Hover { seconds },
    },
    StepKind {
        name: "roll",
        numbers: &[
            number("angle_deg", Range::new(1.0, 35.0, "deg").times(PI / 180.0), 25.0),
            number("seconds", Range::new(0.5, 5.0, "s"), 2.5),
        ],
        build: |[angle, seconds, _]| Step::Roll { angle, seconds },
    },
    StepKind {
        name: "fly-to-pipe",
        numbers: &[],
        build: |_| Step::FlyToPipe,
    },
    StepKind {
        name: "touch",
        numbers: &[],
        build: |_| Step::Touch,
    },
    StepKind {
        name: "clamp",
        numbers: &[PERCH_THROTTLE],
        build: |[throttle, ..]| Step::Clamp { throttle },
    },
    StepKind {
        name: "perch",
        numbers: &[PERCH_THROTTLE],
        build: |[throttle, ..]| Step::Perch { throttle },
    },
    StepKind {
        name: "hold",
        numbers: &[
            number("seconds", Range::new(0.1, 600.0, "s"), 20.0),
            number("push_n", Range::new(0.0, 20.0, "N"), 1.5),
            number("lapse_min", Range::new(0.0, 600.0, "min").times(60.0), 0.0),
        ],
        build: |[seconds, push, lapse]| Step::Hold { seconds, push, lapse },
    },
    StepKind {
        name: "open",
        numbers: &[],
        build: |_| Step::Open,
    },
    StepKind {
        name: "release",
        numbers: &[],
        build: |_| Step::Release,
    },
    StepKind {
        name: "yaw",
        numbers: &[
            number(
                "heading_deg",
                Range::new(-180.0, 180.0, "deg").times(PI / 180.0),
                90.0,
            ),
            number("seconds", Range::new(0.1, 600.0, "s"), 3.0),
        ],
        build: |[heading, seconds, _]| Step::Yaw { heading, seconds },
    },
    StepKind {
        name: "fly-to",
        numbers: &[
            number("north_m", PLACE, 0.0),
            number("east_m", PLACE, 0.0),
            number("height_m", HEIGHT, 2.0),
        ],
        build: |[north, east, height]| Step::FlyTo { north, east, height },
    },
    StepKind {
        name: "land",
        numbers: &[],
        build: |_| Step::Land,
    },
    StepKind {
        name: "disarm",
        numbers: &[],
        build: |_| Step::Disarm,
    },
    StepKind {
        name: "radio-off",
        numbers: &[number("seconds", Range::new(0.05, 600.0, "s"), 5.0)],
        build: |[seconds, ..]| Step::RadioOff { seconds },
    },
    StepKind {
        name: "reset",
        numbers: RESET,
        build: |numbers| reset(StartCause::Watchdog, numbers),
    },
    StepKind {
        name: "power-cycle",
        numbers: RESET,
        build: |numbers| reset(StartCause::PowerOn, numbers),
    },
];

/// Duration of a hold's lapse, s: the grip's loop takes seconds, so that it follows.
pub const LAPSE_TIME: f64 = 60.0;

impl Step {
    /// Duration of a hold of `seconds` with a `lapse`, s.
    #[must_use]
    pub fn hold_time(seconds: f64, lapse: f64) -> f64 {
        seconds + if lapse > 0.0 { LAPSE_TIME } else { 0.0 }
    }

    /// Name in scenario files and flight records.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Arm => "arm",
            Self::TakeOff { .. } => "take-off",
            Self::Hover { .. } => "hover",
            Self::Roll { .. } => "roll",
            Self::FlyToPipe => "fly-to-pipe",
            Self::Touch => "touch",
            Self::Clamp { .. } => "clamp",
            Self::Perch { .. } => "perch",
            Self::Hold { .. } => "hold",
            Self::Open => "open",
            Self::Release => "release",
            Self::Yaw { .. } => "yaw",
            Self::FlyTo { .. } => "fly-to",
            Self::Land => "land",
            Self::Disarm => "disarm",
            Self::RadioOff { .. } => "radio-off",
            Self::Reset { cause, .. } if cause.loses_memory() => "power-cycle",
            Self::Reset { .. } => "reset",
        }
    }
}

/// State of the vehicle between two steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Whereabouts {
    OnGroundDisarmed,
    OnGroundArmed,
    InAir,
    OverPipe,
    OnPipe,
    Closing,
    Clamped,
    Opening,
    /// Clamped, after a restart.
    Hanging,
    /// Without pilot until it sinks or has landed.
    Sinking,
}

impl Whereabouts {
    /// State after `step`, or when the step is possible.
    pub(super) fn after(self, step: &Step) -> Result<Self, String> {
        use Whereabouts::*;
        let (from, to): (&[Self], Self) = match step {
            Step::Arm if self == Hanging => (&[Hanging], Clamped),
            Step::Arm => (&[OnGroundDisarmed], OnGroundArmed),
            Step::TakeOff { .. } => (&[OnGroundArmed], InAir),
            Step::Hover { .. } if self == OverPipe => (&[OverPipe], OverPipe),
            Step::Hover { .. } | Step::FlyTo { .. } => (&[InAir, OverPipe, Sinking], InAir),
            Step::Roll { .. } | Step::Yaw { .. } => (&[InAir, OverPipe], InAir),
            Step::FlyToPipe => (&[InAir], OverPipe),
            Step::Touch => (&[OverPipe], OnPipe),
            Step::Clamp { .. } => (&[OnPipe], Closing),
            Step::Perch { .. } => (&[OnPipe, Closing], Clamped),
            Step::Hold { .. } => (&[Clamped], Clamped),
            Step::Open => (&[Clamped], Opening),
            Step::Release => (&[Clamped, Opening], OverPipe),
            Step::Reset { .. } => match self {
                OnGroundDisarmed | OnGroundArmed => (&[OnGroundDisarmed, OnGroundArmed], OnGroundDisarmed),
                InAir => (&[InAir], Sinking),
                _ => (&[Closing, Clamped, Opening, Hanging], Hanging),
            },
            // Above the pipe the vehicle cannot land on the ground.
            Step::Land => (&[InAir], OnGroundArmed),
            Step::Disarm => (&[OnGroundArmed, Sinking], OnGroundDisarmed),
            Step::RadioOff { seconds } if self == InAir && *seconds > FLIES_ON => (&[InAir], Sinking),
            Step::RadioOff { .. } => (&[InAir, Closing, Clamped], self),
        };
        if from.contains(&self) {
            return Ok(to);
        }
        let when: Vec<&str> = from.iter().map(|w| w.words()).collect();
        Err(format!(
            "only {}, but here the vehicle is {}",
            when.join(" or "),
            self.words()
        ))
    }

    const fn words(self) -> &'static str {
        match self {
            Self::OnGroundDisarmed => "on the ground, disarmed",
            Self::OnGroundArmed => "on the ground, armed",
            Self::InAir => "in free flight",
            Self::OverPipe => "over the pipe",
            Self::OnPipe => "touching the pipe",
            Self::Closing => "closing its arms on the pipe",
            Self::Clamped => "clamped to the pipe",
            Self::Opening => "letting go of the pipe",
            Self::Hanging => "clamped to the pipe, disarmed by a reset",
            Self::Sinking => "sinking without a radio",
        }
    }
}
