//! A link that falls silent stops the motors.

use embassy_time::Instant;
use sophie_control::chain::MixOutput;
use sophie_control::params::Params;
use sophie_sim::board::{Board, Port};
use sophie_sim::clock::VirtualTime;
use sophie_sim::streams::Streams;
use sophie_tasks::links::Links;

fn rig() -> (VirtualTime, &'static Links, &'static Board) {
    let time = VirtualTime::new();
    let links: &'static Links = Box::leak(Box::new(Links::new(Params::default())));
    let board: &'static Board = Box::leak(Box::new(Board::new(Streams::new(1))));
    time.spawn(sophie_tasks::flight::motors::run(links, Port(board)));
    (time, links, board)
}

fn spin(links: &Links, at_us: u64, command: f32) {
    let mix = MixOutput {
        running: true,
        commands: [command; 4],
        ..MixOutput::default()
    };
    links.mix.send(Instant::from_micros(at_us), mix);
}

#[test]
fn motors_stop_within_ten_milliseconds_of_the_last_mix() {
    let (time, links, board) = rig();
    for ms in 1..=50 {
        time.run_until(ms * 1000);
        spin(links, ms * 1000, 0.5);
    }
    time.run_until(51_000);
    assert!(board.actuators().motors.iter().all(|m| *m > 0.0));
    time.run_until(59_900);
    assert!(board.actuators().motors.iter().all(|m| *m > 0.0));
    time.run_until(60_100);
    assert_eq!(board.actuators().motors, [0.0; 4]);
}

#[test]
fn a_mix_from_an_old_sample_or_without_a_number_spins_nothing() {
    let (time, links, board) = rig();
    time.run_until(100_000);
    spin(links, 80_000, 0.5);
    time.run_until(100_100);
    assert_eq!(board.actuators().motors, [0.0; 4]);
    spin(links, 100_100, f32::NAN);
    time.run_until(100_200);
    assert_eq!(board.actuators().motors, [0.0; 4]);
}
