//! The USB device against a scripted host on a fake bus: descriptors, the class, and what a host may do.

use embassy_usb::driver::{Direction, EndpointType, Event};
use mavlink_core::{MAVLinkV1MessageRaw, MAVLinkV2MessageRaw, MavHeader, MessageData};
use sophie_control::mode::Mode;
use sophie_dialect::{HEARTBEAT_DATA, PARAM_REQUEST_LIST_DATA, PARAM_SET_DATA, SERIAL_CONTROL_DATA};
use sophie_fakes::FakeLine;
use sophie_ports::signing::Stored;
use sophie_tasks::console;
use sophie_tasks::console::either::Either;
use sophie_tasks::console::terminals::ActiveTerminal;
use sophie_tasks::ground_station::console_pipe::ConsolePipe;
use sophie_tasks::ground_station::mavlink::{self, Lines};
use sophie_tasks::links::Links;
use sophie_tasks::links::messages::Status as Commander;
use sophie_tasks::schedule::TaskId;
use sophie_tasks::usb::port::Port;
use sophie_tasks::usb::{self, Identity, Memory};

use crate::console::{Board, Screen};
use crate::fake_bus::{FakeBus, Status};
use crate::mavlink::{Wire, frames_of};
use crate::rig::Rig;

const GET_DESCRIPTOR: u8 = 6;
/// From device and to device: standard, and of the class to an interface.
const FROM_DEVICE: u8 = 0x80;
const TO_DEVICE: u8 = 0x00;
const FROM_CLASS: u8 = 0xA1;
const TO_CLASS: u8 = 0x21;
const SET_LINE_CODING: u8 = 0x20;
const GET_LINE_CODING: u8 = 0x21;
const SET_CONTROL_LINE_STATE: u8 = 0x22;

/// Fewest frames of the streams in a second, of a vehicle of which little is known.
const STREAMED: usize = 5;

const SERIAL: &str = "0123456789ABCDEF01234567";

fn setup(kind: u8, request: u8, value: u16, index: u16, length: u16) -> [u8; 8] {
    let [value, index, length] = [value, index, length].map(u16::to_le_bytes);
    [
        kind, request, value[0], value[1], index[0], index[1], length[0], length[1],
    ]
}

/// A board with its lines: a terminal and a MAVLink line beside USB, and the console at all three.
struct Bench {
    rig: Rig,
    bus: FakeBus,
    typed: FakeLine,
    screen: Screen,
    radio: FakeLine,
    aired: Wire,
    board: Board,
    /// Endpoint of what the device sends, once it is configured.
    bulk_in: u8,
    mode: Mode,
}

impl Bench {
    fn new() -> Self {
        let rig = Rig::new();
        let port: &'static Port = Box::leak(Box::new(Port::new()));
        let memory: &'static mut Memory<'static> = Box::leak(Box::new(Memory::new()));
        let (bus, board) = (FakeBus::default(), Board::default());
        let identity = Identity {
            product: "SOPHIE table",
            serial: SERIAL,
        };
        rig.time.spawn(usb::run(bus.clone(), memory, port, identity));
        let (typed, screen) = (FakeLine::default(), Screen::default());
        let served: &'static ActiveTerminal = Box::leak(Box::default());
        let shell: &'static ConsolePipe = Box::leak(Box::default());
        let (input, output) = port.console();
        rig.time.spawn(console::run(
            rig.links,
            served.inputs([
                Either::First(Either::First(typed.clone())),
                Either::First(Either::Second(input)),
                Either::Second(shell.port()),
            ]),
            served.outputs([
                Either::First(Either::First(screen.clone())),
                Either::First(Either::Second(output)),
                Either::Second(shell.port()),
            ]),
            board.clone(),
            board.clone(),
        ));
        let (radio, aired) = (FakeLine::default(), Wire::default());
        let (input, output) = port.mavlink();
        rig.time.spawn(mavlink::run(
            rig.links,
            Lines {
                inputs: [Either::First(radio.clone()), Either::Second(input)],
                outputs: [Either::First(aired.clone()), Either::Second(output)],
                bytes_per_second: [5000, 20_000],
            },
            shell,
            board.clone(),
            board.clone(),
            Stored::None,
        ));
        Self {
            rig,
            bus,
            typed,
            screen,
            radio,
            aired,
            board,
            bulk_in: 0,
            mode: Mode::Disarmed,
        }
    }

