//! Layout of a MAVLink 2 frame, and the encoder of sent frames.

use mavlink_core::{MAVLinkV2MessageRaw, MavHeader, MessageData, calculate_crc};

/// First byte of a MAVLink 2 frame. MAVLink 1 is not supported.
pub(crate) const STX: u8 = 0xFD;
/// Bytes around the payload of a frame without signature: start, header, checksum.
pub const OVERHEAD: usize = 12;
/// Bytes before the payload.
pub(crate) const HEADER: usize = 10;
/// Bytes of a signature.
pub const SIGNATURE: usize = 13;
/// Length of the longest frame, bytes.
pub const LONGEST: usize = OVERHEAD + 255 + SIGNATURE;
/// Incompatibility flag of a signed frame, the only supported one.
pub(crate) const SIGNED: u8 = 1;
/// System ID of the vehicle: 1, as of all autopilots.
pub const SYSTEM: u8 = 1;
/// Component ID of the autopilot (MAV_COMP_ID_AUTOPILOT1).
pub const COMPONENT: u8 = 1;

/// A frame with a valid checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Number of the message.
    pub id: u32,
    /// The sender's system.
    pub system: u8,
    /// The sender's component.
    pub component: u8,
    /// The message, without the zeros at its end.
    pub payload: &'a [u8],
    /// The frame has a signature.
    pub signed: bool,
    /// The whole frame, from the first byte to the checksum or the signature.
    pub bytes: &'a [u8],
}

/// Encodes frames and numbers them.
pub struct Encoder {
    raw: MAVLinkV2MessageRaw,
    system: u8,
    component: u8,
    sequence: u8,
    /// Frames get room for a signature.
    signed: bool,
}

impl Default for Encoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Encoder {
    /// The vehicle's encoder, before the first frame.
    pub const fn new() -> Self {
        Self::of(SYSTEM, COMPONENT)
    }

    /// The encoder of another component, such as a station.
    pub const fn of(system: u8, component: u8) -> Self {
        Self {
            raw: MAVLinkV2MessageRaw::new(),
            system,
            component,
            sequence: 0,
            signed: false,
        }
    }

    /// Sets whether following frames get room for a signature.
    pub const fn leave_room(&mut self, signed: bool) {
        self.signed = signed;
    }

    /// Makes the frame of `message`, with its trailing zeros left out; returns its length.
    pub fn encode<M: MessageData>(&mut self, message: &M) -> u32 {
        let header = MavHeader {
            system_id: self.system.into(),
            component_id: self.component,
            sequence: self.sequence,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.raw.serialize_message_data(header, message);
        if self.signed {
            self.mark(M::EXTRA_CRC);
        }
        self.frame().len() as u32
    }

    /// Marks the frame as signed, which its checksum covers.
    fn mark(&mut self, extra: u8) {
        *self.raw.incompatibility_flags_mut() |= SIGNED;
        let body = HEADER + usize::from(self.raw.payload_length());
        let bytes = self.raw.as_mut_slice();
        let sum = bytes.get(1..body).map(|bytes| calculate_crc(bytes, extra));
        if let (Some(sum), Some(place)) = (sum, bytes.get_mut(body..body + 2)) {
            place.copy_from_slice(&sum.to_le_bytes());
        }
    }

    /// The last frame, for signing.
    pub fn frame_mut(&mut self) -> &mut [u8] {
        let length = self.frame().len();
        self.raw.as_mut_slice().get_mut(..length).unwrap_or_default()
    }

    /// The last frame.
    pub fn frame(&self) -> &[u8] {
        self.raw.raw_bytes()
    }
}
