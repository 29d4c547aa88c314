//! The task of the MAVLink server, byte by byte on a scripted line.

use std::cell::RefCell;
use std::rc::Rc;

use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_fakes::FakeLine;
use sophie_mavlink::dialect::HEARTBEAT_DATA;
use sophie_tasks::links::{Links, Status};
use sophie_tasks::mavlink::{self, Line};
use sophie_tasks::ports::{PortError, SerialOutput};

use crate::console::Board;
use crate::rig::Rig;

/// What a ground station has received.
#[derive(Clone, Default)]
struct Wire(Rc<RefCell<Vec<u8>>>);

impl SerialOutput for Wire {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(())
    }
}

impl Wire {
    /// The frames so far: message number and frame.
    fn frames(&self) -> Vec<(u32, Vec<u8>)> {
        let bytes = self.0.borrow();
        let mut rest = &bytes[..];
        let mut frames = Vec::new();
        while let [0xFD, length, ..] = rest {
            let (frame, after) = rest.split_at(12 + usize::from(*length));
            frames.push((
                u32::from_le_bytes([frame[7], frame[8], frame[9], 0]),
                frame.to_vec(),
            ));
            rest = after;
        }
        assert!(rest.is_empty(), "{rest:?}");
        frames
    }
}

#[test]
fn a_heartbeat_goes_out_each_second() {
    let mut rig = Rig::with(Params::DEFAULT);
    let wire = Wire::default();
    let board = Board::default();
    rig.time.spawn(mavlink::run(
        rig.links,
        FakeLine::default(),
        wire.clone(),
        board,
        || (),
        Line {
            bytes_per_second: 5000,
        },
    ));
    let status = Status {
        mode: Mode::Flight,
        ..Status::default()
    };
    rig.run_with(4990, |links: &Links, at| links.status.send(at, status));
    let frames = wire.frames();
    let beats: Vec<_> = frames.iter().filter(|(id, _)| *id == 0).collect();
    assert_eq!(beats.len(), 5);
    let payload = &beats[4].1[10..];
    assert_eq!(payload[0], Mode::Flight as u8);
    use mavlink_core::{MavlinkVersion, MessageData};
    let beat = HEARTBEAT_DATA::deser(MavlinkVersion::V2, &payload[..9]).unwrap();
    assert_eq!(
        (beat.mavtype, beat.autopilot, beat.base_mode & 0x81),
        (2, 0, 0x81)
    );
}