    fn run(&mut self, ms: u64) {
        let status = Commander {
            mode: self.mode,
            ..Commander::default()
        };
        self.rig
            .run_with(ms, |links: &Links, at| links.status.send(at, status));
    }

    fn control(&mut self, setup: [u8; 8], data: &[u8]) -> (Option<Status>, Vec<u8>) {
        self.bus.setup(setup, data);
        self.run(3);
        self.bus.answer()
    }

    fn descriptor(&mut self, kind: u8, index: u8, length: u16) -> Vec<u8> {
        let value = u16::from_be_bytes([kind, index]);
        let (status, bytes) = self.control(setup(FROM_DEVICE, GET_DESCRIPTOR, value, 0, length), &[]);
        assert_eq!(status, Some(Status::Accepted));
        bytes
    }

    /// What a host does with a device that was plugged in.
    fn enumerate(&mut self) {
        self.bus.event(Event::PowerDetected);
        self.bus.event(Event::Reset);
        self.run(20);
        let device = self.descriptor(1, 0, 64);
        assert_eq!(device.len(), 18);
        let (status, _) = self.control(setup(TO_DEVICE, 5, 7, 0, 0), &[]);
        assert_eq!((status, self.bus.address()), (Some(Status::Accepted), 7));
        let configuration = self.descriptor(2, 0, 255);
        assert_eq!(
            usize::from(u16::from_le_bytes([configuration[2], configuration[3]])),
            configuration.len()
        );
        let (status, _) = self.control(setup(TO_DEVICE, 9, 1, 0, 0), &[]);
        assert_eq!(status, Some(Status::Accepted));
        let bulk_in = (self.bus.endpoints().into_iter())
            .find(|e| e.ep_type == EndpointType::Bulk && e.addr.direction() == Direction::In);
        self.bulk_in = bulk_in.unwrap().addr.into();
        assert!(self.bus.is_enabled(self.bulk_in));
    }

    /// A program opens the port, or closes it.
    fn open(&mut self, open: bool) {
        let state = if open { 3 } else { 0 };
        let (status, _) = self.control(setup(TO_CLASS, SET_CONTROL_LINE_STATE, state, 0, 0), &[]);
        assert_eq!(status, Some(Status::Accepted));
    }

    /// An enumerated device whose port is open.
    fn opened() -> Self {
        let mut bench = Self::new();
        bench.enumerate();
        bench.open(true);
        bench
    }

    /// Sends `bytes` as a host does.
    fn send(&mut self, bytes: &[u8]) {
        for packet in bytes.chunks(64) {
            self.bus.send(packet);
        }
    }

    /// What the host fetches in `ms`, a packet a millisecond.
    fn hear(&mut self, ms: u64) -> Vec<u8> {
        let mut heard = Vec::new();
        for _ in 0..ms {
            self.run(1);
            while let Some(packet) = self.bus.fetch(self.bulk_in) {
                // A full packet would keep the host waiting for the next.
                assert!(packet.len() < 64, "{}", packet.len());
                heard.extend(packet);
                self.run(0);
            }
        }
        heard
    }

    fn hear_text(&mut self, ms: u64) -> String {
        String::from_utf8(self.hear(ms)).unwrap()
    }

    /// Sends text and gives what came of it.
    fn says(&mut self, text: &str) -> String {
        self.send(text.as_bytes());
        self.hear_text(300)
    }

    /// Types `text` at the console over the MAVLink line; `stays`: the station wants an answer.
    fn types_by_mavlink(&mut self, text: &str, stays: bool) {
        let mut data = [0; 70];
        data[..text.len()].copy_from_slice(text.as_bytes());
        self.radio.put(&frame(&SERIAL_CONTROL_DATA {
            device: 10,
            flags: if stays { 2 } else { 0 },
            count: text.len() as u8,
            data,
            ..Default::default()
        }));
    }

    /// The same, and what the console answers there.
    fn says_by_mavlink(&mut self, text: &str) -> String {
        self.aired.clear();
        self.types_by_mavlink(text, true);
        self.run(1000);
        self.aired.console()
    }

