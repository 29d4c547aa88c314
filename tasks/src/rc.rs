//! The receiver: bytes in, the pilot's wishes out.
//!
//! CRSF at 420 kbaud, 50 to 500 frames a second. A frame that is broken, or whose channels no transmitter
//! sends on purpose, is counted and otherwise as if it had not come: the link then turns stale by itself.

use embassy_time::{Duration, Instant, Timer};
use sophie_control::rc::Sticks;
use uf_crsf::{CrsfParser, Packet};

use crate::deadline::{TaskId, record_run};
use crate::links::{Links, RcState};
use crate::ports::RcReceiver;

/// Bytes taken at once: two of the longest frames.
const BUFFER: usize = 128;
/// Time from the bytes' arrival by which they must have been decoded.
const DEADLINE: Duration = Duration::from_millis(2);
/// Pause after a line error or an empty read, so that a dead line cannot take the processor.
const PAUSE: Duration = Duration::from_millis(1);

/// Decodes frames for ever.
pub async fn run(links: &Links, mut port: impl RcReceiver) -> ! {
    let mut decoder = Decoder::new();
    let mut buffer = [0; BUFFER];
    loop {
        let count = match port.read(&mut buffer).await {
            Ok(count) if count > 0 => count,
            Ok(_) => {
                Timer::after(PAUSE).await;
                continue;
            }
            Err(_) => {
                decoder.state.errors = decoder.state.errors.wrapping_add(1);
                Timer::after(PAUSE).await;
                continue;
            }
        };
        let at = Instant::now();
        if let Some(state) = decoder.take(buffer.get(..count).unwrap_or_default()) {
            links.rc.send(at, state);
        }
        record_run(links, TaskId::Rc, at, at, DEADLINE);
    }
}

/// Frames and counts out of a stream of bytes, however it is cut.
struct Decoder {
    parser: CrsfParser,
    state: RcState,
}

impl Decoder {
    fn new() -> Self {
        Self {
            parser: CrsfParser::new(),
            state: RcState::default(),
        }
    }

    /// Takes bytes; gives the state when they held at least one good frame of channels.
    fn take(&mut self, mut bytes: &[u8]) -> Option<RcState> {
        let mut news = false;
        while let Some(packet) = self.parser.next_packet(&mut bytes) {
            match packet {
                Ok(Packet::RCChannels(channels)) => match Sticks::from_channels(&channels.0) {
                    Ok(sticks) => {
                        self.state.sticks = sticks;
                        self.state.frames = self.state.frames.wrapping_add(1);
                        news = true;
                    }
                    Err(_) => self.state.errors = self.state.errors.wrapping_add(1),
                },
                // Link statistics and the like: well formed, nothing for flying.
                Ok(_) => (),
                Err(_) => self.state.errors = self.state.errors.wrapping_add(1),
            }
        }
        news.then_some(self.state)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use uf_crsf::packets::{PacketAddress, RcChannelsPacked};
    use uf_crsf::write_packet_to_buffer;

    use super::*;

    fn frame(sticks: Sticks) -> Vec<u8> {
        let mut out = [0; 64];
        let packet = RcChannelsPacked(sticks.to_channels());
        let n = write_packet_to_buffer(&mut out, PacketAddress::FlightController, &packet).unwrap_or(0);
        out.into_iter().take(n).collect()
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
                let _ = decoder.take(chunk);
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
        assert!(decoder.take(&broken).is_none());
        let _ = decoder.take(&[0x55; 9]);
        for _ in 0..3 {
            let _ = decoder.take(&good);
        }
        assert!(
            decoder.state.errors > 0 && decoder.state.frames >= 2,
            "{:?}",
            decoder.state
        );
        assert!((decoder.state.sticks.roll - 0.5).abs() < 2e-3);
    }
}
