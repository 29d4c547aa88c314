//! SBUS, Futaba's receiver protocol: 100 kbaud, 8 data bits, even parity, 2 stop bits, inverted.
//!
//! | byte | what |
//! |---|---|
//! | 0 | 0x0F |
//! | 1..=22 | 16 channels of 11 bits, lowest bit first |
//! | 23 | flags: 0x04 frame lost, 0x08 failsafe, 0x01 and 0x02 the switch channels |
//! | 24 | 0x00, or 0x04 with a slot number in the upper nibble (SBUS2) |
//!
//! The counts are those of CRSF: 172 and 1811 at the ends of a stick's travel, 992 at its centre, so a frame's
//! channels go into the same table of meanings.
//!
//! There is no checksum. A frame is found only where it began after silence or where the frame before it ended;
//! after garbage on an unbroken stream, the first frame found serves to find the second. And the pilot's sticks are accepted
//! only from the third frame on that comes without garbage between: bytes that are no SBUS look like one frame now
//! and then (in 70,000 random ones after silence), hardly ever like three.
//!
//! A receiver that has lost its transmitter says so in the flags: such frames, and those that it repeats, publish no
//! sticks, so that the link turns stale and the failsafe acts.

use embassy_time::{Duration, Instant};
use sophie_control::rc::{CHANNELS, ChannelError, Sticks};
use sophie_tasks::links::RcState;
use sophie_tasks::ports::RcDecoder;

/// Bytes of a frame.
pub const FRAME: usize = 25;
/// First byte.
const HEADER: u8 = 0x0F;
/// Bits of a channel.
const CHANNEL_BITS: u32 = 11;
/// Flags that mean something; no receiver sets the others.
const FLAGS: u8 = 0x0F;
/// Time that a byte takes on the line: twelve bits.
const BYTE: Duration = Duration::from_micros(120);
/// Pause of the line that parts two frames. Receivers leave 4 ms and more; within a frame there is none.
const SILENCE: Duration = Duration::from_millis(3);
/// Frames in a row from which on the sticks are accepted.
const BELIEVED_FROM: u8 = 3;

/// One frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// Counts, 0..=2047.
    pub channels: [u16; CHANNELS],
    /// Channel 17, a switch.
    pub channel_17: bool,
    /// Channel 18, a switch.
    pub channel_18: bool,
    /// The receiver missed this frame from its transmitter and repeats the one before.
    pub frame_lost: bool,
    /// The receiver has given its transmitter up: the channels are its failsafe values.
    pub failsafe: bool,
}

/// Why bytes are not the pilot's wishes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SbusError {
    /// Bytes that are no frame.
    Garbage,
    /// The receiver repeats an old frame.
    FrameLost,
    /// The receiver has lost its transmitter.
    Failsafe,
    /// A channel outside what a transmitter sends.
    Channel(ChannelError),
}

impl Frame {
    /// The frame in these bytes; `None` unless header, flags and end fit.
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

    /// The bytes of this frame, as a receiver sends them; channels are cut to 11 bits.
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

    /// What the pilot wishes.
    ///
    /// # Errors
    /// A frame that the receiver made up, or a channel out of range: it is to be dropped as if it had not
    /// come, so that the link turns stale.
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
    byte == 0x00 || byte & 0xCF == 0x04
}

/// Finds frames in a stream of bytes, however it is cut.
///
/// Call [`Parser::silence`] wherever the line was idle (a receiver's is, for 4 ms or more after each frame): data
/// that stands still can look like frames at the wrong place, and only silence separates them.
#[derive(Clone, Copy, Debug)]
pub struct Parser {
    bytes: [u8; FRAME],
    count: usize,
    /// The frame being gathered began after silence or after a whole frame.
    aligned: bool,
}

impl Default for Parser {
    fn default() -> Self {
        Self::new()
    }
}

impl Parser {
    /// A parser somewhere in a stream.
    pub const fn new() -> Self {
        Self {
            bytes: [0; FRAME],
            count: 0,
            aligned: false,
        }
    }

    /// Bytes are missing here: an unfinished frame is dropped, and the next byte may be any of a frame.
    pub fn gap(&mut self) {
        (self.count, self.aligned) = (0, false);
    }

    /// The line has been silent for longer than a byte: the next byte starts a frame. True if bytes of an
    /// unfinished frame were dropped.
    pub fn silence(&mut self) -> bool {
        let dropped = self.count > 0;
        (self.count, self.aligned) = (0, true);
        dropped
    }

    /// The next frame, or one report of garbage, in `bytes`, which is moved behind what was taken; `None` when
    /// it is used up.
    ///
    /// # Errors
    /// [`SbusError::Garbage`] where the stream is no SBUS, once for each run of bytes thrown away.
    pub fn next_frame(&mut self, bytes: &mut &[u8]) -> Option<Result<Frame, SbusError>> {
        loop {
            let (&byte, rest) = bytes.split_first()?;
            *bytes = rest;
            let lost = self.aligned;
            if let Some(slot) = self.bytes.get_mut(self.count) {
                *slot = byte;
                self.count += 1;
            }
            if self.count == 1 && byte != HEADER {
                (self.count, self.aligned) = (0, false);
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
                if lost {
                    return Some(Err(SbusError::Garbage));
                }
                continue;
            };
            self.count = 0;
            if core::mem::replace(&mut self.aligned, true) {
                return Some(Ok(frame));
            }
        }
    }

    /// Looks for another start among the bytes gathered.
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

/// The pilot's wishes out of the bytes of a line.
#[derive(Clone, Copy, Debug)]
pub struct Decoder {
    parser: Parser,
    state: RcState,
    /// Frames in a row without garbage between.
    in_a_row: u8,
    /// When the line was last read, or failed.
    last: Option<Instant>,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder that has heard nothing yet.
    pub fn new() -> Self {
        Self {
            parser: Parser::new(),
            state: RcState::default(),
            in_a_row: 0,
            last: None,
        }
    }

    fn garbage(&mut self) {
        self.in_a_row = 0;
        self.state.errors = self.state.errors.wrapping_add(1);
    }
}

impl RcDecoder for Decoder {
    fn take(&mut self, mut bytes: &[u8], at: Instant) -> Option<RcState> {
        // A read ends when its last byte is there, so these bytes began their own length earlier.
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
            self.in_a_row = self.in_a_row.saturating_add(1).min(BELIEVED_FROM);
            self.state.frames = self.state.frames.wrapping_add(1);
            match frame.sticks() {
                Ok(sticks) if self.in_a_row >= BELIEVED_FROM => {
                    self.state.sticks = sticks;
                    news = true;
                }
                Ok(_) => (),
                // What came just before the report may be the last frame over again.
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