    /// What the terminal at the cable has shown since the last look.
    fn shown(&mut self, ms: u64) -> String {
        self.run(ms);
        self.screen.0.take()
    }

    /// Counts what is sent over USB in a second: frames, with nothing between them.
    fn frames(&mut self) -> usize {
        let heard = self.hear(1000);
        frames_of(&heard).len()
    }
}

fn frame<M: MessageData>(message: &M) -> Vec<u8> {
    let mut raw = MAVLinkV2MessageRaw::new();
    raw.serialize_message_data(STATION, message);
    raw.raw_bytes().to_vec()
}

const STATION: MavHeader = MavHeader {
    system_id: 255,
    component_id: 190,
    sequence: 0,
};

fn heartbeat() -> Vec<u8> {
    frame(&HEARTBEAT_DATA::DEFAULT)
}

#[test]
fn a_host_finds_one_serial_port() {
    let mut bench = Bench::new();
    bench.enumerate();
    let device = bench.descriptor(1, 0, 18);
    // USB 2.0, a function of several interfaces, packets of 64, ST's virtual serial port.
    assert_eq!(device[..8], [18, 1, 0x00, 0x02, 0xEF, 0x02, 0x01, 64]);
    assert_eq!(device[8..12], [0x83, 0x04, 0x40, 0x57]);

    let configuration = bench.descriptor(2, 0, 255);
    let mut rest = &configuration[..];
    let mut parts = Vec::new();
    while let Some(&length) = rest.first() {
        let (part, after) = rest.split_at(usize::from(length));
        parts.push(part.to_vec());
        rest = after;
    }
    // Two interfaces, powered by the bus, 500 mA.
    assert_eq!(parts[0][4..], [2, 1, 0, 0x80, 250]);
    let of = |kind: u8| parts.iter().filter(move |part| part[1] == kind);
    assert_eq!(of(0x0B).count(), 1, "one function");
    let classes: Vec<_> = of(4).map(|part| [part[2], part[5], part[6], part[7]]).collect();
    assert_eq!(classes, [[0, 0x02, 0x02, 0x00], [1, 0x0A, 0x00, 0x00]]);
    // Header, abstract control model with line coding and state, union of both interfaces.
    let functional: Vec<_> = of(0x24).map(|part| part[2..].to_vec()).collect();
    assert_eq!(
        functional,
        [vec![0x00, 0x10, 0x01], vec![0x02, 0x02], vec![0x06, 0, 1]]
    );
    let endpoints: Vec<_> = of(5).map(|part| (part[2], part[3], part[4])).collect();
    assert_eq!(endpoints, [(0x81, 3, 8), (0x01, 2, 64), (0x82, 2, 64)]);

    let text = |bytes: Vec<u8>| {
        let units: Vec<u16> = bytes[2..]
            .chunks(2)
            .map(|u| u16::from_le_bytes([u[0], u[1]]))
            .collect();
        String::from_utf16(&units).unwrap()
    };
    let strings = [device[14], device[15], device[16]].map(|index| text(bench.descriptor(3, index, 255)));
    assert_eq!(strings, ["SOPHIE", "SOPHIE table", SERIAL]);
    // Longer than the control buffer of a careless size would be.
    assert!(bench.descriptor(3, device[16], 255).len() <= 64);
}

#[test]
fn the_class_takes_what_hosts_set_and_refuses_the_rest() {
    let mut bench = Bench::new();
    bench.enumerate();
    // 115,200 baud, one stop bit, no parity, eight bits.
    let coding = [0x00, 0xC2, 0x01, 0x00, 0, 0, 8];
    let set = setup(TO_CLASS, SET_LINE_CODING, 0, 0, 7);
    assert_eq!(bench.control(set, &coding).0, Some(Status::Accepted));
    let get = setup(FROM_CLASS, GET_LINE_CODING, 0, 0, 7);
    assert_eq!(bench.control(get, &[]), (Some(Status::Accepted), coding.to_vec()));
    bench.open(true);
    // To the data interface, a request that there is not, and more data than it has room for.
    for (wrong, data) in [
        (setup(TO_CLASS, SET_CONTROL_LINE_STATE, 1, 1, 0), &[][..]),
        (setup(TO_CLASS, 0x7F, 0, 0, 0), &[]),
        (setup(TO_CLASS, SET_LINE_CODING, 0, 0, 500), &[0; 64]),
        (setup(FROM_CLASS, GET_LINE_CODING, 0, 0, 3), &[]),
    ] {
        assert_eq!(bench.control(wrong, data).0, Some(Status::Stalled), "{wrong:x?}");
    }
    assert!(bench.says("version\r").contains("SOPHIE"));
}

