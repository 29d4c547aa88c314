//! What arrives: whole, cut, garbled, not for here, and too much.

use proptest::prelude::*;
use sophie_dialect::*;
use sophie_mavlink::wire::parser::Parser;
use sophie_mavlink::wire::requests::{Request, request};

use crate::station::{Station, frame, frame_from};

fn sync(ts1: i64) -> TIMESYNC_DATA {
    TIMESYNC_DATA {
        tc1: 0,
        ts1,
        target_system: 0,
        target_component: 0,
    }
}

/// The time stamps of the requests in `bytes`.
fn taken(parser: &mut Parser, bytes: &[u8], now: u64) -> Vec<i64> {
    let mut all = Vec::new();
    for &byte in bytes {
        if let Some(Request::Timesync(m)) = parser.push(byte, now).and_then(|frame| request(&frame)) {
            all.push(m.ts1);
        }
    }
    all
}

#[test]
fn a_frame_is_taken_however_it_is_cut_and_none_twice() {
    let bytes: Vec<u8> = (1..=20).flat_map(|ts1| frame(&sync(ts1))).collect();
    for chunk in [1, 2, 7, 64, 500] {
        let mut parser = Parser::new();
        let all: Vec<i64> = (bytes.chunks(chunk))
            .flat_map(|chunk| taken(&mut parser, chunk, 0))
            .collect();
        assert!(all.iter().copied().eq(1..=20), "{chunk}: {all:?}");
    }
}

#[test]
fn every_wrong_bit_is_noticed_and_the_next_frame_is_taken() {
    let good = frame(&sync(0x0102_0304_0506_0708));
    for bit in 0..8 * good.len() {
        let mut bytes = good.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let mut parser = Parser::new();
        // The flag of a signature makes it wait for one, and a longer length for more: silence ends that.
        let mut all = taken(&mut parser, &bytes, 0);
        all.extend(taken(&mut parser, &good, 1_000_000));
        assert_eq!(all, [0x0102_0304_0506_0708], "bit {bit}");
    }
}

#[test]
fn a_frame_that_lost_bytes_costs_no_other() {
    let good = frame(&sync(7));
    for lost in 1..good.len() {
        let mut parser = Parser::new();
        let cut = [&good[..good.len() - lost], &good, &good, &good].concat();
        let all = taken(&mut parser, &cut, 0);
        assert!(all.len() >= 2, "{lost} bytes lost: {all:?}");
    }
}

#[test]
fn a_signed_frame_is_read_while_signing_is_off() {
    let mut signed = frame(&sync(9));
    let body = signed.len() - 2;
    signed[2] = 1;
    let sum = mavlink_core::calculate_crc(
        &signed[1..body],
        <TIMESYNC_DATA as mavlink_core::MessageData>::EXTRA_CRC,
    );
    signed[body..].copy_from_slice(&sum.to_le_bytes());
    signed.extend([0; 13]);
    let mut parser = Parser::new();
    assert_eq!(taken(&mut parser, &signed, 0), [9]);
    assert_eq!(taken(&mut parser, &frame(&sync(10)), 0), [10]);
}

#[test]
fn what_lies_in_an_unknown_message_is_not_for_here() {
    // A tunnel's payload that is a frame of its own.
    let inside = frame(&sync(5));
    let mut outside = vec![0xFD, inside.len() as u8, 0, 0, 0, 255, 190, 0x81, 0x01, 0x00];
    outside.extend(&inside);
    outside.extend([0, 0]);
    let mut parser = Parser::new();
    assert_eq!(taken(&mut parser, &outside, 0), [0; 0]);
    assert_eq!(taken(&mut parser, &inside, 0), [5]);
}

#[test]
fn what_is_for_another_vehicle_or_is_the_own_echo_is_left_alone() {
    let mut station = Station::new();
    let command = MavCmd::MAV_CMD_REQUEST_MESSAGE as u16;
    for (system, component) in [(2, 1), (1, 2), (255, 190), (2, 0)] {
        let results = station.command_to(system, component, command, [148.0, 0.0]);
        assert!(results.is_empty(), "{system} {component}");
    }
    for (system, component) in [(1, 1), (1, 0), (0, 0), (0, 1)] {
        let results = station.command_to(system, component, command, [148.0, 0.0]);
        assert_eq!(results, [0], "{system} {component}");
    }
    station.sent.clear();
    let mut echo = frame_from(1, &sync(1));
    echo[6] = 1;
    let body = echo.len() - 2;
    let sum = mavlink_core::calculate_crc(
        &echo[1..body],
        <TIMESYNC_DATA as mavlink_core::MessageData>::EXTRA_CRC,
    );
    echo[body..].copy_from_slice(&sum.to_le_bytes());
    station.say(&echo);
    station.run(100);
    assert!(station.got::<TIMESYNC_DATA>().is_empty());
}

proptest! {
    #[test]
    fn garbage_harms_nothing_and_ends_with_silence(
        mut garbage in prop::collection::vec(prop_oneof![Just(0xFDu8), any::<u8>()], 0..2000),
        cut in 0usize..64,
    ) {
        garbage.extend(&frame(&sync(3))[..cut.min(20)]);
        let mut station = Station::new();
        station.say(&garbage);
        station.run(200);
        station.sent.clear();
        station.say(&frame(&sync(42)));
        station.run(100);
        let answers: Vec<i64> = station.got::<TIMESYNC_DATA>().iter().map(|m| m.ts1).collect();
        prop_assert_eq!(answers, [42]);
    }

    #[test]
    fn sound_frames_of_any_content_harm_nothing(
        ids in prop::collection::vec(prop::sample::select(vec![0u32, 4, 20, 21, 23, 75, 76, 111]), 1..40),
        payload in prop::collection::vec(any::<u8>(), 0..255),
    ) {
        let mut station = Station::new();
        for id in ids {
            let mut bytes = vec![0xFD, payload.len() as u8, 0, 0, 0, 255, 190];
            bytes.extend(&id.to_le_bytes()[..3]);
            bytes.extend(&payload);
            let extra = sophie_mavlink::wire::requests::crc_extra(id).unwrap();
            let sum = mavlink_core::calculate_crc(&bytes[1..], extra);
            bytes.extend(sum.to_le_bytes());
            station.say(&bytes);
            station.run(20);
        }
    }
}
