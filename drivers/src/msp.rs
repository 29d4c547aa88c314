//! MSP version 2: the messages that sensors send unrequested.
//!
//! | byte | what |
//! |---|---|
//! | 0 to 2 | `$`, `X`, `<` or `>` |
//! | 3 | flags |
//! | 4, 5 | function, lowest byte first |
//! | 6, 7 | length of the payload, lowest byte first |
//! | 8.. | payload |
//! | last | CRC-8/DVB-S2 of all from the flags on |
//!
//! Range (0x1F01): 8-bit quality, 32-bit distance in mm, negative out of range. Flow (0x1F02): 8-bit quality, then the
//! counts along x and y since the previous frame, 32 bits each. Definitions: INAV's `msp_protocol_v2_sensor.h`, for
//! which such modules are made.

use heapless::Vec;

/// Longest accepted payload, bytes; a frame that declares more is treated as garbage.
const PAYLOAD: usize = 32;
const HEAD: usize = 8;
/// Longest frame.
const FRAME: usize = HEAD + PAYLOAD + 1;
const RANGE: u16 = 0x1F01;
const FLOW: u16 = 0x1F02;

/// Message of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Message {
    /// Range.
    Range {
        /// 0 to 255, 255 the best.
        quality: u8,
        /// Distance, mm; negative out of range.
        distance: i32,
    },
    /// Optical flow.
    Flow {
        /// 0 to 255, 255 the best.
        quality: u8,
        /// Counts along the module's x and y since the previous frame.
        counts: [i32; 2],
    },
}

impl Message {
    /// Decodes a payload; `None` for another function or length.
    fn of(function: u16, payload: &[u8]) -> Option<Self> {
        match (function, payload) {
            (RANGE, &[quality, a, b, c, d]) => Some(Self::Range {
                quality,
                distance: i32::from_le_bytes([a, b, c, d]),
            }),
            (FLOW, &[quality, a, b, c, d, e, f, g, h]) => Some(Self::Flow {
                quality,
                counts: [i32::from_le_bytes([a, b, c, d]), i32::from_le_bytes([e, f, g, h])],
            }),
            _ => None,
        }
    }

    /// Its frame, as a sensor sends it.
    pub fn frame(&self) -> Vec<u8, FRAME> {
        let mut payload: Vec<u8, PAYLOAD> = Vec::new();
        let mut put = |bytes: &[u8]| {
            // A payload is longer than either message.
            let _ = payload.extend_from_slice(bytes);
        };
        let function = match self {
            Self::Range { quality, distance } => {
                put(&[*quality]);
                put(&distance.to_le_bytes());
                RANGE
            }
            Self::Flow { quality, counts } => {
                put(&[*quality]);
                counts.iter().for_each(|count| put(&count.to_le_bytes()));
                FLOW
            }
        };
        let length = u16::try_from(payload.len()).unwrap_or_default();
        let mut frame = Vec::new();
        let parts: [&[u8]; 5] = [
            b"$X<",
            &[0],
            &function.to_le_bytes(),
            &length.to_le_bytes(),
            &payload,
        ];
        for part in parts {
            let _ = frame.extend_from_slice(part);
        }
        let sum = crc(frame.get(3..).unwrap_or_default());
        let _ = frame.push(sum);
        frame
    }
}

/// Classification of the bytes at the start of the buffer.
enum Start {
    /// An incomplete frame.
    Open,
    /// Not a frame.
    Garbage,
    /// A frame of this length with a correct checksum; `None` for an unused function.
    Frame(usize, Option<Message>),
}

/// Extracts frames from bytes in chunks of any size. After garbage it rescans every buffered byte, so that no byte of
/// the next frame is lost; each received byte costs at most as many scans as a frame has bytes.
#[derive(Clone, Debug, Default)]
pub struct Parser {
    held: Vec<u8, FRAME>,
}

impl Parser {
    /// Empty.
    pub const fn new() -> Self {
        Self { held: Vec::new() }
    }

    /// Takes a byte; returns the message of a frame that it completes.
    pub fn take(&mut self, byte: u8) -> Option<Message> {
        // Never full: the longest frame is evaluated with its last byte.
        let _ = self.held.push(byte);
        while !self.held.is_empty() {
            match start(&self.held) {
                Start::Open => return None,
                Start::Garbage => self.drop_first(1),
                Start::Frame(length, message) => {
                    self.drop_first(length);
                    if message.is_some() {
                        return message;
                    }
                }
            }
        }
        None
    }

    /// Clears the buffer after a loss of bytes.
    pub fn reset(&mut self) {
        self.held.clear();
    }

