//! Restart of the board, storing of the parameters, and the brown-out level of the chip.

use super::whole;
use crate::services::Services;
use crate::vehicle::Vehicle;
use sophie_dialect::*;

/// Delay of a restart, µs: the acknowledgement is sent first.
const LAST_WORDS: u64 = 300_000;

impl Services {
    pub(super) fn reboot(&mut self, autopilot: f32, now: u64, vehicle: &Vehicle) -> MavResult {
        match whole(autopilot) {
            Some(1) if vehicle.at_rest() => {
                self.restart_at = Some(now.saturating_add(LAST_WORDS));
                MavResult::MAV_RESULT_ACCEPTED
            }
            Some(1) => self.refuse_armed(),
            _ => self.unsupported("1 restarts, nothing else"),
        }
    }

    pub(super) fn brown_out(&mut self, confirmed: f32, vehicle: &Vehicle) -> MavResult {
        match whole(confirmed) {
            Some(1) if vehicle.at_rest() => {
                self.set_brown_out = true;
                MavResult::MAV_RESULT_ACCEPTED
            }
            Some(1) => self.refuse_armed(),
            _ => self.unsupported("1 sets it, nothing else"),
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
