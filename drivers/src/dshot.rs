//! DShot frames and their timer values: 16 bits, highest throttle bit first, a long pulse for 1 and a short one for 0.
//!
//! | bits | what |
//! |---|---|
//! | 15..5 | 0 stop, 1 to 47 commands, 48 to 2047 throttle |
//! | 4 | telemetry request |
//! | 3..0 | exclusive or of the three nibbles above |

use sophie_control::allocation::wrench::PerArm;
use sophie_control::maths::scalar;

/// Lowest throttle; lower values are commands.
pub const THROTTLE_MIN: u16 = 48;
/// Highest throttle.
pub const THROTTLE_MAX: u16 = 2047;
/// Bits per frame.
pub const BITS: usize = 16;
/// Motors per burst.
pub const MOTORS: usize = 4;
/// Compare values of a burst, including one row of zeros.
pub const BURST: usize = (BITS + 1) * MOTORS;

/// A frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frame(u16);

impl Frame {
    /// Motor stop (command 0, no telemetry).
    pub const STOP: Self = Self(0);

    /// A frame of an 11-bit `value` (limited to 2047): 0 stop, 48..=2047 throttle.
    pub const fn new(value: u16, telemetry: bool) -> Self {
        let value = if value > THROTTLE_MAX { THROTTLE_MAX } else { value };
        let payload = value << 1 | telemetry as u16;
        Self(payload << 4 | checksum(payload))
    }

    /// Frame of a motor command: 0 (or anything not positive) stops, 0 < c <= 1 maps to 48..=2047.
    pub fn from_command(command: f32) -> Self {
        if command > 0.0 {
            let span = f32::from(THROTTLE_MAX - THROTTLE_MIN);
            Self::new(
                THROTTLE_MIN + (scalar::clamp(command, 0.0, 1.0) * span + 0.5) as u16,
                false,
            )
        } else {
            Self::STOP
        }
    }

    /// The 16 bits, highest first on the line.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// The frame of these bits; `None` if the checksum is wrong.
    pub const fn from_bits(bits: u16) -> Option<Self> {
        if checksum(bits >> 4) == bits & 0xF {
            Some(Self(bits))
        } else {
            None
        }
    }

    /// The 11-bit value: 0 stop, 1..=47 command, 48..=2047 throttle.
    pub const fn value(self) -> u16 {
        self.0 >> 5
    }

    /// Telemetry request.
    pub const fn telemetry(self) -> bool {
        self.0 & 0x10 != 0
    }
}

const fn checksum(payload: u16) -> u16 {
    (payload ^ payload >> 4 ^ payload >> 8) & 0xF
}

/// Bit rate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Speed {
    /// 150 kbit/s: 106.7 µs per frame.
    Dshot150,
    /// 300 kbit/s: 53.3 µs per frame.
    #[default]
    Dshot300,
    /// 600 kbit/s: 26.7 µs per frame.
    Dshot600,
}

impl Speed {
    /// Bits per second.
    pub const fn bits_per_second(self) -> u32 {
        match self {
            Self::Dshot150 => 150_000,
            Self::Dshot300 => 300_000,
            Self::Dshot600 => 600_000,
        }
    }
}

/// Timer counts of one bit (prescaler 0).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitTiming {
    /// Counts per bit; the reload register takes one less.
    pub period: u16,
    /// High counts of a 1: 75 % of the bit.
    pub one: u16,
    /// High counts of a 0: 37.5 % of the bit.
    pub zero: u16,
}

impl BitTiming {
    /// Fewest counts per bit, for pulses within 2 % of the bit.
    pub const PERIOD_MIN: u32 = 24;

    /// Values nearest to `speed` at `timer_hz`; `None` below [`Self::PERIOD_MIN`] counts or beyond 16 bits.
    pub const fn new(timer_hz: u32, speed: Speed) -> Option<Self> {
        let rate = speed.bits_per_second();
        let period = (timer_hz + rate / 2) / rate;
        if period < Self::PERIOD_MIN || period > u16::MAX as u32 {
            return None;
        }
        Some(Self {
            period: period as u16,
            one: ((period * 6 + 4) / 8) as u16,
            zero: ((period * 3 + 4) / 8) as u16,
        })
    }

    /// Relative error of the bit rate, positive when too fast. Motor controllers accept several percent.
    pub fn rate_error(self, timer_hz: u32, speed: Speed) -> f32 {
        timer_hz as f32 / (f32::from(self.period) * speed.bits_per_second() as f32) - 1.0
    }

    /// Frame time, s, without pause.
    pub fn frame_time(self, timer_hz: u32) -> f32 {
        BITS as f32 * f32::from(self.period) / timer_hz as f32
    }
}

/// Fills `buffer` with one burst: a row per bit with the four motors in channel order, then rows of zeros to rest low.
///
/// `N` is [`BURST`] or longer by whole rows, where the timer runs on briefly after the last bit.
pub fn fill_burst<const N: usize>(buffer: &mut [u16; N], frames: PerArm<Frame>, timing: BitTiming) {
    const {
        assert!(
            N >= BURST && N.is_multiple_of(MOTORS),
            "whole rows, the last of them zero"
        )
    };
    let [one, two, three, four] = frames.map(|frame| u32::from(frame.bits()));
    let (rows, _) = buffer.as_chunks_mut::<MOTORS>();
    let (bits, rest) = rows.split_at_mut(BITS);
    fill_bits(bits, [one | two << 16, three | four << 16], timing);
    rest.fill([0; MOTORS]);
}

