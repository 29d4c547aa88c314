//! The console over MAVLink: what is typed, what is said, and who has it.

use mavlink_core::MessageData;
use sophie_dialect::{HEARTBEAT_DATA, SERIAL_CONTROL_DATA};
use sophie_mavlink::services::shell::{CHUNK, HANG_UP, TYPED};

use crate::station::{PLENTY, Station, frame, frame_from};

/// SERIAL_CONTROL_DEV_SHELL, and flags: an answer, wanting one.
const SHELL: u8 = 10;
const REPLY: u8 = 1;
const RESPOND: u8 = 2;

fn typing(text: &[u8]) -> SERIAL_CONTROL_DATA {
    let mut data = [0; CHUNK];
    data[..text.len()].copy_from_slice(text);
    SERIAL_CONTROL_DATA {
        device: SHELL,
        flags: RESPOND,
        count: text.len() as u8,
        data,
        ..Default::default()
    }
}

fn typed(station: &mut Station) -> Vec<u8> {
    station.server.shell().typed().to_vec()
}

fn said(station: &Station) -> String {
    let said = station.got::<SERIAL_CONTROL_DATA>();
    let bytes = said.iter().flat_map(|m| m.data[..usize::from(m.count)].to_vec());
    String::from_utf8(bytes.collect()).unwrap()
}

#[test]
fn what_is_typed_is_answered_to_who_typed_it() {
    let mut station = Station::new();
    // Without a station.
    station.server.shell().say(b"> ");
    station.run(100);
    assert!(station.got::<SERIAL_CONTROL_DATA>().is_empty());
    station.say(&frame(&typing(b"status\r")));
    assert_eq!(typed(&mut station), b"status\r");
    for text in ["DISARMED\r\n", "> "] {
        assert!(station.server.shell().takes());
        station.server.shell().say(text.as_bytes());
        assert!(!station.server.shell().takes());
        station.run(100);
    }
    assert_eq!(said(&station), "DISARMED\r\n> ");
    let answers = station.got::<SERIAL_CONTROL_DATA>();
    for answer in &answers {
        assert_eq!((answer.device, answer.flags), (SHELL, REPLY));
        assert_eq!((answer.target_system, answer.target_component), (255, 190));
    }
}

#[test]
fn other_devices_answers_and_vehicles_are_left_alone() {
    let mut station = Station::new();
    for other in [
        SERIAL_CONTROL_DATA {
            device: 0,
            ..typing(b"save\r")
        },
        SERIAL_CONTROL_DATA {
            flags: REPLY,
            ..typing(b"save\r")
        },
        SERIAL_CONTROL_DATA {
            target_system: 2,
            ..typing(b"save\r")
        },
    ] {
        station.say(&frame(&other));
    }
    assert_eq!(typed(&mut station), b"");
    // A count beyond the message is the message.
    station.say(&frame(&SERIAL_CONTROL_DATA {
        count: 255,
        ..typing(&[b'x'; CHUNK])
    }));
    assert_eq!(typed(&mut station), [b'x'; CHUNK]);
}

#[test]
fn a_console_ends_with_its_station() {
    let mut station = Station::new();
    station.say(&frame(&typing(b"watch\r")));
    // As long as it is there.
    for _ in 0..90 {
        station.run(1000);
        station.say(&frame(&HEARTBEAT_DATA::default()));
        station.say(&frame_from(7, &HEARTBEAT_DATA::default()));
    }
    assert_eq!(typed(&mut station), b"watch\r");
    for _ in 0..90 {
        station.run(1000);
        // Another's does not count.
        station.say(&frame_from(7, &HEARTBEAT_DATA::default()));
    }
    assert_eq!(typed(&mut station), [HANG_UP]);
    // By its own word, as pymavlink's shells end; no answer is on its way any more.
    station.say(&frame(&typing(b"watch\r")));
    station.server.shell().say(b"roll pitch\r\n");
    station.say(&frame(&SERIAL_CONTROL_DATA {
        flags: 0,
        ..typing(b"")
    }));
    station.sent.clear();
    station.run(1000);
    assert_eq!(typed(&mut station), b"watch\r\x03");
    assert!(station.got::<SERIAL_CONTROL_DATA>().is_empty());
}

#[test]
fn who_types_takes_it_from_another_whose_command_ends_whatever_was_typed() {
    let mut station = Station::new();
    // More than there is room for, and no end is lost in it.
    for _ in 0..4 {
        station.say(&frame(&typing(&[b'x'; CHUNK])));
    }
    station.say(&frame_from(7, &typing(b"help\r")));
    let all = typed(&mut station);
    assert!(all.len() <= TYPED && all.ends_with(&[HANG_UP]), "{all:?}");
    station.say(&frame_from(7, &typing(b"help\r")));
    assert_eq!(typed(&mut station), b"help\r");
    station.server.shell().say(b"help");
    station.run(100);
    assert_eq!(station.got::<SERIAL_CONTROL_DATA>()[0].target_system, 7);
}

#[test]
fn console_and_streams_share_what_the_line_carries() {
    let mut station = Station::with(1500);
    station.say(&frame(&typing(b"list\r")));
    for _ in 0..500 {
        station.server.shell().say(&[b'x'; CHUNK]);
        station.run(20);
    }
    let bytes = |id: Option<u32>| -> usize {
        let of = station
            .sent
            .iter()
            .filter(|sent| id.is_none_or(|id| sent.id == id));
        of.map(|sent| sent.bytes).sum()
    };
    let (console, all) = (bytes(Some(SERIAL_CONTROL_DATA::ID)), bytes(None));
    assert!(all <= 15_000 + PLENTY as usize, "{all} bytes in 10 s");
    assert!(console > all / 4 && console < all * 3 / 4, "{console} of {all}");
    let beats = station.got::<HEARTBEAT_DATA>().len();
    assert!(beats >= 9, "{beats} heartbeats in 10 s");
}