#[test]
fn a_terminal_gets_the_console() {
    let mut bench = Bench::opened();
    assert_eq!(bench.hear(2000), b"", "nothing is said that was not asked for");
    assert_eq!(bench.says("\r"), "\r\n> ");
    let said = bench.says("get infill\r");
    assert!(
        said.starts_with("get infill\r\n  infill ") && said.ends_with("\r\n> "),
        "{said}"
    );
    // Key by key, and corrected.
    for key in [&b"s"[..], b"x", b"\x7F", b"et infill 8", b"\r"] {
        bench.send(key);
    }
    let said = bench.hear_text(300);
    assert!(said.contains("infill") && said.ends_with("> "), "{said}");
    // More than the device keeps: the host is held back, and no byte is lost.
    let paste: String = (0..60).map(|_| "get arm_d\r").collect();
    bench.send(paste.as_bytes());
    let said = bench.hear_text(3000);
    assert_eq!(said.matches("get arm_d\r\n").count(), 60, "{said}");
    assert_eq!(bench.bus.held_back(), 0);
}

#[test]
fn heartbeats_of_a_ground_station_make_it_mavlink() {
    let mut old = MAVLinkV1MessageRaw::new();
    old.serialize_message_data(STATION, &HEARTBEAT_DATA::DEFAULT);
    for hello in [heartbeat(), old.raw_bytes().to_vec()] {
        let mut bench = Bench::opened();
        bench.send(&hello);
        let count = bench.frames();
        assert!(count > 20, "{count} frames after {hello:x?}");
        // Its own budget holds: a list of all parameters is through in a second, and not at once.
        let list = PARAM_REQUEST_LIST_DATA {
            target_system: 1,
            target_component: 1,
        };
        bench.send(&frame(&list));
        let bytes = bench.hear(1000);
        assert!((4000..=25_000).contains(&bytes.len()), "{}", bytes.len());
        // A program that closes the port ends it.
        bench.open(false);
        bench.hear(50);
        assert_eq!(bench.hear(2000), b"");
        bench.open(true);
        assert!(bench.says("version\r").contains("SOPHIE"));
    }
}

#[test]
fn a_line_of_text_takes_the_port_back() {
    let mut bench = Bench::opened();
    bench.send(&heartbeat());
    assert!(bench.frames() > STREAMED);
    // Cut anywhere, and with a frame behind it that is not for a terminal.
    bench.send(b"he");
    bench.send(b"lp\r");
    let said = bench.hear(300);
    let end = String::from_utf8_lossy(&said);
    assert!(end.ends_with("\r\n> "), "{end:?}");
    assert!(bench.says("version\r").contains("SOPHIE"));
    // What lies in frames is no text.
    bench.send(&heartbeat());
    bench.hear(1000);
    let set = PARAM_SET_DATA {
        param_value: f32::from_le_bytes(*b"\rab\r"),
        target_system: 1,
        target_component: 1,
        param_id: "\rsave\r".into(),
        param_type: 9,
    };
    for _ in 0..5 {
        bench.send(&frame(&set));
    }
    assert!(bench.frames() > STREAMED);
}

#[test]
fn a_frame_is_no_text_for_the_console_and_text_no_frame() {
    let mut bench = Bench::opened();
    // A frame in the midst of a line, with a command in it, that is not sound.
    let mut garbled = frame(&PARAM_SET_DATA {
        param_id: "\rrestart\rsave\r".into(),
        ..PARAM_SET_DATA::DEFAULT
    });
    let last = garbled.len() - 1;
    garbled[last] ^= 1;
    bench.send(b"get infill");
    bench.send(&garbled);
    let said = bench.says("\r");
    assert!(
        said.contains("only printable ASCII characters are understood"),
        "{said}"
    );
    assert_eq!(bench.board.restarts.get(), 0);
    // A beginning that nothing follows holds nothing up.
    bench.send(&[0xFD]);
    bench.hear(400);
    assert!(bench.says("\r").contains("only printable ASCII"));
    assert!(bench.says("version\r").contains("SOPHIE"));
}

