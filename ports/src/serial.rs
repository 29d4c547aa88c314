//! Serial lines of the receiver, the console, MAVLink and the flow module.

use crate::error::PortError;

/// A serial line towards the vehicle: the receiver's or the console's.
pub trait SerialInput {
    /// Waits for bytes and writes them to the start of `buffer`; returns their number, at the latest when the line
    /// idles. The future may be dropped before it is ready, without loss of bytes.
    ///
    /// # Errors
    /// A line error; the next call starts a new frame.
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError>;

    /// True for a cable, which no one else can read; false for a radio.
    fn private(&self) -> bool {
        true
    }
}

/// A serial line from the vehicle: to the receiver, which carries telemetry to the pilot, or to the console.
pub trait SerialOutput {
    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// The line does not accept the bytes.
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError>;

    /// False if the other end is known to be absent: then output for the line can be skipped.
    fn listens(&self) -> bool {
        true
    }
}
