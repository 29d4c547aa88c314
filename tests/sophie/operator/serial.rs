//! A serial port: a pseudo-terminal, which the command opens, sets up and locks like any other.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::time::{Duration, Instant};

use sophie_control::params::Params;

use super::board::{Board, Hands};
use super::bringup::Builder;
use super::{Done, run};
use sophie_test_support::command::{Temp, command, text};

fn params(temp: &Temp, board: &Board, verb: &str) -> Done {
    let name = board.name();
    run(
        temp,
        &["params", verb, "p.toml", "--port", &name, "--patience", "3"],
    )
}

#[test]
fn parameters_are_dumped_compared_and_loaded_over_a_serial_port() {
    let temp = Temp::new("serial-params");
    let board = Board::on_serial(Hands::default());
    let dumped = params(&temp, &board, "dump");
    assert_eq!((dumped.status, &*dumped.complaint), (Some(0), ""), "{dumped:?}");
    let file = temp.0.join("p.toml");
    let text = fs::read_to_string(&file).unwrap();
    assert!(text.contains("build 1234abcd, "), "{text}");
    assert_eq!(params(&temp, &board, "diff").status, Some(0));
    fs::write(&file, text.replace("infill = 6.9 ", "infill = 8 ")).unwrap();
    let different = params(&temp, &board, "diff");
    assert_eq!(
        (different.status, &*different.said),
        (Some(1), "infill 6.9 -> 8 %\n"),
        "{different:?}"
    );
    let loaded = params(&temp, &board, "load");
    assert!(
        loaded.status == Some(0) && loaded.said.contains("saved; the board has restarted"),
        "{loaded:?}"
    );
    assert!((board.stored().infill - 8.0).abs() < 1e-6);
}

#[test]
fn a_bring_up_goes_over_a_serial_port_and_has_it_alone() {
    let temp = Temp::new("serial-bringup");
    let board = Board::on_serial(Hands {
        brown_out_set: false,
        unreadable: true,
        ..Hands::default()
    });
    let mut builder = Builder::begins(&temp, &board, &[]);
    builder.step("chip");
    builder.hears("Enter sets it");
    // The port is taken meanwhile.
    params(&temp, &board, "dump").complains(2, "cannot be opened: another program has it; close the other");
    builder.types("");
    builder.step("setup");
    for name in [
        "motor_protocol",
        "rc_protocol",
        "battery_capacity",
        "battery_warning",
        "battery_critical",
        "infill",
        "servo_range",
    ] {
        builder.at(&format!("Enter keeps {name}"), "");
    }
    builder.hears("stored parameters unreadable");
    // The storage breaks: the failure is one line, and the next run repeats the step.
    board.hands(|hands| hands.broken = true);
    builder.at("Enter erases what cannot be read", "");
    let (status, _, complaint) = builder.ends();
    assert_eq!(status, Some(1));
    assert!(
        complaint.ends_with("not stored: stored parameters unreadable\n"),
        "{complaint}"
    );
    board.hands(|hands| hands.broken = false);
    let mut builder = Builder::begins(&temp, &board, &[]);
    builder.step("setup");
    for _ in 0..7 {
        builder.at("Enter keeps ", "");
    }
    builder.at("Enter erases what cannot be read", "");
    builder.step("selftest");
    builder.step("live-air");
    builder.hears("no barometer on table");
    builder.at("(live-imu)", "q");
    let (status, said, complaint) = builder.ends();
    assert_eq!((status, &*complaint), (Some(1), ""), "{said}");
    assert!(said.contains("\nStopped. not done: live-imu, "), "{said}");
    // Given back with the end of the program, and continued.
    let mut builder = Builder::begins(&temp, &board, &[]);
    builder.at("(live-imu)", "q");
    assert_eq!(builder.ends().0, Some(1));
}

