//! The transmitter's side of CRSF: channel frames out, telemetry in.

use sophie_control::mode::Mode;
use sophie_control::pilot::rc::{CHANNELS, Sticks};
use sophie_tasks::pilot::telemetry::parse_mode_text;
use uf_crsf::packets::{PacketAddress, RcChannelsPacked};
use uf_crsf::{CrsfParser, Packet, write_packet_to_buffer};

/// Channel frames per second.
pub const FRAME_HZ: f64 = 150.0;
/// Line rate, baud; ten bits a byte.
pub const BAUD: f64 = 420_000.0;

/// A frame on the line.
pub type Frame = heapless::Vec<u8, 64>;

/// Time of `bytes` on the line, s.
#[must_use]
pub fn line_time(bytes: usize) -> f64 {
    10.0 * bytes as f64 / BAUD
}

/// The channel frame of `sticks`.
#[must_use]
pub fn rc_frame(sticks: &Sticks) -> Frame {
    channel_frame(&sticks.to_channels())
}

/// Frame of 11-bit channel counts.
///
/// # Panics
/// Never: 26 bytes fit.
#[must_use]
pub fn channel_frame(channels: &[u16; CHANNELS]) -> Frame {
    let mut bytes = [0; 64];
    let packet = RcChannelsPacked(*channels);
    let count = write_packet_to_buffer(&mut bytes, PacketAddress::FlightController, &packet)
        .expect("a channel frame is 26 bytes long");
    Frame::from_slice(&bytes[..count]).expect("a channel frame is 26 bytes long")
}

/// The transmitter's display.
#[derive(Debug, Default)]
pub struct Telemetry {
    parser: CrsfParser,
    /// Mode; `None` until the first frame.
    pub mode: Option<Mode>,
    /// Reason beside the mode; may be empty.
    pub reason: String,
    /// Flight battery, V.
    pub battery_voltage: Option<f64>,
    /// Estimated roll, pitch and yaw, rad.
    pub attitude: Option<[f64; 3]>,
    /// Frames understood.
    pub frames: u32,
    /// Frames or bytes rejected.
    pub errors: u32,
}

impl Telemetry {
    /// Transmitter off: clears the display.
    pub fn darken(&mut self) {
        self.mode = None;
        self.reason.clear();
        self.battery_voltage = None;
        self.attitude = None;
    }

    /// Sets mode and reason.
    pub fn report(&mut self, mode: Mode, reason: &str) {
        self.mode = Some(mode);
        if self.reason != reason {
            self.reason = reason.to_owned();
        }
    }

    /// Takes telemetry bytes in any pieces.
    pub fn take(&mut self, mut bytes: &[u8]) {
        while let Some(packet) = self.parser.next_packet(&mut bytes) {
            match packet {
                Ok(packet) => {
                    self.frames += 1;
                    self.show(&packet);
                }
                Err(_) => self.errors += 1,
            }
        }
    }

    fn show(&mut self, packet: &Packet) {
        match packet {
            Packet::FlightMode(text) => {
                if let Some((mode, reason)) = parse_mode_text(text.flight_mode()) {
                    self.report(mode, reason);
                }
            }
            Packet::Battery(b) => self.battery_voltage = Some(0.1 * f64::from(b.voltage)),
            Packet::Attitude(a) => {
                self.attitude = Some([a.roll, a.pitch, a.yaw].map(|x| 1e-4 * f64::from(x)));
            }
            _ => (),
        }
    }
}

#[cfg(test)]
mod tests {
    use uf_crsf::packets::FlightMode;

    use super::*;

    #[test]
    fn a_channel_frame_takes_0_6_ms_on_the_line() {
        let frame = rc_frame(&Sticks::default());
        assert_eq!((frame.len(), frame[0], frame[2]), (26, 0xC8, 0x16));
        assert!((line_time(frame.len()) - 0.619e-3).abs() < 1e-6);
    }

    #[test]
    fn the_display_follows_the_mode_and_survives_garbage() {
        let mut t = Telemetry::default();
        let mut bytes = [0; 64];
        for (text, mode, reason) in [
            ("FLIGHT", Mode::Flight, ""),
            ("DISARMED: battery low", Mode::Disarmed, "battery low"),
        ] {
            let packet = FlightMode::new(text).unwrap();
            let n = write_packet_to_buffer(&mut bytes, PacketAddress::FlightController, &packet).unwrap();
            t.take(&[0x00; 3]);
            for byte in &bytes[..n] {
                t.take(&[*byte]);
            }
            // A broken start may swallow the next frame.
            t.take(&bytes[..n]);
            t.take(&bytes[..n]);
            assert_eq!((t.mode, t.reason.as_str()), (Some(mode), reason));
        }
        assert!(t.errors > 0);
    }
}
