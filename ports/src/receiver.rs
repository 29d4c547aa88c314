//! The radio receiver's protocol, and what it gives.

use embassy_time::Instant;
use sophie_control::pilot::rc::Sticks;

/// State of the radio link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RcState {
    /// The pilot's wishes.
    pub sticks: Sticks,
    /// Frames decoded since power-up.
    pub frames: u32,
    /// Frames or bytes rejected since power-up.
    pub errors: u32,
}

/// The receiver's protocol: frames and counts out of the bytes of its line.
///
/// A read may end anywhere in a frame, and a late one may hold several frames with the pauses between them; but a pause
/// lies at the start of a read or between the whole frames that the read begins with, as [`SerialInput`](crate::serial::SerialInput) gives them. A
/// protocol whose frames are found by pauses (SBUS) cannot place one within a read that begins in mid-frame, as only the
/// read has a time: it publishes nothing then, rather than half of one frame with half of another.
pub trait RcDecoder {
    /// Takes bytes that were there at `at`; gives the state when they held at least one good frame of channels and
    /// the radio is not known to be lost.
    fn take(&mut self, bytes: &[u8], at: Instant) -> Option<RcState>;

    /// The line has failed at `at`: bytes are missing.
    fn broken(&mut self, at: Instant);
}