#[test]
fn a_text_console_where_mavlink_is_wanted_is_named() {
    let temp = Temp::new("serial-console");
    let board = Board::at_its_console(Hands::default());
    for command in [&["bringup"][..], &["params", "dump", "bringup.toml"]] {
        let port = ["--port", &board.name(), "--patience", "2"];
        let done = run(&temp, &[command, &port].concat());
        done.complains(
            2,
            "this is the text console, MAVLink is wanted: the board's USB socket",
        );
        assert!(!temp.0.join("bringup.toml").exists());
    }
    // A vehicle that is signed by a key, and a line where nobody is.
    let board = Board::with_key(
        Hands::default(),
        sophie_sim::live::Key::from_hex(super::bringup::KEY),
    );
    let done = run(&temp, &["bringup", "--port", &board.name(), "--patience", "2"]);
    done.complains(2, "it may want signed frames: --mavlink-key FILE");
    board.hands(|hands| hands.mute = true);
    let done = run(&temp, &["bringup", "--port", &board.name(), "--patience", "2"]);
    done.complains(2, "no vehicle answers within 2 s, nothing came; expected MAVLink");
}

#[test]
fn a_plug_that_is_pulled_is_told_in_one_line() {
    let temp = Temp::new("serial-plug");
    for (verb, at, patience) in [
        ("dump", ("rate_yaw_p", Params::DEFAULT.rate_yaw_p), 3),
        ("load", ("infill", 8.0), 3),
    ] {
        fs::write(temp.0.join("p.toml"), "[params]\ninfill = 8\n").unwrap();
        let board = Board::on_serial(Hands {
            unplugged_at: Some(at),
            ..Hands::default()
        });
        let name = board.name();
        let begun = Instant::now();
        let done = params(&temp, &board, verb);
        done.complains(1, &format!("sophie: {name}: the line "));
        // At once: that there is nothing to wait for is seen.
        assert!(
            begun.elapsed() < Duration::from_secs(patience),
            "{:?}",
            begun.elapsed()
        );
        assert_eq!(
            fs::read_to_string(temp.0.join("p.toml")).unwrap(),
            "[params]\ninfill = 8\n"
        );
        assert_eq!(fs::read_dir(&temp.0).unwrap().count(), 1, "{verb}");
        // What had come is stored, and that is said.
        board.pass(3.0);
        let came = verb == "load";
        assert_eq!(board.stored().infill > 7.0, came);
        assert_eq!(
            done.complaint
                .contains("; the board may store what was set until then: load again\n"),
            came
        );
    }
}

#[test]
fn a_path_that_is_no_serial_port_is_told_in_one_line() {
    let temp = Temp::new("serial-path");
    temp.file("plain", b"text");
    for (path, why) in [
        ("nowhere", "No such file"),
        ("plain", "it is no serial port"),
        ("/dev/null", "it is no serial port"),
        (".", "it is no serial port"),
    ] {
        let done = run(&temp, &["params", "dump", "p.toml", "--port", path]);
        done.complains(2, &format!("sophie: {path}: cannot be opened: "));
        assert!(done.complaint.contains(why), "{done:?}");
    }
    assert_eq!(fs::read_to_string(temp.0.join("plain")).unwrap(), "text");
    assert!(!temp.0.join("p.toml").exists());
}

/// A user who may do nothing, where the test may choose.
const NOBODY: u32 = 65_534;

#[test]
fn a_port_without_permission_is_told_with_what_to_do() {
    let temp = Temp::new("serial-permission");
    let board = Board::on_serial(Hands::default());
    let name = board.name();
    fs::set_permissions(Path::new(&name), fs::Permissions::from_mode(0o000)).unwrap();
    let mut command = command(Path::new("/"), &["params", "dump", "-", "--port", &name]);
    // Root may open everything.
    if fs::metadata("/proc/self").is_ok_and(|it| std::os::unix::fs::MetadataExt::uid(&it) == 0) {
        // From a place that everybody may reach.
        let copy = temp.0.join("sophie");
        fs::copy(env!("CARGO_BIN_EXE_sophie"), &copy).unwrap();
        fs::set_permissions(&temp.0, fs::Permissions::from_mode(0o755)).unwrap();
        let args: Vec<_> = command.get_args().map(ToOwned::to_owned).collect();
        command = std::process::Command::new(copy);
        command.args(args).current_dir("/").uid(NOBODY).gid(NOBODY);
    }
    let output = command.output().unwrap();
    let done = Done {
        status: output.status.code(),
        said: text(&output.stdout),
        complaint: text(&output.stderr),
    };
    done.complains(2, "on Linux join the group of the port, dialout");
}
