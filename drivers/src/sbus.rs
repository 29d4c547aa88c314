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
//! There is no checksum. A frame is believed only if it began where the line had been silent or where the
//! frame before it ended; after garbage on an unbroken stream, the first frame found serves to find the
//! second.

use sophie_control::rc::{CHANNELS, ChannelError, Sticks};

/// Bytes of a frame.
pub const FRAME: usize = 25;
/// First byte.
const HEADER: u8 = 0x0F;
/// Bits of a channel.
const CHANNEL_BITS: u32 = 11;

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
    /// The frame in these bytes; `None` unless header and end fit.
    pub fn decode(bytes: &[u8; FRAME]) -> Option<Self> {
        let [header, payload @ .., flags, end] = bytes;
        if *header != HEADER || !is_end(*end) {
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
/// Call [`Parser::silence`] wherever the line was idle (a receiver is, for 4 ms or more after each frame): data
/// that stands still can look like frames at the wrong place, and only silence tells.
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
    /// A parser at the start of a stream, which it takes for the start of a frame.
    pub const fn new() -> Self {
        Self {
            bytes: [0; FRAME],
            count: 0,
            aligned: true,
        }
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

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use proptest::prelude::*;
    use sophie_control::rc::StickMode;

    use super::*;

    fn stream(parser: &mut Parser, mut bytes: &[u8]) -> (Vec<Frame>, usize) {
        let (mut frames, mut errors) = (Vec::new(), 0);
        while let Some(result) = parser.next_frame(&mut bytes) {
            match result {
                Ok(frame) => frames.push(frame),
                Err(_) => errors += 1,
            }
        }
        (frames, errors)
    }

    fn pilot() -> Frame {
        let sticks = Sticks {
            roll: 0.5,
            throttle: 0.3,
            arm_switch: true,
            stick_mode: StickMode::Rate,
            ..Default::default()
        };
        Frame {
            channels: sticks.to_channels(),
            ..Default::default()
        }
    }

    #[test]
    fn a_known_frame() {
        // Every channel at its centre, 992: the bit pattern repeats each eleven bytes.
        let mut bytes = [0; FRAME];
        bytes[0] = 0x0F;
        let centre = [0xE0, 0x03, 0x1F, 0xF8, 0xC0, 0x07, 0x3E, 0xF0, 0x81, 0x0F, 0x7C];
        bytes[1..12].copy_from_slice(&centre);
        bytes[12..23].copy_from_slice(&centre);
        let frame = Frame::decode(&bytes).unwrap();
        assert_eq!(frame.channels, [992; 16]);
        assert_eq!(frame.encode(), bytes);
        bytes[24] = 0x24;
        assert!(Frame::decode(&bytes).is_some());
        bytes[24] = 0x05;
        assert!(Frame::decode(&bytes).is_none());
    }

    #[test]
    fn sticks_mean_what_they_mean_over_crsf() {
        let sticks = pilot().sticks().unwrap();
        assert!(
            (sticks.roll - 0.5).abs() < 2e-3 && (sticks.throttle - 0.3).abs() < 2e-3 && sticks.arm_switch
        );
        assert_eq!(
            Frame {
                failsafe: true,
                ..pilot()
            }
            .sticks(),
            Err(SbusError::Failsafe)
        );
        assert_eq!(
            Frame {
                frame_lost: true,
                ..pilot()
            }
            .sticks(),
            Err(SbusError::FrameLost)
        );
        let mut silly = pilot();
        silly.channels[2] = 0;
        assert!(matches!(silly.sticks(), Err(SbusError::Channel(e)) if e.channel == 3));
    }

    #[test]
    fn a_frame_after_garbage_is_not_believed_before_the_stream_is_understood() {
        let good = pilot().encode();
        let mut bytes = Vec::from([0x55; 11]);
        for _ in 0..3 {
            bytes.extend(good);
        }
        let (frames, errors) = stream(&mut Parser::new(), &bytes);
        assert_eq!((frames.len(), errors), (2, 1));
        // With silence before it, the very first is.
        let mut parser = Parser::new();
        assert!(stream(&mut parser, &[0x55; 11]).0.is_empty());
        parser.silence();
        assert_eq!(stream(&mut parser, &good).0, [pilot()]);
    }

    #[test]
    fn a_lost_byte_costs_its_frame_and_the_next() {
        let good = pilot().encode();
        for lost in 0..FRAME {
            let mut bytes = Vec::from(good);
            let mut broken = Vec::from(good);
            broken.remove(lost);
            bytes.extend(broken);
            for _ in 0..4 {
                bytes.extend(good);
            }
            let (frames, errors) = stream(&mut Parser::new(), &bytes);
            assert!(
                frames.len() >= 3 && frames.iter().all(|f| *f == pilot()),
                "{lost}: {}",
                frames.len()
            );
            assert!(errors >= 1, "{lost}");
        }
    }

    proptest! {
        #[test]
        fn encoding_and_decoding_are_inverse(
            channels in proptest::array::uniform16(0u16..2048), flags in 0u8..16,
        ) {
            let frame = Frame {
                channels,
                channel_17: flags & 1 != 0,
                channel_18: flags & 2 != 0,
                frame_lost: flags & 4 != 0,
                failsafe: flags & 8 != 0,
            };
            prop_assert_eq!(Frame::decode(&frame.encode()), Some(frame));
        }

        #[test]
        fn frames_are_found_however_the_stream_is_cut(cut in 1usize..60, count in 1usize..20) {
            let bytes: Vec<u8> = (0..count).flat_map(|_| pilot().encode()).collect();
            let mut parser = Parser::new();
            let found: usize = bytes.chunks(cut).map(|chunk| stream(&mut parser, chunk).0.len()).sum();
            prop_assert_eq!(found, count);
        }

        #[test]
        fn any_garbage_is_survived(garbage in proptest::collection::vec(any::<u8>(), 0..200)) {
            let mut bytes = garbage;
            for _ in 0..6 {
                bytes.extend(pilot().encode());
            }
            let (frames, _) = stream(&mut Parser::new(), &bytes);
            // Garbage may end in the head of a frame that was never sent, which swallows one and unsettles one.
            prop_assert!(frames.iter().rev().take(3).all(|f| *f == pilot()) && frames.len() >= 3);
            // And after silence the next frame is believed at once.
            let mut parser = Parser::new();
            stream(&mut parser, &bytes);
            parser.silence();
            prop_assert_eq!(stream(&mut parser, &pilot().encode()).0, [pilot()]);
        }
    }
}
