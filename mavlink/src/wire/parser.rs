//! Frames out of a stream of bytes, however it is cut, garbled or flooded.
//!
//! Each byte costs at most `CANDIDATES` looks at what is buffered, so that a flood costs its line rate and no more.

use heapless::Vec;
use mavlink_core::calculate_crc;

use crate::wire::frame::{Frame, HEADER, LONGEST, SIGNATURE, SIGNED, STX};
use crate::wire::requests::crc_extra;

/// Beginnings of frames looked at for one byte that arrives.
const CANDIDATES: usize = 4;
/// Silence after which an unfinished frame is given up, µs: three of the longest at 57,600 baud.
pub(crate) const GAP: u64 = 150_000;

/// What the buffer begins with.
enum Look {
    /// A frame that is not complete.
    Incomplete,
    /// A sound frame of this length.
    Frame(usize),
    /// This many bytes that are of no use.
    Useless(usize),
}

/// The frames of one line.
#[derive(Clone, Debug, Default)]
pub struct Parser {
    bytes: Vec<u8, LONGEST>,
    /// Length of the sound frame at the start of `bytes`; 0 where there is none.
    ready: usize,
    /// When the newest byte arrived, µs.
    at: u64,
}

impl Parser {
    /// Before the first byte.
    pub const fn new() -> Self {
        Self {
            bytes: Vec::new(),
            ready: 0,
            at: 0,
        }
    }

    /// Takes a byte that arrived at `now`, µs; gives the frame that it completes.
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
            match self.look() {
                Look::Incomplete => return None,
                Look::Frame(length) => {
                    self.ready = length;
                    return self.frame();
                }
                Look::Useless(count) => self.discard(count),
            }
        }
        // Made to cost time: what follows is looked at from its next beginning.
        self.bytes.clear();
        None
    }

    fn look(&self) -> Look {
        let &[_, length, incompatible, .., a, b, c] = self.bytes.get(..HEADER).unwrap_or_default() else {
            let unknown = self.bytes.get(2).is_some_and(|flags| flags & !SIGNED != 0);
            return if unknown {
                Look::Useless(1)
            } else {
                Look::Incomplete
            };
        };
        if incompatible & !SIGNED != 0 {
            return Look::Useless(1);
        }
        let body = HEADER + usize::from(length);
        let signature = if incompatible & SIGNED != 0 { SIGNATURE } else { 0 };
        let whole = body + 2 + signature;
        if self.bytes.len() < whole {
            return Look::Incomplete;
        }
        // A message that is not known cannot be checked: all of it is skipped, since what lies in it is not for here.
        let Some(extra) = crc_extra(u32::from_le_bytes([a, b, c, 0])) else {
            return Look::Useless(whole);
        };
        let sum = self.bytes.get(1..body).map(|bytes| calculate_crc(bytes, extra));
        let sent = self.bytes.get(body..body + 2);
        if sum.is_some_and(|sum| sent == Some(&sum.to_le_bytes())) {
            Look::Frame(whole)
        } else {
            Look::Useless(1)
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

    /// Drops the first `count` bytes and what follows up to the next beginning of a frame.
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
