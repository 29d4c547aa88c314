//! A vehicle over a line that loses frames, goes away with its board at a restart, or ends at another kind of vehicle.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use mavlink_core::{MavlinkVersion, Message, MessageData};
use sophie_board_link::Failure;
use sophie_board_link::parameters::Listed;
use sophie_board_link::vehicle::Vehicle;
use sophie_dialect::*;
use sophie_mavlink::services::files::{FILES, File, GENERAL};
use sophie_mavlink::services::ftp::Ftp;
use sophie_mavlink::wire::frame::{COMPONENT, Encoder, SYSTEM};
use sophie_mavlink::wire::parser::Parser;
use sophie_mavlink::wire::requests::Peer;

/// Longest silence while an answer is due.
const PATIENCE: Duration = Duration::from_secs(3);
/// The board's time before a restart, ms.
const LONG_UP: u32 = 60_000;

/// A scripted vehicle at its end of a line.
struct Board {
    line: TcpStream,
    encoder: Encoder,
}

impl Board {
    fn new(line: TcpStream) -> Self {
        let encoder = Encoder::of(SYSTEM, COMPONENT);
        let mut board = Self { line, encoder };
        board.beat();
        board
    }

    fn say<M: MessageData>(&mut self, message: &M) {
        self.encoder.encode(message);
        self.line.write_all(self.encoder.frame()).unwrap();
    }

    fn beat(&mut self) {
        self.say(&HEARTBEAT_DATA::DEFAULT);
    }

    fn up_for(&mut self, time_boot_ms: u32) {
        self.say(&ATTITUDE_DATA {
            time_boot_ms,
            ..ATTITUDE_DATA::DEFAULT
        });
    }

    fn acknowledge(&mut self, command: u16, result: MavResult) {
        self.say(&COMMAND_ACK_DATA {
            command,
            result: result as u8,
            target_system: 254,
            target_component: 190,
            ..COMMAND_ACK_DATA::DEFAULT
        });
    }

    fn text(&mut self, words: &str) {
        let mut text = [0; 50];
        text.iter_mut()
            .zip(words.bytes())
            .for_each(|(to, from)| *to = from);
        self.say(&STATUSTEXT_DATA {
            text: text.into(),
            ..STATUSTEXT_DATA::DEFAULT
        });
    }

    fn parameter(&mut self, index: u16, count: u16) {
        let mut name = [0; 16];
        name[0] = b'a' + index as u8;
        self.say(&PARAM_VALUE_DATA {
            param_value: f32::from(index),
            param_count: count,
            param_index: index,
            param_id: name.into(),
            ..PARAM_VALUE_DATA::DEFAULT
        });
    }

    /// Answers by `script` until that is false or the line ends.
    fn serve(mut self, mut script: impl FnMut(&mut Self, MavMessage) -> bool) {
        let mut parser = Parser::reading(|id| Some(MavMessage::extra_crc(id)));
        let mut bytes = [0; 256];
        while let Ok(count @ 1..) = self.line.read(&mut bytes) {
            for byte in &bytes[..count] {
                let message = parser
                    .push(*byte, 0)
                    .and_then(|frame| MavMessage::parse(MavlinkVersion::V2, frame.id, frame.payload).ok());
                if message.is_some_and(|message| !script(&mut self, message)) {
                    return;
                }
            }
        }
    }
}

/// A vehicle that answers by `script` after it has said what `first` says.
fn vehicle(
    first: impl FnOnce(&mut Board) + Send + 'static,
    mut script: impl FnMut(&mut Board, MavMessage) -> bool + Send + 'static,
) -> (Vehicle, JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap();
    let board = thread::spawn(move || {
        let mut board = Board::new(listener.accept().unwrap().0);
        first(&mut board);
        board.serve(&mut script);
    });
    (open(&port.to_string()), board)
}

