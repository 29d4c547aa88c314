//! Frames, finding them in a stream, and what is published.

extern crate std;

use std::vec::Vec;

use proptest::prelude::*;
use sophie_control::pilot::rc::StickMode;

use super::*;

fn stream(parser: &mut Parser, mut bytes: &[u8]) -> (Vec<Frame>, usize) {
    let (mut frames, mut errors) = (Vec::new(), 0);
    while let Some(result) = parser.next_frame(&mut bytes) {
        match result {
            Ok(frame) => frames.push(frame),
            Err(_) => errors += 1,
        }
    }
    (frames, errors)
}

/// A parser after silence.
fn fresh() -> Parser {
    let mut parser = Parser::new();
    parser.silence();
    parser
}

fn pilot() -> Frame {
    let sticks = Sticks {
        roll: 0.5,
        throttle: 0.3,
        arm_switch: true,
        stick_mode: StickMode::Rate,
        ..Default::default()
    };
    Frame {
        channels: sticks.to_channels(),
        ..Default::default()
    }
}

#[test]
fn a_known_frame() {
    // All channels at 992.
    let mut bytes = [0; FRAME];
    bytes[0] = 0x0F;
    let centre = [0xE0, 0x03, 0x1F, 0xF8, 0xC0, 0x07, 0x3E, 0xF0, 0x81, 0x0F, 0x7C];
    bytes[1..12].copy_from_slice(&centre);
    bytes[12..23].copy_from_slice(&centre);
    let frame = Frame::decode(&bytes).unwrap();
    assert_eq!(frame.channels, [992; 16]);
    assert_eq!(frame.encode(), bytes);
    bytes[24] = 0x24;
    assert!(Frame::decode(&bytes).is_some());
    bytes[24] = 0x05;
    assert!(Frame::decode(&bytes).is_none());
    (bytes[24], bytes[23]) = (0x00, 0x10);
    assert!(Frame::decode(&bytes).is_none());
}

#[test]
fn sticks_mean_what_they_mean_over_crsf() {
    let sticks = pilot().sticks().unwrap();
    assert!((sticks.roll - 0.5).abs() < 2e-3 && (sticks.throttle - 0.3).abs() < 2e-3 && sticks.arm_switch);
    assert_eq!(
        Frame {
            failsafe: true,
            ..pilot()
        }
        .sticks(),
        Err(SbusError::Failsafe)
    );
    assert_eq!(
        Frame {
            frame_lost: true,
            ..pilot()
        }
        .sticks(),
        Err(SbusError::FrameLost)
    );
    let mut silly = pilot();
    silly.channels[2] = 0;
    assert!(matches!(silly.sticks(), Err(SbusError::Channel(e)) if e.channel == 3));
}

#[test]
fn a_frame_after_garbage_is_not_decoded_before_the_stream_is_understood() {
    let good = pilot().encode();
    let mut bytes = Vec::from([0x55; 11]);
    for _ in 0..3 {
        bytes.extend(good);
    }
    let (frames, errors) = stream(&mut fresh(), &bytes);
    assert_eq!((frames.len(), errors), (2, 1));
    let mut parser = fresh();
    assert!(stream(&mut parser, &[0x55; 11]).0.is_empty());
    parser.silence();
    assert_eq!(stream(&mut parser, &good).0, [pilot()]);
}

#[test]
fn a_lost_byte_costs_its_frame_and_the_next() {
    let good = pilot().encode();
    for lost in 0..FRAME {
        let mut bytes = Vec::from(good);
        let mut broken = Vec::from(good);
        broken.remove(lost);
        bytes.extend(broken);
        for _ in 0..4 {
            bytes.extend(good);
        }
        let (frames, errors) = stream(&mut fresh(), &bytes);
        assert!(
            frames.len() >= 3 && frames.iter().all(|f| *f == pilot()),
            "{lost}: {}",
            frames.len()
        );
        assert!(errors >= 1, "{lost}");
    }
}

fn published(decoder: &mut Decoder, bytes: &[u8], us: u64) -> Option<u32> {
    decoder
        .take(bytes, Instant::from_micros(us))
        .map(|state| (state.sticks.throttle * 100.0 + 0.5) as u32)
}

/// A decoder after three frames, 7 ms apart, the last at 21 ms.
fn believing() -> Decoder {
    let mut d = Decoder::new();
    assert_eq!(published(&mut d, &[0x00], 0), None);
    assert_eq!(published(&mut d, &pilot().encode(), 7_000), None);
    assert_eq!(published(&mut d, &pilot().encode(), 14_000), None);
    assert_eq!(published(&mut d, &pilot().encode(), 21_000), Some(30));
    d
}

