//! Text output to a terminal, which may be absent.

use core::fmt::{self, Write};

use embassy_time::{Duration, Timer, with_timeout};
use heapless::String;

use sophie_ports::error::PortError;
use sophie_ports::serial::SerialOutput;

/// Longest line written, bytes; more is cut off. 160 take 14 ms at 115,200 baud.
const LENGTH: usize = 160;
/// Write time-out of a line, after which it is dropped.
const PATIENCE: Duration = Duration::from_millis(200);
/// Time to transmit the last line before a restart: 23 ms in the boards' buffers at 115,200 baud; over MAVLink one run
/// of its task, plus twice 70 bytes at a tenth of its budget.
const FAREWELL: Duration = Duration::from_millis(400);

/// Output of a terminal.
pub(super) struct Output<O> {
    port: O,
    /// A write timed out: further output of the same command is dropped.
    stalled: bool,
    /// The line to send. Lines are formatted and sent in this one place: a hundred separate format calls would cost 12
    /// KB of flash.
    text: Cut,
}

impl<O: SerialOutput> Output<O> {
    pub(super) const fn new(port: O) -> Self {
        Self {
            port,
            stalled: false,
            text: Cut(String::new()),
        }
    }

    /// Enables output again after a write time-out.
    pub(super) const fn resume(&mut self) {
        self.stalled = false;
    }

    pub(super) fn line<'a>(&'a mut self, text: fmt::Arguments<'_>) -> impl Future<Output = ()> + use<'a, O> {
        self.format(text);
        self.flush()
    }

    /// Writes a line before a restart and waits until the port's buffer has drained.
    pub(super) async fn last(&mut self, text: fmt::Arguments<'_>) {
        self.line(text).await;
        Timer::after(FAREWELL).await;
    }

    pub(super) async fn bytes(&mut self, bytes: &[u8]) {
        send(&mut self.port, &mut self.stalled, bytes).await;
    }

    #[inline(never)]
    fn format(&mut self, text: fmt::Arguments<'_>) {
        let Cut(line) = &mut self.text;
        line.clear();
        // Never an error: what does not fit is cut off.
        let _ = self.text.write_fmt(text);
        let Cut(line) = &mut self.text;
        let _ = line.push_str("\r\n");
    }

    async fn flush(&mut self) {
        let Self { port, stalled, text } = self;
        send(port, stalled, text.0.as_bytes()).await;
    }
}

async fn send(port: &mut impl SerialOutput, stalled: &mut bool, bytes: &[u8]) {
    if *stalled || bytes.is_empty() {
        return;
    }
    let sent = with_timeout(PATIENCE, port.write(bytes)).await;
    *stalled = sent.unwrap_or(Err(PortError::Timeout)).is_err();
}

/// A line that keeps room for its end.
struct Cut(String<{ LENGTH + 2 }>);

impl Write for Cut {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for c in text.chars() {
            if self.0.len() < LENGTH {
                let c = if c.is_ascii() { c } else { '?' };
                self.0.push(c).map_err(|_| fmt::Error)?;
            }
        }
        Ok(())
    }
}
