//! The task of the MAVLink server, byte by byte on a scripted line.

use std::cell::RefCell;
use std::rc::Rc;

use mavlink_core::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, MessageData};
use sophie_control::arming::ArmingInhibit;
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_control::pilot::remote::{RemoteAnswer, RemoteOrder, RemoteRequest};
use sophie_dialect::{
    COMMAND_ACK_DATA, COMMAND_LONG_DATA, HEARTBEAT_DATA, ODOMETRY_DATA, PARAM_SET_DATA, SERIAL_CONTROL_DATA,
    SOPHIE_CHECK_DATA,
};
use sophie_fakes::{FakeChip, FakeLine};
use sophie_mavlink::wire::signing::{Refused, Signing};
use sophie_ports::chip::Chip;
use sophie_ports::chip_check::ChipCheck;
use sophie_ports::error::PortError;
use sophie_ports::serial::SerialOutput;
use sophie_ports::signing::{Key, Record, Stored};
use sophie_tasks::console;
use sophie_tasks::ground_station::console_pipe::ConsolePipe;
use sophie_tasks::ground_station::mavlink::{self, Lines};
use sophie_tasks::links::Links;
use sophie_tasks::links::mavlink_line::{LineState, SigningState};
use sophie_tasks::links::messages::Status;

use crate::console::Board;
use crate::rig::Rig;

/// What a ground station has received.
#[derive(Clone, Default)]
pub struct Wire(Rc<RefCell<Vec<u8>>>);

impl SerialOutput for Wire {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(())
    }
}

impl Wire {
    /// The frames so far: message number and frame.
    pub fn frames(&self) -> Vec<(u32, Vec<u8>)> {
        frames_of(&self.0.borrow())
    }

    /// Forgets them.
    pub fn clear(&self) {
        self.0.take();
    }

    /// What the console has said in them.
    pub fn console(&self) -> String {
        let frames = self.frames().into_iter();
        let said = frames.filter(|(id, _)| *id == SERIAL_CONTROL_DATA::ID);
        said.map(|(_, frame)| {
            let payload = &frame[10..10 + usize::from(frame[1])];
            let said = SERIAL_CONTROL_DATA::deser(MavlinkVersion::V2, payload).unwrap();
            String::from_utf8(said.data[..usize::from(said.count)].to_vec()).unwrap()
        })
        .collect()
    }
}

/// The frames that `bytes` are, and nothing else: message number and frame.
pub fn frames_of(bytes: &[u8]) -> Vec<(u32, Vec<u8>)> {
    let mut rest = bytes;
    let mut frames = Vec::new();
    while let [0xFD, length, ..] = rest {
        let signature = if rest[2] == 1 { 13 } else { 0 };
        let (frame, after) = rest.split_at(12 + usize::from(*length) + signature);
        frames.push((
            u32::from_le_bytes([frame[7], frame[8], frame[9], 0]),
            frame.to_vec(),
        ));
        rest = after;
    }
    assert!(rest.is_empty(), "{rest:?}");
    frames
}

/// A frame of `message` from `component` of `system`.
fn frame_by<M: MessageData>(system_id: u8, component_id: u8, message: &M) -> Vec<u8> {
    let mut raw = MAVLinkV2MessageRaw::new();
    let header = MavHeader {
        system_id: system_id.into(),
        component_id,
        sequence: 0,
    };
    raw.serialize_message_data(header, message);
    raw.raw_bytes().to_vec()
}

/// The task on a line, at rest or in flight.
struct Bench {
    rig: Rig,
    line: FakeLine,
    wire: Wire,
    /// Another line of the same task.
    second: End,
    /// The signed frame that was said last.
    newest: Vec<u8>,
    shell: &'static ConsolePipe,
    board: Board,
    mode: Mode,
}

/// The far end of a line.
#[derive(Clone, Default)]
struct End {
    line: FakeLine,
    wire: Wire,
}

impl Bench {
    fn in_mode(mode: Mode) -> Self {
        Self::of(mode, Board::default())
    }

    /// With what `board` has stored.
    fn of(mode: Mode, board: Board) -> Self {
        let chip = board.clone();
        Self::on(mode, board, chip)
    }

