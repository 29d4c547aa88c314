//! CRSF at 420 kbaud: TBS Crossfire, ExpressLRS.
//!
//! A receiver without its transmitter may repeat the last channels. At 0 % uplink quality in its link statistics no
//! sticks are published: the link turns stale and the failsafe acts. Sticks resume with the first frame after a quality
//! above 0 %, and with nothing else: a receiver may report the loss and then be silent about its link, and channels that
//! change may be its failsafe's. One that never sends statistics is heard. Receivers should be set to "no pulses"
//! without a link.
//!
//! Channels are read from frames of type 0x16. Those of type 0x17 (some of the channels, CRSF 3) are not: a receiver
//! sends them only to a vehicle that has agreed to CRSF 3, which this one never does.

use embassy_time::{Duration, Instant};
use sophie_control::pilot::rc::Sticks;
use sophie_ports::receiver::{RcDecoder, RcState};
use uf_crsf::{CrsfParser, Packet};

/// Ten bits at 420 kbaud.
const BYTE: Duration = Duration::from_micros(24);
/// Line pause that ends a frame: twice the longest, 64 bytes. A returning link must not complete an old frame.
const SILENCE: Duration = Duration::from_millis(3);

/// Decodes frames from a stream, in pieces of any length.
pub struct Decoder {
    parser: CrsfParser,
    state: RcState,
    /// The last report was of 0 % uplink quality.
    lost: bool,
    last: Option<Instant>,
    unfinished: bool,
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
            parser: CrsfParser::new(),
            state: RcState::default(),
            lost: false,
            last: None,
            unfinished: false,
        }
    }

    /// Last decoded state, including frames that were not published.
    pub const fn state(&self) -> &RcState {
        &self.state
    }

    fn drop_unfinished(&mut self) {
        self.parser.reset();
        if core::mem::take(&mut self.unfinished) {
            self.state.errors = self.state.errors.wrapping_add(1);
        }
    }
}

impl RcDecoder for Decoder {
    fn take(&mut self, mut bytes: &[u8], at: Instant) -> Option<RcState> {
        // A read ends with its last byte.
        let length = BYTE * u32::try_from(bytes.len()).unwrap_or(u32::MAX);
        let before = self.last.replace(at);
        let pause = before.map_or(Duration::MIN, |before| at.saturating_duration_since(before));
        if pause >= length + SILENCE {
            self.drop_unfinished();
        }
        let mut news = false;
        self.unfinished |= !bytes.is_empty();
        while let Some(packet) = self.parser.next_packet(&mut bytes) {
            self.unfinished = !bytes.is_empty();
            match packet {
                Ok(Packet::RCChannels(channels)) => match Sticks::from_channels(&channels.0) {
                    Ok(sticks) => {
                        self.state.frames = self.state.frames.wrapping_add(1);
                        if !self.lost {
                            self.state.sticks = sticks;
                            news = true;
                        }
                    }
                    Err(_) => self.state.errors = self.state.errors.wrapping_add(1),
                },
                Ok(Packet::LinkStatistics(link)) => {
                    self.lost = link.uplink_link_quality == 0;
                    // Earlier frames may be repetitions.
                    news &= !self.lost;
                }
                Ok(_) => (),
                Err(_) => self.state.errors = self.state.errors.wrapping_add(1),
            }
        }
        news.then_some(self.state)
    }

