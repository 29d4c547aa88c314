//! The receiver task on a line with every radio error.

use super::links::links_with;
use embassy_time::Instant;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use sophie_control::params::Params;
use sophie_control::pilot::rc::{RAW_CENTRE, Sticks};
use sophie_drivers::crsf::Decoder;
use sophie_fakes::{Answer, BrokenLine, FakeLine};
use sophie_ports::receiver::RcState;
use sophie_sim::board::{Board, Port};
use sophie_sim::clock::VirtualTime;
use sophie_sim::devices::crsf::{channel_frame, rc_frame};
use sophie_sim::streams::Streams;
use sophie_tasks::links::Links;

struct Line {
    time: VirtualTime,
    links: &'static Links,
    line: FakeLine,
    us: u64,
}

impl Line {
    fn new() -> Self {
        let (time, links, line) = (
            VirtualTime::new(),
            links_with(Params::default()),
            FakeLine::default(),
        );
        time.spawn(sophie_tasks::pilot::rc::run(links, line.clone(), Decoder::new()));
        Self {
            time,
            links,
            line,
            us: 0,
        }
    }

    fn send(&mut self, bytes: &[u8], us: u64) {
        self.line.put(bytes);
        self.us += us;
        self.time.run_until(self.us);
    }

    fn state(&self) -> RcState {
        self.links.rc.latest().map(|m| m.value).unwrap_or_default()
    }
}

fn frame(throttle: f32) -> Vec<u8> {
    let sticks = Sticks {
        throttle,
        ..Sticks::default()
    };
    rc_frame(&sticks).to_vec()
}

#[test]
fn frames_split_anywhere_are_understood_and_stamped_when_they_are_whole() {
    for split in 1..26 {
        let mut line = Line::new();
        let bytes = frame(0.5);
        line.send(&bytes[..split], 3000);
        assert!(line.links.rc.latest().is_none(), "half a frame says nothing");
        line.send(&bytes[split..], 0);
        let message = line.links.rc.latest().unwrap();
        assert_eq!(message.at, Instant::from_micros(3000));
        assert_eq!((message.value.frames, message.value.errors), (1, 0));
        assert!((message.value.sticks.throttle - 0.5).abs() < 2e-3);
    }
}

#[test]
fn a_flipped_bit_anywhere_is_never_obeyed() {
    // Every bit after the address, which CRSF does not protect.
    for bit in 8..26 * 8 {
        let mut line = Line::new();
        line.send(&frame(0.0), 10_000);
        let mut broken = frame(0.9);
        broken[bit / 8] ^= 1 << (bit % 8);
        line.send(&broken, 10_000);
        assert!(line.state().sticks.throttle < 0.01, "bit {bit}");
        // A broken length may swallow what follows; three frames restore reception.
        for _ in 0..4 {
            line.send(&frame(0.9), 10_000);
        }
        let state = line.state();
        assert!((state.sticks.throttle - 0.9).abs() < 2e-3, "bit {bit}");
        assert!(state.errors > 0 && state.frames >= 2, "bit {bit}: {state:?}");
    }
}

#[test]
fn garbage_gives_no_frame_and_hides_none_for_long() {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let mut line = Line::new();
    for _ in 0..2000 {
        let noise: Vec<u8> = (0..32).map(|_| rng.random()).collect();
        line.send(&noise, 2000);
    }
    // 8 bits of CRC over 64,000 random bytes: a frame by chance also needs 26 bytes of the right type.
    assert!(line.links.rc.latest().is_none(), "{:?}", line.state());
    for _ in 0..5 {
        line.send(&frame(0.7), 10_000);
    }
    let state = line.state();
    assert!(state.errors > 100, "{state:?}");
    assert!((state.sticks.throttle - 0.7).abs() < 2e-3);
}

#[test]
fn channels_that_no_transmitter_sends_are_counted_and_keep_the_link_stale() {
    let mut line = Line::new();
    line.send(&frame(0.4), 10_000);
    let mut channels = [RAW_CENTRE; 16];
    channels[2] = 0;
    let dead = channel_frame(&channels);
    for _ in 0..60 {
        line.send(&dead, 10_000);
    }
    assert!(
        line.links.rc.fresh().is_none(),
        "a receiver's failsafe frames are no pilot"
    );
    line.send(&frame(0.4), 0);
    let state = line.links.rc.fresh().unwrap();
    assert_eq!((state.frames, state.errors), (2, 60));
}

#[test]
fn the_link_is_stale_half_a_second_after_the_last_good_frame() {
    let mut line = Line::new();
    line.send(&frame(0.4), 500_000);
    assert!(line.links.rc.fresh().is_some());
    let mut broken = frame(0.4);
    broken[25] ^= 0xFF;
    line.send(&broken, 1);
    assert!(line.links.rc.fresh().is_none());
    line.send(&frame(0.4), 0);
    assert!(line.links.rc.fresh().is_some());
}

#[test]
fn a_broken_line_is_counted_and_leaves_the_processor_alone() {
    for answer in [Answer::Fails, Answer::Refuses, Answer::Sound] {
        let (time, links) = (VirtualTime::new(), links_with(Params::default()));
        let line = BrokenLine::default();
        line.0.answer.set(answer);
        time.spawn(sophie_tasks::pilot::rc::run(links, line.clone(), Decoder::new()));
        time.run_until(1_000_000);
        assert!(!line.0.spun.get(), "{answer:?}");
        assert!(links.rc.latest().is_none());
    }
}

#[test]
fn the_simulated_line_loses_no_byte_that_fits() {
    let (time, links) = (VirtualTime::new(), links_with(Params::default()));
    let board: &'static Board = Box::leak(Box::new(Board::new(Streams::new(1))));
    time.spawn(sophie_tasks::pilot::rc::run(links, Port(board), Decoder::new()));
    for i in 1..=100 {
        board.receive(&frame(0.4));
        time.run_until(i * 10_000);
    }
    let state = links.rc.fresh().unwrap();
    assert_eq!((state.frames, state.errors), (100, 0));
}
