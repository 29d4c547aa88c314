//! Terminal input byte by byte: lines for commands, single keys for running commands.

use core::task::Poll;

use embassy_futures::poll_once;
use embassy_time::Duration;

use sophie_ports::error::PortError;
use sophie_ports::serial::SerialInput;

/// Most keys consumed per poll: continuous noise on the line must not block the reader.
const KEYS: usize = 256;
/// Bytes per read.
pub(super) const CHUNK: usize = 32;
/// Pause after a line error or an empty read, so that a dead line cannot take the processor.
pub(super) const PAUSE: Duration = Duration::from_millis(1);
/// Ctrl-C: aborts a running command and drops an unfinished line. A receive error is reported as the same byte.
pub const CANCEL: u8 = 0x03;

/// Input of a terminal.
pub(super) struct Keys<I> {
    port: I,
    chunk: [u8; CHUNK],
    /// Bytes consumed of the chunk, and its length.
    taken: usize,
    filled: usize,
    after_cr: bool,
}

impl<I: SerialInput> Keys<I> {
    pub(super) const fn new(port: I) -> Self {
        Self {
            port,
            chunk: [0; CHUNK],
            taken: 0,
            filled: 0,
            after_cr: false,
        }
    }

    /// True if no third party can read the input on its way.
    pub(super) fn private(&self) -> bool {
        self.port.private()
    }

    /// Waits for bytes; `Ok(false)` after an empty read.
    pub(super) async fn wait(&mut self) -> Result<bool, PortError> {
        if self.taken >= self.filled {
            (self.taken, self.filled) = (0, 0);
            self.filled = self.port.read(&mut self.chunk).await?;
        }
        Ok(self.taken < self.filled)
    }

    /// Next byte of the chunk. CR LF is one line end, as is telnet's CR NUL.
    pub(super) fn next(&mut self) -> Option<u8> {
        while self.taken < self.filled {
            let byte = self.chunk.get(self.taken).copied()?;
            self.taken += 1;
            let after_cr = core::mem::replace(&mut self.after_cr, byte == b'\r');
            if !(after_cr && matches!(byte, b'\n' | 0)) {
                return Some(byte);
            }
        }
        None
    }

    /// Key pressed since the last call, if any; [`CANCEL`] after a receive error.
    pub(super) fn poll(&mut self) -> Option<u8> {
        if let Some(byte) = self.next() {
            return Some(byte);
        }
        match poll_once(self.wait()) {
            Poll::Ready(Ok(true)) => self.next(),
            Poll::Ready(Err(_)) => Some(CANCEL),
            Poll::Ready(Ok(false)) | Poll::Pending => None,
        }
    }

    /// True if a key was pressed or the line failed; pending input is discarded.
    pub(super) fn pressed(&mut self) -> bool {
        let mut pressed = false;
        for _ in 0..KEYS {
            match self.poll() {
                None => break,
                Some(CANCEL) => return true,
                Some(_) => pressed = true,
            }
        }
        pressed
    }
}
