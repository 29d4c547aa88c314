//! `sophie params`: a board's parameters as a file, against one, and from one.

use std::fs;
use std::time::{Duration, Instant};

use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_control::pilot::rc::Sticks;
use sophie_dialect::{MavParamType, PARAM_SET_DATA};
use sophie_mavlink::wire::frame::{COMPONENT, Encoder, SYSTEM};
use sophie_sim::live::Key;

use super::board::{Board, Hands};
use super::bringup::KEY;
use super::{Done, run};
use sophie_test_support::command::{Temp, refused};

/// `params VERB FILE` at the board.
fn params(temp: &Temp, board: &Board, verb: &str, file: &str) -> Done {
    run(temp, &["params", verb, file, "--port", &board.name()])
}

#[test]
fn a_boards_parameters_are_dumped_compared_and_set() {
    let (temp, board) = (Temp::new("params-whole"), Board::new(Hands::default()));
    let dumped = params(&temp, &board, "dump", "p.toml");
    assert_eq!((dumped.status, &*dumped.complaint), (Some(0), ""), "{dumped:?}");
    let text = fs::read_to_string(temp.0.join("p.toml")).unwrap();
    assert!(
        text.starts_with(concat!(
            "# Parameters of SOPHIE ",
            env!("CARGO_PKG_VERSION"),
            " on table"
        )),
        "{text}"
    );
    assert_eq!(text.matches(" = ").count(), Params::TABLE.len());
    // As stdout has it.
    let piped = params(&temp, &board, "dump", "-");
    assert_eq!(piped.said, text);
    let same = params(&temp, &board, "diff", "p.toml");
    assert_eq!((same.status, &*same.said, &*same.complaint), (Some(0), "", ""));

    let changed = text
        .replace("infill = 6.9 ", "infill = 8 ")
        .replace("motor_protocol = \"dshot300\"", "motor_protocol = \"pwm\"")
        .replace("setpoint_lpf_hz = 1.5915494", "setpoint_cutoff = 20");
    temp.file("p.toml", changed.as_bytes());
    let wanted =
        "motor_protocol 300 -> 400 pwm\ninfill 6.9 -> 8 %\nsetpoint_lpf_hz 1.5915494 -> 3.183099 Hz\n";
    let different = params(&temp, &board, "diff", "p.toml");
    assert_eq!(
        (different.status, &*different.said),
        (Some(1), wanted),
        "{different:?}"
    );
    let loaded = params(&temp, &board, "load", "p.toml");
    let count = Params::TABLE.len();
    let said = format!("{wanted}saved; the board has restarted\nall {count} are in force\n");
    assert_eq!((loaded.status, &*loaded.said), (Some(0), &*said), "{loaded:?}");
    let stored = board.stored();
    assert_eq!((stored.infill, stored.get("motor_protocol")), (8.0, Some(400.0)));
    let again = params(&temp, &board, "load", "p.toml");
    assert_eq!(
        again.said,
        format!("nothing to change: all {count} are in force\n"),
        "{again:?}"
    );
    assert_eq!(params(&temp, &board, "diff", "p.toml").status, Some(0));
}

#[test]
fn a_bad_file_is_refused_before_the_board_is_asked() {
    let temp = Temp::new("params-bad");
    for (text, why) in [
        ("[params]\ninfil = 8\n", "nearest allowed params.infill"),
        (
            "[params]\ninfill = 12\n",
            "p.toml:2: params.infill = 12: allowed 4 to 10 %",
        ),
        (
            "[params]\ninfill = 8\nrate_pitch_p = \"high\"\n",
            "p.toml:3: params.rate_pitch_p",
        ),
        ("[vehicle]\ninfill = 8\n", "unknown key: nearest allowed params"),
        ("", "[params] is missing"),
    ] {
        temp.file("p.toml", text.as_bytes());
        // No port is there: the file comes first.
        for verb in ["diff", "load"] {
            let line = refused(&temp, &["params", verb, "p.toml", "--port", "tcp:127.0.0.1:1"]);
            assert!(line.contains(why), "{line}");
        }
    }
    let line = refused(
        &temp,
        &["params", "load", "none.toml", "--port", "tcp:127.0.0.1:1"],
    );
    assert!(line.contains("none.toml"), "{line}");
    for (port, patience) in [("COM1", "0"), ("COM1", "nan"), ("tcp:nowhere", "5")] {
        let args = ["params", "dump", "-", "--port", port, "--patience", patience];
        let line = refused(&temp, &args);
        assert!(line.contains("allowed "), "{line}");
    }
}

