//! SBUS, Futaba's receiver protocol: 100 kbaud, 8 data bits, even parity, 2 stop bits, inverted.
//!
//! | byte | what |
//! |---|---|
//! | 0 | 0x0F |
//! | 1..=22 | 16 channels of 11 bits, lowest bit first |
//! | 23 | flags: 0x04 frame lost, 0x08 failsafe, 0x01 and 0x02 the switch channels |
//! | 24 | 0x00, or 0x04 with a slot number in the upper nibble (SBUS2) |
//!
//! Counts are those of CRSF: 172 and 1811 at the stick's ends, 992 at its centre.
//!
//! A frame that ends in SBUS2's byte is followed by the slots of telemetry sensors on the same wire: 8 of 3 bytes each
//! (number, value), 660 µs apart, from 2 ms after the frame on. They are skipped, and cost nothing.
//!
//! Without a checksum, a frame must begin after silence or right after another frame; after garbage or slots on an
//! unbroken stream, the first frame only locates the second. Sticks are accepted from the third frame in a row: random
//! bytes after silence form one with probability p = 1/256 · 1/16 · 5/256 = 1/210,000 (header, flags, end). The other
//! two may each begin at 25 places where four of five ends announce slots, so three in a row are at most
//! p · (25 · 4/5 · p + p)² = 5e-14 a silence: at the 300 silences of 3 ms that fit into a second of pure noise, one
//! in 2,000 years.
//!
//! Frames with a lost transmitter or a repetition publish no sticks: the link turns stale and the failsafe acts.

use embassy_time::{Duration, Instant};
use sophie_control::pilot::rc::{CHANNELS, ChannelError, Sticks};
use sophie_ports::receiver::{RcDecoder, RcState};

/// Bytes per frame.
pub const FRAME: usize = 25;
const HEADER: u8 = 0x0F;
const CHANNEL_BITS: u32 = 11;
const FLAGS: u8 = 0x0F;
/// Twelve bits.
const BYTE: Duration = Duration::from_micros(120);
/// Pause between frames. Receivers leave 4 ms or more, and none within a frame.
const SILENCE: Duration = Duration::from_millis(3);
/// Bytes of the eight telemetry slots that may follow an SBUS2 frame.
const SLOTS: u8 = 24;
/// Consecutive frames before sticks are accepted.
const TRUSTED_FROM: u8 = 3;

/// A frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// Counts, 0..=2047.
    pub channels: [u16; CHANNELS],
    /// Channel 17, a switch.
    pub channel_17: bool,
    /// Channel 18, a switch.
    pub channel_18: bool,
    /// The last frame repeated for a missed one.
    pub frame_lost: bool,
    /// The transmitter is lost: the channels are failsafe values.
    pub failsafe: bool,
}

/// Reason for no sticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SbusError {
    /// No frame.
    Garbage,
    /// Repeated frame.
    FrameLost,
    /// Transmitter lost.
    Failsafe,
    /// A channel without a pulse.
    Channel(ChannelError),
}

impl Frame {
    /// Decodes a frame; `None` unless header, flags and end fit.
    pub fn decode(bytes: &[u8; FRAME]) -> Option<Self> {
        let [header, payload @ .., flags, end] = bytes;
        if *header != HEADER || flags & !FLAGS != 0 || !is_end(*end) {
            return None;
        }
        let mut channels = [0; CHANNELS];
        let (mut held, mut held_bits) = (0u32, 0);
        let mut source = payload.iter();
        for channel in &mut channels {
            while held_bits < CHANNEL_BITS {
                held |= u32::from(*source.next()?) << held_bits;
                held_bits += 8;
            }
            *channel = (held & 0x7FF) as u16;
            held >>= CHANNEL_BITS;
            held_bits -= CHANNEL_BITS;
        }
        Some(Self {
            channels,
            channel_17: flags & 0x01 != 0,
            channel_18: flags & 0x02 != 0,
            frame_lost: flags & 0x04 != 0,
            failsafe: flags & 0x08 != 0,
        })
    }

    /// Encodes a frame; channels are cut to 11 bits.
    pub fn encode(&self) -> [u8; FRAME] {
        let mut bytes = [0; FRAME];
        let [header, payload @ .., flags, _end] = &mut bytes;
        *header = HEADER;
        *flags = u8::from(self.channel_17)
            | u8::from(self.channel_18) << 1
            | u8::from(self.frame_lost) << 2
            | u8::from(self.failsafe) << 3;
        let (mut held, mut held_bits) = (0u32, 0);
        let mut source = self.channels.iter();
        for byte in payload {
            if held_bits < 8 {
                held |= u32::from(source.next().copied().unwrap_or(0) & 0x7FF) << held_bits;
                held_bits += CHANNEL_BITS;
            }
            *byte = held as u8;
            held >>= 8;
            held_bits -= 8;
        }
        bytes
    }

    /// The pilot's sticks.
    ///
    /// # Errors
    /// A frame that the receiver made up, or a channel without a pulse: the caller drops it, so the link turns stale.
    pub fn sticks(&self) -> Result<Sticks, SbusError> {
        if self.failsafe {
            return Err(SbusError::Failsafe);
        }
        if self.frame_lost {
            return Err(SbusError::FrameLost);
        }
        Sticks::from_channels(&self.channels).map_err(SbusError::Channel)
    }
}

const fn is_end(byte: u8) -> bool {
    byte == 0x00 || announces_slots(byte)
}

