//! The firmware's log, decoded as by a probe's host.

use defmt_decoder::{DecodeError, StreamDecoder, Table};

/// A line of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Time of reading, ms: at most one after writing.
    pub ms: u64,
    /// The firmware's time stamp.
    pub stamp: String,
    /// `ERROR`, `WARN`, `INFO`, `DEBUG` or `TRACE`; empty without level.
    pub level: &'static str,
    /// Text.
    pub text: String,
}

impl std::fmt::Display for Line {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:>11} {:5} {}", self.stamp, self.level, self.text)
    }
}

/// Decoder of a run.
pub struct Log<'a> {
    decoder: Box<dyn StreamDecoder + Send + Sync + 'a>,
    recovers: bool,
    /// Parts that could not be decoded.
    pub malformed: u32,
}

impl<'a> Log<'a> {
    /// For an image with `table`.
    #[must_use]
    pub fn new(table: &'a Table) -> Self {
        Self {
            decoder: table.new_stream_decoder(),
            recovers: table.encoding().can_recover(),
            malformed: 0,
        }
    }

    /// Takes bytes read at `ms`; returns completed lines.
    pub fn take(&mut self, ms: u64, bytes: &[u8]) -> Vec<Line> {
        let mut lines = Vec::new();
        if bytes.is_empty() {
            return lines;
        }
        self.decoder.received(bytes);
        loop {
            match self.decoder.decode() {
                Ok(frame) => lines.push(Line {
                    ms,
                    stamp: frame
                        .display_timestamp()
                        .map_or(String::new(), |stamp| stamp.to_string()),
                    level: frame.level().map_or("", |level| match level.as_str() {
                        "error" => "ERROR",
                        "warn" => "WARN",
                        "info" => "INFO",
                        "debug" => "DEBUG",
                        _ => "TRACE",
                    }),
                    text: frame.display_message().to_string(),
                }),
                Err(DecodeError::UnexpectedEof) => return lines,
                Err(DecodeError::Malformed) => {
                    self.malformed += 1;
                    if !self.recovers {
                        return lines;
                    }
                }
            }
        }
    }
}
