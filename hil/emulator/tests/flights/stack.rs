//! Depth of the stack while every line is busy, in flight and over a restart on the pipe.

use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpStream};
use std::time::Duration;

use mavlink_core::MessageData;
use serde::Deserialize;
use sophie_dialect::{FILE_TRANSFER_PROTOCOL_DATA, HEARTBEAT_DATA, PARAM_REQUEST_LIST_DATA};
use sophie_emulator::closed_loop::Setup;
use sophie_emulator::silicon;
use sophie_emulator::terminal::Sockets;
use sophie_mavlink::services::ftp::PAYLOAD;
use sophie_mavlink::wire::frame::Encoder;
use sophie_sim::scenario::World;
use sophie_test_support::signals::uninterrupted;

use super::console::terminal;
use super::*;

/// Up, onto a low pipe nearby, and reset by the watchdog while the arms close: the shortest way to a restart on the pipe.
fn onto_the_pipe() -> Scenario {
    let scenario = scenario("reset-clamping.toml");
    let until = scenario
        .steps
        .iter()
        .position(|step| matches!(step, Step::Reset { .. }))
        .unwrap();
    let mut steps = scenario.steps[..=until].to_vec();
    steps[1] = Step::TakeOff { height: 1.2 };
    let mut pilot = scenario.pilot;
    pilot.eye_noise = 0.0;
    let world = World {
        gust_force: 0.0,
        gust_moment: 0.0,
        steady_wind: 0.0,
        pipe_position: [1.5, 0.0],
        pipe_top: 0.5,
        ..scenario.world
    };
    Scenario {
        steps,
        pilot,
        world,
        ..scenario
    }
}

/// Commands with the longest answers and computations; the board refuses some of them in the air.
const COMMANDS: [&str; 10] = [
    "list",
    "status",
    "timing",
    "silicon",
    "get infill",
    "set infill 8",
    "changes",
    "reset infill",
    "watch imu",
    "mavlink",
];

/// Types [`COMMANDS`] again and again until the board has gone; counts the answers by their prompts.
fn type_on(port: u16) -> usize {
    let mut user = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
    user.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    let mut answers = 0;
    for command in COMMANDS.iter().cycle() {
        // The second line ends a watch; a board that restarts loses a command, and answers the next.
        if user.write_all(format!("{command}\r\r").as_bytes()).is_err() {
            break;
        }
        let mut said = Vec::<u8>::new();
        let mut bytes = [0; 256];
        while said.iter().filter(|byte| **byte == b'>').count() < 2 {
            match uninterrupted(|| user.read(&mut bytes)) {
                Ok(0) => return answers,
                Ok(count) => said.extend(&bytes[..count]),
                Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => break,
                Err(_) => return answers,
            }
        }
        answers += usize::from(!said.is_empty());
    }
    answers
}

/// Messages by their numbers.
const PARAM_VALUE: u32 = 22;
const FILE_TRANSFER_PROTOCOL: u32 = 110;

/// A file's first bytes and the whole of it as a burst, in the protocol's numbers.
const REQUESTS: [(u8, &[u8]); 5] = [
    (3, b"/"),
    (4, b"/parameter.json.xz"),
    (14, b"/general.json"),
    (5, b""),
    (15, b""),
];

/// Takes the whole frames of the vehicle off the front of `heard`; returns the numbers of their messages.
fn frames(heard: &mut Vec<u8>) -> Vec<u32> {
    let mut ids = Vec::new();
    loop {
        // A frame may have begun before the connection, or ended with a restart.
        let begin = heard.iter().position(|byte| *byte == 0xFD).unwrap_or(heard.len());
        heard.drain(..begin);
        let [_, length, _, _, _, system, _, a, b, c, ..] = heard[..] else {
            return ids;
        };
        let whole = 12 + usize::from(length);
        if system != 1 {
            heard.drain(..1);
        } else if whole > heard.len() {
            return ids;
        } else {
            heard.drain(..whole);
            ids.push(u32::from_le_bytes([a, b, c, 0]));
        }
    }
}

/// A ground station on the line with the bytes received.
struct Station {
    line: TcpStream,
    encoder: Encoder,
    heard: Vec<u8>,
    parameters: usize,
    files: usize,
}

impl Station {
    /// Sends `message`, and reads until the line is silent, or `enough` is; `None` once the board has gone.
    fn ask(&mut self, message: &impl MessageData, enough: impl Fn(&Self) -> bool) -> Option<()> {
        self.encoder.encode(message);
        self.line.write_all(self.encoder.frame()).ok()?;
        let mut bytes = [0; 512];
        for _ in 0..2000 {
            let count = match uninterrupted(|| self.line.read(&mut bytes)) {
                Ok(0) => return None,
                Ok(count) => count,
                Err(e) if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => break,
                Err(_) => return None,
            };
            self.heard.extend(&bytes[..count]);
            for id in frames(&mut self.heard) {
                self.parameters += usize::from(id == PARAM_VALUE);
                self.files += usize::from(id == FILE_TRANSFER_PROTOCOL);
            }
            if enough(self) {
                break;
            }
        }
        Some(())
    }

