//! Distinguishes MAVLink and text on a line that carries both, by the received bytes, as PX4 and ArduPilot do on USB.
//!
//! The line begins with text. A valid frame switches it to MAVLink: a known one of version 2, or a heartbeat of version
//! 1, which QGroundControl sends until it receives version 2. A line of text between frames switches it back.

use heapless::Vec;
use mavlink_core::{MessageData, calculate_crc};

use crate::wire::frame::{OVERHEAD, SIGNATURE, SIGNED, STX};
use crate::wire::parser::{GAP, Parser};
use sophie_dialect::HEARTBEAT_DATA;

/// First byte of a MAVLink 1 frame.
const STX_1: u8 = 0xFE;
/// Bytes around the payload of a MAVLink 1 frame.
const OVERHEAD_1: usize = 8;
/// Payload of a heartbeat in both versions, bytes.
const HEARTBEAT: usize = 9;
/// Length of a MAVLink 1 heartbeat, bytes.
const HEARTBEAT_1: usize = OVERHEAD_1 + HEARTBEAT;

/// The protocol of the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Protocol {
    /// Text of the console.
    #[default]
    Text,
    /// MAVLink frames.
    Mavlink,
}

/// Receiver of a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// The console.
    Console,
    /// The MAVLink server.
    Mavlink,
    /// The console, in place of bytes that looked like a frame and were not: the typed line is not complete.
    Unreadable,
    /// The console, as the end of the text line that switched the protocol back.
    Reclaim,
    /// Neither.
    Neither,
}

/// Position of the next byte.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Place {
    /// Between frames.
    #[default]
    Between,
    /// Length of the payload.
    Length { old: bool },
    /// Flags, which contain the mark of a signature.
    Flags { payload: usize },
    /// Within a frame, with so many bytes to come.
    Within { left: usize },
}

/// Routes the bytes of one line.
#[derive(Debug, Default)]
pub struct ProtocolDetector {
    protocol: Protocol,
    place: Place,
    /// Detects frames while the protocol is text.
    frames: Parser,
    /// A possible heartbeat of version 1.
    old: Vec<u8, HEARTBEAT_1>,
    /// Length of the text line between frames; `None` once it contains a byte that is not text.
    text: Option<usize>,
    /// Time of the newest byte, µs.
    at: u64,
}

impl ProtocolDetector {
    /// A line that begins with text.
    pub const fn new() -> Self {
        Self {
            protocol: Protocol::Text,
            place: Place::Between,
            frames: Parser::new(),
            old: Vec::new(),
            text: Some(0),
            at: 0,
        }
    }

    /// The protocol of the line.
    pub const fn protocol(&self) -> Protocol {
        self.protocol
    }

    /// Switches back to text, after the line was opened, closed or unplugged.
    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// Drops a frame that has stalled by `now`, µs; true if the console lost typed bytes with it.
    pub fn expires(&mut self, now: u64) -> bool {
        let over = self.place != Place::Between && now.saturating_sub(self.at) > GAP;
        if over {
            self.leave_frame();
        }
        over && self.protocol == Protocol::Text
    }

    /// Takes a byte received at `now`, µs, after [`Self::expires`]; returns its receiver.
    pub fn take(&mut self, byte: u8, now: u64) -> Route {
        self.at = now;
        match self.protocol {
            Protocol::Mavlink => self.within_mavlink(byte),
            Protocol::Text => self.within_text(byte, now),
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

    fn within_mavlink(&mut self, byte: u8) -> Route {
        if self.place != Place::Between || matches!(byte, STX | STX_1) {
            self.follow(byte);
            return Route::Mavlink;
        }
        match byte {
            b'\r' | b'\n' => {
                let line = self.text.replace(0).is_some_and(|length| length > 0);
                if line {
                    self.reset();
                    return Route::Reclaim;
                }
            }
            b' '..=b'~' => self.text = self.text.map(|length| length.saturating_add(1)),
            _ => self.text = None,
        }
        Route::Mavlink
    }

    fn within_text(&mut self, byte: u8, now: u64) -> Route {
        if self.place == Place::Between && !matches!(byte, STX | STX_1) {
            return Route::Console;
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
        // In version 1 only a heartbeat is detected; in version 2, other flags are unknown.
        let other = match self.place {
            Place::Flags { .. } => byte & !SIGNED != 0,
            _ => old && !may_be_heartbeat(&self.old),
        };
        let ended = self.follow(byte);
        if sound {
            self.leave_frame();
            self.protocol = Protocol::Mavlink;
        } else if ended || other {
            self.leave_frame();
            return Route::Unreadable;
        }
        if old { Route::Neither } else { Route::Mavlink }
    }
}

/// True if these bytes can begin a MAVLink 1 heartbeat.
fn may_be_heartbeat(bytes: &[u8]) -> bool {
    let length = bytes
        .get(1)
        .is_none_or(|&length| usize::from(length) == HEARTBEAT);
    length && bytes.get(5).is_none_or(|&id| id == 0)
}

/// True for a complete and valid MAVLink 1 heartbeat.
fn is_heartbeat(bytes: &[u8]) -> bool {
    let Some((&[_, ref body @ ..], sum)) = bytes.split_last_chunk::<2>() else {
        return false;
    };
    bytes.len() == HEARTBEAT_1
        && may_be_heartbeat(bytes)
        && *sum == calculate_crc(body, HEARTBEAT_DATA::EXTRA_CRC).to_le_bytes()
}