#[test]
fn a_host_that_does_not_read_delays_nothing() {
    let mut bench = Bench::opened();
    bench.send(&heartbeat());
    bench.run(5000);
    // The other line has all that it has with USB unplugged.
    let beats = |wire: &Wire| wire.frames().iter().filter(|(id, _)| *id == 0).count();
    assert!((4..=6).contains(&beats(&bench.aired)), "{}", beats(&bench.aired));
    assert_eq!(bench.rig.links.timing.task(TaskId::Mavlink).overruns, 0);
    // What it gets when it reads again is of now, behind what was on its way.
    assert!(bench.bus.fetch(bench.bulk_in).is_some());
    let count = bench.frames();
    assert!(count > STREAMED, "{count}");

    // A terminal that stands: the console obeys what is typed at the other.
    let mut bench = Bench::opened();
    bench.send(b"list\r");
    bench.run(3000);
    bench.typed.put(b"version\r");
    bench.run(500);
    let said = bench.screen.0.take();
    assert!(said.contains("SOPHIE") && said.ends_with("> "), "{said}");
}

#[test]
fn what_is_typed_last_has_the_console() {
    let mut bench = Bench::opened();
    bench.typed.put(b"watch imu\r");
    bench.run(1000);
    assert!(bench.screen.0.take().contains("attitude"));
    // It ends, and the line that was begun there is not mixed with this one.
    bench.typed.put(b"sa");
    bench.run(50);
    let said = bench.says("ve\r");
    assert!(said.contains("no command 've'"), "{said}");
    assert_eq!(bench.board.stored.get(), None);
    bench.run(1000);
    bench.screen.0.take();
    bench.run(1000);
    assert_eq!(*bench.screen.0.borrow(), "");
    // Closing the port takes nothing from who types elsewhere.
    bench.typed.put(b"get inf");
    bench.run(50);
    bench.open(false);
    bench.bus.event(Event::Reset);
    bench.run(50);
    bench.typed.put(b"ill\r");
    bench.run(100);
    assert!(bench.screen.0.take().contains("infill"));
}

#[test]
fn mavlinks_shell_is_a_terminal_of_the_same_console() {
    let mut bench = Bench::opened();
    // One working copy.
    bench.typed.put(b"set infill 8\r");
    assert!(bench.shown(300).contains("infill 6.9 -> 8 %"));
    assert!(bench.says_by_mavlink("changes\r").contains("infill 6.9 -> 8 %"));
    assert_eq!(bench.shown(0), "", "answered where it was typed");
    // What runs at the cable ends, what was begun there is not mixed with it, and the reverse.
    bench.typed.put(b"watch imu\r");
    assert!(bench.shown(1000).contains("attitude"));
    assert!(bench.says_by_mavlink("version\r").contains("SOPHIE"));
    bench.shown(0);
    assert_eq!(bench.shown(1000), "");
    bench.says_by_mavlink("sa");
    bench.typed.put(b"ve\r");
    assert!(bench.shown(300).contains("no command 've'"));
    assert!(bench.says("version\r").contains("SOPHIE"));
    assert_eq!(bench.board.stored.get(), None);
}

#[test]
fn a_station_that_leaves_disturbs_no_other_terminal() {
    let mut bench = Bench::opened();
    bench.says_by_mavlink("help\r");
    // It has the console no longer when it leaves.
    for leaves_by_silence in [false, true] {
        bench.typed.put(b"propellers off\rservo 1 pulse 1500\r");
        bench.run(300);
        bench.typed.put(b"\rwatch imu\r");
        bench.shown(1000);
        if leaves_by_silence {
            bench.says_by_mavlink("help\r");
            bench.typed.put(b"watch imu\r");
            // A minute of silence, and what follows it.
            bench.shown(59_000);
        } else {
            bench.types_by_mavlink("", false);
        }
        bench.shown(3000);
        let rows = bench.shown(1000);
        assert!(rows.lines().count() >= 4, "{leaves_by_silence}: {rows:?}");
        bench.typed.put(b"\x03get inf");
        bench.run(50);
        bench.types_by_mavlink("", false);
        bench.typed.put(b"ill\r");
        let said = bench.shown(300);
        assert!(said.contains("  infill "), "{leaves_by_silence}: {said:?}");
    }
    // Who has it and leaves ends what it has begun, and the next at the cable begins anew.
    bench.says_by_mavlink("get inf");
    bench.types_by_mavlink("", false);
    bench.run(100);
    assert!(bench.says_by_mavlink("ill\r").contains("no command 'ill'"));
}

