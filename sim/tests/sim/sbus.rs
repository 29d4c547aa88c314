//! SBUS: receiver task, loss of radio by the receiver's flags, a line with the wrong protocol.

use super::links::links_with;
use super::vehicle::Vehicle;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use sophie_control::mode::{Mode, Reason};
use sophie_control::params::{Params, RcProtocol};
use sophie_control::pilot::rc::Sticks;
use sophie_drivers::rc_decoder::Decoder;
use sophie_drivers::sbus::Frame;
use sophie_fakes::FakeLine;
use sophie_sim::devices::crsf::rc_frame;
use sophie_sim::flight::fly;
use sophie_sim::record::Silent;
use sophie_sim::scenario::{Overrides, Scenario};

/// ms.
const FRAME_MS: u64 = 7;

fn sbus() -> Params {
    Params {
        rc_protocol: RcProtocol::Sbus,
        ..Params::default()
    }
}

fn frame(sticks: &Sticks) -> Frame {
    Frame {
        channels: sticks.to_channels(),
        ..Frame::default()
    }
}

fn on_line(params: Params) -> (Vehicle, FakeLine) {
    let mut v = Vehicle::with(params);
    v.sticks = None;
    let line = FakeLine::default();
    let decoder = Decoder::from_params(&v.links.params);
    v.time
        .spawn(sophie_tasks::pilot::rc::run(v.links, line.clone(), decoder));
    (v, line)
}

fn send(v: &mut Vehicle, line: &FakeLine, bytes: &[u8], ms: u64) {
    for _ in 0..ms / FRAME_MS {
        line.put(bytes);
        v.run(FRAME_MS);
    }
}

/// Armed over SBUS at hover throttle; with the frame that holds it.
fn flying() -> (Vehicle, FakeLine, Frame) {
    let (mut v, line) = on_line(sbus());
    let low = Sticks::default();
    send(&mut v, &line, &frame(&low).encode(), 4000);
    let on = Sticks {
        arm_switch: true,
        ..low
    };
    send(&mut v, &line, &frame(&Sticks { yaw: 1.0, ..on }).encode(), 1200);
    assert_eq!(v.mode(), Mode::Armed, "{:?}", v.reason());
    let hover = frame(&Sticks { throttle: 0.5, ..on });
    send(&mut v, &line, &hover.encode(), 1000);
    assert_eq!((v.mode(), v.reason()), (Mode::Flight, None));
    (v, line, hover)
}

#[test]
fn sbus_flies_as_crsf_does() {
    let (mut v, line, hover) = flying();
    let state = v.links.rc.fresh().unwrap();
    assert!(state.sticks.arm_switch && (state.sticks.throttle - 0.5).abs() < 2e-3);
    assert_eq!(state.errors, 0);
    send(&mut v, &line, &hover.encode(), 5000);
    assert_eq!((v.mode(), v.reason()), (Mode::Flight, None));
    send(&mut v, &line, &frame(&Sticks::default()).encode(), 300);
    assert!(v.motors_stand() && v.mode() == Mode::Disarmed);
}

#[test]
fn the_receivers_failsafe_flag_starts_the_failsafe_although_frames_continue() {
    for (failsafe, frame_lost) in [(true, false), (false, true), (true, true)] {
        let (mut v, line, hover) = flying();
        let lost = Frame {
            failsafe,
            frame_lost,
            ..hover
        };
        send(&mut v, &line, &lost.encode(), 490);
        assert_eq!(v.mode(), Mode::Flight, "a gap of half a second is flown over");
        send(&mut v, &line, &lost.encode(), 50);
        assert_eq!((v.mode(), v.reason()), (Mode::Failsafe, Some(Reason::RADIO_LOST)));
        send(&mut v, &line, &hover.encode(), 300);
        assert!(v.links.rc.fresh().is_some() && v.reason() != Some(Reason::RADIO_LOST));
    }
}

#[test]
fn a_line_that_turns_to_crsf_is_a_lost_radio() {
    let (mut v, line, _) = flying();
    let crsf = rc_frame(&Sticks {
        throttle: 0.9,
        roll: 1.0,
        ..Sticks::default()
    });
    send(&mut v, &line, &crsf, 600);
    assert_eq!((v.mode(), v.reason()), (Mode::Failsafe, Some(Reason::RADIO_LOST)));
    assert!(v.links.rc.latest().unwrap().value.sticks.throttle < 0.51);
}

