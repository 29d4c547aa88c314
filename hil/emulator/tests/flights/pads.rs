//! Pressure sensors on pads with a divider.

use sophie_emulator::wires::BoardFault;

use super::*;

/// The Matek's former pads of sensors 1 and 3, AirS and VB2, with their dividers (ArduPilot `MatekH743`, PX4
/// `matek/h743-slim`).
const OLD_PADS: [(f64, Trouble); 2] = [
    (0.0, Trouble::Board(BoardFault::PadDivider(0, 2))),
    (0.0, Trouble::Board(BoardFault::PadDivider(2, 11))),
];

fn perch(seconds: f64) -> Scenario {
    let mut scenario = Scenario {
        time_limit: seconds,
        ..scenario("perch-short.toml")
    };
    (scenario.world.gust_force, scenario.world.gust_moment) = (0.0, 0.0);
    scenario
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn with_the_old_pads_the_perch_fails_by_the_arm_whose_sensor_reads_too_little() {
    let flight = fly(&perch(60.0), 1.0, &OLD_PADS);
    let closing =
        logged_at(&flight, 20.0, "CLAMPING").unwrap_or_else(|| panic!("no perch\n{}", log(&flight)));
    // Behind 1:11 it reads at most 69 N/m2, and the arm presses beyond its limit.
    let outcome = &flight.record.outcome;
    assert!(
        !outcome.accomplished && outcome.reason.starts_with("pressure on arm 3 reached"),
        "{outcome:?}\n{}",
        log(&flight)
    );
    for never in ["grip proven", "PERCHED"] {
        assert_eq!(logged_at(&flight, closing, never), None, "{}", log(&flight));
    }
    assert_eq!(flight.gaps, [], "{}", log(&flight));
}
