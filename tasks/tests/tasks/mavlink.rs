//! The task of the MAVLink server, byte by byte on a scripted line.

use std::cell::RefCell;
use std::rc::Rc;

use mavlink_core::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, MessageData};
use sophie_control::arming::ArmingInhibit;
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_fakes::FakeLine;
use sophie_mavlink::dialect::{COMMAND_LONG_DATA, HEARTBEAT_DATA, PARAM_SET_DATA};
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

/// The task on a line, at rest or in flight.
struct Bench {
    rig: Rig,
    line: FakeLine,
    wire: Wire,
    board: Board,
    mode: Mode,
}

impl Bench {
    fn in_mode(mode: Mode) -> Self {
        let rig = Rig::with(Params::DEFAULT);
        let (line, wire, board) = (FakeLine::default(), Wire::default(), Board::default());
        let restarts = board.restarts.clone();
        rig.time.spawn(mavlink::run(
            rig.links,
            line.clone(),
            wire.clone(),
            board.clone(),
            move || restarts.set(restarts.get() + 1),
            Line {
                bytes_per_second: 5000,
            },
        ));
        Self {
            rig,
            line,
            wire,
            board,
            mode,
        }
    }

    fn run(&mut self, ms: u64) {
        let status = Status {
            mode: self.mode,
            ..Status::default()
        };
        self.rig
            .run_with(ms, |links: &Links, at| links.status.send(at, status));
    }

    fn say<M: MessageData>(&mut self, message: &M) {
        let mut raw = MAVLinkV2MessageRaw::new();
        let header = MavHeader {
            system_id: 255,
            component_id: 190,
            sequence: 0,
        };
        raw.serialize_message_data(header, message);
        self.line.put(raw.raw_bytes());
    }

    fn set_infill(&mut self, param_value: f32) {
        self.say(&PARAM_SET_DATA {
            param_value,
            target_system: 1,
            target_component: 1,
            param_id: "infill".into(),
            param_type: 9,
        });
    }

    fn arming_waits(&self) -> bool {
        self.rig.links.hardware().contains(ArmingInhibit::Stored)
    }

    fn arming_is_held(&self) -> bool {
        self.rig.links.hardware().contains(ArmingInhibit::Storing)
    }
}

#[test]
fn a_heartbeat_goes_out_each_second() {
    let mut bench = Bench::in_mode(Mode::Flight);
    bench.run(4990);
    let frames = bench.wire.frames();
    let beats: Vec<_> = frames.iter().filter(|(id, _)| *id == 0).collect();
    assert_eq!(beats.len(), 5);
    let beat = HEARTBEAT_DATA::deser(MavlinkVersion::V2, &beats[4].1[10..19]).unwrap();
    assert_eq!(beat.custom_mode, Mode::Flight as u32);
    assert_eq!(
        (beat.mavtype, beat.autopilot, beat.base_mode & 0x81),
        (2, 0, 0x81)
    );
}

#[test]
fn what_is_set_is_stored_a_second_later_and_arming_waits_for_the_restart() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    bench.run(100);
    bench.set_infill(8.0);
    bench.run(900);
    assert!(bench.board.stored.get().is_none() && !bench.arming_is_held());
    bench.run(500);
    assert_eq!(bench.board.stored.get().map(|p| p.infill), Some(8.0));
    assert!(!bench.arming_is_held() && bench.arming_waits());
    assert_eq!(bench.board.restarts.get(), 0);
    // What is in force again needs no restart.
    bench.set_infill(Params::DEFAULT.infill);
    bench.run(1500);
    assert!(!bench.arming_waits());
}

#[test]
fn nothing_is_stored_or_restarted_while_armed() {
    let mut bench = Bench::in_mode(Mode::Armed);
    bench.run(100);
    bench.set_infill(8.0);
    bench.say(&COMMAND_LONG_DATA {
        param1: 1.0,
        command: 246,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    });
    bench.run(5000);
    assert!(bench.board.stored.get().is_none() && !bench.arming_is_held());
    assert_eq!(bench.board.restarts.get(), 0);
}

#[test]
fn a_restart_comes_after_its_acknowledgement_with_arming_held() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    bench.run(100);
    bench.say(&COMMAND_LONG_DATA {
        param1: 1.0,
        command: 246,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    });
    bench.run(200);
    assert!(bench.wire.frames().iter().any(|(id, _)| *id == 77));
    assert_eq!(bench.board.restarts.get(), 0);
    bench.run(800);
    assert_eq!(bench.board.restarts.get(), 1);
    assert!(bench.arming_is_held());
}