    /// The same on `chip`.
    fn on(mode: Mode, board: Board, chip: impl Chip + 'static) -> Self {
        let rig = Rig::with(Params::DEFAULT);
        let (line, wire, second) = (FakeLine::default(), Wire::default(), End::default());
        let shell: &'static ConsolePipe = Box::leak(Box::default());
        rig.time.spawn(mavlink::run(
            rig.links,
            Lines {
                inputs: [line.clone(), second.line.clone()],
                outputs: [wire.clone(), second.wire.clone()],
                bytes_per_second: [5000; 2],
            },
            shell,
            board.clone(),
            chip,
            board.signing.get().map_or(Stored::None, Stored::Key),
        ));
        Self {
            rig,
            line,
            wire,
            second,
            newest: Vec::new(),
            shell,
            board,
            mode,
        }
    }

    /// With the console over the line.
    fn with_console() -> Self {
        let bench = Self::in_mode(Mode::Disarmed);
        let (port, board) = (bench.shell.port(), bench.board.clone());
        bench
            .rig
            .time
            .spawn(console::run(bench.rig.links, port, port, board.clone(), board));
        bench
    }

    /// What the console answers to `text`.
    fn asks(&mut self, text: &str) -> String {
        self.wire.clear();
        let mut data = [0; 70];
        data[..text.len()].copy_from_slice(text.as_bytes());
        self.say(&SERIAL_CONTROL_DATA {
            device: 10,
            flags: 2,
            count: text.len() as u8,
            data,
            ..Default::default()
        });
        self.run(1000);
        self.wire.console()
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
        self.line.put(&frame_by(255, 190, message));
    }

    /// Sends command `number` with `first` and runs for `ms`; gives its acknowledgements.
    fn commands(&mut self, number: u16, first: f32, ms: u64) -> Vec<u8> {
        self.wire.clear();
        self.say(&COMMAND_LONG_DATA {
            param1: first,
            command: number,
            target_system: 1,
            target_component: 1,
            ..Default::default()
        });
        self.run(ms);
        let acks = self.got::<COMMAND_ACK_DATA>();
        assert!(acks.iter().all(|ack| ack.command == number));
        acks.iter().map(|ack| ack.result).collect()
    }