#[test]
fn the_third_frame_in_a_row_is_decoded() {
    let mut d = believing();
    assert_eq!((d.state.frames, d.state.errors), (3, 0));
    let frame = pilot().encode();
    assert_eq!(published(&mut d, &frame[..11], 27_000), None);
    assert_eq!(published(&mut d, &frame[11..], 28_680), Some(30));
    assert_eq!(published(&mut d, &[frame, frame].concat(), 42_000), Some(30));
    // After garbage: three more.
    assert_eq!(published(&mut d, &[0x55; 25], 49_000), None);
    assert_eq!(published(&mut d, &frame, 56_000), None);
    assert_eq!(published(&mut d, &frame, 63_000), None);
    assert_eq!(published(&mut d, &frame, 70_000), Some(30));
}

#[test]
fn only_a_pause_beyond_the_bytes_own_time_is_silence() {
    // Half a frame, then bytes over 3 ms without idle time.
    let frame = pilot().encode();
    let mut d = believing();
    assert_eq!(published(&mut d, &frame[..12], 28_000), None);
    assert_eq!(published(&mut d, &frame, 31_500), None, "still the same stream");
    // After 4 ms of idle time the half is dropped.
    let mut d = believing();
    assert_eq!(published(&mut d, &frame[..12], 28_000), None);
    assert_eq!(published(&mut d, &frame, 35_000), None);
    assert_eq!((d.state.frames, d.state.errors), (4, 1));
    assert_eq!(published(&mut d, &frame, 42_000), None);
    assert_eq!(published(&mut d, &frame, 49_000), Some(30));
}

#[test]
fn a_receiver_without_its_transmitter_publishes_nothing_and_is_heard_again_at_once() {
    for flags in [(true, false), (false, true), (true, true)] {
        let mut d = believing();
        let lost = Frame {
            failsafe: flags.0,
            frame_lost: flags.1,
            ..pilot()
        };
        for i in 4..200 {
            assert_eq!(published(&mut d, &lost.encode(), 7_000 * i), None);
        }
        // A report applies to earlier frames of its read.
        let read = [pilot().encode(), lost.encode()].concat();
        assert_eq!(published(&mut d, &read, 1_400_000), None);
        assert_eq!(published(&mut d, &pilot().encode(), 1_407_000), Some(30));
        assert_eq!((d.state.frames, d.state.errors), (202, 0));
    }
}

/// 300 frames, `period` µs apart, each with another throttle; byte times in µs.
fn frames_of_many_sticks(period: u64) -> Vec<(u64, u8)> {
    let frame = |i: u64| {
        let throttle = (i % 64) as f32 / 64.0;
        let sticks = Sticks {
            throttle,
            roll: -throttle,
            ..Default::default()
        };
        Frame {
            channels: sticks.to_channels(),
            ..Default::default()
        }
        .encode()
    };
    (1..=300)
        .flat_map(|i| {
            (1..)
                .zip(frame(i))
                .map(move |(k, byte)| (i * period + 120 * k, byte))
        })
        .collect()
}

/// Reads with sticks of `reads`, each of which ends with its last byte; roll and throttle must be of one frame.
fn read_with_sticks<'a>(reads: impl Iterator<Item = &'a [(u64, u8)]>) -> usize {
    let mut d = Decoder::new();
    let mut with_sticks = 0;
    for read in reads {
        let bytes: Vec<u8> = read.iter().map(|(_, byte)| *byte).collect();
        let at = read.last().map_or(0, |(us, _)| *us);
        if let Some(state) = d.take(&bytes, Instant::from_micros(at)) {
            let Sticks { roll, throttle, .. } = state.sticks;
            assert!((roll + throttle).abs() < 2e-3, "{roll} {throttle}");
            with_sticks += 1;
        }
    }
    with_sticks
}

#[test]
fn reads_that_end_where_the_line_idles_lose_no_frame() {
    for period in [6_300, 7_000, 9_000, 14_000, 15_000] {
        let line = frames_of_many_sticks(period);
        // The first has no silence before it, the next two are not trusted yet.
        let idle = read_with_sticks(line.chunks(FRAME));
        assert_eq!(idle, 297, "{period} us");
        // In pieces of a DMA ring's half, of the task's buffer, of a byte.
        for size in [1, 8, 16] {
            let pieces = line.chunks(FRAME).flat_map(|frame| frame.chunks(size));
            assert_eq!(read_with_sticks(pieces), 297, "{period} us, {size} bytes a read");
        }
        // Late: three frames and their pauses in one read.
        let late = line.chunks(3 * FRAME);
        assert_eq!(read_with_sticks(late), 99, "{period} us");
    }
}

