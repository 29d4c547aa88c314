//! Frames that are sent.

use mavlink_core::{MAVLinkV2MessageRaw, MavHeader, MessageData};

/// The vehicle's number among systems: the first, as autopilots have it.
pub const SYSTEM: u8 = 1;
/// The autopilot's number among the vehicle's components (MAV_COMP_ID_AUTOPILOT1).
pub const COMPONENT: u8 = 1;

/// Makes frames, numbered as they are sent.
pub struct Encoder {
    raw: MAVLinkV2MessageRaw,
    sequence: u8,
}

impl Default for Encoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Encoder {
    /// Before the first frame.
    pub const fn new() -> Self {
        Self {
            raw: MAVLinkV2MessageRaw::new(),
            sequence: 0,
        }
    }

    /// Makes the frame of `message`, with its trailing zeros left out; returns its length.
    pub fn encode<M: MessageData>(&mut self, message: &M) -> u32 {
        let header = MavHeader {
            system_id: SYSTEM.into(),
            component_id: COMPONENT,
            sequence: self.sequence,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.raw.serialize_message_data(header, message);
        self.frame().len() as u32
    }

    /// The frame that was made last.
    pub fn frame(&self) -> &[u8] {
        self.raw.raw_bytes()
    }
}