    /// The messages of this kind so far.
    fn got<M: MessageData>(&self) -> Vec<M> {
        let frames = self.wire.frames().into_iter();
        let of_it = frames.filter(|(id, _)| *id == M::ID);
        of_it
            .map(|(_, frame)| M::deser(MavlinkVersion::V2, &frame[10..10 + usize::from(frame[1])]).unwrap())
            .collect()
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

#[test]
fn storing_by_command_repairs_what_could_not_be_read() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    bench.run(100);
    let reasons = [
        ArmingInhibit::StorageUnreadable,
        ArmingInhibit::StorageForeign,
        ArmingInhibit::StorageFull,
    ];
    reasons
        .iter()
        .for_each(|reason| bench.rig.links.report(*reason, true));
    assert_eq!(bench.commands(245, 1.0, 500), [0]);
    assert_eq!(
        bench.board.stored.get().map(|p| p.infill),
        Some(Params::DEFAULT.infill)
    );
    let hardware = bench.rig.links.hardware();
    assert!(reasons.iter().all(|reason| !hardware.contains(*reason)));
    assert!(!bench.arming_is_held() && !bench.arming_waits());
}

/// A chip whose brown-out level is 0.
fn new_chip() -> FakeChip {
    let check = |name, ok, inhibits| ChipCheck {
        name,
        read: "0".try_into().unwrap(),
        expected: "3",
        ok,
        inhibits,
    };
    FakeChip {
        checks: vec![
            check("flash wait states", true, Some(ArmingInhibit::Silicon)),
            check("brown-out level", false, Some(ArmingInhibit::BrownOutLevel)),
        ],
        ..FakeChip::default()
    }
}

#[test]
fn the_brown_out_level_is_acknowledged_once_it_is_set_and_the_restart_waits_for_that() {
    let chip = new_chip();
    let mut bench = Bench::on(Mode::Disarmed, Board::default(), chip.clone());
    bench.run(100);
    assert_eq!(bench.commands(53002, 1.0, 200), [0]);
    assert_eq!((chip.level.get(), chip.restarts.get()), (3, 0));
    bench.run(300);
    assert_eq!(chip.restarts.get(), 1);
    assert!(bench.arming_is_held());
    for (mode, chip, result) in [
        (
            Mode::Disarmed,
            FakeChip {
                refuses: true,
                ..new_chip()
            },
            4,
        ),
        (Mode::Disarmed, FakeChip::default(), 4),
        (Mode::Armed, new_chip(), 1),
    ] {
        let mut bench = Bench::on(mode, Board::default(), chip.clone());
        bench.run(100);
        assert_eq!(bench.commands(53002, 1.0, 1000), [result]);
        assert_eq!((chip.level.get(), chip.restarts.get()), (0, 0));
        assert!(!bench.arming_is_held());
    }
}

#[test]
fn reports_come_row_by_row_with_the_arming_checks_that_belong_to_them() {
    let mut bench = Bench::on(Mode::Disarmed, Board::default(), new_chip());
    bench.run(100);
    // The self-test counts rates for a second, each time anew.
    for _ in 0..2 {
        assert_eq!(bench.commands(53001, 1.0, 900), [5]);
        bench.run(1500);
        let rows = bench.got::<SOPHIE_CHECK_DATA>();
        let numbers: Vec<u8> = rows.iter().map(|row| row.row).collect();
        assert!(numbers.into_iter().eq(0..17) && rows.iter().all(|row| (row.report, row.rows) == (1, 17)));
        let radio = 1_u64 << ArmingInhibit::RcLost as u8;
        let receiver = rows.iter().find(|row| row.inhibits == radio).unwrap();
        assert_eq!(
            (receiver.name.to_str(), receiver.found.to_str(), receiver.passed),
            (Ok("receiver"), Ok("silent: 0 frames, 0 errors"), 0)
        );
        let results: Vec<u8> = bench
            .got::<COMMAND_ACK_DATA>()
            .iter()
            .map(|ack| ack.result)
            .collect();
        assert_eq!(results, [5, 0]);
    }
    assert_eq!(bench.commands(53001, 2.0, 500), [5, 0]);
    let rows = bench.got::<SOPHIE_CHECK_DATA>();
    let found: Vec<_> = rows
        .iter()
        .map(|row| {
            (
                row.report,
                row.rows,
                row.inhibits,
                row.passed,
                row.found.to_str().unwrap(),
            )
        })
        .collect();
    let [silicon, level] =
        [ArmingInhibit::Silicon, ArmingInhibit::BrownOutLevel].map(|why| 1_u64 << why as u8);
    assert_eq!(
        found,
        [
            (2, 2, silicon, 1, "0; expected 3"),
            (2, 2, level, 0, "0; expected 3")
        ]
    );
}

/// In units of 10 µs since 2015: 2026.
const DATE: u64 = 0x215C_0000_0000;

/// A board with a key that has taken nothing later than [`DATE`].
fn signing_board() -> Board {
    let board = Board::default();
    let key = Key::new([7; 32]);
    board.signing.set(Some(Record { key, bound: DATE }));
    board
}

impl Bench {
    /// Sends `message` signed by a ground station whose time is `time`.
    fn say_signed<M: MessageData>(&mut self, time: u64, message: &M) {
        let mut raw = MAVLinkV2MessageRaw::new();
        let header = MavHeader {
            system_id: 255,
            component_id: 190,
            sequence: 0,
        };
        raw.serialize_message_data(header, message);
        let mut frame = raw.raw_bytes().to_vec();
        let body = frame.len() - 2;
        frame[2] = 1;
        let sum = mavlink_core::calculate_crc(&frame[1..body], M::EXTRA_CRC);
        frame[body..].copy_from_slice(&sum.to_le_bytes());
        frame.extend([0; 13]);
        let bound = time - 1;
        let key = Key::new([7; 32]);
        Signing::new(Stored::Key(Record { key, bound })).sign(&mut frame, 5, 10);
        self.line.put(&frame);
        self.newest = frame;
    }
}

#[test]
fn with_a_key_frames_are_signed_and_what_arrives_without_is_refused_and_shown() {
    let mut bench = Bench::of(Mode::Disarmed, signing_board());
    bench.run(1000);
    bench.set_infill(8.0);
    bench.run(2000);
    assert_eq!(bench.board.stored.get(), None);
    assert!(bench.wire.frames().iter().all(|(_, frame)| frame[2] == 1));
    let state = bench.rig.links.mavlink.fresh();
    let refused = Refused {
        unsigned: 1,
        ..Refused::default()
    };
    let wanted = LineState {
        signing: SigningState::On,
        refused,
        ..LineState::default()
    };
    assert_eq!(state, Some(wanted));
    // Signed, it is obeyed.
    bench.say_signed(
        DATE + 1,
        &PARAM_SET_DATA {
            param_value: 8.0,
            target_system: 1,
            target_component: 1,
            param_id: "infill".into(),
            param_type: 9,
        },
    );
    bench.run(2000);
    assert_eq!(bench.board.stored.get().map(|p| p.infill), Some(8.0));
}

#[test]
fn the_bound_of_times_is_stored_at_rest_alone_and_arming_is_free_again() {
    for (mode, stores) in [(Mode::Disarmed, true), (Mode::Flight, false)] {
        let mut bench = Bench::of(mode, signing_board());
        bench.run(100);
        bench.say_signed(DATE + 1, &HEARTBEAT_DATA::DEFAULT);
        bench.run(1000);
        let bound = bench.board.signing.get().unwrap().bound;
        // An hour ahead.
        let wanted = if stores { DATE + 1 + 360_000_000 } else { DATE };
        assert_eq!(bound, wanted, "{mode:?}");
        assert!(!bench.arming_is_held());
    }
}

#[test]
fn the_bound_is_not_written_over_a_key_that_waits_for_a_restart() {
    let mut bench = Bench::of(Mode::Disarmed, signing_board());
    bench.run(100);
    let new = Record::fresh(Key::new([8; 32]));
    bench.rig.links.report(ArmingInhibit::Storing, true);
    bench.board.signing.set(Some(new));
    bench.say_signed(DATE + 1, &HEARTBEAT_DATA::DEFAULT);
    bench.run(1000);
    assert_eq!(bench.board.signing.get(), Some(new));
}

#[test]
fn poses_from_outside_are_published_and_grow_old() {
    let mut bench = Bench::in_mode(Mode::Flight);
    bench.run(1000);
    let pose = ODOMETRY_DATA {
        time_usec: 990_000,
        x: 1.0,
        q: [1.0, 0.0, 0.0, 0.0],
        frame_id: 1,
        child_frame_id: 12,
        ..Default::default()
    };
    bench.line.put(&frame_by(1, 197, &pose));
    let broken = ODOMETRY_DATA { x: f32::NAN, ..pose };
    bench.line.put(&frame_by(1, 197, &broken));
    bench.run(40);
    let links = bench.rig.links;
    let seen = links.external_pose.latest().unwrap();
    assert_eq!(seen.at.as_micros(), 990_000);
    assert_eq!(seen.value.pose.position.x, 1.0);
    let inputs = links.mavlink.fresh().unwrap().inputs;
    assert_eq!((inputs.poses, inputs.value), (1, 1));
    bench.run(200);
    assert!(links.external_pose.fresh().is_none());
}

#[test]
fn an_input_has_one_source_and_its_sender_one_clock_whatever_the_line() {
    let mut bench = Bench::in_mode(Mode::Flight);
    bench.run(1000);
    let pose = |time_usec| ODOMETRY_DATA {
        time_usec,
        q: [1.0, 0.0, 0.0, 0.0],
        frame_id: 1,
        child_frame_id: 12,
        ..Default::default()
    };
    let counts = |bench: &Bench| bench.rig.links.mavlink.fresh().unwrap().inputs;
    bench.line.put(&frame_by(1, 197, &pose(990_000)));
    bench.run(40);
    // Another source on the other line, and the same message on both, as a router sends it.
    bench.second.line.put(&frame_by(1, 198, &pose(1_030_000)));
    bench.second.line.put(&frame_by(1, 197, &pose(990_000)));
    bench.run(40);
    let seen = counts(&bench);
    assert_eq!((seen.poses, seen.source, seen.late), (1, 1, 1));
    // The source may change its line.
    bench.second.line.put(&frame_by(1, 197, &pose(1_060_000)));
    bench.run(40);
    assert_eq!(counts(&bench).poses, 2);
    let latest = bench.rig.links.external_pose.latest().unwrap();
    assert_eq!(latest.at.as_micros(), 1_060_000);
    // Asked once a second, where it was heard.
    let asked = |wire: &Wire| wire.frames().iter().filter(|(id, _)| *id == 111).count();
    assert_eq!((asked(&bench.wire), asked(&bench.second.wire)), (1, 0));
}

#[test]
fn a_frame_that_was_taken_on_one_line_is_old_on_the_other() {
    let mut bench = Bench::of(Mode::Disarmed, signing_board());
    bench.run(100);
    bench.say_signed(DATE + 1, &HEARTBEAT_DATA::DEFAULT);
    bench.run(100);
    bench.second.line.put(&bench.newest);
    bench.run(100);
    let state = bench.rig.links.mavlink.fresh().unwrap();
    assert_eq!(state.refused.old, 1);
    // Each line signs under its own number.
    bench.run(1000);
    for (wire, number) in [(&bench.wire, 0), (&bench.second.wire, 1)] {
        let frames = wire.frames();
        assert!(frames.len() > 5);
        let numbers = frames.iter().map(|(_, frame)| frame[frame.len() - 13]);
        assert!(numbers.into_iter().all(|given| given == number));
    }
}

#[test]
fn orders_of_two_lines_wait_for_each_other() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    bench.run(1000);
    let arm = |param1| COMMAND_LONG_DATA {
        command: 400,
        param1,
        target_system: 1,
        target_component: 1,
        ..COMMAND_LONG_DATA::DEFAULT
    };
    bench.say(&arm(1.0));
    let line = std::mem::replace(&mut bench.line, bench.second.line.clone());
    bench.say(&arm(0.0));
    bench.line = line;
    let links = bench.rig.links;
    let ordered = || links.remote.latest().map(|m| m.value);
    bench.run(100);
    let request = |number, order| Some(RemoteRequest { number, order });
    assert_eq!(ordered(), request(1, RemoteOrder::Arm));
    let answer = |number| {
        let answer = RemoteAnswer {
            number,
            ..RemoteAnswer::default()
        };
        links.remote_answer.send(embassy_time::Instant::now(), answer);
    };
    answer(1);
    bench.run(60);
    assert_eq!(ordered(), request(2, RemoteOrder::Disarm));
    answer(2);
    bench.run(100);
    for wire in [&bench.wire, &bench.second.wire] {
        let acks = wire.frames().into_iter().filter(|(id, _)| *id == 77);
        // COMMAND_ACK, accepted: its zeros are left out.
        let results: Vec<u8> = acks
            .map(|(_, frame)| if frame[1] > 2 { frame[12] } else { 0 })
            .collect();
        assert_eq!(results, [0]);
    }
}