    fn broken(&mut self, at: Instant) {
        self.last = Some(at);
        self.parser.reset();
        self.unfinished = false;
        self.state.errors = self.state.errors.wrapping_add(1);
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use uf_crsf::packets::{LinkStatistics, PacketAddress, RcChannelsPacked};
    use uf_crsf::write_packet_to_buffer;

    use super::*;

    fn frame(sticks: Sticks) -> Vec<u8> {
        let mut out = [0; 64];
        let packet = RcChannelsPacked(sticks.to_channels());
        let n = write_packet_to_buffer(&mut out, PacketAddress::FlightController, &packet).unwrap_or(0);
        out.into_iter().take(n).collect()
    }

    fn statistics(uplink_link_quality: u8) -> Vec<u8> {
        let mut out = [0; 64];
        let packet = LinkStatistics {
            uplink_rssi_1: 90,
            uplink_rssi_2: 95,
            uplink_link_quality,
            uplink_snr: 4,
            active_antenna: 0,
            rf_mode: 4,
            uplink_tx_power: 3,
            downlink_rssi: 80,
            downlink_link_quality: 100,
            downlink_snr: 6,
        };
        let n = write_packet_to_buffer(&mut out, PacketAddress::FlightController, &packet).unwrap_or(0);
        out.into_iter().take(n).collect()
    }

    fn throttle(throttle: f32) -> Vec<u8> {
        frame(Sticks {
            throttle,
            ..Default::default()
        })
    }

    /// Throttle published for `bytes` at `ms`, %.
    fn published(decoder: &mut Decoder, bytes: &[u8], ms: u64) -> Option<u32> {
        decoder
            .take(bytes, Instant::from_millis(ms))
            .map(|state| (state.sticks.throttle * 100.0 + 0.5) as u32)
    }

    #[test]
    fn a_receiver_without_a_radio_is_not_heard() {
        let mut d = Decoder::new();
        assert_eq!(
            published(&mut d, &throttle(0.4), 0),
            Some(40),
            "no statistics yet"
        );
        assert_eq!(
            published(&mut d, &statistics(97), 10),
            None,
            "statistics are no sticks"
        );
        assert_eq!(published(&mut d, &throttle(0.5), 20), Some(50));
        assert_eq!(published(&mut d, &statistics(0), 30), None);
        // The last frame repeated, the loss reported at 5 Hz.
        for ms in (40..3000).step_by(20) {
            if ms % 200 == 0 {
                assert_eq!(published(&mut d, &statistics(0), ms), None, "{ms}");
            }
            assert_eq!(published(&mut d, &throttle(0.5), ms), None, "{ms}");
        }
        assert!(
            (d.state.frames, d.state.errors) == (150, 0),
            "counted all the same: {:?}",
            d.state
        );
        // 1 % is a link.
        assert_eq!(published(&mut d, &throttle(0.6), 3000), None);
        assert_eq!(published(&mut d, &statistics(1), 3010), None);
        assert_eq!(published(&mut d, &throttle(0.7), 3020), Some(70));
    }

    #[test]
    fn a_report_of_loss_counts_until_a_quality_above_zero_comes() {
        // ExpressLRS 3.x: two reports at the loss, then none; the last frame goes on for an hour.
        let mut d = Decoder::new();
        assert_eq!(published(&mut d, &throttle(0.3), 100), Some(30));
        let _ = published(&mut d, &statistics(0), 500);
        let _ = published(&mut d, &statistics(0), 600);
        for ms in (620..3_600_000).step_by(100) {
            assert_eq!(published(&mut d, &throttle(0.3), ms), None, "{ms}");
        }
        // A line that fails or was silent is no good news either, nor is a cut report.
        d.broken(Instant::from_millis(3_600_000));
        assert_eq!(published(&mut d, &throttle(0.3), 3_700_000), None);
        let cut = statistics(50);
        assert_eq!(published(&mut d, &cut[..9], 3_700_010), None);
        assert_eq!(published(&mut d, &throttle(0.3), 3_700_020), None);
        assert_eq!(published(&mut d, &statistics(1), 3_700_030), None);
        assert_eq!(published(&mut d, &throttle(0.4), 3_700_040), Some(40));
        // A report counts for every frame of its read.
        let read = [throttle(0.1), statistics(0), throttle(0.2)].concat();
        assert_eq!(published(&mut d, &read, 3_700_050), None);
        let read = [throttle(0.1), statistics(50), throttle(0.2)].concat();
        assert_eq!(published(&mut d, &read, 3_700_060), Some(20));
    }

    #[test]
    fn a_stick_beyond_its_range_is_held_at_full_and_low_counts_are_a_lost_radio() {
        let mut d = Decoder::new();
        let mut seen = |channel: usize, raw: u16, ms: u64| {
            let mut channels = Sticks {
                throttle: 0.5,
                ..Default::default()
            }
            .to_channels();
            channels[channel] = raw;
            let mut out = [0; 64];
            let packet = RcChannelsPacked(channels);
            let n = write_packet_to_buffer(&mut out, PacketAddress::FlightController, &packet).unwrap_or(0);
            d.take(&out[..n], Instant::from_millis(ms))
                .map(|state| state.sticks)
        };
        // EdgeTX's extended limits end at 1984; full 11 bits at 2047.
        for (i, raw) in (0..).zip([1976, 1977, 1984, 2047]) {
            let stick = seen(0, raw, 100 + 20 * i).map(|s| s.roll);
            assert_eq!(stick, Some(1.0), "{raw}");
            assert!(seen(15, raw, 110 + 20 * i).is_some());
        }
        for (i, raw) in (0..).zip([0, 7]) {
            assert!(seen(0, raw, 200 + 20 * i).is_none(), "{raw}");
            assert!(seen(2, raw, 205 + 20 * i).is_none(), "{raw}");
            assert!(
                seen(15, raw, 210 + 20 * i).is_some(),
                "unused: it costs itself alone"
            );
        }
        assert_eq!(d.state.errors, 4);
    }

    #[test]
    fn what_came_before_a_silence_is_never_published_after_it() {
        for later in [4, 20, 1000, 60_000] {
            for length in 2..=62 {
                // A start announcing `length` bytes, then a pilot's frame.
                let (mut d, mut missing) = (Decoder::new(), usize::from(length) + 2);
                let read = [std::vec![0xC8, length], throttle(0.9)].concat();
                let seen = published(&mut d, &read, 1000);
                missing = missing.saturating_sub(read.len());
                assert_eq!(
                    published(&mut d, &std::vec![0; missing], 1000 + later),
                    None,
                    "{length}, {later} ms later, {seen:?} before"
                );
                assert_eq!(
                    published(&mut d, &throttle(0.1), 1010 + 2 * later),
                    Some(10),
                    "{length}"
                );
            }
        }
    }

    #[test]
    fn a_frame_in_two_reads_is_one_unless_the_line_was_silent_or_failed_between() {
        let bytes = throttle(0.3);
        let (first, rest) = bytes.split_at(11);
        let mut d = Decoder::new();
        let _ = published(&mut d, first, 1000);
        assert_eq!(published(&mut d, rest, 1002), Some(30));
        assert_eq!(d.state.errors, 0);
        // Silence after a whole frame is no error.
        assert_eq!(published(&mut d, &bytes.repeat(4), 1006), Some(30));
        let _ = published(&mut d, first, 2000);
        assert_eq!((d.state.frames, d.state.errors), (5, 0));
        assert_eq!(published(&mut d, rest, 2004), None);
        let errors = d.state.errors;
        assert!(errors > 0);
        let _ = published(&mut d, first, 3000);
        d.broken(Instant::from_millis(3001));
        assert_eq!(published(&mut d, rest, 3002), None);
        assert!(d.state.errors > errors);
        assert_eq!(published(&mut d, &bytes, 3010), Some(30));
    }

    #[test]
    fn every_frame_is_decoded_however_the_bytes_are_cut() {
        for cut in [1, 7, 26, 32, 64] {
            let mut decoder = Decoder::new();
            let bytes: Vec<u8> = (0..50)
                .flat_map(|i| {
                    frame(Sticks {
                        throttle: 0.02 * i as f32,
                        ..Default::default()
                    })
                })
                .collect();
            for chunk in bytes.chunks(cut) {
                let _ = decoder.take(chunk, Instant::MIN);
            }
            assert_eq!((decoder.state.frames, decoder.state.errors), (50, 0), "{cut}");
            assert!((decoder.state.sticks.throttle - 0.98).abs() < 2e-3);
        }
    }

    #[test]
    fn garbage_is_counted_and_the_next_frame_is_understood() {
        let mut decoder = Decoder::new();
        let good = frame(Sticks {
            roll: 0.5,
            ..Default::default()
        });
        let mut broken = good.clone();
        if let Some(byte) = broken.get_mut(5) {
            *byte ^= 0x10;
        }
        assert!(decoder.take(&broken, Instant::MIN).is_none());
        let _ = decoder.take(&[0x55; 9], Instant::MIN);
        for _ in 0..3 {
            let _ = decoder.take(&good, Instant::MIN);
        }
        assert!(
            decoder.state.errors > 0 && decoder.state.frames >= 2,
            "{:?}",
            decoder.state
        );
        assert!((decoder.state.sticks.roll - 0.5).abs() < 2e-3);
    }
}
