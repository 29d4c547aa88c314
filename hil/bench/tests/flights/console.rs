//! Commands typed at the emulated board's console while it runs.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::Duration;

use sophie_bench::terminal::{Sockets, Terminal};

use super::*;

/// Types `command` and reads until the console says `answer`; gives what it said.
fn type_in(user: &mut TcpStream, command: &str, answer: &str) -> String {
    user.write_all(command.as_bytes()).unwrap();
    let mut said = String::new();
    let mut bytes = [0; 64];
    while !said.contains(answer) {
        let count = user.read(&mut bytes).unwrap();
        assert!(count > 0, "the board has gone: {said}");
        said.push_str(&String::from_utf8_lossy(&bytes[..count]));
    }
    said
}

/// The battery's voltage by `status`, once it has been measured.
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

/// Presses the key until the console answers: what comes before it has started is lost, as on a real line.
fn wake(user: &mut TcpStream) {
    let mut bytes = [0; 64];
    // Long enough for a restart, on a machine that is busy.
    user.set_read_timeout(Some(Duration::from_secs(2))).unwrap();
    while matches!(user.read(&mut bytes), Ok(count) if count > 0) {}
    loop {
        user.write_all(b"\r").unwrap();
        if matches!(user.read(&mut bytes), Ok(count) if count > 0) {
            break;
        }
    }
    // An answer that does not come ends the test, whatever the load of the machine.
    user.set_read_timeout(Some(Duration::from_secs(300))).unwrap();
}

#[test]
fn a_parameter_set_and_saved_at_the_console_is_in_force_after_the_restart() {
    let [port, heard_at] = [(); 2].map(|()| {
        let free = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        free.local_addr().unwrap().port()
    });
    let sockets = Sockets {
        console: Some(Terminal::listen("--console", port).unwrap()),
        telemetry: Some(Terminal::listen("--telemetry", heard_at).unwrap()),
    };
    let mut listener = TcpStream::connect((Ipv4Addr::LOCALHOST, heard_at)).unwrap();
    let user = std::thread::spawn(move || {
        let mut user = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        wake(&mut user);
        let before = volts(&mut user);
        type_in(&mut user, "set infill 8\r", "in force after save");
        type_in(&mut user, "set battery_divider 22\r", "in force after save");
        type_in(&mut user, "save\r", "save\r\n");
        // The board restarts: what is typed meanwhile is lost.
        wake(&mut user);
        let after = volts(&mut user);
        (type_in(&mut user, "list infill\r", "4 to 10 %"), before, after)
    });
    let scenario = Scenario {
        // Nobody arms: the board has the time that the session needs.
        time_limit: 20.0,
        ..scenario("hover.toml")
    };
    let plan = Plan::new([(0, Trouble::RadioSilent(true))]);
    let firmware = Firmware::read(image(), boards::find("matek-h743").unwrap()).unwrap();
    let told_to = |_: &sophie_bench::log::Line| ();
    let flight = flight::fly(&firmware, &scenario, 1.0, plan, sockets, told_to, &mut Silent).unwrap();
    let (listed, before, after) = user.join().unwrap();
    // CRSF frames, one of them with the mode, marked as one that does not arm.
    let mut telemetry = Vec::new();
    listener.read_to_end(&mut telemetry).unwrap();
    assert_eq!(telemetry.first(), Some(&0xC8), "{telemetry:02x?}");
    let said = String::from_utf8_lossy(&telemetry);
    assert!(said.contains("!DISARMED"), "{said}");
    assert!(listed.contains("* infill") && listed.contains(" 8 "), "{listed}");
    // A full battery behind 1:11, and by a divider that is believed to be twice as large.
    assert!((16.0..17.0).contains(&before), "{before} V");
    assert!((after / before - 2.0).abs() < 0.01, "{before} V, then {after} V");
    // Two more than the calibration.
    assert!(
        told(&flight, 0.0, "parameters: 3 from storage").is_some(),
        "{}",
        log(&flight)
    );
    assert!(
        told(&flight, 0.0, "parameters: 5 from storage").is_some(),
        "{}",
        log(&flight)
    );
    assert_eq!(flight.board.resets.len(), 1, "{:?}", flight.board.resets);
    // The set was appended: no sector is worn by a save.
    assert!(flight.board.run.erases.is_empty());
    assert_eq!(flight.gaps, []);
}
