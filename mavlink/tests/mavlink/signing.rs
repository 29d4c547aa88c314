//! Signed frames: what is taken, what is refused, and what of it is said.

use mavlink_core::MessageData;
use proptest::prelude::*;
use sha2::{Digest, Sha256};
use sophie_control::mode::Mode;
use sophie_dialect::*;
use sophie_mavlink::wire::frame::Encoder;
use sophie_mavlink::wire::signing::{Refused, Signing};
use sophie_ports::signing::{Key, Record, Stored};

use crate::station::{PERIOD, Station, frame, vehicle};

/// In units of 10 µs.
const SECOND: u64 = 100_000;
const MINUTE: u64 = 60 * SECOND;
const HOUR: u64 = 60 * MINUTE;
/// In 2026.
const DATE: u64 = 0x215C_0000_0000;

/// The key of the frames that pymavlink has made: 0, 1, 2 and so on.
fn key() -> Key {
    Key::new(core::array::from_fn(|n| n as u8))
}

fn bytes(hex: &str) -> Vec<u8> {
    let digits: Vec<u8> = hex
        .bytes()
        .map(|c| (c as char).to_digit(16).unwrap() as u8)
        .collect();
    digits.chunks(2).map(|pair| pair[0] << 4 | pair[1]).collect()
}

/// By pymavlink 2.4.50, `MAVLink.signing` with that key: system 255, component 190, link 3, time [`DATE`].
fn heartbeat() -> Vec<u8> {
    bytes("fd09010000ffbe000000000000000608000003bbd303000000005c21546681ffa462")
}

/// The same one unit later: a request of AUTOPILOT_VERSION.
fn version() -> Vec<u8> {
    bytes(
        "fd20010000ffbe4c00000000144300000000000000000000000000000000000000000000000000020101b4b1\
         03010000005c216066d38e1e5d",
    )
}

/// A frame of `message` from link 0 of system 255, component 190, signed with `key` at `time`.
fn signed<M: MessageData>(key: &Key, time: u64, message: &M) -> Vec<u8> {
    signed_by(0, key, time, message)
}

fn signed_by<M: MessageData>(link: u8, key: &Key, time: u64, message: &M) -> Vec<u8> {
    let mut bytes = frame(message);
    let body = bytes.len() - 2;
    bytes[2] |= 1;
    let sum = mavlink_core::calculate_crc(&bytes[1..body], M::EXTRA_CRC);
    bytes[body..].copy_from_slice(&sum.to_le_bytes());
    bytes.push(link);
    bytes.extend(&time.to_le_bytes()[..6]);
    let hash = Sha256::new()
        .chain_update(key.bytes())
        .chain_update(&bytes)
        .finalize();
    bytes.extend(&hash[..6]);
    bytes
}

fn ping(seq: u32) -> PING_DATA {
    PING_DATA {
        seq,
        ..PING_DATA::DEFAULT
    }
}

fn set(value: f32) -> PARAM_SET_DATA {
    PARAM_SET_DATA {
        param_value: value,
        target_system: 1,
        target_component: 1,
        param_id: "infill".into(),
        param_type: 9,
    }
}

/// A vehicle that signs, whose stored bound is `bound`.
fn signing(bound: u64) -> Station {
    let mut station = Station::new();
    station.signing = Signing::new(Stored::Key(Record { key: key(), bound }));
    station
}

/// The pings that were answered since the last call.
fn answered(station: &mut Station) -> Vec<u32> {
    station.run(100);
    let answers = station.got::<PING_DATA>().iter().map(|ping| ping.seq).collect();
    station.sent.clear();
    answers
}

#[test]
fn what_pymavlink_has_signed_is_taken_once() {
    let mut station = signing(0);
    station.say(&heartbeat());
    station.say(&version());
    station.run(100);
    assert_eq!(station.got::<AUTOPILOT_VERSION_DATA>().len(), 1);
    assert_eq!(station.signing.refused(), Refused::default());
    station.sent.clear();
    for again in [version(), heartbeat()] {
        station.say(&again);
        station.run(100);
    }
    assert!(station.got::<AUTOPILOT_VERSION_DATA>().is_empty());
    assert_eq!(station.signing.refused().old, 2);
}

