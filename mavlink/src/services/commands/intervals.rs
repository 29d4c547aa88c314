//! Requests for single messages, and the periods of streams.

use mavlink_core::MessageData;
use sophie_control::mode::Mode;

use super::{Reply, or_zero, whole};
use crate::services::Services;
use crate::services::answer::Answer;
use crate::services::streams::{PERIOD_MIN_US, STREAMS};
use sophie_dialect::*;

/// Longest interval, µs, 35 minutes: the range of MESSAGE_INTERVAL.
const PERIOD_MAX_US: u32 = i32::MAX as u32;
const NO_NUMBER: &str = "no message has that number";

impl Services {
    pub(super) fn set_interval(&mut self, id: f32, interval: f32, now: u64) -> MavResult {
        let Some(id) = whole(id) else {
            return self.deny(NO_NUMBER);
        };
        let Some(stream) = STREAMS.iter().find(|stream| stream.id == id) else {
            return MavResult::MAV_RESULT_UNSUPPORTED;
        };
        let period = match whole(interval) {
            Some(0) => stream.period_ms * 1000,
            Some(period) if (PERIOD_MIN_US..=PERIOD_MAX_US).contains(&period) => period,
            // -1 turns a stream off, except heartbeats, by which others know the vehicle.
            None if whole(-interval) == Some(1) && id != HEARTBEAT_DATA::ID => 0,
            _ => return self.deny("an interval is 20 ms to 35 min, 0 or -1"),
        };
        match self.schedule.set_period(id, period, now) {
            Some(()) => MavResult::MAV_RESULT_ACCEPTED,
            None => MavResult::MAV_RESULT_UNSUPPORTED,
        }
    }

    pub(super) fn get_interval(&mut self, id: f32) -> Reply {
        let Some(id) = whole(id).and_then(|id| u16::try_from(id).ok()) else {
            return self.deny(NO_NUMBER).into();
        };
        let interval_us = match self.schedule.period(id.into()) {
            Some(0) => -1,
            Some(period) => i32::try_from(period).unwrap_or(i32::MAX),
            // 0: not available.
            None => 0,
        };
        Answer::Interval { id, interval_us }.into()
    }

    /// Answers the request for one message; `index` selects one of several.
    pub(super) fn once(&mut self, id: f32, index: f32) -> Reply {
        let Some(id) = whole(id) else {
            return self.deny(NO_NUMBER).into();
        };
        match id {
            AUTOPILOT_VERSION_DATA::ID => Answer::Version.into(),
            SOPHIE_ARMING_DATA::ID => Answer::Arming.into(),
            COMPONENT_INFORMATION_BASIC_DATA::ID => Answer::Component.into(),
            COMPONENT_METADATA_DATA::ID => Answer::Metadata.into(),
            AVAILABLE_MODES_DATA::ID => match whole(or_zero(index)) {
                Some(0) => Answer::Mode { index: 1, all: true }.into(),
                Some(index) if index as usize <= Mode::ALL.len() => Answer::Mode {
                    index: index as u8,
                    all: false,
                }
                .into(),
                _ => self.deny("no such mode").into(),
            },
            id if STREAMS.iter().any(|stream| stream.id == id) => Answer::Stream(id).into(),
            _ => MavResult::MAV_RESULT_UNSUPPORTED.into(),
        }
    }
}