/// Rows of four frames' bits, two in each word. One product per pair replaces a choice per motor, to advance the first
/// edge. Not inlined, to stay fast in a caller optimised for size.
#[inline(never)]
fn fill_bits(rows: &mut [[u16; MOTORS]], pairs: [u32; 2], timing: BitTiming) {
    const BOTH: u32 = 1 << 16 | 1;
    let zeros = u32::from(timing.zero) * BOTH;
    // A 1 is longer than a 0: no product carries into the upper half.
    let more = u32::from(timing.one.saturating_sub(timing.zero));
    for (row, bit) in rows.iter_mut().zip((0..BITS).rev()) {
        let [first, second] = pairs.map(|pair| (pair >> bit & BOTH) * more + zeros);
        *row = [
            first as u16,
            (first >> 16) as u16,
            second as u16,
            (second >> 16) as u16,
        ];
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn known_frames() {
        // Usual worked example: throttle 1046, no telemetry.
        assert_eq!(Frame::new(1046, false).bits(), 0b1000_0010_1100_0110);
        assert_eq!(Frame::STOP.bits(), 0);
        assert_eq!(Frame::new(0, false), Frame::STOP);
        assert_eq!(Frame::new(48, true).value(), 48);
        assert!(Frame::new(48, true).telemetry());
        assert_eq!(Frame::new(9999, false).value(), 2047);
    }

    #[test]
    fn commands_spread_over_the_throttle_range() {
        assert_eq!(Frame::from_command(0.0), Frame::STOP);
        assert_eq!(Frame::from_command(-0.1), Frame::STOP);
        assert_eq!(Frame::from_command(f32::NAN), Frame::STOP);
        assert_eq!(Frame::from_command(1e-9).value(), 48);
        assert_eq!(Frame::from_command(1.0).value(), 2047);
        assert_eq!(Frame::from_command(f32::INFINITY).value(), 2047);
        let mut last = 0;
        for i in 0..=4000 {
            let value = Frame::from_command(i as f32 / 4000.0).value();
            assert!(value >= last && (value == 0 || value >= 48));
            last = value;
        }
    }

    #[test]
    fn every_single_bit_error_is_caught_and_every_frame_comes_back() {
        for value in 0..=THROTTLE_MAX {
            for telemetry in [false, true] {
                let frame = Frame::new(value, telemetry);
                let back = Frame::from_bits(frame.bits()).unwrap();
                assert_eq!((back.value(), back.telemetry()), (value, telemetry));
                for bit in 0..16 {
                    assert!(Frame::from_bits(frame.bits() ^ 1 << bit).is_none());
                }
            }
        }
    }

    #[test]
    fn timing_is_within_a_percent_on_every_board() {
        // APB2 timers of F405 (168 MHz) and F765 (216 MHz), H743 at 200 and 240 MHz.
        for hz in [
            84_000_000,
            108_000_000,
            168_000_000,
            200_000_000,
            216_000_000,
            240_000_000,
        ] {
            for speed in [Speed::Dshot150, Speed::Dshot300, Speed::Dshot600] {
                let t = BitTiming::new(hz, speed).unwrap();
                let error = t.rate_error(hz, speed);
                assert!(error.abs() < 0.005, "{hz} {speed:?}: {error}");
                let share = |counts: u16| f32::from(counts) / f32::from(t.period);
                assert!(
                    (share(t.one) - 0.75).abs() < 0.005 && (share(t.zero) - 0.375).abs() < 0.005,
                    "{t:?}"
                );
            }
        }
        let t = BitTiming::new(200_000_000, Speed::Dshot600).unwrap();
        assert_eq!(
            t,
            BitTiming {
                period: 333,
                one: 250,
                zero: 125
            }
        );
        assert!((t.rate_error(200_000_000, Speed::Dshot600) - 0.001).abs() < 1e-5);
        assert!((t.frame_time(200_000_000) - 26.64e-6).abs() < 1e-9);
        assert!(BitTiming::new(8_000_000, Speed::Dshot600).is_none());
    }

    #[test]
    fn a_burst_is_laid_out_bit_by_bit() {
        let timing = BitTiming {
            period: 280,
            one: 210,
            zero: 105,
        };
        let frames = [
            Frame::new(1046, false),
            Frame::STOP,
            Frame::new(2047, true),
            Frame::new(48, false),
        ];
        let mut buffer = [0xAAAA; 72];
        fill_burst(&mut buffer, frames, timing);
        for (row, values) in buffer.chunks(4).enumerate() {
            for (motor, &value) in values.iter().enumerate() {
                let expected = if row >= 16 {
                    0
                } else if frames[motor].bits() >> (15 - row) & 1 == 1 {
                    210
                } else {
                    105
                };
                assert_eq!(value, expected, "row {row} motor {motor}");
            }
        }
        let mut shortest = [1; BURST];
        fill_burst(&mut shortest, frames, timing);
        assert_eq!(shortest[64..], [0; 4]);
        assert_eq!(shortest[..64], buffer[..64]);
    }

    proptest! {
        #[test]
        fn an_error_in_one_nibble_is_caught(value in 0u16..2048, telemetry: bool, nibble in 0u16..4, error in 1u16..16) {
            let bits = Frame::new(value, telemetry).bits();
            prop_assert!(Frame::from_bits(bits ^ error << (4 * nibble)).is_none());
        }
    }
}
