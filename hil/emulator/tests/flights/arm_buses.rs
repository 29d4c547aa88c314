//! The arms' I2C buses on the emulated boards: chips and interfaces behave as manuals and errata state.

use sophie_control::params::ArmBusSpeed;
use sophie_emulator::wires::BoardFault;

use super::*;

/// Writes of the driver to a BNO055: register numbers of reads, and settings.
const WRITES: [&[u8]; 16] = [
    &[0x00],
    &[0x07],
    &[0x2E],
    &[0x3B],
    &[0x3E],
    &[0x41],
    &[0x42],
    &[0x07, 0x00],
    &[0x3B, 0x80],
    &[0x3D, 0x00],
    &[0x3D, 0x08],
    &[0x3E, 0x00],
    &[0x3F, 0x00],
    &[0x3F, 0x20],
    &[0x41, 0x24],
    &[0x42, 0x00],
];
/// Time until every sensor is read, with a second start of one, s; end of the run, s.
const UP: f64 = 2.6;
const END: f64 = 3.4;

/// Readings a second of a sensor that is read in each round, as the window cuts them.
const EACH_ROUND: std::ops::Range<f64> = 98.0..102.0;

/// Runs a disarmed board with `troubles`.
fn stand(small: bool, speed: ArmBusSpeed, troubles: &[(f64, BoardFault)]) -> Flight {
    let mut scenario = Scenario {
        time_limit: END,
        ..scenario("hover.toml")
    };
    scenario.params.arm_bus_khz = speed;
    let troubles = troubles.iter().map(|&(at, fault)| (at, Trouble::Board(fault)));
    let troubles: Vec<_> = troubles.chain([(0.0, Trouble::RadioSilent(true))]).collect();
    let flight = if small {
        fly_small(&scenario, &troubles)
    } else {
        fly(&scenario, 1.0, &troubles)
    };
    assert_eq!(flight.gaps, [], "{}", log(&flight));
    flight
}

/// Requires each arm's sensor to be read `hz` times a second at the end.
fn read_at(flight: &Flight, hz: std::ops::Range<f64>) {
    let (_, arms) = flight.board.run.reads.rates(UP, END);
    println!("arms {arms:.1?} Hz");
    assert!(
        arms.iter().all(|rate| hz.contains(rate)),
        "{arms:?}\n{}",
        log(flight)
    );
}

/// On each bus a chip that does not acknowledge its reset, and one that refuses a register's number once, behind which
/// another byte waits.
fn refused(small: bool) {
    let flight = stand(
        small,
        ArmBusSpeed::Fast,
        &[
            // UNIT_SEL: 0x80 waits.
            (0.0, BoardFault::ArmRefuses(0, 0x3B)),
            (0.0, BoardFault::ArmRefusesReset(1, true)),
            (0.0, BoardFault::ArmRefusesReset(2, true)),
            (0.0, BoardFault::ArmRefuses(3, 0x3B)),
        ],
    );
    for (arm, written) in flight.board.run.reads.written.iter().enumerate() {
        let strange: Vec<_> = written
            .iter()
            .filter(|(bytes, _)| !WRITES.contains(&&bytes[..]))
            .collect();
        assert!(strange.is_empty(), "arm {arm}: {strange:02X?}");
    }
    read_at(&flight, EACH_ROUND);
}

#[test]
fn a_refused_byte_costs_no_sensor_and_the_next_chip_no_strange_byte() {
    refused(false);
}

#[test]
fn so_it_does_on_the_small_board() {
    refused(true);
}

/// One in some 40 bytes: in almost each reading.
#[test]
fn spurious_bus_errors_cost_no_reading() {
    let troubles = [0, 1].map(|bus| (0.0, BoardFault::BusErrors(bus, 40)));
    read_at(&stand(false, ArmBusSpeed::Fast, &troubles), EACH_ROUND);
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn four_sensors_are_read_a_hundred_times_a_second_at_100_khz() {
    read_at(&stand(false, ArmBusSpeed::Standard, &[]), EACH_ROUND);
}

#[test]
fn so_they_are_on_the_small_board() {
    read_at(&stand(true, ArmBusSpeed::Standard, &[]), EACH_ROUND);
}

#[test]
fn chips_that_stretch_each_byte_are_read_at_sixty_hertz() {
    let troubles = [0, 1].map(|bus| (0.0, BoardFault::ClockHeld(bus, 180)));
    // Four readings of 19 bytes and 202 us each take 15.4 ms; the rest are pauses.
    read_at(&stand(true, ArmBusSpeed::Fast, &troubles), 58.0..65.0);
}