#[test]
fn a_pause_within_a_read_never_makes_a_frame_of_two_halves() {
    for period in [5_900, 6_300, 7_000, 14_000] {
        let line = frames_of_many_sticks(period);
        for size in 1..130 {
            let seen = read_with_sticks(line.chunks(size));
            assert!(size > 1 || seen == 297, "{size}: {seen}");
        }
    }
}

/// S.BUS2: a frame of `group`, then the slots of `sensors`, each of 8, with `data`; byte times in µs from `begin`.
fn with_slots(group: u8, sensors: u8, data: [u8; 2], begin: u64) -> Vec<(u64, u8)> {
    let mut frame = pilot().encode();
    frame[24] = 0x04 | group << 4;
    let byte = |from: u64, i: usize| begin + from + 120 * (i as u64 + 1);
    let mut line: Vec<_> = frame.iter().enumerate().map(|(i, b)| (byte(0, i), *b)).collect();
    for slot in (0..8u8).filter(|slot| sensors & 1 << slot != 0) {
        // Eight slots of 660 us from 2 ms after the frame.
        let from = 3000 + 2000 + 660 * u64::from(slot);
        // The slot's number, lowest bit first, in the upper five bits.
        let id = 0x03 | ((group << 3 | slot).reverse_bits() & 0xF8);
        let bytes = [id, data[0], data[1]];
        line.extend(bytes.iter().enumerate().map(|(i, b)| (byte(from, i), *b)));
    }
    line
}

#[test]
fn sensors_in_every_slot_cost_no_frame() {
    let values = [
        [0xC0, 0x2E],
        [0x0F, 0x0F],
        [0x00, 0x0F],
        [HEADER, 0x04],
        [0xFF, 0xFF],
    ];
    for data in values {
        for sensors in [0xFF, 0x01, 0x80, 0x18, 0xAA] {
            for size in [1, FRAME + 24] {
                let mut d = Decoder::new();
                assert_eq!(published(&mut d, &[0x00], 0), None);
                let mut seen = 0;
                for i in 0..80u64 {
                    let line = with_slots(i as u8 % 4, sensors, data, 15_000 * i + 10_000);
                    // Reads end where the line idles, a byte each or at a pause of two bytes.
                    let mut read = Vec::new();
                    for (at, (us, byte)) in line.iter().enumerate() {
                        read.push(*byte);
                        let idle = line.get(at + 1).is_none_or(|(next, _)| next - us > 240);
                        if idle || read.len() >= size {
                            seen += u32::from(published(&mut d, &read, *us).is_some());
                            read.clear();
                        }
                    }
                }
                assert_eq!(
                    (seen, d.state.frames, d.state.errors),
                    (78, 80, 0),
                    "{data:02x?} {sensors:08b}, {size} bytes a read"
                );
            }
        }
    }
}

#[test]
fn slots_read_late_cost_three_frames_at_most() {
    // Two frames with their slots in one read: a header among the slots makes the second uncertain.
    for (data, sensors, frames) in [
        ([0xC0, 0x2E], 0xFF, 16),
        ([0xC0, 0x2E], 0x01, 15),
        ([HEADER, HEADER], 0xFF, 14),
        ([HEADER, 0x00], 0x81, 14),
    ] {
        let mut d = believing();
        let bytes = |i: u8| -> Vec<u8> { with_slots(i, sensors, data, 0).iter().map(|(_, b)| *b).collect() };
        assert_eq!(published(&mut d, &bytes(0), 36_000), Some(30));
        let late = [bytes(1), bytes(2)].concat();
        assert_eq!(published(&mut d, &late, 66_000), Some(30));
        let read = (0..10u8)
            .filter(|i| {
                let at = 81_000 + 15_000 * u64::from(*i);
                published(&mut d, &bytes(i % 4), at) == Some(30)
            })
            .count();
        assert!(
            read >= 8 && d.state.frames >= frames,
            "{data:02x?}, {sensors:08b}: {read}, {:?}",
            d.state
        );
    }
}

#[test]
fn only_the_bytes_of_eight_slots_are_forgiven_and_only_after_a_frame_that_announces_them() {
    let mut announces = pilot().encode();
    announces[24] = 0x14;
    for (frame, junk, trusted) in [
        (announces, 24, true),
        (announces, 25, false),
        (pilot().encode(), 1, false),
    ] {
        for spread in [false, true] {
            let mut d = believing();
            assert_eq!(published(&mut d, &frame, 28_000), Some(30));
            let junk = std::vec![0x55; junk];
            // At once after the frame, or apart in silences.
            if spread {
                for (i, byte) in (1..).zip(&junk) {
                    assert_eq!(published(&mut d, &[*byte], 28_000 + 5_000 * i), None);
                }
            } else {
                assert_eq!(published(&mut d, &junk, 33_000), None);
            }
            assert_eq!(
                published(&mut d, &pilot().encode(), 200_000).is_some(),
                trusted,
                "{spread}"
            );
            assert_eq!(d.state.errors == 0, trusted);
        }
    }
    // A frame that lacks a byte is not taken for slots.
    let mut d = believing();
    assert_eq!(published(&mut d, &announces, 28_000), Some(30));
    assert_eq!(published(&mut d, &announces[..24], 43_000), None);
    assert_eq!(published(&mut d, &announces, 58_000), None);
    assert_eq!(d.state.errors, 1);
}