#[test]
fn a_port_without_a_board_is_told_in_one_line() {
    let temp = Temp::new("params-port");
    for port in ["/dev/no-such-port", "tcp:127.0.0.1:1"] {
        let done = run(&temp, &["params", "dump", "p.toml", "--port", port]);
        done.complains(2, &format!("sophie: {port}: cannot be opened: "));
    }
    let board = Board::new(Hands {
        mute: true,
        ..Hands::default()
    });
    let begun = Instant::now();
    let done = patiently(&temp, &board, "dump", "p.toml");
    let line = format!(
        "sophie: {}: no vehicle answers within 1 s, nothing came; expected MAVLink",
        board.name()
    );
    done.complains(2, &line);
    assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
    assert!(!temp.0.join("p.toml").exists(), "a file was begun");
}

/// `params VERB FILE` at a board that may fall silent.
fn patiently(temp: &Temp, board: &Board, verb: &str, file: &str) -> Done {
    let args = ["params", verb, file, "--port", &board.name(), "--patience", "1"];
    run(temp, &args)
}

#[test]
fn a_board_that_falls_silent_leaves_no_file_and_is_told() {
    let temp = Temp::new("params-silent");
    let board = Board::new(Hands {
        dies_at: Some(("rate_yaw_p", Params::DEFAULT.rate_yaw_p)),
        ..Hands::default()
    });
    patiently(&temp, &board, "dump", "p.toml").complains(
        1,
        "the vehicle fell silent for 1 s after a parameter was asked for",
    );
    assert_eq!(fs::read_dir(&temp.0).unwrap().count(), 0);
    // A comparison has no answer then: its status 1 is kept for a difference.
    board.hands(|hands| hands.mute = false);
    temp.file("p.toml", b"[params]\ninfill = 8\nrate_pitch_p = 11\n");
    patiently(&temp, &board, "diff", "p.toml").complains(2, "fell silent");
    // In the midst of a load: that a part may be stored is said. Here the old value has come to the board.
    board.hands(|hands| (hands.mute, hands.dies_at) = (false, Some(("infill", 8.0))));
    patiently(&temp, &board, "load", "p.toml").complains(
        1,
        "fell silent for 1 s after a parameter was set; the board may store what was set until then: load again",
    );
    board.pass(3.0);
    assert!(board.stored() == Params::DEFAULT);
    board.hands(|hands| (hands.mute, hands.dies_at) = (false, None));
    let done = patiently(&temp, &board, "load", "p.toml");
    assert_eq!(
        done.said,
        "infill 6.9 -> 8 %\nrate_pitch_p 10 -> 11 1/s\nsaved; the board has restarted\nall 2 are in force\n",
        "{done:?}"
    );
    assert_eq!(done.status, Some(0));
    assert_eq!((board.stored().infill, board.stored().rate_pitch_p), (8.0, 11.0));
}

/// A frame of another station that sets `name`.
fn sets(name: &str, param_value: f32) -> Vec<u8> {
    let mut param_id = [0; 16];
    param_id[..name.len()].copy_from_slice(name.as_bytes());
    let mut encoder = Encoder::of(255, 190);
    encoder.encode(&PARAM_SET_DATA {
        param_value,
        target_system: SYSTEM,
        target_component: COMPONENT,
        param_id: param_id.into(),
        param_type: MavParamType::MAV_PARAM_TYPE_REAL32 as u8,
    });
    encoder.frame().to_vec()
}

#[test]
fn the_line_may_be_in_any_state_and_lose_bytes_and_frames() {
    let (temp, board) = (Temp::new("params-line"), Board::new(Hands::default()));
    let dumped = params(&temp, &board, "dump", "whole.toml");
    assert_eq!((dumped.status, &*dumped.complaint), (Some(0), ""), "{dumped:?}");
    temp.file("p.toml", b"[params]\ninfill = 8\nrate_pitch_p = 11\n");
    // Half a frame, or a command of the console, is not obeyed.
    let frame = sets("infill", 9.0);
    for left in [&frame[..20], &frame[..frame.len() - 1], b"set infill 9\rsave\r"] {
        board.send_and_leave(left);
        let done = params(&temp, &board, "diff", "p.toml");
        assert_eq!(
            done.said, "infill 6.9 -> 8 %\nrate_pitch_p 10 -> 11 1/s\n",
            "{done:?}"
        );
    }
    board.hands(|hands| (hands.loses, hands.drops) = (Some(307), Some(13)));
    let dumped = params(&temp, &board, "dump", "p2.toml");
    assert_eq!(dumped.status, Some(0), "{dumped:?}");
    let read = |name| fs::read_to_string(temp.0.join(name)).unwrap();
    assert_eq!(read("p2.toml"), read("whole.toml"));
    let done = params(&temp, &board, "load", "p.toml");
    assert!(
        done.status == Some(0) && done.said.ends_with("all 2 are in force\n"),
        "{done:?}"
    );
    assert_eq!((board.stored().infill, board.stored().rate_pitch_p), (8.0, 11.0));
    let others = Params {
        infill: 6.9,
        rate_pitch_p: 10.0,
        ..board.stored()
    };
    assert!(others == Params::DEFAULT, "another parameter was set");
}

