//! An SBUS or SBUS2 receiver: turns radio channels into frames on its line, followed by the answers of telemetry
//! sensors.

use sophie_control::pilot::rc::CHANNELS;
use sophie_drivers::sbus::{FRAME, Frame};

/// Slots for sensors behind each frame.
pub const SLOTS: usize = 8;
/// Frame period, s: the slower of the two common ones.
const PERIOD: f64 = 14e-3;
/// Frame period with slots, s: that of a Futaba R7008SB.
const PERIOD_WITH_SLOTS: f64 = 15e-3;
/// Time from a frame's begin to its first slot, s: 25 bytes of 120 µs and a pause of 2 ms.
const FIRST_SLOT: f64 = 5e-3;
/// Time from slot to slot, s.
const SLOT: f64 = 0.66e-3;
/// Radio silence after which the failsafe flag is set, s (FrSky: about 1 s).
const FAILSAFE_AFTER: f64 = 0.9;

/// Bytes that go on the line in one step.
pub type Bytes = heapless::Vec<u8, { FRAME + 3 * SLOTS }>;

/// The receiver. After its first frame it sends without a break and reports a lost transmitter by flags.
#[derive(Clone, Debug, Default)]
pub struct Receiver {
    channels: Option<[u16; CHANNELS]>,
    /// Since the transmitter was heard, s.
    silence: f64,
    /// Since the last frame on the line, s.
    elapsed: f64,
    /// Slots that a sensor answers in; 0: SBUS.
    sensors: usize,
    /// Group of the last frame, 0 to 3.
    group: u8,
    /// Slots of its group that have passed.
    passed: usize,
    /// Value that the sensors send; it runs through all values.
    value: u16,
}

impl Receiver {
    /// SBUS2 with sensors in the first `sensors` slots of each group; with 0 it sends SBUS.
    #[must_use]
    pub fn new(sensors: usize) -> Self {
        Self {
            sensors: sensors.min(SLOTS),
            passed: SLOTS,
            ..Self::default()
        }
    }

    /// Advances by `dt` s with the channels `heard` over the air; returns the bytes that go on the line.
    pub fn step(&mut self, dt: f64, heard: Option<[u16; CHANNELS]>) -> Bytes {
        let mut line = Bytes::new();
        self.silence += dt;
        self.elapsed += dt;
        if heard.is_some() {
            self.channels = heard;
            self.silence = 0.0;
        }
        while self.passed < self.sensors && self.elapsed >= FIRST_SLOT + SLOT * self.passed as f64 {
            // Slot numbers run from the top bit down, before the two bits of the group.
            let number = (self.group << 3 | self.passed as u8).reverse_bits() | 0x03;
            let [low, high] = self.value.to_le_bytes();
            // Three bytes each always fit.
            let _ = line.extend_from_slice(&[number, low, high]);
            self.value = self.value.wrapping_add(1);
            self.passed += 1;
        }
        let Some(channels) = self.channels else {
            return line;
        };
        let period = if self.sensors > 0 {
            PERIOD_WITH_SLOTS
        } else {
            PERIOD
        };
        if self.elapsed < period {
            return line;
        }
        self.elapsed %= period;
        let frame = Frame {
            channels,
            frame_lost: self.silence >= period,
            failsafe: self.silence >= FAILSAFE_AFTER,
            ..Frame::default()
        };
        let mut bytes = frame.encode();
        if self.sensors > 0 {
            self.group = (self.group + 1) % 4;
            self.passed = 0;
            if let Some(end) = bytes.last_mut() {
                *end = 0x04 | self.group << 4;
            }
        }
        let _ = line.extend_from_slice(&bytes);
        line
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(r: &mut Receiver, seconds: f64, heard: Option<[u16; CHANNELS]>) -> Vec<Frame> {
        (0..(seconds * 1e3) as u32)
            .map(|_| r.step(1e-3, heard))
            .filter(|bytes| !bytes.is_empty())
            .map(|bytes| Frame::decode(bytes[..].try_into().unwrap()).unwrap())
            .collect()
    }

    #[test]
    fn a_receiver_without_radio_repeats_the_last_channels_and_flags_it() {
        let mut r = Receiver::new(0);
        assert!(run(&mut r, 1.0, None).is_empty(), "nothing heard, nothing to say");
        let good = run(&mut r, 1.0, Some([1200; CHANNELS]));
        assert!((70..=73).contains(&good.len()));
        assert!(good.iter().all(|f| !f.frame_lost && !f.failsafe));
        let lost = run(&mut r, 2.0, None);
        assert!((141..=144).contains(&lost.len()));
        assert!(lost.iter().all(|f| f.channels == [1200; CHANNELS]));
        assert!(lost.iter().skip(1).all(|f| f.frame_lost));
        let given_up = lost.iter().position(|f| f.failsafe).unwrap();
        assert!((60..=66).contains(&given_up), "{given_up} frames of 14 ms");
        assert!(
            run(&mut r, 0.1, Some([1300; CHANNELS]))
                .iter()
                .all(|f| !f.failsafe)
        );
    }

    #[test]
    fn sensors_answer_behind_each_frame_in_its_group() {
        for sensors in [1, 8] {
            let mut r = Receiver::new(sensors);
            let (mut groups, mut numbers) = (Vec::new(), Vec::new());
            let mut since_frame = 0;
            for _ in 0..6060 {
                let bytes = r.step(1e-3, Some([992; CHANNELS]));
                since_frame += 1;
                if bytes.len() == FRAME {
                    assert!(groups.is_empty() || since_frame == 15, "{since_frame} ms");
                    since_frame = 0;
                    groups.push(bytes[24]);
                } else {
                    assert!(bytes.is_empty() || (5..=10).contains(&since_frame));
                    numbers.extend(bytes.chunks(3).map(|slot| slot[0]));
                }
            }
            assert_eq!(groups[..5], [0x14, 0x24, 0x34, 0x04, 0x14]);
            assert!(
                numbers.len().abs_diff(sensors * groups.len()) <= 8,
                "{}",
                numbers.len()
            );
            // 0x03 is the R7008SB's voltage, the first slot of the first group.
            assert!(numbers.contains(&0x03) && !numbers.contains(&0x0F));
            numbers.sort_unstable();
            numbers.dedup();
            assert_eq!(numbers.len(), 4 * sensors);
        }
    }
}
