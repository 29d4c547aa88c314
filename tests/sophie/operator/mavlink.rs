//! The console over MAVLink: frames that are lost, and a key.

use std::fs;

use sophie_control::params::Params;
use sophie_sim::live::Key;

use super::board::{Board, Hands};
use super::bringup::KEY;
use super::{Done, run};
use sophie_test_support::command::Temp;

fn params(temp: &Temp, board: &Board, verb: &str, more: &[&str]) -> Done {
    let (name, patience) = (board.name(), ["--patience", "2"]);
    let args = [&["params", verb, "p.toml", "--port", &name], &patience[..], more];
    run(temp, &args.concat())
}

#[test]
fn parameters_come_whole_over_a_line_that_loses_frames() {
    let temp = Temp::new("mavlink-params");
    let board = Board::on_mavlink(Hands::default(), None);
    let dumped = params(&temp, &board, "dump", &[]);
    assert_eq!((dumped.status, &*dumped.complaint), (Some(0), ""), "{dumped:?}");
    let whole = fs::read_to_string(temp.0.join("p.toml")).unwrap();
    assert_eq!(whole.matches(" = ").count(), Params::TABLE.len());
    board.hands(|hands| hands.drops = Some(13));
    let dumped = params(&temp, &board, "dump", &[]);
    assert_eq!(dumped.status, Some(0), "{dumped:?}");
    assert_eq!(fs::read_to_string(temp.0.join("p.toml")).unwrap(), whole);
    board.hands(|hands| hands.drops = None);
    temp.file("p.toml", whole.replace("infill = 6.9 ", "infill = 8 ").as_bytes());
    let different = params(&temp, &board, "diff", &[]);
    assert_eq!(
        (different.status, &*different.said),
        (Some(1), "infill 6.9 -> 8 %\n"),
        "{different:?}"
    );
    let loaded = params(&temp, &board, "load", &[]);
    assert!(
        loaded.status == Some(0) && loaded.said.contains("saved; the board has restarted"),
        "{loaded:?}"
    );
    assert!((board.stored().infill - 8.0).abs() < 1e-6);
}

#[test]
fn with_a_key_nothing_unsigned_reaches_the_console() {
    let temp = Temp::new("mavlink-key");
    let board = Board::on_mavlink(Hands::default(), Key::from_hex(KEY));
    params(&temp, &board, "dump", &[])
        .complains(2, "nothing came; expected its prompt '> ' over MAVLink, unsigned");
    let other = temp.file("other", KEY.replace("00", "11").as_bytes());
    params(&temp, &board, "dump", &["--mavlink-key", &other]).complains(
        2,
        "expected its prompt '> ' over MAVLink, signed by the board's key",
    );
    let key = temp.file("key", KEY.as_bytes());
    // One session after the other: the times of the signatures continue.
    for _ in 0..2 {
        let dumped = params(&temp, &board, "dump", &["--mavlink-key", &key]);
        assert_eq!((dumped.status, &*dumped.complaint), (Some(0), ""), "{dumped:?}");
    }
    let plain = Board::new(Hands::default());
    params(&temp, &plain, "dump", &["--mavlink-key", &key]).complains(2, "a key is for MAVLink");
}
