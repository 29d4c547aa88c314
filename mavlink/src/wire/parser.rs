//! Frames out of a stream of bytes that may be cut, garbled or flooded.
//!
//! Each received byte tests at most `CANDIDATES` frame starts in the buffer: the cost of a flood is bounded by the
//! line's rate.

use heapless::Vec;
use mavlink_core::calculate_crc;

use crate::wire::frame::{Frame, HEADER, LONGEST, SIGNATURE, SIGNED, STX};
use crate::wire::requests::crc_extra;

/// Largest number of frame starts tested for one received byte.
const CANDIDATES: usize = 4;
/// Silence after which an unfinished frame is dropped, µs: three of the longest frames at 57,600 baud.
pub(crate) const GAP: u64 = 150_000;

/// The start of the buffer.
enum Candidate {
    /// An incomplete frame.
    Incomplete,
    /// A valid frame of this length, bytes.
    Frame(usize),
    /// So many bytes that do not begin a frame.
    Useless(usize),
}

/// The frames of one line.
#[derive(Clone, Debug)]
pub struct Parser {
    /// Last byte of the checksum by message; `None` for a message that is not read.
    extra: fn(u32) -> Option<u8>,
    bytes: Vec<u8, LONGEST>,
    /// Length of the complete frame at the start of `bytes`; 0 without one.
    ready: usize,
    /// Time of the newest byte, µs.
    at: u64,
}

impl Default for Parser {
    fn default() -> Self {
        Self::new()
    }
}

impl Parser {
    /// The vehicle's parser: it reads what the vehicle takes.
    pub const fn new() -> Self {
        Self::reading(crc_extra)
    }

    /// A parser of the messages for which `extra` gives the last byte of their checksum.
    pub const fn reading(extra: fn(u32) -> Option<u8>) -> Self {
        Self {
            extra,
            bytes: Vec::new(),
            ready: 0,
            at: 0,
        }
    }

    /// Takes a byte received at `now`, µs; returns the frame that it completes.
    pub fn push(&mut self, byte: u8, now: u64) -> Option<Frame<'_>> {
        let ready = core::mem::take(&mut self.ready);
        self.discard(ready);
        if now.saturating_sub(self.at) > GAP {
            self.bytes.clear();
        }
        self.at = now;
        if (self.bytes.is_empty() && byte != STX) || self.bytes.push(byte).is_err() {
            return None;
        }
        for _ in 0..CANDIDATES {
            match self.candidate() {
                Candidate::Incomplete => return None,
                Candidate::Frame(length) => {
                    self.ready = length;
                    return self.frame();
                }
                Candidate::Useless(count) => self.discard(count),
            }
        }
        // The bytes are made to cost time: they are dropped.
        self.bytes.clear();
        None
    }

    fn candidate(&self) -> Candidate {
        let &[_, length, incompatible, .., a, b, c] = self.bytes.get(..HEADER).unwrap_or_default() else {
            let unknown = self.bytes.get(2).is_some_and(|flags| flags & !SIGNED != 0);
            return if unknown {
                Candidate::Useless(1)
            } else {
                Candidate::Incomplete
            };
        };
        if incompatible & !SIGNED != 0 {
            return Candidate::Useless(1);
        }
        let body = HEADER + usize::from(length);
        let signature = if incompatible & SIGNED != 0 { SIGNATURE } else { 0 };
        let whole = body + 2 + signature;
        if self.bytes.len() < whole {
            return Candidate::Incomplete;
        }
        // The checksum of an unknown message cannot be tested. All of it is skipped: its content could look like a
        // frame.
        let Some(extra) = (self.extra)(u32::from_le_bytes([a, b, c, 0])) else {
            return Candidate::Useless(whole);
        };
        let sum = self.bytes.get(1..body).map(|bytes| calculate_crc(bytes, extra));
        let sent = self.bytes.get(body..body + 2);
        if sum.is_some_and(|sum| sent == Some(&sum.to_le_bytes())) {
            Candidate::Frame(whole)
        } else {
            Candidate::Useless(1)
        }
    }

    fn frame(&self) -> Option<Frame<'_>> {
        let &[_, length, flags, _, _, system, component, a, b, c] = self.bytes.get(..HEADER)? else {
            return None;
        };
        Some(Frame {
            id: u32::from_le_bytes([a, b, c, 0]),
            system,
            component,
            payload: self.bytes.get(HEADER..HEADER + usize::from(length))?,
            signed: flags & SIGNED != 0,
            bytes: self.bytes.get(..self.ready)?,
        })
    }

    /// Drops the first `count` bytes, and further ones up to the next start of a frame.
    fn discard(&mut self, count: usize) {
        if count == 0 {
            return;
        }
        let mut kept = 0;
        let mut begun = false;
        for from in count..self.bytes.len() {
            let byte = self.bytes.get(from).copied().unwrap_or_default();
            begun |= byte == STX;
            if begun && let Some(slot) = self.bytes.get_mut(kept) {
                *slot = byte;
                kept += 1;
            }
        }
        self.bytes.truncate(kept);
    }
}
