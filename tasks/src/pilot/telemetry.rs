//! Telemetry to the pilot's transmitter over the receiver's line. Sends one frame a run, so that the slow downlink
//! never queues; SBUS has no telemetry.
//!
//! | frame | type | rate |
//! |---|---|---|
//! | attitude | 0x1E | 10 Hz |
//! | flight mode: `MODE`, or `MODE: reason` | 0x21 | 8 Hz, and at once when the mode changes |
//! | battery | 0x08 | 2 Hz |

use core::fmt::Write;
use core::future::pending;

use heapless::String;
use sophie_control::mode::{Mode, Reason};
use sophie_control::params::RcProtocol;
use uf_crsf::packets::{self, CrsfPacket, PacketAddress};
use uf_crsf::write_packet_to_buffer;

use crate::deadline::FixedRate;
use crate::links::Links;
use crate::links::messages::Status;
use crate::schedule::TaskId;
use sophie_control::battery::Battery;
use sophie_ports::serial::SerialOutput;

const CYCLE: u8 = 10;
const BATTERY_SLOT: u8 = 9;
const TEXT: usize = 59;

type Frame = heapless::Vec<u8, 64>;

/// Sends frames; never returns.
pub async fn run(links: &Links, mut port: impl SerialOutput) -> ! {
    if links.params.rc_protocol == RcProtocol::Sbus {
        pending::<()>().await;
    }
    let mut rate = FixedRate::of(links, TaskId::Telemetry);
    let mut slot = 0;
    let mut shown = None;
    loop {
        rate.next().await;
        // While the commander is silent the display keeps its last text.
        let Some(status) = links.status.fresh() else {
            continue;
        };
        let frame = if shown == Some(status.mode) {
            let frame = scheduled(links, status, slot);
            slot = (slot + 1) % CYCLE;
            frame
        } else {
            shown = Some(status.mode);
            encode(packets::FlightMode::new(&mode_text(status)).ok())
        };
        if let Some(frame) = frame {
            // A frame refused by the line is lost.
            let _ = port.write(&frame).await;
        }
    }
}

fn scheduled(links: &Links, status: Status, slot: u8) -> Option<Frame> {
    if slot == BATTERY_SLOT {
        encode(
            links
                .battery
                .fresh()
                .map(|b| battery(b, links.params.battery_capacity)),
        )
    } else if slot % 2 == 1 {
        encode(packets::FlightMode::new(&mode_text(status)).ok())
    } else {
        let (roll, pitch, yaw) = links.attitude.fresh()?.q.to_euler();
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(tenths_of_mrad);
        encode(Some(packets::Attitude { pitch, roll, yaw }))
    }
}

fn mode_text(status: Status) -> String<TEXT> {
    let Status {
        mode,
        reason,
        warning,
        ..
    } = status;
    // The warning gives the cause of a missing position, so it replaces the reason.
    let said = reason.filter(|reason| *reason != Reason::NoPosition || warning.is_empty());
    let reason = said.map_or(warning, Reason::text);
    let mut text = String::new();
    let written = if reason.is_empty() {
        text.write_str(mode.name())
    } else {
        write!(text, "{}: {reason}", mode.name())
    };
    if written.is_err() {
        // The name always fits; a longer reason is omitted.
        text.clear();
        let _ = text.write_str(mode.name());
    }
    text
}

/// Splits the text of a flight-mode frame into mode and reason.
pub fn parse_mode_text(text: &str) -> Option<(Mode, &str)> {
    let (name, reason) = text.split_once(": ").unwrap_or((text, ""));
    Some((Mode::from_name(name)?, reason))
}

fn tenths_of_mrad(angle: f32) -> i16 {
    // Saturates; NaN gives 0.
    (angle * 1e4) as i16
}

/// Unknown values are -1 and shown as such: EdgeTX reads the fields as signed.
fn battery(b: Battery, capacity: f32) -> packets::Battery {
    packets::Battery {
        voltage: (b.voltage * 10.0 + 0.5) as i16,
        current: b.current.map_or(-1, |current| (current * 10.0 + 0.5) as i16),
        // A·s to mAh.
        capacity_used: b.used.map_or(0xFF_FFFF, |used| (used / 3.6) as u32),
        remaining: b
            .used
            .map_or(0xFF, |used| (100.0 * (1.0 - used / capacity)) as u8),
        id: 0,
    }
}

fn encode<P: CrsfPacket>(packet: Option<P>) -> Option<Frame> {
    let mut bytes = [0; 64];
    let count = write_packet_to_buffer(&mut bytes, PacketAddress::FlightController, &packet?).ok()?;
    Frame::from_slice(bytes.get(..count)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_of_every_mode_can_be_read_back() {
        for mode in Mode::ALL {
            for reason in Reason::PLAIN.iter().copied().map(Some).chain([None]) {
                let text = mode_text(Status {
                    mode,
                    reason,
                    ..Status::default()
                });
                assert_eq!(
                    parse_mode_text(&text),
                    Some((mode, reason.map_or("", Reason::text)))
                );
                assert!(encode(packets::FlightMode::new(&text).ok()).is_some());
            }
        }
        let why = Status {
            mode: Mode::Flight,
            reason: Some(Reason::NoPosition),
            warning: "too high",
            ..Status::default()
        };
        assert_eq!(mode_text(why), "FLIGHT: too high");
        let long = "a warning far too long for the one line that a transmitter's display has for it";
        assert_eq!(
            mode_text(Status {
                mode: Mode::Disarmed,
                warning: long,
                ..Status::default()
            }),
            "DISARMED"
        );
        assert_eq!(parse_mode_text("ANGLE"), None);
    }

    #[test]
    fn the_battery_comes_in_the_frames_units() {
        let b = battery(
            Battery {
                voltage: 15.26,
                current: Some(21.3),
                used: Some(1800.0),
                ratio: 1.0,
            },
            6480.0,
        );
        assert_eq!(
            (b.voltage, b.current, b.capacity_used, b.remaining),
            (153, 213, 500, 72)
        );
        assert_eq!(
            battery(
                Battery {
                    used: Some(1e9),
                    ..Default::default()
                },
                6480.0
            )
            .remaining,
            0
        );
        let unknown = encode(Some(battery(Battery::default(), 6480.0))).unwrap();
        // Behind address, length and type: voltage, then current, charge and share left, all ones.
        assert_eq!(unknown.get(5..11), Some(&[0xFF; 6][..]));
        assert_eq!(tenths_of_mrad(f32::NAN), 0);
        assert_eq!(tenths_of_mrad(-core::f32::consts::PI), -31415);
    }
}