    fn drop_first(&mut self, count: usize) {
        let count = count.min(self.held.len());
        let left = self.held.len() - count;
        self.held.rotate_left(count);
        self.held.truncate(left);
    }
}

fn start(held: &[u8]) -> Start {
    let begins = |at: usize, any: &[u8]| held.get(at).is_none_or(|byte| any.contains(byte));
    if !(begins(0, b"$") && begins(1, b"X") && begins(2, b"<>")) {
        return Start::Garbage;
    }
    let Some(&[_, _, _, _, function_low, function_high, low, high]) = held.first_chunk::<HEAD>() else {
        return Start::Open;
    };
    let length = usize::from(u16::from_le_bytes([low, high]));
    if length > PAYLOAD {
        return Start::Garbage;
    }
    let Some((&sum, checked)) = held.get(3..HEAD + length + 1).and_then(<[u8]>::split_last) else {
        return Start::Open;
    };
    if crc(checked) != sum {
        return Start::Garbage;
    }
    let function = u16::from_le_bytes([function_low, function_high]);
    let payload = held.get(HEAD..HEAD + length).unwrap_or_default();
    Start::Frame(HEAD + length + 1, Message::of(function, payload))
}

/// CRC-8/DVB-S2: polynomial 0xD5, begins at 0.
fn crc(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| {
        (0..8).fold(sum ^ byte, |sum: u8, _| {
            let carried = sum & 0x80 != 0;
            (sum << 1) ^ if carried { 0xD5 } else { 0 }
        })
    })
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec as List;

    use proptest::prelude::*;

    use super::*;

    fn parsed(bytes: &[u8]) -> List<Message> {
        let mut parser = Parser::new();
        bytes.iter().filter_map(|byte| parser.take(*byte)).collect()
    }

    #[test]
    fn the_sum_is_that_of_the_catalogue() {
        assert_eq!(crc(b"123456789"), 0xBC);
    }

    #[test]
    fn frames_as_modules_send_them_are_read() {
        // 1,234 mm at quality 200; (-3, 70000) counts at quality 96. Laid out by hand.
        let range = [b'$', b'X', b'<', 0, 0x01, 0x1F, 5, 0, 200, 0xD2, 0x04, 0, 0];
        let flow = [
            b'$', b'X', b'<', 0, 0x02, 0x1F, 9, 0, 96, 0xFD, 0xFF, 0xFF, 0xFF, 0x70, 0x11, 0x01, 0,
        ];
        let whole = |frame: &[u8]| [frame, &[crc(&frame[3..])]].concat();
        let bytes = [whole(&range), whole(&flow)].concat();
        let said = [
            Message::Range {
                quality: 200,
                distance: 1234,
            },
            Message::Flow {
                quality: 96,
                counts: [-3, 70_000],
            },
        ];
        assert_eq!(parsed(&bytes), said);
        assert_eq!(said.map(|m| m.frame().to_vec()).concat(), bytes);
    }

    fn message() -> impl Strategy<Value = Message> {
        prop_oneof![
            (any::<u8>(), any::<i32>()).prop_map(|(quality, distance)| Message::Range { quality, distance }),
            (any::<u8>(), any::<[i32; 2]>()).prop_map(|(quality, counts)| Message::Flow { quality, counts }),
        ]
    }

    proptest! {
        #[test]
        fn the_frame_after_any_garbage_is_read(garbage in prop::collection::vec(any::<u8>(), 0..60), m in message()) {
            // Garbage that begins a frame may take bytes of the next one until the checksum fails: three frames on, none does.
            let frame = m.frame();
            let bytes = [&garbage[..], &frame[..], &frame[..], &frame[..]].concat();
            prop_assert_eq!(parsed(&bytes).last().copied(), Some(m));
        }

        #[test]
        fn a_spoilt_frame_is_dropped_and_the_next_is_not(
            (m, next) in (message(), message()), at in 0_usize..32, bit in 0_u8..8,
        ) {
            let mut spoilt = m.frame();
            let at = at % spoilt.len();
            spoilt[at] ^= 1 << bit;
            // The other direction is no fault.
            prop_assume!(spoilt[2] != b'>');
            let found = parsed(&[&spoilt[..], &next.frame(), &next.frame(), &next.frame()].concat());
            prop_assert!(!found.contains(&m) || m == next);
            prop_assert_eq!(found.last(), Some(&next));
        }

        #[test]
        fn bytes_of_any_kind_give_only_frames_that_are_in_them(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
            for m in parsed(&bytes) {
                let frame = m.frame();
                prop_assert!(bytes.windows(frame.len() - 4).any(|w| w == &frame[4..]));
            }
        }
    }
}
