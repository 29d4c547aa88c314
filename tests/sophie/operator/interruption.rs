//! Ctrl-C at `sophie bringup` and `sophie params`: nothing is written half, nothing runs on at the board, and the next
//! run goes on.

use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant};

use sophie_control::params::{ParamInfo, Params};

use super::board::{Board, Hands, Outputs};
use super::bringup::Builder;
use super::{interrupt, run};
use sophie_test_support::command::{Temp, command, text};

/// Steps up to `id`, skipped.
fn skips_to(builder: &mut Builder, id: &str) {
    for step in sophie_bringup::STEPS {
        if step.id == id {
            return builder.step(id);
        }
        builder.at(&format!("({})", step.id), "s");
    }
}

/// Longest wait for what the board does, whatever the load of the machine.
const PATIENCE: Duration = Duration::from_secs(60);

fn until(board: &Board, what: impl Fn(&Outputs) -> bool) {
    let begun = Instant::now();
    while !what(&board.outputs()) {
        assert!(begun.elapsed() < PATIENCE, "{:?}", board.outputs());
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The motors stand, and the servos, which have no marks, get no pulse.
fn rests(board: &Board) {
    until(board, |pins| pins.motors == [0.0; 4] && pins.servos == [0.0; 4]);
}

#[test]
fn a_bring_up_is_left_in_order_wherever_it_is() {
    let temp = Temp::new("interrupt-bringup");
    for (id, at, said) in [
        ("live-imu", "Enter once they have followed", ""),
        ("level", "Enter for the level table", ""),
        ("arm-2", "Enter when it is so", ""),
        ("servo-3", "+ or - moves it", "+9"),
    ] {
        let board = Board::new(Hands::default());
        let file = temp.0.join("bringup.toml");
        let _ = fs::remove_file(&file);
        let mut builder = Builder::begins(&temp, &board, &[]);
        skips_to(&mut builder, id);
        builder.hears(at);
        if !said.is_empty() {
            builder.types(said);
            builder.hears(at);
            until(&board, |pins| pins.servos[2] > 551.0);
        }
        builder.interrupts();
        let (status, text, complaint) = builder.ends();
        assert_eq!((status, &*complaint), (Some(1), ""), "{id}: {text}");
        assert!(
            text.contains("\nStopped. skipped: chip") && text.contains(&format!("not done: {id}")),
            "{id}: {text}"
        );
        rests(&board);
        let protocol = fs::read_to_string(&file).unwrap();
        assert!(!protocol.contains(&format!("id = \"{id}\"")), "{protocol}");
        assert_eq!(fs::read_dir(&temp.0).unwrap().count(), 1, "{id}");
        assert!(board.stored() == Params::DEFAULT);
        // The next one continues it.
        let mut builder = Builder::begins(&temp, &board, &[]);
        // The line is wrapped at a terminal's width.
        builder.hears("not done:");
        builder.hears(id);
        builder.at("(chip)", "q");
        assert_eq!(builder.ends().0, Some(1));
    }
}

#[test]
fn a_running_measurement_ends_and_sets_nothing() {
    let temp = Temp::new("interrupt-measurement");
    let board = Board::new(Hands::default());
    // A level that is not the stored one.
    board.hands(|hands| {
        hands.force.x += 0.2;
        hands.real_time = true;
    });
    let mut builder = Builder::begins(&temp, &board, &[]);
    skips_to(&mut builder, "level");
    builder.at("Enter for the level table", "");
    builder.at("Enter when it is so", "");
    // It measures for 2.5 s.
    board.pass(1.0);
    builder.interrupts();
    let (status, text, complaint) = builder.ends();
    assert_eq!((status, &*complaint), (Some(1), ""), "{text}");
    assert!(text.contains("not done: level"), "{text}");
    board.hands(|hands| hands.real_time = false);
    board.pass(5.0);
    assert!(board.stored() == Params::DEFAULT);
}

#[test]
fn a_skipped_step_leaves_no_motor_turning() {
    let temp = Temp::new("interrupt-skip");
    let board = &Board::new(Hands::default());
    let mut builder = Builder::begins(&temp, board, &[]);
    skips_to(&mut builder, "esc");
    builder.at("Type off", "off");
    board.hands(|hands| hands.real_time = true);
    builder.hears("Did it turn");
    until(board, |pins| pins.motors[0] > 0.0);
    let from = board.seconds();
    builder.types("s");
    until(board, |pins| pins.motors == [0.0; 4]);
    // Left to itself it turns for 2 s.
    let took = board.seconds() - from;
    assert!(took < 1.0, "{took} s");
    // Skipped, not stopped: the next step is there.
    builder.at("(rotors)", "q");
    assert_eq!(builder.ends().0, Some(1));
}

#[test]
fn a_motor_stops_at_once() {
    let temp = Temp::new("interrupt-motor");
    let board = &Board::new(Hands::default());
    let mut builder = Builder::begins(&temp, board, &[]);
    skips_to(&mut builder, "rotors");
    // The question for the second output: the motor before has turned, and stands.
    builder.at("Type off", "off");
    builder.at("Which rotor turned", "1");
    board.hands(|hands| hands.real_time = true);
    builder.at("From above", "a");
    until(board, |pins| pins.motors[1] > 0.0);
    let from = board.seconds();
    builder.interrupts();
    until(board, |pins| pins.motors == [0.0; 4]);
    let took = board.seconds() - from;
    // Left to itself it turns for 2 s.
    assert!(took < 1.0, "{took} s");
    assert_eq!(builder.ends().0, Some(1));
    rests(board);
}

#[test]
fn an_interrupted_load_puts_the_old_values_back() {
    let (temp, board) = (Temp::new("interrupt-load"), Board::new(Hands::default()));
    let dumped = run(&temp, &["params", "dump", "p.toml", "--port", &board.name()]);
    assert_eq!(dumped.status, Some(0), "{dumped:?}");
    // Every number a little otherwise: many lines to be set.
    let other = |row: &ParamInfo| row.default * 0.99;
    let rows = Params::TABLE
        .iter()
        .filter(|row| row.choices.is_empty() && row.default != 0.0 && row.allows(other(row)));
    let lines: String = rows
        .map(|row| format!("{} = {}\n", row.name, other(row)))
        .collect();
    temp.file("p.toml", format!("[params]\n{lines}").as_bytes());
    let name = board.name();
    board.hands(|hands| hands.real_time = true);
    let child = command(&temp.0, &["params", "load", "p.toml", "--port", &name])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    board.hears_a_change();
    interrupt(&child);
    let output = child.wait_with_output().unwrap();
    let complaint = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{complaint}");
    assert_eq!(
        complaint,
        format!("sophie: {name}: stopped by Ctrl-C; nothing is saved\n")
    );
    board.hands(|hands| hands.real_time = false);
    rests(&board);
    // The board stores what it has a second later: the values from before.
    board.pass(3.0);
    assert!(board.stored() == Params::DEFAULT);
    let loaded = run(&temp, &["params", "load", "p.toml", "--port", &name]);
    assert!(
        loaded.status == Some(0) && loaded.said.contains("saved; the board has restarted"),
        "{loaded:?}"
    );
}
