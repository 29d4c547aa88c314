//! Parameters stored in the chip's flash.

use sophie_control::params::{MotorProtocol, RcProtocol};
use sophie_emulator::wires::BoardFault;

use super::*;

/// Ends armed and off the ground.
fn start(change: impl FnOnce(&mut Scenario)) -> Scenario {
    let mut scenario = Scenario {
        time_limit: 7.0,
        ..scenario("hover.toml")
    };
    change(&mut scenario);
    scenario
}

#[test]
fn the_image_flies_with_stored_parameters() {
    let scenario = start(|s| {
        s.params.rc_protocol = RcProtocol::Sbus;
        s.params.motor_protocol = MotorProtocol::Dshot600;
    });
    let flight = fly(&scenario, 1.0, &[]);
    // These two, the lag, the servos' marks and the accelerometer's three axes.
    let taken = logged_at(&flight, 0.0, "parameters: 7 from storage");
    assert!(taken.is_some(), "{}", log(&flight));
    // Airborne with inverted line and parity, and motor frames at twice the rate.
    assert!(logged_at(&flight, 0.0, "FLIGHT").is_some(), "{}", log(&flight));
    for esc in flight.board.run.escs {
        assert!(esc.frames > 5000 && esc.bad == 0, "{esc:?}");
    }
    assert_eq!(flight.gaps, []);
}

#[test]
fn the_small_board_flies_with_stored_parameters() {
    let scenario = start(|s| s.params.rc_protocol = RcProtocol::Sbus);
    let flight = fly_small(&scenario, &[]);
    assert!(
        logged_at(&flight, 0.0, "parameters: 6 from storage").is_some(),
        "{}",
        log(&flight)
    );
    assert!(logged_at(&flight, 0.0, "FLIGHT").is_some(), "{}", log(&flight));
    assert_eq!(flight.gaps, []);
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn corrupt_storage_starts_with_the_defaults_reports_it_and_refuses_arming() {
    let scenario = start(|s| s.params.motor_protocol = MotorProtocol::Dshot600);
    let flight = fly(
        &scenario,
        1.0,
        &[(0.0, Trouble::Board(BoardFault::CorruptParameters))],
    );
    assert!(
        logged_at(&flight, 0.0, "parameters: 0 from storage").is_some(),
        "{}",
        log(&flight)
    );
    assert!(
        logged_at(&flight, 0.0, "parameters: storage unreadable").is_some(),
        "{}",
        log(&flight)
    );
    let refused = logged_at(&flight, 0.0, "DISARMED: stored parameters unreadable");
    assert!(refused.is_some(), "{}", log(&flight));
    let mut lines = flight.board.lines.iter();
    assert!(
        !lines.any(|line| line.text.starts_with("ARMED")),
        "{}",
        log(&flight)
    );
    assert!(stopped(&flight, 0.0, f64::INFINITY));
    // Frames have the default rate, which controllers for the stored one reject.
    assert!(flight.board.run.escs.iter().all(|esc| esc.frames == 0));
    assert_eq!(flight.gaps, []);
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn storage_that_is_corrupted_in_flight_speaks_after_the_next_reset() {
    let troubles = [
        (6.5, Trouble::Board(BoardFault::CorruptParameters)),
        (7.5, Trouble::Board(BoardFault::ResetPin)),
    ];
    let scenario = start(|s| s.time_limit = 8.5);
    let flight = fly(&scenario, 1.0, &troubles);
    assert!(running(&flight, 6.5, 7.4), "{}", log(&flight));
    let unreadable = logged_at(&flight, 0.0, "parameters: storage unreadable");
    assert!(unreadable.is_some_and(|t| t > 7.5), "{}", log(&flight));
    assert_eq!(flight.gaps, []);
}
