//! Commands typed at the emulated board's console while it runs.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::Duration;

use sophie_emulator::closed_loop::Setup;
use sophie_emulator::terminal::{Sockets, Terminal};
use sophie_emulator::wires::BoardFault;
use sophie_test_support::signals::uninterrupted;

use super::*;

/// Returns the text read up to `answer`.
fn type_in(user: &mut TcpStream, command: &str, answer: &str) -> String {
    user.write_all(command.as_bytes()).unwrap();
    let mut said = String::new();
    let mut bytes = [0; 64];
    while !said.contains(answer) {
        let count = uninterrupted(|| user.read(&mut bytes)).unwrap();
        assert!(count > 0, "the board has gone: {said}");
        said.push_str(&String::from_utf8_lossy(&bytes[..count]));
    }
    said
}

fn volts(user: &mut TcpStream) -> f64 {
    loop {
        let said = type_in(user, "status\r", "up for");
        if let Some((_, rest)) = said.split_once("\nbattery ")
            && let Some((volts, _)) = rest.split_once(" V, ")
        {
            return volts.parse().unwrap_or_else(|_| panic!("{said}"));
        }
    }
}

/// A free port and the board's listener on it.
pub(super) fn terminal(option: &'static str) -> (u16, Terminal) {
    let free = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    let port = free.local_addr().unwrap().port();
    drop(free);
    (port, Terminal::listen(option, port).unwrap())
}

/// Runs `session` on a disarmed board for at most `seconds` s of its time.
fn at_the_console<T: Send + 'static>(
    firmware: &Firmware,
    seconds: f64,
    fault: Option<BoardFault>,
    telemetry: Option<Terminal>,
    session: impl FnOnce(&mut TcpStream) -> T + Send + 'static,
) -> (Flight, T) {
    let (port, console) = terminal("--console");
    let user = std::thread::spawn(move || {
        let mut user = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        wake(&mut user);
        session(&mut user)
    });
    let scenario = Scenario {
        time_limit: seconds,
        ..scenario("hover.toml")
    };
    let faults = fault.map(|fault| (0, Trouble::Board(fault)));
    let plan = Plan::new(faults.into_iter().chain([(0, Trouble::RadioSilent(true))]));
    let sockets = Sockets {
        console: Some(console),
        telemetry,
        mavlink: None,
    };
    let setup = Setup {
        speed: 1.0,
        plan,
        sockets,
    };
    let flight = flight::fly(firmware, &scenario, setup, |_| (), &mut Silent).unwrap();
    let given = user.join().unwrap_or_else(|_| panic!("{}", log(&flight)));
    (flight, given)
}