#[test]
fn what_is_sent_is_signed_as_pymavlink_does_it() {
    // pymavlink's PARAM_VALUE of "infill" from system 1, component 1, link 0, two units after DATE.
    let theirs = bytes(
        "fd1901000001011600000000004164000700696e66696c6c000000000000000000000952fa00020000005c2182f77d6eaf45",
    );
    let mut encoder = Encoder::new();
    encoder.leave_room(true);
    let length = encoder.encode(&PARAM_VALUE_DATA {
        param_value: 8.0,
        param_count: 100,
        param_index: 7,
        param_id: "infill".into(),
        param_type: 9,
    });
    let mut signing = Signing::new(Stored::Key(Record {
        key: key(),
        bound: DATE,
    }));
    signing.sign(encoder.frame_mut(), 0, 20);
    assert_eq!((encoder.frame(), length as usize), (&theirs[..], theirs.len()));
    // Times grow even within a unit.
    signing.sign(encoder.frame_mut(), 0, 20);
    assert_eq!(encoder.frame()[theirs.len() - 12], 3);
}

#[test]
fn every_frame_is_signed_within_the_budget() {
    let mut station = signing(DATE);
    station.vehicle = vehicle(Mode::Flight);
    station.run(10_000);
    // The harness has looked at lengths and flags.
    assert!(station.sent.len() > 200 && station.sent.iter().all(|sent| sent.signed));
    let rate = station.sent.iter().map(|sent| sent.bytes as u32).sum::<u32>() / 10;
    assert!(
        (1500..crate::station::PLENTY).contains(&rate),
        "{rate} bytes each second"
    );
    // On a line that carries half of it none goes beyond.
    let mut station = Station::with(1200);
    station.signing = Signing::new(Stored::Key(Record::fresh(key())));
    station.run(10_000);
    let sent = station.sent.iter().map(|sent| sent.bytes as u32).sum::<u32>();
    assert!((11_000..=12_000 + 400).contains(&sent), "{sent}");
}

#[test]
fn without_a_signature_nothing_is_obeyed_but_heartbeats() {
    let mut station = signing(0);
    station.run(1000);
    station.sent.clear();
    station.say(&frame(&set(8.0)));
    station.say(&frame(&ping(1)));
    for number in [209, 211, 241, 245, 246, 400, 511, 512] {
        station.say(&frame(&COMMAND_LONG_DATA {
            param1: 1.0,
            command: number,
            target_system: 1,
            target_component: 1,
            ..Default::default()
        }));
    }
    station.run(3000);
    assert!(station.got::<COMMAND_ACK_DATA>().is_empty() && station.got::<PING_DATA>().is_empty());
    assert!(station.got::<PARAM_VALUE_DATA>().is_empty() && station.orders.is_empty());
    assert_eq!(station.server.params().infill, 6.9);
    assert_eq!(station.signing.refused().unsigned, 10);
    // A heartbeat has what holds said again.
    station.sent.clear();
    station.say(&frame(&HEARTBEAT_DATA::DEFAULT));
    station.run(100);
    assert_eq!(station.signing.refused().unsigned, 10);
    assert_eq!(station.texts(), ["DISARMED"]);
    // Signed, the same is obeyed.
    station.say(&signed(&key(), DATE, &set(8.0)));
    station.run(100);
    assert_eq!(station.server.params().infill, 8.0);
}

#[test]
fn a_wrong_key_and_every_wrong_bit_are_refused() {
    let good = signed(&key(), DATE, &ping(7));
    let mut other = *key().bytes();
    other[31] ^= 1;
    let mut station = signing(0);
    station.say(&signed(&Key::new(other), DATE, &ping(7)));
    assert_eq!(answered(&mut station), [0; 0]);
    assert_eq!(station.signing.refused().wrong, 1);
    for bit in 0..8 * good.len() {
        let mut station = signing(0);
        let mut bad = good.clone();
        bad[bit / 8] ^= 1 << (bit % 8);
        station.say(&bad);
        assert_eq!(answered(&mut station), [0; 0], "bit {bit}");
        // Silence ends what a longer length has begun.
        station.run(200);
        station.say(&good);
        assert_eq!(answered(&mut station), [7], "bit {bit}");
    }
}

#[test]
fn a_truncated_frame_is_not_taken_and_costs_no_other() {
    let good = signed(&key(), DATE + 1, &ping(7));
    for length in 1..good.len() {
        let mut station = signing(0);
        station.say(&good[..length]);
        station.run(200);
        assert_eq!(answered(&mut station), [0; 0], "{length}");
        station.say(&good);
        assert_eq!(answered(&mut station), [7], "{length}");
    }
}