fn open(address: &str) -> Vehicle {
    let port = format!("mavlink:tcp:{address}").parse().unwrap();
    Vehicle::open(&port, None, PATIENCE, Arc::new(AtomicBool::new(false))).unwrap()
}

/// The command and its confirmation, if `message` is one.
fn command(message: &MavMessage) -> Option<(u16, u8)> {
    match message {
        MavMessage::COMMAND_LONG(command) => Some((command.command, command.confirmation)),
        _ => None,
    }
}

const MOTOR: MavCmd = MavCmd::MAV_CMD_DO_MOTOR_TEST;
const ACCEPTED: MavResult = MavResult::MAV_RESULT_ACCEPTED;

#[test]
fn a_command_is_repeated_until_it_is_acknowledged() {
    let (mut vehicle, board) = vehicle(
        // The acknowledgement of an earlier one.
        |board| board.acknowledge(MOTOR as u16, MavResult::MAV_RESULT_DENIED),
        |board, message| {
            match command(&message) {
                // The first one is lost, the second one's acknowledgement comes behind progress and is lost.
                Some((number, 1)) => board.acknowledge(number, MavResult::MAV_RESULT_IN_PROGRESS),
                Some((number, 2)) => board.acknowledge(number, ACCEPTED),
                _ => (),
            }
            true
        },
    );
    thread::sleep(Duration::from_millis(100));
    assert_eq!(vehicle.command(MOTOR, &[1.0]), Ok(ACCEPTED));
    drop(vehicle);
    board.join().unwrap();
}

#[test]
fn progress_extends_the_wait_and_a_lost_line_ends_it() {
    let (mut vehicle, board) = vehicle(
        |_| (),
        |board, message| {
            if let Some((number, 0)) = command(&message)
                && number != MOTOR as u16
            {
                // Longer than the patience.
                for _ in 0..4 {
                    board.acknowledge(number, MavResult::MAV_RESULT_IN_PROGRESS);
                    thread::sleep(Duration::from_millis(900));
                }
                board.acknowledge(number, MavResult::MAV_RESULT_FAILED);
                board.text("not level");
            }
            command(&message) != Some((MOTOR as u16, 0))
        },
    );
    let failed = Ok(MavResult::MAV_RESULT_FAILED);
    assert_eq!(vehicle.command(MavCmd::MAV_CMD_SOPHIE_CALIBRATE, &[2.0]), failed);
    // The reason comes behind the result.
    assert_eq!(vehicle.reason(), Ok("not level".to_owned()));
    // The next command ends the line.
    let Err(Failure::Board(line)) = vehicle.command(MOTOR, &[1.0]) else {
        panic!("a line without a board");
    };
    assert!(line.contains(": the line "), "{line}");
    board.join().unwrap();
}

#[test]
fn a_board_that_restarts_during_a_command_is_told() {
    let (mut vehicle, board) = vehicle(
        |board| board.up_for(LONG_UP),
        |board, message| {
            if command(&message).is_some() {
                board.beat();
                board.up_for(1000);
            }
            true
        },
    );
    let starts = vehicle.starts();
    let Err(Failure::Board(line)) = vehicle.command(MOTOR, &[1.0]) else {
        panic!("acknowledged");
    };
    assert!(
        line.ends_with("the board has restarted after DO_MOTOR_TEST"),
        "{line}"
    );
    assert_eq!(vehicle.starts(), starts + 1);
    drop(vehicle);
    board.join().unwrap();
}

#[test]
fn parameters_that_are_lost_on_their_way_are_asked_for_again() {
    const COUNT: u16 = 9;
    let mut asked = 0;
    let (mut vehicle, board) = vehicle(
        |_| (),
        move |board, message| {
            match message {
                MavMessage::PARAM_REQUEST_LIST(_) => {
                    for index in (0..COUNT).filter(|index| index % 3 == 1) {
                        board.parameter(index, COUNT);
                    }
                }
                MavMessage::PARAM_REQUEST_READ(read) => {
                    asked += 1;
                    if asked != 4 {
                        board.parameter(read.param_index as u16, COUNT);
                    }
                }
                _ => (),
            }
            true
        },
    );
    let values = vehicle.values().unwrap();
    assert_eq!(values.0.len(), usize::from(COUNT));
    assert_eq!(values.get("i"), Some(8.0));
    drop(vehicle);
    board.join().unwrap();
}