#[test]
fn a_key_is_taken_at_a_cable_though_mavlink_has_a_terminal_too() {
    let mut bench = Bench::opened();
    let key = "mavlink key off\r";
    let refused = "not set: a key is typed at a cable, never over MAVLink";
    assert!(bench.says_by_mavlink(key).contains(refused));
    assert_eq!(bench.board.restarts.get(), 0);
    let said = bench.says(key);
    assert!(!said.contains(refused), "{said}");
    bench.run(1000);
    assert_eq!(bench.board.restarts.get(), 1);
    // A line that was begun at the cable is not ended over MAVLink, nor the other way round.
    let mut bench = Bench::opened();
    bench.typed.put(b"mavlink key ");
    bench.run(50);
    assert!(bench.says_by_mavlink("off\r").contains("no command 'off'"));
    bench.says_by_mavlink("mavlink key ");
    bench.typed.put(b"off\r");
    assert!(bench.shown(300).contains("no command 'off'"));
    bench.run(1000);
    assert_eq!(bench.board.restarts.get(), 0);
}

#[test]
fn both_mavlink_lines_share_what_is_set() {
    let mut bench = Bench::opened();
    let set = |value: f32, name: &str| {
        frame(&PARAM_SET_DATA {
            param_value: value,
            target_system: 1,
            target_component: 1,
            param_id: name.into(),
            param_type: 9,
        })
    };
    bench.send(&set(8.0, "infill"));
    bench.hear(100);
    bench.radio.put(&set(0.2, "arm_d"));
    bench.hear(3000);
    let stored = bench.board.stored.get().expect("stored");
    assert_eq!((stored.infill, stored.arm_d), (8.0, 0.2));
}

#[test]
fn a_reset_in_the_midst_of_a_transfer_is_got_over() {
    let mut bench = Bench::opened();
    // The host asks and is gone; then another resets the bus.
    bench.bus.absent(true);
    bench
        .bus
        .setup(setup(FROM_DEVICE, GET_DESCRIPTOR, 0x0200, 0, 255), &[]);
    bench.run(100);
    bench.bus.absent(false);
    bench.bus.event(Event::Reset);
    bench.run(600);
    bench.enumerate();
    bench.open(true);
    assert!(bench.says("version\r").contains("SOPHIE"));
    // In the midst of a packet from and to it.
    bench.send(b"list\r");
    bench.run(2);
    bench.bus.event(Event::Reset);
    bench.run(20);
    bench.enumerate();
    bench.open(true);
    let said = bench.says("\x03\rversion\r");
    assert!(said.contains("on table"), "{said}");
}

#[test]
fn a_cable_that_is_pulled_while_the_device_sends_can_be_put_back() {
    // In a `watch`, with MAVLink's streams, and with a descriptor on its way.
    for sends in [&b"watch imu\r"[..], &heartbeat(), b""] {
        let mut bench = Bench::opened();
        for _ in 0..3 {
            bench.send(sends);
            bench.hear(1000);
            if sends.is_empty() {
                bench.bus.absent(true);
                let asks = setup(FROM_DEVICE, GET_DESCRIPTOR, 0x0200, 0, 255);
                bench.bus.setup(asks, &[]);
            }
            bench.run(600);
            let waiting = if sends.is_empty() { 0x80 } else { bench.bulk_in };
            assert!(bench.bus.has_packet(waiting), "{waiting:#x}");
            bench.bus.event(Event::Suspend);
            bench.run(5000);
            bench.bus.event(Event::Reset);
            bench.bus.absent(false);
            bench.run(20);
            bench.enumerate();
            bench.open(true);
            assert!(bench.says("version\r").contains("SOPHIE"), "{sends:?}");
        }
    }
}