    /// Lists parameters, most of them, and reads files, by turns: a list has priority over files.
    fn turn(&mut self, number: u8) -> Option<()> {
        let heartbeat = HEARTBEAT_DATA {
            mavtype: 6,
            autopilot: 8,
            ..HEARTBEAT_DATA::DEFAULT
        };
        self.ask(&heartbeat, |_| true)?;
        let list = PARAM_REQUEST_LIST_DATA {
            target_system: 1,
            target_component: 1,
        };
        let before = self.parameters;
        self.ask(&list, |s| s.parameters > before + 100)?;
        for (op, data) in REQUESTS {
            let mut payload = [0; PAYLOAD];
            payload[0] = number;
            payload[2] = 1;
            payload[3] = op;
            payload[4] = if data.is_empty() { 200 } else { data.len() as u8 };
            payload[12..12 + data.len()].copy_from_slice(data);
            let request = FILE_TRANSFER_PROTOCOL_DATA {
                target_system: 1,
                target_component: 1,
                payload,
                ..FILE_TRANSFER_PROTOCOL_DATA::DEFAULT
            };
            let before = self.files;
            self.ask(&request, |s| s.files > before)?;
        }
        Some(())
    }
}

/// Asks until the board has gone; counts parameters and answers of files.
fn ask_on(port: u16) -> (usize, usize) {
    let line = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
    line.set_read_timeout(Some(Duration::from_millis(500))).unwrap();
    let mut station = Station {
        line,
        encoder: Encoder::of(255, 190),
        heard: Vec::new(),
        parameters: 0,
        files: 0,
    };
    for number in (0..=u8::MAX).cycle() {
        if station.turn(number).is_none() {
            break;
        }
    }
    (station.parameters, station.files)
}

/// A board of `xtask/ceilings.toml`.
#[derive(Deserialize)]
struct Ceiling {
    stack: u32,
}

/// Flies `board` with full lines onto the pipe and over a restart there.
fn leaves_a_quarter(board: &str, image: &Path) {
    let firmware = Firmware::read(image, board_kind::find(board).unwrap()).unwrap();
    let (typed, console) = terminal("--console");
    let (asked, mavlink) = terminal("--mavlink");
    let user = std::thread::spawn(move || type_on(typed));
    let station = std::thread::spawn(move || ask_on(asked));
    let setup = Setup {
        speed: 1.0,
        plan: Plan::new([]),
        sockets: Sockets {
            console: Some(console),
            mavlink: Some(mavlink),
            ..Sockets::default()
        },
    };
    let flight = flight::fly(&firmware, &onto_the_pipe(), setup, |_| (), &mut Silent).unwrap();
    let (answers, (parameters, files)) = (user.join().unwrap(), station.join().unwrap());
    let used = silicon::stack_use(&flight.board.lines).unwrap_or_else(|| panic!("{}", log(&flight)));
    // For docs/boards.md.
    println!("{board}: {used:?}; {answers} answers, {parameters} parameters, {files} pieces of files");
    assert!(
        flight.passed(),
        "{:?} {:?}\n{}",
        flight.record.outcome,
        flight.gaps,
        log(&flight)
    );
    assert_eq!(flight.board.resets.len(), 1, "{:?}", flight.board.resets);
    // Every command once; how often more is a matter of the machine's speed.
    assert!(
        answers >= COMMANDS.len() && parameters > 100 && files > 10,
        "{answers} {parameters} {files}"
    );
    assert!(
        !used.is_scarce() && logged_at(&flight, 0.0, "stack nearly full").is_none(),
        "{board}: {used:?}\n{}",
        log(&flight)
    );
    let page = std::fs::read_to_string(root().join("xtask/ceilings.toml")).unwrap();
    let ceilings: std::collections::BTreeMap<String, Ceiling> = toml::from_str(&page).unwrap();
    let ceiling = ceilings[board].stack;
    assert!(
        used.start.max(used.flight) <= ceiling,
        "{board}: {used:?}, xtask/ceilings.toml has {ceiling}"
    );
}

#[test]
fn a_quarter_of_the_stack_is_left_while_every_line_is_busy_and_the_board_restarts_on_the_pipe() {
    leaves_a_quarter("matek-h743", image());
}

#[test]
fn so_it_is_left_on_the_small_board() {
    leaves_a_quarter("f405", small_image());
}
