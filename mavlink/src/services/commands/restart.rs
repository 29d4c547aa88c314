//! Restart of the board, storing of the parameters, and the brown-out level of the chip.

use super::orders::Answerer;
use super::{Received, whole};
use crate::services::Services;
use crate::vehicle::Vehicle;
use sophie_dialect::*;

/// Delay of a restart, µs: the acknowledgement is sent first.
const RESTART_DELAY_US: u64 = 300_000;

impl Services {
    pub(super) fn reboot(&mut self, autopilot: f32, now: u64, vehicle: &Vehicle) -> MavResult {
        match whole(autopilot) {
            Some(1) if vehicle.at_rest() => {
                self.restart_at = Some(now.saturating_add(RESTART_DELAY_US));
                MavResult::MAV_RESULT_ACCEPTED
            }
            Some(1) => self.refuse_armed(),
            _ => self.unsupported("1 restarts, nothing else"),
        }
    }

    /// Has the brown-out level set; `None` if the acknowledgement comes later.
    pub(super) fn brown_out(&mut self, received: &Received<'_>) -> Option<MavResult> {
        let [confirmed, ..] = received.command.params;
        match whole(confirmed) {
            Some(1) if received.vehicle.at_rest() => {
                if let Err(answer) = self.begin(received, Answerer::Board) {
                    return answer;
                }
                self.set_brown_out = true;
                None
            }
            Some(1) => Some(self.refuse_armed()),
            _ => Some(self.unsupported("1 sets it, nothing else")),
        }
    }

    /// Acknowledges that the brown-out level is set, or why it is not.
    pub(crate) fn brown_out_done(&mut self, result: Result<(), &'static str>) {
        match result {
            Ok(()) => self.settle(Answerer::Board, MavResult::MAV_RESULT_ACCEPTED),
            Err(why) => {
                self.texts.say(
                    MavSeverity::MAV_SEVERITY_ERROR,
                    format_args!("brown-out level not set: {why}"),
                );
                self.settle(Answerer::Board, MavResult::MAV_RESULT_FAILED);
            }
        }
    }

    pub(super) fn storage(&mut self, parameters: f32, vehicle: &Vehicle) -> MavResult {
        match whole(parameters) {
            Some(1) if vehicle.at_rest() => {
                self.store_now = true;
                MavResult::MAV_RESULT_ACCEPTED
            }
            Some(1) => self.refuse_armed(),
            _ => self.unsupported("1 stores, nothing else"),
        }
    }
}