#[test]
fn a_reset_that_is_noticed_with_the_hosts_first_request_counts() {
    let mut bench = Bench::opened();
    bench.send(b"list\r");
    bench.run(20);
    assert!(bench.bus.has_packet(bench.bulk_in));
    bench.bus.event(Event::Reset);
    let (status, _) = bench.control(setup(FROM_DEVICE, GET_DESCRIPTOR, 0x0100, 0, 64), &[]);
    assert_eq!(status, Some(Status::Accepted));
    let (status, _) = bench.control(setup(TO_DEVICE, 9, 1, 0, 0), &[]);
    assert_eq!(status, Some(Status::Accepted));
    bench.open(true);
    assert!(bench.says("version\r").contains("SOPHIE"));
}

#[test]
fn a_stage_that_never_comes_ends_in_time() {
    let mut bench = Bench::opened();
    // Line coding announced, and never sent.
    bench.bus.setup(setup(TO_CLASS, SET_LINE_CODING, 0, 0, 7), &[]);
    bench.run(600);
    let get = setup(FROM_CLASS, GET_LINE_CODING, 0, 0, 7);
    assert_eq!(bench.control(get, &[]).0, Some(Status::Accepted));
}

#[test]
fn endpoints_that_there_are_not_are_left_alone() {
    let mut bench = Bench::opened();
    // CLEAR_FEATURE and SET_FEATURE of a halt, and GET_STATUS, of every endpoint that a host can name.
    for index in (0..16).chain(0x80..0x90) {
        for request in [3, 1] {
            bench.control(setup(0x02, request, 0, index, 0), &[]);
        }
        let (status, bytes) = bench.control(setup(0x82, 0, 0, index, 2), &[]);
        assert_eq!(
            (status, bytes),
            (Some(Status::Accepted), vec![0, 0]),
            "{index:#x}"
        );
    }
    let halted = u16::from(bench.bulk_in);
    bench.control(setup(0x02, 3, 0, halted, 0), &[]);
    assert!(bench.bus.is_stalled(bench.bulk_in));
    assert_eq!(bench.control(setup(0x82, 0, 0, halted, 2), &[]).1, [1, 0]);
    bench.control(setup(0x02, 1, 0, halted, 0), &[]);
    assert!(!bench.bus.is_stalled(bench.bulk_in));
    assert!(bench.says("version\r").contains("SOPHIE"));
}

#[test]
fn a_suspended_bus_is_given_nothing_and_goes_on_where_it_resumes() {
    let mut bench = Bench::opened();
    bench.send(&heartbeat());
    assert!(bench.frames() > STREAMED);
    bench.bus.event(Event::Suspend);
    bench.run(20);
    bench.bus.fetch(bench.bulk_in);
    assert_eq!(bench.hear(3000), b"");
    assert_eq!(bench.rig.links.timing.task(TaskId::Mavlink).overruns, 0);
    bench.bus.event(Event::Resume);
    bench.send(&heartbeat());
    assert!(bench.frames() > STREAMED);
    // Noticed late: the host had long gone on.
    bench.bus.event(Event::Suspend);
    bench.run(5);
    let configuration = bench.descriptor(2, 0, 255);
    assert_eq!(configuration[1], 2);
    assert!(bench.says("version\r").contains("SOPHIE"));
}

#[test]
fn an_unplugged_port_costs_nothing() {
    let mut bench = Bench::new();
    bench.bus.event(Event::PowerDetected);
    bench.bus.event(Event::Suspend);
    bench.run(50);
    let polls = bench.bus.polls();
    bench.typed.put(b"watch imu\r");
    bench.run(10_000);
    assert_eq!(bench.bus.polls(), polls, "nothing wakes the device");
    let timing = bench.rig.links.timing.task(TaskId::Mavlink);
    assert_eq!(timing.overruns, 0);
    assert!((500..=505).contains(&timing.runs), "{}", timing.runs);
    assert!(bench.screen.0.take().len() > 1000);
    use sophie_ports::serial::SerialOutput;
    let port = Port::new();
    let (_, output) = port.mavlink();
    assert!(!output.listens());
}
