//! The radio receiver: decoder of its protocol, and the link's state.

use embassy_time::Instant;
use sophie_control::pilot::rc::Sticks;

/// State of the radio link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RcState {
    /// The pilot's sticks and switches.
    pub sticks: Sticks,
    /// Frames decoded since power-up.
    pub frames: u32,
    /// Frames or bytes rejected since power-up.
    pub errors: u32,
}

/// Decoder of the receiver's protocol: extracts frames and counts from the bytes of its line.
///
/// A read may end anywhere in a frame, and a late one may hold several frames with the pauses between them; but a pause
/// lies at the start of a read or between the whole frames with which the read begins, as
/// [`SerialInput`](crate::serial::SerialInput) delivers them. A protocol that finds its frames by pauses (SBUS) cannot
/// place one within a read that begins in mid-frame, as only the read has a time: it then publishes nothing rather than
/// half of one frame with half of another.
pub trait RcDecoder {
    /// Takes bytes received at `at`; returns the state if they completed at least one good frame of channels and the
    /// radio is not known to be lost.
    fn take(&mut self, bytes: &[u8], at: Instant) -> Option<RcState>;

    /// The line failed at `at`: bytes are missing.
    fn broken(&mut self, at: Instant);
}