const fn announces_slots(end: u8) -> bool {
    end & 0xCF == 0x04
}

/// Finds frames in a stream of bytes, in pieces of any length.
///
/// [`Parser::silence`] must be called wherever the line was idle (4 ms or more after each frame): constant data can
/// look like misplaced frames.
#[derive(Clone, Copy, Debug)]
pub struct Parser {
    bytes: [u8; FRAME],
    count: usize,
    /// Began after silence or a whole frame.
    aligned: bool,
    /// Bytes that slots may still send.
    slots: u8,
}

impl Default for Parser {
    fn default() -> Self {
        Self::new()
    }
}

impl Parser {
    /// A parser at an unknown place in a stream.
    pub const fn new() -> Self {
        Self {
            bytes: [0; FRAME],
            count: 0,
            aligned: false,
            slots: 0,
        }
    }

    /// Bytes are missing: drops an unfinished frame and its alignment.
    pub fn gap(&mut self) {
        (self.count, self.aligned, self.slots) = (0, false, 0);
    }

    /// The line was idle: the next byte starts a frame. True if an unfinished frame was dropped.
    pub fn silence(&mut self) -> bool {
        // A header within a slot.
        let slots = u8::try_from(self.count)
            .ok()
            .and_then(|count| self.slots.checked_sub(count))
            .filter(|_| !self.aligned);
        let dropped = self.count > 0 && slots.is_none();
        if self.count > 0 {
            self.slots = slots.unwrap_or(0);
        }
        (self.count, self.aligned) = (0, true);
        dropped
    }

    /// Next frame or report of garbage in `bytes`, which is advanced; `None` at its end.
    ///
    /// # Errors
    /// [`SbusError::Garbage`], once for each run of discarded bytes.
    pub fn next_frame(&mut self, bytes: &mut &[u8]) -> Option<Result<Frame, SbusError>> {
        loop {
            let (&byte, rest) = bytes.split_first()?;
            *bytes = rest;
            // First of its run.
            let lost = self.aligned || self.slots > 0;
            if let Some(slot) = self.bytes.get_mut(self.count) {
                *slot = byte;
                self.count += 1;
            }
            if self.count == 1 && byte != HEADER {
                self.count = 0;
                if let Some(left) = self.slots.checked_sub(1) {
                    // After the last slot comes a frame.
                    (self.slots, self.aligned) = (left, left == 0);
                    continue;
                }
                self.aligned = false;
                if lost {
                    return Some(Err(SbusError::Garbage));
                }
                continue;
            }
            if self.count < FRAME {
                continue;
            }
            let Some(frame) = Frame::decode(&self.bytes) else {
                self.resume();
                self.slots = 0;
                if lost {
                    return Some(Err(SbusError::Garbage));
                }
                continue;
            };
            self.slots = if self.bytes.last().is_some_and(|end| announces_slots(*end)) {
                SLOTS
            } else {
                0
            };
            self.count = 0;
            if core::mem::replace(&mut self.aligned, true) {
                return Some(Ok(frame));
            }
        }
    }

    /// Looks for another start in the gathered bytes.
    fn resume(&mut self) {
        self.aligned = false;
        let next = self
            .bytes
            .iter()
            .skip(1)
            .position(|&b| b == HEADER)
            .map(|at| at + 1);
        match next {
            Some(start) => {
                self.bytes.copy_within(start.., 0);
                self.count = FRAME - start;
            }
            None => self.count = 0,
        }
    }
}

/// Decodes sticks from the bytes of a line.
#[derive(Clone, Copy, Debug)]
pub struct Decoder {
    parser: Parser,
    state: RcState,
    in_a_row: u8,
    last: Option<Instant>,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder without data.
    pub fn new() -> Self {
        Self {
            parser: Parser::new(),
            state: RcState::default(),
            in_a_row: 0,
            last: None,
        }
    }

    /// Last decoded state, including frames that were not published.
    pub const fn state(&self) -> &RcState {
        &self.state
    }

    fn garbage(&mut self) {
        self.in_a_row = 0;
        self.state.errors = self.state.errors.wrapping_add(1);
    }
}

impl RcDecoder for Decoder {
    fn take(&mut self, mut bytes: &[u8], at: Instant) -> Option<RcState> {
        // A read ends with its last byte.
        let length = BYTE * u32::try_from(bytes.len()).unwrap_or(u32::MAX);
        let before = self.last.replace(at);
        let pause = before.map_or(Duration::MIN, |before| at.saturating_duration_since(before));
        if pause >= length + SILENCE && self.parser.silence() {
            self.garbage();
        }
        let mut news = false;
        while let Some(result) = self.parser.next_frame(&mut bytes) {
            let Ok(frame) = result else {
                self.garbage();
                continue;
            };
            self.in_a_row = self.in_a_row.saturating_add(1).min(TRUSTED_FROM);
            self.state.frames = self.state.frames.wrapping_add(1);
            match frame.sticks() {
                Ok(sticks) if self.in_a_row >= TRUSTED_FROM => {
                    self.state.sticks = sticks;
                    news = true;
                }
                Ok(_) => (),
                // Earlier frames may be repetitions.
                Err(SbusError::Failsafe | SbusError::FrameLost) => news = false,
                Err(_) => {
                    news = false;
                    self.garbage();
                }
            }
        }
        news.then_some(self.state)
    }

    fn broken(&mut self, at: Instant) {
        self.last = Some(at);
        self.parser.gap();
        self.garbage();
    }
}

#[cfg(test)]
mod tests;
