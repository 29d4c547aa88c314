//! What is typed, byte by byte: lines for commands, and keys for those that last.

use core::task::Poll;

use embassy_futures::poll_once;
use embassy_time::{Duration, Instant, Timer, with_deadline};

use sophie_ports::error::PortError;
use sophie_ports::serial::SerialInput;

/// Most keys that one look at them takes: a line that is full of noise must not hold its reader.
const KEYS: usize = 256;
/// Bytes taken at once.
pub(super) const CHUNK: usize = 32;
/// Pause after a line error or an empty read, so that a dead line cannot take the processor.
pub(super) const PAUSE: Duration = Duration::from_millis(1);
/// Ctrl-C: every command ends with it, and a line that was begun is dropped. Stands for a broken line as well.
pub const CANCEL: u8 = 0x03;

/// A terminal's keyboard.
pub(super) struct Keys<I> {
    port: I,
    chunk: [u8; CHUNK],
    /// Bytes of the chunk that are taken, and that it has.
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

    /// What is typed stays between both ends.
    pub(super) fn private(&self) -> bool {
        self.port.private()
    }

    /// Waits for bytes; `Ok(false)` where a read gives none.
    pub(super) async fn wait(&mut self) -> Result<bool, PortError> {
        if self.taken >= self.filled {
            (self.taken, self.filled) = (0, 0);
            self.filled = self.port.read(&mut self.chunk).await?;
        }
        Ok(self.taken < self.filled)
    }

    /// The next byte of those that are there. CR LF is one end of a line, and so is telnet's CR NUL.
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

    /// The key that has been pressed, if any; [`CANCEL`] where the line is broken.
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

    /// A key was pressed, or the line is broken; what was typed until now is gone then.
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
    /// The next key, of those that come within `time`; `None` where none does or the line breaks.
    pub(super) async fn key(&mut self, time: Duration) -> Option<u8> {
        let until = Instant::now() + time;
        loop {
            if let Some(byte) = self.next() {
                return Some(byte);
            }
            match with_deadline(until, self.wait()).await {
                Ok(Ok(true)) => (),
                Ok(Ok(false)) => Timer::after(PAUSE).await,
                Ok(Err(_)) | Err(_) => return None,
            }
        }
    }
}