#[test]
fn each_sender_has_its_own_time_and_a_new_one_may_be_a_minute_behind() {
    let mut station = signing(0);
    station.say(&signed_by(1, &key(), DATE, &ping(1)));
    station.say(&signed_by(2, &key(), DATE + MINUTE, &ping(2)));
    // The first has been heard: it may be as late as it likes, as long as it grows.
    station.say(&signed_by(1, &key(), DATE + 1, &ping(3)));
    station.say(&signed_by(1, &key(), DATE + 1, &ping(4)));
    station.say(&signed_by(3, &key(), DATE - 1, &ping(5)));
    station.say(&signed_by(4, &key(), DATE + 10, &ping(6)));
    assert_eq!(answered(&mut station), [1, 2, 3, 6]);
    assert_eq!(
        station.signing.refused(),
        Refused {
            old: 2,
            ..Refused::default()
        }
    );
    // Time passes without further input.
    station.run(30_000);
    station.say(&signed_by(5, &key(), DATE + 29 * SECOND, &ping(7)));
    station.say(&signed_by(6, &key(), DATE + 31 * SECOND, &ping(8)));
    assert_eq!(answered(&mut station), [8]);
}

#[test]
fn a_sender_too_many_waits_until_one_has_been_silent_for_a_minute() {
    let mut station = signing(0);
    let old = signed_by(0, &key(), DATE, &ping(0));
    station.say(&old);
    for link in 1..=6 {
        station.say(&signed_by(
            link,
            &key(),
            DATE + u64::from(link),
            &ping(link.into()),
        ));
    }
    assert_eq!(answered(&mut station), [0, 1, 2, 3, 4, 5]);
    assert_eq!(station.signing.refused().old, 1);
    station.run(60_000);
    station.say(&signed_by(6, &key(), DATE + MINUTE, &ping(6)));
    assert_eq!(answered(&mut station), [6]);
    // The one whose place it took is not heard again with what it said.
    station.say(&old);
    assert_eq!(answered(&mut station), [0; 0]);
}

#[test]
fn nothing_from_before_a_restart_is_taken_after_it() {
    let mut station = signing(0);
    let mut said = Vec::new();
    let mut stored = Record::fresh(key());
    for minute in 0..90 {
        let frame = signed(&key(), DATE + minute * MINUTE, &ping(minute as u32));
        station.say(&frame);
        assert_eq!(answered(&mut station), [minute as u32]);
        said.push(frame);
        if let Some(record) = station.signing.to_store(station.now) {
            station.signing.keep(record);
            stored = record;
        }
        station.run(60_000 - 100);
        // The bound is ahead of all that was taken, half an hour at least.
        assert!(stored.bound >= DATE + minute * MINUTE + HOUR / 2, "{minute}");
    }
    let mut station = signing(stored.bound);
    for frame in &said {
        station.say(frame);
    }
    assert_eq!(answered(&mut station), [0; 0]);
    assert_eq!(station.signing.refused().old, 90);
    // Who follows the times that the vehicle sends is heard.
    station.say(&signed(&key(), stored.bound + 1, &ping(1)));
    assert_eq!(answered(&mut station), [1]);
}

#[test]
fn the_bound_is_written_rarely_and_again_where_writing_failed() {
    let mut signing = Signing::new(Stored::None);
    assert_eq!(signing.to_store(PERIOD), None);
    let mut station = self::signing(DATE);
    assert_eq!(station.signing.to_store(0), None, "nothing was taken yet");
    let mut writes = 0;
    for second in 1..7200 {
        station.now = second * 1_000_000;
        station.say(&signed(&key(), DATE + second * SECOND, &HEARTBEAT_DATA::DEFAULT));
        if let Some(record) = station.signing.to_store(station.now) {
            writes += 1;
            station.signing.keep(record);
        }
    }
    assert_eq!(writes, 4, "each half hour");
    assert_eq!(station.signing.refused(), Refused::default());
    // One that failed is tried again after 10 s.
    let mut station = self::signing(DATE);
    station.say(&signed(&key(), DATE + 1, &HEARTBEAT_DATA::DEFAULT));
    let tries = (0..1000).filter(|n| station.signing.to_store(n * PERIOD).is_some());
    assert_eq!(tries.count(), 2, "in 20 s");
}

#[test]
fn a_storage_that_cannot_be_read_may_have_had_a_key() {
    let mut station = Station::new();
    station.signing = Signing::new(Stored::Unreadable);
    station.say(&frame(&ping(1)));
    station.say(&signed(&key(), DATE, &ping(2)));
    station.say(&frame(&HEARTBEAT_DATA::DEFAULT));
    assert_eq!(answered(&mut station), [0; 0]);
    let refused = station.signing.refused();
    assert_eq!((refused.unsigned, refused.wrong), (1, 1));
    assert!(station.sent.iter().all(|sent| !sent.signed));
}

