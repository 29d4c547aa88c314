//! An SBUS receiver: channels from the air to frames on its line.

use sophie_control::rc::CHANNELS;
use sophie_drivers::sbus::{FRAME, Frame};

/// Frame period, s: the slower usual one.
const PERIOD: f64 = 14e-3;
/// Silence, s (FrSky: about 1 s).
const FAILSAFE_AFTER: f64 = 0.9;

/// Sends always after its first frame; flags report a lost transmitter.
#[derive(Clone, Debug, Default)]
pub struct Receiver {
    channels: Option<[u16; CHANNELS]>,
    /// Since the transmitter was heard, s.
    silence: f64,
    /// Since the last frame on the line, s.
    elapsed: f64,
}

impl Receiver {
    /// A step of `dt` s with `heard` from the air; returns a due frame.
    pub fn step(&mut self, dt: f64, heard: Option<[u16; CHANNELS]>) -> Option<[u8; FRAME]> {
        self.silence += dt;
        self.elapsed += dt;
        if heard.is_some() {
            self.channels = heard;
            self.silence = 0.0;
        }
        let channels = self.channels?;
        if self.elapsed < PERIOD {
            return None;
        }
        self.elapsed %= PERIOD;
        let frame = Frame {
            channels,
            frame_lost: self.silence >= PERIOD,
            failsafe: self.silence >= FAILSAFE_AFTER,
            ..Frame::default()
        };
        Some(frame.encode())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(r: &mut Receiver, seconds: f64, heard: Option<[u16; CHANNELS]>) -> Vec<Frame> {
        (0..(seconds * 1e3) as u32)
            .filter_map(|_| r.step(1e-3, heard))
            .map(|bytes| Frame::decode(&bytes).unwrap())
            .collect()
    }

    #[test]
    fn it_goes_on_with_the_last_channels_and_says_so() {
        let mut r = Receiver::default();
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
}
