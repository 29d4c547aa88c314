//! Serial lines: of the receiver, the console, MAVLink and the flow module.

use crate::error::PortError;

/// A serial line towards the vehicle: the receiver's or the console's.
pub trait SerialInput {
    /// Waits for bytes and puts them at the start of `buffer`; returns how many, at the latest when the line idles. The
    /// future may be dropped before it is ready, and loses nothing then.
    ///
    /// # Errors
    /// A line error; the next call starts a new frame.
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError>;

    /// What is typed stays between both ends: a cable, and no radio.
    fn private(&self) -> bool {
        true
    }
}

/// A serial line from the vehicle: to the receiver, which carries telemetry to the pilot, or to the console.
pub trait SerialOutput {
    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// A line that does not take them.
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError>;

    /// Someone may be there. Where it is known that no one is, nothing needs to be made for the line.
    fn listens(&self) -> bool {
        true
    }
}