#[test]
fn the_console_is_there_over_the_line_without_its_secrets() {
    let mut bench = Bench::with_console();
    bench.run(100);
    let said = bench.asks("get infill\r");
    assert!(
        said.starts_with("get infill\r\n") && said.ends_with("\r\n> "),
        "{said:?}"
    );
    assert!(said.contains("infill           6.9"), "{said:?}");
    // A list, longer than what waits at once.
    let said = bench.asks("list\r");
    bench.run(4000);
    assert!(said.len() > 1000, "{said:?}");
    for key in [
        "off",
        "00112233445566778899aabbccddeeff00112233445566778899aabbccddeeff",
    ] {
        let typed = format!("mavlink key {key}");
        let (first, rest) = typed.split_at(typed.len().min(60));
        bench.asks(first);
        let said = bench.asks(&format!("{rest}\r"));
        assert!(
            said.contains("not set: a key is typed at a cable, never over MAVLink"),
            "{said:?}"
        );
    }
    assert!(bench.board.signing.get().is_none());
}

#[test]
fn the_console_does_not_save_over_what_was_stored_by_the_parameter_protocol() {
    let mut bench = Bench::with_console();
    bench.run(100);
    bench.set_infill(8.0);
    bench.run(2000);
    assert_eq!(bench.board.stored.get().unwrap().infill, 8.0);
    bench.asks("set rate_pitch_p 11\r");
    let said = bench.asks("save\r");
    assert!(
        said.contains("not saved: others were stored over MAVLink, restart first and set yours again"),
        "{said:?}"
    );
    assert_eq!(
        bench.board.stored.get().unwrap().rate_pitch_p,
        Params::DEFAULT.rate_pitch_p
    );
    assert_eq!(bench.board.restarts.get(), 0);
    // A restart is what brings both together.
    assert!(bench.asks("restart\r").contains("restarting"));
    assert_eq!(bench.board.restarts.get(), 1);
}
