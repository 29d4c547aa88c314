//! Pulse protocols: rate, and no new pulse once the software stands still.

use sophie_control::params::MotorProtocol;
use sophie_emulator::wires::BoardFault;
use sophie_sim::plant::esc::EscSpec;

use super::*;

/// In the air; the flight ends before the watchdog's reset.
const STILL: f64 = AIRBORNE - 0.5;
const END: f64 = STILL + 0.18;

fn hung(protocol: MotorProtocol, small: bool) -> Flight {
    let mut scenario = hover(END);
    scenario.params.motor_protocol = protocol;
    let troubles = [(STILL, Trouble::Board(BoardFault::Hang(true)))];
    let flight = if small {
        fly_small(&scenario, &troubles)
    } else {
        fly(&scenario, 1.0, &troubles)
    };
    assert!(
        logged_at(&flight, 0.0, "FLIGHT").is_some_and(|t| t < STILL),
        "{}",
        log(&flight)
    );
    assert!(running(&flight, STILL - 0.5, STILL), "{}", log(&flight));
    assert_eq!(flight.gaps, [], "{}", log(&flight));
    flight
}

/// Requires frames within `interval` µs of each other, all valid; none later than `last` µs after the standstill; then
/// low pins.
fn ends(protocol: MotorProtocol, interval: [f64; 2], last: f64) {
    for small in [false, true] {
        let flight = hung(protocol, small);
        for esc in flight.board.run.escs {
            let [shortest, longest] = esc.interval.unwrap().map(|ns| ns as f64 * 1e-3);
            assert!(esc.bad == 0 && esc.frames > 1000, "{esc:?}");
            assert!(shortest >= interval[0] && longest <= interval[1], "{esc:?}");
        }
        let hung = flight.board.run.hung.unwrap();
        assert!(hung.last_rise_us <= last && hung.high == [false; 4], "{hung:?}");
    }
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_pulse_is_the_last_one_when_the_software_stands_still() {
    // At most 400 Hz; 100 Hz without mixes. A started pulse ends, none follows.
    ends(MotorProtocol::Pwm, [2500.0, 13_000.0], 0.0);
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn so_is_a_short_pulse() {
    ends(MotorProtocol::Oneshot125, [900.0, 13_000.0], 0.0);
}

#[test]
fn so_is_a_digital_frame() {
    // DMA completes the frame.
    ends(MotorProtocol::Dshot300, [900.0, 13_000.0], 120.0);
}

/// A DJI 430 Lite, whose pulses the emulated controllers read by its own ends from what the compare registers make.
#[test]
fn controllers_get_the_pulses_of_their_own_ends() {
    let mut scenario = hover(AIRBORNE);
    scenario.vehicle.esc = EscSpec {
        pulse_min: 1120.0,
        pulse_idle: 1180.0,
        pulse_max: 1920.0,
    };
    let p = &mut scenario.params;
    p.motor_protocol = MotorProtocol::Pwm;
    (p.motor_pulse_min, p.motor_pulse_idle, p.motor_pulse_max) = (1120.0, 1190.0, 1920.0);
    let flight = fly_small(&scenario, &[]);
    let flies = logged_at(&flight, 0.0, "FLIGHT").unwrap_or_else(|| panic!("{}", log(&flight)));
    for esc in flight.board.run.escs {
        // 400 a second, rotors from their idle on; the last pulse below full drive.
        assert!(esc.bad == 0 && esc.frames > 1500, "{esc:?}");
        let [shortest, longest] = esc.pulse_us.unwrap();
        assert!(shortest >= 1189.5 && longest <= 1920.5, "{esc:?}");
    }
    let turns = |s: &Sample| s.thrust.iter().all(|thrust| *thrust > 0.1);
    assert!(samples(&flight, flies + 0.5, AIRBORNE).count() > 50);
    assert!(
        samples(&flight, flies + 0.5, AIRBORNE).all(turns),
        "{}",
        log(&flight)
    );
    assert_eq!(flight.gaps, [], "{}", log(&flight));
}