#[test]
fn a_key_that_was_lost_is_said_to_each_who_comes_and_nothing_is_obeyed_meanwhile() {
    for (stored, text) in [
        (Stored::Unreadable, "signing key not known: storage unreadable"),
        (Stored::Lost, "signing key lost: set it at the console, or off"),
    ] {
        let mut station = Station::new();
        station.signing = Signing::new(stored);
        let said = |station: &mut Station| {
            station.run(1000);
            let texts = station.texts();
            station.sent.clear();
            texts.iter().filter(|said| *said == text).count()
        };
        // At the start, and not again and again.
        assert_eq!(said(&mut station), 1);
        station.run(60_000);
        assert_eq!(said(&mut station), 0);
        // To who comes after silence.
        station.say(&frame(&HEARTBEAT_DATA::DEFAULT));
        assert_eq!(said(&mut station), 1);
        station.say(&frame(&ping(1)));
        station.say(&signed(&key(), DATE, &ping(2)));
        assert_eq!(answered(&mut station), [0; 0]);
    }
    for stored in [Stored::None, Stored::Key(Record::fresh(key()))] {
        assert_eq!(Signing::new(stored).notice(), "");
    }
}

#[test]
fn without_a_key_signed_frames_are_read_as_if_they_were_not() {
    let mut station = Station::new();
    station.say(&version());
    station.say(&signed(&Key::new([9; 32]), 5, &ping(3)));
    assert_eq!(answered(&mut station), [3]);
    assert!(!station.signing.signs());
}

#[test]
fn a_key_is_never_taken_from_the_line() {
    let setup = SETUP_SIGNING_DATA {
        initial_timestamp: 1,
        target_system: 1,
        target_component: 1,
        secret_key: [7; 32],
    };
    for mut station in [Station::new(), signing(0)] {
        let was = *station.signing.stored();
        station.say(&signed(&key(), DATE, &setup));
        station.run(500);
        assert_eq!(*station.signing.stored(), was);
        let texts = station.texts();
        assert!(
            texts.contains(&"signing key refused: console only".into()),
            "{texts:?}"
        );
        // Others' keys are none of its business.
        station.sent.clear();
        station.say(&signed(
            &key(),
            DATE + 1,
            &SETUP_SIGNING_DATA {
                target_system: 2,
                ..setup.clone()
            },
        ));
        station.run(500);
        assert!(station.texts().is_empty());
    }
}

#[test]
fn a_flood_of_wrong_signatures_is_counted_and_said_now_and_then() {
    let mut station = signing(0);
    station.say(&signed(&key(), DATE, &HEARTBEAT_DATA::DEFAULT));
    station.run(1000);
    station.sent.clear();
    // 200 frames a second, the shortest at 57,600 baud.
    for n in 0..6000u32 {
        station.say(&signed(&Key::new([1; 32]), DATE + 1 + u64::from(n), &ping(n)));
        if n % 4 == 0 {
            station.run(20);
        }
    }
    assert_eq!(station.signing.refused().wrong, 6000);
    assert!(station.got::<PING_DATA>().is_empty());
    let texts = station.texts();
    assert!((3..=4).contains(&texts.len()), "{texts:?}");
    assert!(
        texts.iter().all(|text| text.starts_with("refused: 0 unsigned, ")),
        "{texts:?}"
    );
    // Heartbeats and streams come as ever, and who has the key is heard.
    assert!((29..=31).contains(&station.got::<HEARTBEAT_DATA>().len()));
    station.say(&signed(&key(), DATE + 1, &ping(1)));
    assert_eq!(answered(&mut station), [1]);
}

#[test]
fn a_key_is_64_digits_and_is_not_shown() {
    let text: String = key().bytes().iter().map(|byte| format!("{byte:02x}")).collect();
    assert_eq!(Key::from_hex(&text), Some(key()));
    assert_eq!(Key::from_hex(&text.to_uppercase()), Some(key()));
    for bad in [
        "",
        "00",
        &text[1..],
        &format!("{text}0"),
        &format!("{text}00"),
        &text.replace('f', "g"),
    ] {
        assert_eq!(Key::from_hex(bad), None, "{bad}");
    }
    let shown = format!("{:?}", Signing::new(Stored::Key(Record::fresh(key()))));
    assert!(
        !shown.contains("1, 2, 3") && !shown.contains(&text[..8]),
        "{shown}"
    );
}

proptest! {
    #[test]
    fn no_time_and_no_order_takes_a_frame_twice(
        times in prop::collection::vec((0u8..9, prop_oneof![0..1u64 << 48, DATE..DATE + HOUR]), 1..60),
    ) {
        let mut station = signing(0);
        let frames: Vec<_> = (times.iter().zip(0..))
            .map(|(&(link, time), seq)| signed_by(link, &key(), time, &ping(seq)))
            .collect();
        let mut taken = Vec::new();
        for frame in frames.iter().chain(&frames) {
            station.say(frame);
            taken.extend(answered(&mut station));
        }
        let mut once = taken.clone();
        once.sort_unstable();
        once.dedup();
        prop_assert_eq!(once.len(), taken.len());
    }
}
