//! `sophie bringup`'s step `lag`: the board steps its own output, and a phone hears the simulator's rotor.

use sophie_control::pilot::rc::Sticks;
use sophie_control::pilot::static_thrust_test::{Rotors, StaticThrustTest};
use sophie_sim::scenario::{Overrides, Scenario};
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::phone;
use sophie_test_support::command::Temp;

use super::board::{Board, Hands};
use super::bringup::Builder;

#[test]
fn the_lag_is_stored_from_a_recording_of_the_boards_own_steps() {
    let scenario = Scenario::parse("[vehicle]\nmotor_tau_s = 0.08\n", "slow", &Overrides::default()).unwrap();
    let test = StaticThrustTest::train(Rotors::One(0), 0.3, 0.6);
    let hands = Hands {
        unhurried: true,
        sticks: Some(Sticks::default()),
        ..Hands::default()
    };
    let (temp, board) = (Temp::new("bringup-lag"), Board::new(hands));
    let phone = phone::beside(&scenario, &test, 1.2, 15.2, Streams::new(6));
    std::fs::write(temp.0.join("steps.wav"), phone.wav()).unwrap();
    let mut builder = Builder::begins(&temp, &board, &[]);
    for step in sophie_bringup::STEPS.iter().take_while(|step| step.id != "lag") {
        builder.at(&format!("({})", step.id), "s");
    }
    builder.step("lag");
    builder.at("Type tied", "tied");
    builder.at("Does the phone record?", "");
    // The rise to the first drive, a second there, and into each step.
    board.pass(0.6 + 0.5);
    for i in 0..11 {
        let drive = if i % 2 == 0 { 0.3 } else { 0.6 };
        let motors = board.outputs().motors;
        assert!(
            (motors[0] - drive).abs() < 1e-3 && motors[1..] == [0.0; 3],
            "{i}: {motors:?}"
        );
        if i < 10 {
            board.pass(1.0);
        }
    }
    builder.at("Its file", "no.wav");
    builder.hears("no.wav: cannot be read");
    builder.at("Its file", "steps.wav");
    builder.hears("gains speed in 0.0");
    builder.hears("motor_tau 0.1 -> ");
    builder.hears("passed");
    builder.at("(", "q");
    let (_, said, _) = builder.ends();
    let tau = board.stored().motor_tau;
    assert!((tau - 0.08).abs() < 0.01, "{tau}\n{said}");
}
