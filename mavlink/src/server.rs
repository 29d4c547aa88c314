//! The server of one link.

use sophie_control::mode::Mode;

use crate::dialect::{HEARTBEAT_DATA, MavAutopilot, MavModeFlag, MavState, MavType};
use crate::frame::Encoder;
use crate::vehicle::Vehicle;

/// Time between two heartbeats, µs: the standard's one second.
const HEARTBEAT_PERIOD: u64 = 1_000_000;
/// The version of the protocol in every heartbeat.
const MAVLINK_VERSION: u8 = 3;

/// The server of one link.
pub struct Server {
    encoder: Encoder,
    heartbeat_at: u64,
}

impl Default for Server {
    fn default() -> Self {
        Self::new()
    }
}

impl Server {
    /// Before the first byte.
    pub const fn new() -> Self {
        Self {
            encoder: Encoder::new(),
            heartbeat_at: 0,
        }
    }

    /// Takes `bytes` that arrived at `now`, µs since the start.
    pub fn receive(&mut self, _bytes: &[u8], _now: u64) {}

    /// The next frame that is due at `now`, µs since the start.
    pub fn send(&mut self, now: u64, vehicle: &Vehicle) -> Option<&[u8]> {
        if now < self.heartbeat_at {
            return None;
        }
        self.heartbeat_at = now.saturating_add(HEARTBEAT_PERIOD);
        Some(self.encoder.encode(&heartbeat(vehicle)))
    }
}

/// What the vehicle is and does.
fn heartbeat(vehicle: &Vehicle) -> HEARTBEAT_DATA {
    let mut base_mode = MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED;
    if vehicle.mode.is_some_and(|mode| !mode.rotors_stand()) {
        base_mode |= MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED;
    }
    let state = match vehicle.mode {
        None => MavState::MAV_STATE_UNINIT,
        Some(Mode::Calibrating) => MavState::MAV_STATE_CALIBRATING,
        Some(Mode::Disarmed) => MavState::MAV_STATE_STANDBY,
        Some(Mode::Failsafe) => MavState::MAV_STATE_CRITICAL,
        Some(_) => MavState::MAV_STATE_ACTIVE,
    };
    HEARTBEAT_DATA {
        custom_mode: vehicle.mode.map_or(0, |mode| mode as u32),
        mavtype: MavType::MAV_TYPE_QUADROTOR as u8,
        autopilot: MavAutopilot::MAV_AUTOPILOT_GENERIC as u8,
        base_mode: base_mode.bits() as u8,
        system_status: state as u8,
        mavlink_version: MAVLINK_VERSION,
    }
}
