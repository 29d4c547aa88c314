//! Byte pipe between the console and the MAVLink server, which carries it in `SERIAL_CONTROL`.

use embassy_sync::pipe::Pipe;
use heapless::Vec;
use sophie_mavlink::services::shell::CHUNK;

use crate::links::last_value::Raw;
use sophie_ports::error::PortError;
use sophie_ports::serial::{SerialInput, SerialOutput};

/// Buffered bytes in each direction: two commands; one console line and its end.
const TYPED: usize = 256;
const SAID: usize = 256;

/// Both directions of the pipe.
pub struct ConsolePipe {
    typed: Pipe<Raw, TYPED>,
    said: Pipe<Raw, SAID>,
}

impl Default for ConsolePipe {
    fn default() -> Self {
        Self::new()
    }
}

impl ConsolePipe {
    /// An empty pipe.
    pub const fn new() -> Self {
        Self {
            typed: Pipe::new(),
            said: Pipe::new(),
        }
    }

    /// The console's end.
    pub const fn port(&self) -> ConsolePipePort<'_> {
        ConsolePipePort(self)
    }

    /// Passes `bytes` to the console; bytes beyond the buffer are lost, as on a cable.
    pub(crate) fn type_in(&self, bytes: &[u8]) {
        let mut rest = bytes;
        while let Ok(taken) = self.typed.try_write(rest)
            && taken > 0
        {
            rest = rest.get(taken..).unwrap_or_default();
        }
    }

    /// Drops pending console output: its reader has changed or gone.
    pub(crate) fn drop_said(&self) {
        self.said.clear();
    }

    /// Next console output, at most one message's payload.
    pub(crate) fn said(&self) -> Vec<u8, CHUNK> {
        let mut bytes = [0; CHUNK];
        let count = self.said.try_read(&mut bytes).unwrap_or(0);
        Vec::from_slice(bytes.get(..count).unwrap_or_default()).unwrap_or_default()
    }
}

/// The console's end of a [`ConsolePipe`].
#[derive(Clone, Copy)]
pub struct ConsolePipePort<'a>(&'a ConsolePipe);

impl SerialInput for ConsolePipePort<'_> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        Ok(self.0.typed.read(buffer).await)
    }

    fn private(&self) -> bool {
        false
    }
}

impl SerialOutput for ConsolePipePort<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        self.0.said.write_all(bytes).await;
        Ok(())
    }
}