#[test]
fn a_line_error_costs_the_frame_in_progress_and_trust() {
    let mut d = believing();
    let frame = pilot().encode();
    assert_eq!(published(&mut d, &frame[..12], 27_000), None);
    d.broken(Instant::from_micros(27_500));
    assert_eq!(published(&mut d, &frame[13..], 29_000), None);
    assert_eq!(published(&mut d, &frame, 35_000), None);
    assert_eq!(published(&mut d, &frame, 42_000), None);
    assert_eq!(published(&mut d, &frame, 49_000), Some(30));
    assert_eq!((d.state.frames, d.state.errors), (6, 2));
}

#[test]
fn counts_of_a_lost_radio_are_garbage_and_those_beyond_full_stick_are_full_stick() {
    let mut d = believing();
    let mut full = pilot();
    full.channels[2] = 2047;
    assert_eq!(published(&mut d, &full.encode(), 28_000), Some(100));
    let mut d = believing();
    let mut silly = pilot();
    silly.channels[2] = 0;
    for i in 4..20 {
        assert_eq!(published(&mut d, &silly.encode(), 7_000 * i), None);
    }
    assert_eq!(d.state.errors, 16);
}

proptest! {
    #[test]
    fn encoding_and_decoding_are_inverse(
        channels in proptest::array::uniform16(0u16..2048), flags in 0u8..16,
    ) {
        let frame = Frame {
            channels,
            channel_17: flags & 1 != 0,
            channel_18: flags & 2 != 0,
            frame_lost: flags & 4 != 0,
            failsafe: flags & 8 != 0,
        };
        prop_assert_eq!(Frame::decode(&frame.encode()), Some(frame));
    }

    #[test]
    fn frames_are_found_however_the_stream_is_cut(cut in 1usize..60, count in 1usize..20) {
        let bytes: Vec<u8> = (0..count).flat_map(|_| pilot().encode()).collect();
        let mut parser = fresh();
        let found: usize = bytes.chunks(cut).map(|chunk| stream(&mut parser, chunk).0.len()).sum();
        prop_assert_eq!(found, count);
    }

    #[test]
    fn any_garbage_is_survived(garbage in proptest::collection::vec(any::<u8>(), 0..200)) {
        let mut bytes = garbage;
        for _ in 0..6 {
            bytes.extend(pilot().encode());
        }
        let (frames, _) = stream(&mut fresh(), &bytes);
        // A false header may swallow one frame and misalign another.
        prop_assert!(frames.iter().rev().take(3).all(|f| *f == pilot()) && frames.len() >= 3);
        let mut parser = Parser::new();
        stream(&mut parser, &bytes);
        parser.silence();
        prop_assert_eq!(stream(&mut parser, &pilot().encode()).0, [pilot()]);
    }

    #[test]
    fn no_bytes_but_sbus_give_sticks(
        reads in proptest::collection::vec(
            (proptest::collection::vec(any::<u8>(), 1..60), 0u64..20_000),
            1..60,
        ),
    ) {
        let mut decoder = Decoder::new();
        let mut us = 0;
        for (bytes, pause) in reads {
            us += 120 * bytes.len() as u64 + pause;
            prop_assert_eq!(decoder.take(&bytes, Instant::from_micros(us)), None);
        }
    }

    #[test]
    fn bytes_that_are_almost_sbus_give_no_sticks(
        reads in proptest::collection::vec((proptest::array::uniform23(any::<u8>()), 0u8..4), 1..60),
    ) {
        // One error: header, flags or end in turn.
        let mut decoder = Decoder::new();
        for (i, (inner, wrong)) in (1..).zip(reads) {
            let mut bytes = [0; FRAME];
            bytes[0] = if wrong == 0 { 0x0E } else { HEADER };
            bytes[1..24].copy_from_slice(&inner);
            bytes[23] = if wrong == 1 { inner[22] | 0x10 } else { 0x00 };
            bytes[24] = if wrong == 2 { 0x01 } else { 0x00 };
            if wrong == 3 {
                // Whole, but without transmitter.
                bytes[23] = 0x08;
            }
            prop_assert_eq!(decoder.take(&bytes, Instant::from_micros(7_000 * i)), None);
        }
    }
}