/// Stores and restarts; at the restart the port is gone, `acknowledged` or not.
fn restarted(acknowledged: bool) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let board = thread::spawn(move || {
        let mut board = Board::new(listener.accept().unwrap().0);
        board.up_for(LONG_UP);
        board.serve(|board, message| {
            let MavMessage::COMMAND_LONG(command) = message else {
                return true;
            };
            let restarts = command.command == MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN as u16;
            if acknowledged || !restarts {
                board.acknowledge(command.command, ACCEPTED);
            }
            if command.command == MavCmd::MAV_CMD_REQUEST_MESSAGE as u16 {
                board.say(&SOPHIE_ARMING_DATA {
                    time_boot_ms: LONG_UP,
                    ..SOPHIE_ARMING_DATA::DEFAULT
                });
            }
            !restarts
        });
        // Gone for a while: nothing can be opened.
        drop(listener);
        thread::sleep(Duration::from_millis(300));
        let again = TcpListener::bind(address).unwrap();
        let mut board = Board::new(again.accept().unwrap().0);
        board.up_for(1000);
        board.serve(|board, message| {
            if let Some((number, _)) = command(&message) {
                board.acknowledge(number, ACCEPTED);
            }
            true
        });
    });
    let mut vehicle = open(&address.to_string());
    vehicle.store_and_restart().unwrap();
    assert_eq!(vehicle.starts(), 1, "acknowledged: {acknowledged}");
    assert_eq!(vehicle.command(MOTOR, &[1.0]), Ok(ACCEPTED));
    drop(vehicle);
    board.join().unwrap();
}

#[test]
fn a_restart_may_take_the_port_and_its_acknowledgement_away() {
    restarted(true);
    restarted(false);
}