fn any_sticks(rng: &mut Pcg64Mcg) -> Sticks {
    Sticks {
        roll: rng.random_range(-1.0..1.0),
        pitch: rng.random_range(-1.0..1.0),
        yaw: rng.random_range(-1.0..1.0),
        throttle: rng.random_range(0.0..1.0),
        arm_switch: rng.random(),
        perch_switch: rng.random(),
        ..Sticks::default()
    }
}

#[test]
fn the_wrong_protocol_gives_no_sticks_and_no_arming() {
    let mut rng = Pcg64Mcg::seed_from_u64(11);
    for crsf_expected in [true, false] {
        let params = if crsf_expected { Params::default() } else { sbus() };
        let (mut v, line) = on_line(params);
        for _ in 0..20_000 {
            let sticks = any_sticks(&mut rng);
            if crsf_expected {
                line.put(&frame(&sticks).encode());
            } else {
                line.put(&rc_frame(&sticks));
            }
            v.run(FRAME_MS);
            assert!(v.links.rc.latest().is_none(), "{sticks:?}");
        }
        assert_eq!((v.mode(), v.motors_stand()), (Mode::Disarmed, true));
    }
}

#[test]
fn noise_gives_no_sticks_and_the_pilot_is_heard_behind_it() {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let (mut v, line) = on_line(sbus());
    for _ in 0..100_000 {
        let mut noise: Vec<u8> = (0..25).map(|_| rng.random()).collect();
        noise[0] = 0x0F;
        line.put(&noise);
        v.run(rng.random_range(1..9));
        assert!(v.links.rc.latest().is_none());
    }
    let sticks = Sticks {
        throttle: 0.7,
        ..Sticks::default()
    };
    send(&mut v, &line, &frame(&sticks).encode(), 5 * FRAME_MS);
    let state = v.links.rc.fresh().unwrap();
    assert!(
        (state.sticks.throttle - 0.7).abs() < 2e-3 && state.errors > 10_000,
        "{state:?}"
    );
}

#[test]
fn telemetry_keeps_off_a_line_that_has_no_way_back() {
    use embassy_time::Instant;
    use sophie_sim::board::{Board, Port};
    use sophie_sim::clock::VirtualTime;
    use sophie_sim::streams::Streams;
    use sophie_tasks::links::messages::Status;

    for (params, silent) in [(Params::default(), false), (sbus(), true)] {
        let (time, links) = (VirtualTime::new(), links_with(params));
        let board: &'static Board = Box::leak(Box::new(Board::new(Streams::new(1))));
        time.spawn(sophie_tasks::pilot::telemetry::run(links, Port(board)));
        for ms in 1..=500 {
            links.status.send(Instant::now(), Status::default());
            time.run_until(ms * 1000);
        }
        assert_eq!(board.take_telemetry(&mut [0; 64]) == 0, silent);
    }
}

#[test]
fn a_transmitter_switched_off_in_hover_ends_on_the_ground() {
    for seed in 1..=3 {
        let text = format!(
            "seed = {seed}\nsteps = [{{ do = 'arm' }}, {{ do = 'take-off', height_m = 3 }}, \
             {{ do = 'hover', seconds = 3 }}, {{ do = 'radio-off', seconds = 30 }}, {{ do = 'disarm' }}]\n\
             [params]\nreceiver_protocol = 1"
        );
        let scenario = Scenario::parse(&text, "sbus-lost", &Overrides::default()).unwrap();
        let record = fly(&scenario, &mut Silent);
        println!("seed {seed}: {}", record.outcome.reason);
        assert!(record.outcome.accomplished && record.overruns == 0);
        let off = record
            .phases
            .iter()
            .find(|p| p.name == "radio-off")
            .unwrap()
            .start;
        let failsafe = record.samples.iter().find(|s| s.mode == Mode::Failsafe).unwrap();
        // The last good frame is up to 14 ms old.
        let after = failsafe.t - off;
        assert!((0.48..0.53).contains(&after), "{after} s");
        let last = record.samples.last().unwrap();
        assert!(last.mode == Mode::Disarmed && last.position[2] > -0.05);
    }
}