#[test]
fn with_a_key_nothing_unsigned_reaches_the_parameters() {
    let temp = Temp::new("params-key");
    let board = Board::with_key(Hands::default(), Key::from_hex(KEY));
    let (name, patience) = (board.name(), ["--patience", "2"]);
    let dumps = |more: &[&str]| {
        let args = [
            &["params", "dump", "p.toml", "--port", &name],
            &patience[..],
            more,
        ];
        run(&temp, &args.concat())
    };
    dumps(&[]).complains(2, "it may want signed frames: --mavlink-key FILE");
    let other = temp.file("other", KEY.replace("00", "11").as_bytes());
    dumps(&["--mavlink-key", &other]).complains(2, "no vehicle answers within 2 s that signs with this key");
    let key = temp.file("key", KEY.as_bytes());
    // One session after the other: the times of the signatures continue.
    for _ in 0..2 {
        let dumped = dumps(&["--mavlink-key", &key]);
        assert_eq!((dumped.status, &*dumped.complaint), (Some(0), ""), "{dumped:?}");
    }
}

#[test]
fn what_another_station_has_set_waits_for_a_restart_and_a_load_gives_it() {
    let (temp, board) = (Temp::new("params-waits"), Board::new(Hands::default()));
    temp.file("p.toml", b"[params]\ninfill = 8\n");
    board.until(Mode::Disarmed, false);
    board.send_and_leave(&sets("infill", 8.0));
    board.pass(3.0);
    let dumped = params(&temp, &board, "dump", "-");
    let line = format!(
        "sophie: {}: what is stored there is in force after a restart\n",
        board.name()
    );
    assert_eq!((dumped.status, dumped.complaint), (Some(0), line));
    assert!(dumped.said.contains("\ninfill = 8 "), "{}", dumped.said);
    // The values are those of the file, but not in force yet.
    for said in [
        "saved; the board has restarted\nall 1 are in force\n",
        "nothing to change: all 1 are in force\n",
    ] {
        let done = params(&temp, &board, "load", "p.toml");
        assert_eq!((done.status, &*done.said), (Some(0), said), "{done:?}");
    }
    assert_eq!(params(&temp, &board, "dump", "-").complaint, "");
}

#[test]
fn what_the_board_refuses_or_does_not_keep_is_status_1() {
    let (temp, board) = (Temp::new("params-refused"), Board::new(Hands::default()));
    temp.file("marks.toml", b"[params]\nservo_marks = 1234\n");
    temp.file("p.toml", b"[params]\ninfill = 8\n");
    // Servos without marks forbid arming.
    assert_eq!(params(&temp, &board, "load", "marks.toml").status, Some(0));
    let stored = board.stored();
    board.hands(|hands| hands.broken = true);
    let done = params(&temp, &board, "load", "p.toml");
    done.complains(1, "not stored: stored parameters unreadable; nothing is saved");
    // The board's values are as they were.
    assert_eq!(
        params(&temp, &board, "diff", "p.toml").said,
        "infill 6.9 -> 8 %\n"
    );
    board.hands(|hands| (hands.broken, hands.forgets) = (false, true));
    params(&temp, &board, "load", "p.toml").complains(1, "read back after the restart: infill 6.9 -> 8 %");
    // Armed by the pilot's gesture.
    board.hands(|hands| (hands.sticks, hands.forgets) = (Some(Sticks::default()), false));
    board.until(Mode::Disarmed, true);
    let arming = Sticks {
        arm_switch: true,
        yaw: 1.0,
        ..Sticks::default()
    };
    board.hands(|hands| hands.sticks = Some(arming));
    board.until(Mode::Armed, false);
    let done = params(&temp, &board, "load", "p.toml");
    done.complains(
        1,
        "the board refused infill 6.9 -> 8 %: parameters: disarm first; nothing is saved",
    );
    assert!(board.stored() == stored && stored != Params::DEFAULT);
}