#[test]
fn a_refusal_of_the_restart_has_its_reason() {
    let (mut vehicle, board) = vehicle(
        |_| (),
        |board, message| {
            if let Some((number, _)) = command(&message) {
                board.acknowledge(number, MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
                thread::sleep(Duration::from_millis(50));
                board.text("refused: disarm first");
            }
            true
        },
    );
    let Err(Failure::Board(line)) = vehicle.store_and_restart() else {
        panic!("stored");
    };
    assert!(line.ends_with("not stored: refused: disarm first"), "{line}");
    drop(vehicle);
    board.join().unwrap();
}

#[test]
fn another_vehicle_is_named() {
    for vendor in [None, Some(*b"PX4")] {
        let (mut vehicle, board) = vehicle(
            |_| (),
            move |board, message| {
                match (command(&message), vendor) {
                    (Some((number, _)), None) => {
                        board.acknowledge(number, MavResult::MAV_RESULT_UNSUPPORTED);
                    }
                    (Some((number, _)), Some(vendor)) => {
                        board.acknowledge(number, ACCEPTED);
                        let mut name = [0; 32];
                        name[..3].copy_from_slice(&vendor);
                        board.say(&COMPONENT_INFORMATION_BASIC_DATA {
                            vendor_name: name.into(),
                            ..COMPONENT_INFORMATION_BASIC_DATA::DEFAULT
                        });
                    }
                    _ => (),
                }
                true
            },
        );
        let Err(Failure::Input(line)) = vehicle.identity() else {
            panic!("{vendor:?} is taken");
        };
        assert!(
            line.contains("this is no vehicle of this program's release"),
            "{line}"
        );
        drop(vehicle);
        board.join().unwrap();
    }
}

/// `text` in a field of N bytes.
fn padded<const N: usize>(text: &str) -> [u8; N] {
    let mut field = [0; N];
    field[..text.len()].copy_from_slice(text.as_bytes());
    field
}

/// Messages of a vehicle that calls itself 0.0.9 and has another table of parameters than this program.
fn earlier(board: &mut Board, request: &COMMAND_LONG_DATA) {
    board.acknowledge(request.command, ACCEPTED);
    match request.param1 as u32 {
        COMPONENT_INFORMATION_BASIC_DATA::ID => board.say(&COMPONENT_INFORMATION_BASIC_DATA {
            vendor_name: padded::<32>("SOPHIE").into(),
            model_name: padded::<32>("table").into(),
            software_version: padded::<24>("0.0.9").into(),
            ..COMPONENT_INFORMATION_BASIC_DATA::DEFAULT
        }),
        AUTOPILOT_VERSION_DATA::ID => board.say(&AUTOPILOT_VERSION_DATA {
            flight_custom_version: [0x12, 0x34, 0xAB, 0xCD, 0, 0, 0, 1],
            ..AUTOPILOT_VERSION_DATA::DEFAULT
        }),
        _ => (),
    }
}

/// What is read of a vehicle of an earlier release that serves `files`; its line loses every eighth piece of one.
fn earlier_release(files: &'static [File]) -> Listed {
    let mut ftp = Ftp::new(files);
    let mut pieces = 0;
    let (mut vehicle, board) = vehicle(
        |_| (),
        move |board, message| {
            match message {
                MavMessage::COMMAND_LONG(request) => earlier(board, &request),
                MavMessage::PARAM_REQUEST_LIST(_) => {
                    for (index, name) in (0..).zip(["infill", "old_gain"]) {
                        board.say(&PARAM_VALUE_DATA {
                            param_value: 8.0,
                            param_count: 2,
                            param_index: index,
                            param_id: padded::<16>(name).into(),
                            ..PARAM_VALUE_DATA::DEFAULT
                        });
                    }
                }
                MavMessage::FILE_TRANSFER_PROTOCOL(request) => {
                    let station = Peer {
                        system: 254,
                        component: 190,
                    };
                    ftp.ask(station, &request.payload);
                    pieces += 1;
                    while let Some((to, payload)) = ftp.answer() {
                        if pieces % 8 != 3 {
                            board.say(&FILE_TRANSFER_PROTOCOL_DATA {
                                target_network: 0,
                                target_system: to.system,
                                target_component: to.component,
                                payload,
                            });
                        }
                    }
                }
                _ => (),
            }
            true
        },
    );
    let listed = Listed::of(&mut vehicle).unwrap();
    drop(vehicle);
    board.join().unwrap();
    listed
}

#[test]
fn a_vehicle_of_another_release_describes_its_own_parameters() {
    let listed = earlier_release(&FILES);
    let line = listed.foreign().unwrap();
    assert!(
        line.starts_with("SOPHIE 0.0.9 there has another table of parameters"),
        "{line}"
    );
    let text = listed.text();
    assert!(
        text.starts_with(
            "# Parameters of SOPHIE 0.0.9 on table, build 1234abcd, 2 parameters, table 00000001."
        ),
        "{text}"
    );
    // What it does not describe comes behind.
    assert!(
        text.contains("# 4 to 10 %; not the default\nold_gain = 8\n"),
        "{text}"
    );
}

#[test]
fn a_vehicle_without_a_description_has_its_values_alone() {
    static LIST_ALONE: [File; 1] = [GENERAL];
    for files in [&[][..], &LIST_ALONE] {
        let listed = earlier_release(files);
        assert!(
            listed
                .foreign()
                .unwrap()
                .contains("no description that can be read")
        );
        let text = listed.text();
        assert!(text.ends_with("[params]\ninfill = 8\nold_gain = 8\n"), "{text}");
        assert!(listed.differences(&[]).is_err());
    }
}
