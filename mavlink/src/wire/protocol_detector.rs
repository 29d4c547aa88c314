//! Tells MAVLink and text apart on a line that carries both, by what arrives, as PX4 and ArduPilot do on USB.
//!
//! The line begins with text. A sound frame makes it MAVLink's: one of version 2 that is known here, or a heartbeat of
//! version 1, which QGroundControl sends until it has heard version 2. A line of text between frames gives it back.

use heapless::Vec;
use mavlink_core::{MessageData, calculate_crc};

use crate::wire::frame::{OVERHEAD, SIGNATURE, SIGNED, STX};
use crate::wire::parser::{GAP, Parser};
use sophie_dialect::HEARTBEAT_DATA;

/// First byte of a MAVLink 1 frame.
const STX_1: u8 = 0xFE;
/// Bytes around its payload.
const OVERHEAD_1: usize = 8;
/// Payload of a heartbeat, in both versions.
const HEARTBEAT: usize = 9;
/// A heartbeat of version 1.
const HEARTBEAT_1: usize = OVERHEAD_1 + HEARTBEAT;

/// Whose line it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Speaks {
    /// The console's.
    #[default]
    Text,
    /// MAVLink's.
    Mavlink,
}

/// For whom a byte is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum For {
    /// The console.
    Console,
    /// The MAVLink server.
    Mavlink,
    /// The console, in place of bytes that were taken for a frame and were none: what was typed is not whole.
    Unreadable,
    /// The console, in place of the line that took the line back.
    Return,
    /// Neither.
    Neither,
}

/// Where the next byte belongs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Place {
    /// Between frames.
    #[default]
    Between,
    /// Length of the payload.
    Length { old: bool },
    /// Flags, which say whether a signature follows.
    Flags { payload: usize },
    /// Within a frame that has this many bytes to come.
    Within { left: usize },
}

/// Sorts the bytes of one line.
#[derive(Debug, Default)]
pub struct Sorter {
    speaks: Speaks,
    place: Place,
    /// Looks for frames while the line is the console's.
    frames: Parser,
    /// What may be a heartbeat of version 1.
    old: Vec<u8, HEARTBEAT_1>,
    /// Characters of a line of text between frames; `None` where another byte was among them.
    text: Option<usize>,
    /// When the newest byte arrived, µs.
    at: u64,
}

impl Sorter {
    /// Of a line that is the console's.
    pub const fn new() -> Self {
        Self {
            speaks: Speaks::Text,
            place: Place::Between,
            frames: Parser::new(),
            old: Vec::new(),
            text: Some(0),
            at: 0,
        }
    }

    /// Whose line it is.
    pub const fn speaks(&self) -> Speaks {
        self.speaks
    }

    /// Gives the line to the console: it was opened, closed or unplugged.
    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// Gives up a frame that has not gone on by `now`, µs; true where that left the console with less than was typed.
    pub fn gives_up(&mut self, now: u64) -> bool {
        let over = self.place != Place::Between && now.saturating_sub(self.at) > GAP;
        if over {
            self.leave_frame();
        }
        over && self.speaks == Speaks::Text
    }

    /// Takes a byte that arrived at `now`, µs, after [`Self::gives_up`]: for whom it is.
    pub fn take(&mut self, byte: u8, now: u64) -> For {
        self.at = now;
        match self.speaks {
            Speaks::Mavlink => self.within_mavlink(byte),
            Speaks::Text => self.within_text(byte, now),
        }
    }

    fn leave_frame(&mut self) {
        self.place = Place::Between;
        self.text = Some(0);
        self.old.clear();
    }

    /// Follows the frames; true at the end of one.
    fn follow(&mut self, byte: u8) -> bool {
        let value = usize::from(byte);
        let left = match self.place {
            Place::Between => {
                self.place = match byte {
                    STX | STX_1 => Place::Length { old: byte == STX_1 },
                    _ => Place::Between,
                };
                return false;
            }
            Place::Length { old: true } => value + OVERHEAD_1 - 2,
            Place::Length { old: false } => {
                self.place = Place::Flags { payload: value };
                return false;
            }
            Place::Flags { payload } => {
                let signature = if byte & SIGNED != 0 { SIGNATURE } else { 0 };
                payload + OVERHEAD + signature - 3
            }
            Place::Within { left } => left.saturating_sub(1),
        };
        self.place = Place::Within { left };
        if left == 0 {
            self.leave_frame();
        }
        left == 0
    }

    fn within_mavlink(&mut self, byte: u8) -> For {
        if self.place != Place::Between || matches!(byte, STX | STX_1) {
            self.follow(byte);
            return For::Mavlink;
        }
        match byte {
            b'\r' | b'\n' => {
                let line = self.text.replace(0).is_some_and(|length| length > 0);
                if line {
                    self.reset();
                    return For::Return;
                }
            }
            b' '..=b'~' => self.text = self.text.map(|length| length.saturating_add(1)),
            _ => self.text = None,
        }
        For::Mavlink
    }

    fn within_text(&mut self, byte: u8, now: u64) -> For {
        if self.place == Place::Between && !matches!(byte, STX | STX_1) {
            return For::Console;
        }
        let old = !self.old.is_empty() || (self.place == Place::Between && byte == STX_1);
        if old {
            let _ = self.old.push(byte);
        }
        let sound = if old {
            is_heartbeat(&self.old)
        } else {
            self.frames.push(byte, now).is_some()
        };
        // Nothing but a heartbeat is looked for in version 1; other flags are not known in version 2.
        let other = match self.place {
            Place::Flags { .. } => byte & !SIGNED != 0,
            _ => old && !may_be_heartbeat(&self.old),
        };
        let ended = self.follow(byte);
        if sound {
            self.leave_frame();
            self.speaks = Speaks::Mavlink;
        } else if ended || other {
            self.leave_frame();
            return For::Unreadable;
        }
        if old { For::Neither } else { For::Mavlink }
    }
}

/// The beginning of a MAVLink 1 frame is that of a heartbeat.
fn may_be_heartbeat(bytes: &[u8]) -> bool {
    let length = bytes
        .get(1)
        .is_none_or(|&length| usize::from(length) == HEARTBEAT);
    length && bytes.get(5).is_none_or(|&id| id == 0)
}

/// A whole and sound heartbeat of MAVLink 1.
fn is_heartbeat(bytes: &[u8]) -> bool {
    let Some((&[_, ref body @ ..], sum)) = bytes.split_last_chunk::<2>() else {
        return false;
    };
    bytes.len() == HEARTBEAT_1
        && may_be_heartbeat(bytes)
        && *sum == calculate_crc(body, HEARTBEAT_DATA::EXTRA_CRC).to_le_bytes()
}
