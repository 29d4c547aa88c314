//! Answers to requests, kept until the line has room.

use crate::services::parameters::Place;
use crate::services::streams::{STREAMS, frame_bytes};
use crate::wire::requests::Peer;
use sophie_dialect::*;

/// An answer to a request, made into a frame when the line has room.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Answer {
    Ack {
        command: u16,
        result: MavResult,
        /// Progress of a long command, %.
        progress: u8,
        to: Peer,
    },
    Ping(PING_DATA),
    Timesync(TIMESYNC_DATA),
    /// A TIMESYNC request to a sender of inputs.
    AskTime(Peer),
    Interval {
        id: u16,
        interval_us: i32,
    },
    Parameter(Place),
    /// The row of a report that waits.
    Row,
    /// The failing arming checks.
    Arming,
    /// Board, chip and version.
    Component,
    /// The end of the newest calibration step.
    CalibrationResult,
    /// A stream's message, once.
    Stream(u32),
    /// The servo battery, behind the flight battery.
    ServoBattery,
    Version,
    /// The address of the description of the parameters.
    Metadata,
    /// This mode; if all were requested, the following ones as well.
    Mode {
        index: u8,
        all: bool,
    },
}

impl Answer {
    /// Length of its frame at most, bytes.
    pub(crate) fn bytes(&self) -> u32 {
        match self {
            Self::Ack { .. } => frame_bytes::<COMMAND_ACK_DATA>(),
            Self::Ping(_) => frame_bytes::<PING_DATA>(),
            Self::Timesync(_) | Self::AskTime(_) => frame_bytes::<TIMESYNC_DATA>(),
            Self::Interval { .. } => frame_bytes::<MESSAGE_INTERVAL_DATA>(),
            Self::Parameter(_) => frame_bytes::<PARAM_VALUE_DATA>(),
            Self::Row => frame_bytes::<SOPHIE_CHECK_DATA>(),
            Self::Arming => frame_bytes::<SOPHIE_ARMING_DATA>(),
            Self::Component => frame_bytes::<COMPONENT_INFORMATION_BASIC_DATA>(),
            Self::CalibrationResult => frame_bytes::<SOPHIE_CALIBRATION_RESULT_DATA>(),
            Self::Stream(id) => STREAMS.iter().find(|s| s.id == *id).map_or(0, |s| s.bytes),
            Self::ServoBattery => frame_bytes::<BATTERY_STATUS_DATA>(),
            Self::Version => frame_bytes::<AUTOPILOT_VERSION_DATA>(),
            Self::Metadata => frame_bytes::<COMPONENT_METADATA_DATA>(),
            Self::Mode { .. } => frame_bytes::<AVAILABLE_MODES_DATA>(),
        }
    }
}