/// Presses the key until answered: input before the console starts is lost.
pub(super) fn wake(user: &mut TcpStream) {
    let mut bytes = [0; 64];
    // Covers a restart on a busy machine.
    user.set_read_timeout(Some(Duration::from_secs(2))).unwrap();
    while matches!(uninterrupted(|| user.read(&mut bytes)), Ok(count) if count > 0) {}
    loop {
        user.write_all(b"\r").unwrap();
        if matches!(user.read(&mut bytes), Ok(count) if count > 0) {
            break;
        }
    }
    // Ends the test without an answer, whatever the machine's load.
    user.set_read_timeout(Some(Duration::from_secs(300))).unwrap();
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_parameter_set_and_saved_at_the_console_is_in_force_after_the_restart() {
    let (heard_at, telemetry) = terminal("--telemetry");
    let mut listener = TcpStream::connect((Ipv4Addr::LOCALHOST, heard_at)).unwrap();
    let firmware = Firmware::read(image(), board_kind::find("matek-h743").unwrap()).unwrap();
    let session = |user: &mut TcpStream| {
        let before = volts(user);
        type_in(user, "set infill 8\r", "in force after save");
        type_in(user, "set battery_divider 22\r", "in force after save");
        type_in(user, "save\r", "saved; restarting");
        wake(user);
        let after = volts(user);
        (type_in(user, "list infill\r", "4 to 10 %"), before, after)
    };
    let (flight, (listed, before, after)) = at_the_console(&firmware, 32.0, None, Some(telemetry), session);
    // CRSF frames, one with the mode, marked as not armable.
    let mut telemetry = Vec::new();
    listener.read_to_end(&mut telemetry).unwrap();
    assert_eq!(telemetry.first(), Some(&0xC8), "{telemetry:02x?}");
    let said = String::from_utf8_lossy(&telemetry);
    assert!(said.contains("!DISARMED"), "{said}");
    assert!(listed.contains("* infill") && listed.contains(" 8 "), "{listed}");
    // A full battery behind 1:11, then with the parameter's divider doubled.
    assert!((16.0..17.0).contains(&before), "{before} V");
    assert!((after / before - 2.0).abs() < 0.01, "{before} V, then {after} V");
    // Two besides the calibration and the servos' marks.
    assert!(
        logged_at(&flight, 0.0, "parameters: 4 from storage").is_some(),
        "{}",
        log(&flight)
    );
    assert!(
        logged_at(&flight, 0.0, "parameters: 6 from storage").is_some(),
        "{}",
        log(&flight)
    );
    assert_eq!(flight.board.resets.len(), 1, "{:?}", flight.board.resets);
    // The set was appended: a save erases no sector.
    assert!(flight.board.run.erases.is_empty());
    assert_eq!(flight.gaps, []);
}

/// On a new chip the level is set at the console once; the next start finds it.
fn the_brown_out_level_is_set(image: &Path, board: &str) {
    let firmware = Firmware::read(image, board_kind::find(board).unwrap()).unwrap();
    let session = |user: &mut TcpStream| {
        let before = type_in(user, "brownout\r", "nothing else is changed");
        type_in(user, "brownout set\r", "restarting");
        wake(user);
        let after = type_in(user, "brownout\r", "nothing to do");
        (
            before,
            after,
            type_in(user, "brownout set\r", "not set: nothing to do"),
        )
    };
    let (flight, (before, after, _)) =
        at_the_console(&firmware, 24.0, Some(BoardFault::FactoryOptions), None, session);
    assert!(
        before.contains("brown-out level 0, expected 3"),
        "{board}: {before}"
    );
    assert!(
        after.contains("brown-out level 3, expected 3"),
        "{board}: {after}"
    );
    let refused = logged_at(&flight, 0.0, "arming blocked: brown-out level not set");
    assert!(refused.is_some(), "{board}: {}", log(&flight));
    let [(ms, _)] = &flight.board.resets[..] else {
        panic!("{board}: {:?}\n{}", flight.board.resets, log(&flight))
    };
    let restarted = logged_at(&flight, *ms * 1e-3, "start after Software");
    let restarted = restarted.unwrap_or_else(|| panic!("{board}: {}", log(&flight)));
    // Lines from before the reset may have its time.
    let again = logged_at(&flight, restarted, "brown-out level not set");
    assert_eq!(again, None, "{board}: {}", log(&flight));
    assert_eq!(flight.gaps, [], "{board}");
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn the_brown_out_level_of_a_new_chip_is_set_at_the_console() {
    the_brown_out_level_is_set(image(), "matek-h743");
}

#[test]
fn so_is_that_of_the_small_board_whose_encoding_is_the_opposite() {
    the_brown_out_level_is_set(small_image(), "f405");
}

/// `dfu` restarts into the chip's loader, once: before the clocks, with its vector table.
fn the_loader_is_entered(image: &Path, board: &str) {
    let mut firmware = Firmware::read(image, board_kind::find(board).unwrap()).unwrap();
    firmware.with_the_chips_loader().unwrap();
    let session = |user: &mut TcpStream| {
        while !type_in(user, "status\r", "up for").contains("DISARMED") {}
        type_in(user, "dfu\r", "leaving for the chip's USB loader");
        wake(user);
        type_in(user, "status\r", "up for");
    };
    let (flight, ()) = at_the_console(&firmware, 24.0, None, None, session);
    assert_eq!(flight.board.resets.len(), 1, "{board}: {:?}", flight.board.resets);
    // The loader has started it: the reset's cause was taken before.
    let log = log(&flight);
    assert!(!log.contains("start after Software"), "{board}: {log}");
    assert!(log.contains("start after Unknown"), "{board}: {log}");
    assert_eq!(flight.gaps, [], "{board}");
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn the_loader_is_entered_from_the_console() {
    the_loader_is_entered(image(), "matek-h743");
}

#[test]
fn so_is_that_of_the_small_board() {
    the_loader_is_entered(small_image(), "f405");
}

#[test]
fn a_motor_a_servo_live_numbers_and_the_self_test_are_tried_at_the_console() {
    let firmware = Firmware::read(small_image(), board_kind::find("f405").unwrap()).unwrap();
    let session = |user: &mut TcpStream| {
        while !type_in(user, "status\r", "up for").contains("DISARMED") {}
        type_in(
            user,
            "motor 2\r",
            "refused: say 'propellers off' first, once they are",
        );
        type_in(user, "propellers off\r", "motors may be tried");
        type_in(user, "motor 2\r", "motor 2 at 8 % for 2 s; any key stops it");
        type_in(user, "", "motor 2 stopped\r\n> ");
        // One row, then the key.
        type_in(user, "watch imu\r", "m/s2");
        type_in(user, "", " -9.");
        // The end of the row may have been read with it.
        type_in(user, "q", "> ");
        let tested = type_in(user, "selftest\r", " of 17 failed\r\n> ");
        type_in(user, "servo 1 pulse 900\r", "any key ends it");
        tested
    };
    let (flight, tested) = at_the_console(&firmware, 40.0, None, None, session);
    assert!(tested.contains("\n1 of 17 failed"), "{tested}");
    assert!(tested.contains("\nFAIL  receiver           silent"), "{tested}");
    // Frames at the pins: one motor for two seconds, the others none.
    let asked = |s: &&Sample| s.thrust_asked[1] > 0.0;
    let times: Vec<f64> = samples(&flight, 0.0, 14.0).filter(asked).map(|s| s.t).collect();
    let (Some(first), Some(last)) = (times.first(), times.last()) else {
        panic!("{}", log(&flight))
    };
    assert!((1.9..2.1).contains(&(last - first)), "{first} to {last} s");
    for s in samples(&flight, 0.0, 14.0) {
        assert!(
            [0, 2, 3].iter().all(|rotor| s.thrust_asked[*rotor] == 0.0),
            "{} s",
            s.t
        );
        // A thirtieth of the largest, 8.3 N.
        assert!(s.thrust_asked[1] < 0.5, "{} s: {} N", s.t, s.thrust_asked[1]);
    }
    let [servo, others @ ..] = flight.board.run.servos;
    assert!((servo - 900.0).abs() < 2.0, "{servo} us");
    assert!(others.iter().all(|us| (us - 550.0).abs() < 2.0), "{others:?} us");
    assert_eq!(flight.gaps, []);
}
