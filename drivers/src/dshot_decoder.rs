//! Decodes DShot pulses as a motor controller does, for tests and benches.

use crate::dshot::{BITS, Frame};

/// Reason for no frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineError {
    /// Neither 0 nor 1: the pulse's share of the bit, ‰.
    Pulse(u16),
    /// Wrong checksum.
    Checksum(u16),
    /// Silence after this many bits.
    Short(usize),
}

/// Decoder of one line, in any unit of time.
#[derive(Clone, Copy, Debug)]
pub struct Decoder {
    bit: u32,
    bits: u16,
    count: usize,
    last_rise: Option<u64>,
}

impl Decoder {
    /// A decoder for bits of length `bit`.
    pub const fn new(bit: u32) -> Self {
        Self {
            bit,
            bits: 0,
            count: 0,
            last_rise: None,
        }
    }

    /// Adds a pulse that rose at `rise` and lasted `high`; returns a completed frame.
    ///
    /// # Errors
    /// A pulse of invalid length, a truncated frame, a wrong checksum. The decoder then restarts.
    pub fn pulse(&mut self, rise: u64, high: u32) -> Option<Result<Frame, LineError>> {
        let gap = self.last_rise.replace(rise).map(|last| rise.saturating_sub(last));
        // A rise more than 1.5 bits after the last starts a frame.
        let short = match gap {
            Some(gap) if gap * 2 > u64::from(self.bit) * 3 => self.finish(),
            _ => None,
        };
        if let Some(short) = short {
            let _ = self.take(high);
            return Some(Err(short));
        }
        self.take(high)
    }

    /// The line is silent: returns an error for a truncated frame.
    pub fn silence(&mut self) -> Option<LineError> {
        self.last_rise = None;
        self.finish()
    }

    fn finish(&mut self) -> Option<LineError> {
        let count = core::mem::take(&mut self.count);
        self.bits = 0;
        (count > 0).then_some(LineError::Short(count))
    }

    fn take(&mut self, high: u32) -> Option<Result<Frame, LineError>> {
        let share = u64::from(high) * 1000 / u64::from(self.bit.max(1));
        // Nominal 375 and 750, split in the middle.
        let bit = match share {
            200..=562 => 0,
            563..=900 => 1,
            _ => {
                self.finish();
                return Some(Err(LineError::Pulse(share.min(9999) as u16)));
            }
        };
        self.bits = self.bits << 1 | bit;
        self.count += 1;
        if self.count < BITS {
            return None;
        }
        let bits = self.bits;
        self.finish();
        Some(Frame::from_bits(bits).ok_or(LineError::Checksum(bits)))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::*;
    use crate::dshot::{BURST, BitTiming, MOTORS, Speed, fill_burst};

    fn play(
        decoder: &mut Decoder,
        buffer: &[u16],
        motor: usize,
        t: BitTiming,
        start: u64,
    ) -> Vec<Result<Frame, LineError>> {
        let rows = buffer.chunks(MOTORS).enumerate();
        rows.filter_map(|(i, row)| {
            let high = u32::from(row[motor]);
            (high > 0)
                .then(|| decoder.pulse(start + i as u64 * u64::from(t.period), high))
                .flatten()
        })
        .collect()
    }

    proptest! {
        #[test]
        fn what_a_burst_says_is_read_on_each_line(
            values in proptest::array::uniform4(0u16..2048), telemetry: bool, hz in 84_000_000u32..240_000_000,
        ) {
            for speed in [Speed::Dshot150, Speed::Dshot300, Speed::Dshot600] {
                let t = BitTiming::new(hz, speed).unwrap();
                let frames = values.map(|v| Frame::new(v, telemetry));
                let mut buffer = [0; BURST];
                fill_burst(&mut buffer, frames, t);
                for (motor, &frame) in frames.iter().enumerate() {
                    let mut decoder = Decoder::new(u32::from(t.period));
                    // Twice, the second 1 ms later.
                    for start in [0, u64::from(hz / 1000)] {
                        prop_assert_eq!(play(&mut decoder, &buffer, motor, t, start), [Ok(frame)]);
                    }
                }
            }
        }
    }

    #[test]
    fn broken_frames_are_named_and_the_next_one_is_read() {
        let t = BitTiming::new(168_000_000, Speed::Dshot300).unwrap();
        let frame = Frame::new(1500, false);
        let mut good = [0; BURST];
        fill_burst(&mut good, [frame; 4], t);
        let mut decoder = Decoder::new(u32::from(t.period));

        // Cut after ten bits, detected at the next frame.
        assert!(play(&mut decoder, &good[..40], 0, t, 0).is_empty());
        let next = play(&mut decoder, &good, 0, t, 168_000);
        assert_eq!(next, [Err(LineError::Short(10)), Ok(frame)]);

        // One bit flipped.
        let mut flipped = good;
        flipped[3 * MOTORS] = if flipped[3 * MOTORS] == t.one {
            t.zero
        } else {
            t.one
        };
        let heard = play(&mut decoder, &flipped, 0, t, 336_000);
        assert_eq!(heard, [Err(LineError::Checksum(frame.bits() ^ 1 << 12))]);

        assert_eq!(decoder.pulse(504_000, 560), Some(Err(LineError::Pulse(1000))));
        let _ = play(&mut decoder, &good[..8], 0, t, 672_000);
        assert_eq!(decoder.silence(), Some(LineError::Short(2)));
        assert_eq!(decoder.silence(), None);
    }
}
