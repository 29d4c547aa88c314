//! Text and frames on one line, told apart byte by byte.

use mavlink_core::{MAVLinkV1MessageRaw, MavHeader, MessageData};
use sophie_dialect::{ATTITUDE_DATA, HEARTBEAT_DATA, PING_DATA};
use sophie_mavlink::wire::protocol_detector::{Protocol, ProtocolDetector, Route};

use crate::station::frame;

/// Time between two bytes, µs.
const BYTE: u64 = 10;

/// The detector's answers to `bytes`, each for itself.
fn sort(detector: &mut ProtocolDetector, now: &mut u64, bytes: &[u8]) -> Vec<Route> {
    bytes
        .iter()
        .map(|&byte| {
            *now += BYTE;
            assert!(!detector.expires(*now));
            detector.take(byte, *now)
        })
        .collect()
}

fn old<M: MessageData>(message: &M) -> Vec<u8> {
    let mut raw = MAVLinkV1MessageRaw::new();
    let header = MavHeader {
        system_id: 255,
        component_id: 190,
        sequence: 0,
    };
    raw.serialize_message_data(header, message);
    raw.raw_bytes().to_vec()
}

#[test]
fn text_stays_text_and_a_sound_frame_takes_the_line() {
    let (mut detector, mut now) = (ProtocolDetector::new(), 0);
    let text: Vec<u8> = (0..=0xFC).collect();
    assert!(
        sort(&mut detector, &mut now, &text)
            .iter()
            .all(|to| *to == Route::Console)
    );
    let ping = frame(&PING_DATA::DEFAULT);
    for part in ping.chunks(3) {
        assert!(
            sort(&mut detector, &mut now, part)
                .iter()
                .all(|to| *to == Route::Mavlink)
        );
    }
    assert_eq!(detector.protocol(), Protocol::Mavlink);
    // What is known of a frame is its length, whatever lies in it.
    let unknown = frame(&ATTITUDE_DATA::DEFAULT);
    sort(&mut detector, &mut now, &unknown);
    assert_eq!(sort(&mut detector, &mut now, b"ok\n")[2], Route::Reclaim);
    assert_eq!(detector.protocol(), Protocol::Text);
}

#[test]
fn of_version_1_a_heartbeat_alone_takes_the_line() {
    let (mut detector, mut now) = (ProtocolDetector::new(), 0);
    let mut wrong = old(&HEARTBEAT_DATA::DEFAULT);
    *wrong.last_mut().unwrap() ^= 1;
    for bytes in [wrong, old(&PING_DATA::DEFAULT)] {
        let to = sort(&mut detector, &mut now, &bytes);
        assert_eq!(detector.protocol(), Protocol::Text);
        assert!(to.contains(&Route::Unreadable));
    }
    let (mut detector, mut now) = (ProtocolDetector::new(), 0);
    let to = sort(&mut detector, &mut now, &old(&HEARTBEAT_DATA::DEFAULT));
    assert_eq!(
        (to, detector.protocol()),
        (vec![Route::Neither; 17], Protocol::Mavlink)
    );
}

#[test]
fn a_damaged_or_unfinished_frame_does_not_switch_the_line_to_mavlink() {
    let beat = frame(&HEARTBEAT_DATA::DEFAULT);
    for cut in 1..beat.len() {
        let (mut detector, mut now) = (ProtocolDetector::new(), 0);
        sort(&mut detector, &mut now, &beat[..cut]);
        now += 150_001;
        assert!(detector.expires(now), "{cut}");
        assert_eq!(sort(&mut detector, &mut now, b"help\r"), [Route::Console; 5]);
    }
    for bit in 8..8 * beat.len() {
        let mut garbled = beat.clone();
        garbled[bit / 8] ^= 1 << (bit % 8);
        let (mut detector, mut now) = (ProtocolDetector::new(), 0);
        sort(&mut detector, &mut now, &garbled);
        assert_eq!(detector.protocol(), Protocol::Text, "bit {bit}");
        // Behind it the next is found, once the wrong one is over.
        now += 200_000;
        detector.expires(now);
        sort(&mut detector, &mut now, &beat);
        assert_eq!(detector.protocol(), Protocol::Mavlink, "bit {bit}");
    }
}

#[test]
fn what_lies_in_frames_or_is_no_text_gives_nothing_back() {
    let (mut detector, mut now) = (ProtocolDetector::new(), 0);
    sort(&mut detector, &mut now, &frame(&HEARTBEAT_DATA::DEFAULT));
    for bytes in [
        &b"\r\n\r\n"[..],
        b"ab\x01c\r",
        b"\x80\n",
        &old(&HEARTBEAT_DATA::DEFAULT),
    ] {
        let to = sort(&mut detector, &mut now, bytes);
        assert!(to.iter().all(|to| *to == Route::Mavlink), "{bytes:x?}");
    }
    // Text in a frame.
    let text = frame(&PING_DATA {
        time_usec: u64::from_le_bytes(*b"\rabcde\r\n"),
        ..PING_DATA::DEFAULT
    });
    sort(&mut detector, &mut now, &text);
    assert_eq!(detector.protocol(), Protocol::Mavlink);
    // A frame that ends too early keeps no line that comes later.
    sort(&mut detector, &mut now, &text[..4]);
    now += 150_001;
    assert!(!detector.expires(now));
    assert_eq!(sort(&mut detector, &mut now, b"help\r")[4], Route::Reclaim);
}
