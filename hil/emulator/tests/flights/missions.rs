use sophie_control::mode::Mode;
use sophie_emulator::compare;
use sophie_emulator::wires::BoardFault;
use sophie_sim::record::FlightRecord;
use sophie_sim::sensors::barometer::BarometerFault;
use sophie_sim::sensors::fsr::FsrBreak;
use sophie_timing::live::{self, Contact, Line};

use super::*;

/// Each second's record of the pressure chain.
fn contact(flight: &Flight) -> Vec<Contact> {
    let lines = flight.board.lines.iter();
    let read = lines.filter_map(|line| live::parse(&line.text));
    read.filter_map(|line| match line.unwrap() {
        Line::Contact(contact) => Some(contact),
        Line::Record(_) | Line::Chain(_) => None,
    })
    .collect()
}

/// Requires a pulse within the deadline for every answered conversion, over at least `seconds` of the flight.
fn answers_contact_in_time(flight: &Flight, seconds: usize) {
    let all = contact(flight);
    // Servos at 50 Hz; first and last record are partial seconds.
    let whole = all.iter().filter(|second| second.pulses >= 49);
    assert!(whole.count() >= seconds, "{all:?}");
    for second in &all {
        assert!(
            second.missed == 0 && second.pulse.max <= second.deadline && second.deadline == 3500,
            "{second:?}"
        );
    }
    // For docs/timing.md.
    let command = all.iter().map(|second| second.command.max).max();
    let pulse = all.iter().map(|second| second.pulse.max).max();
    println!("contact: {command:?} us to the command, {pulse:?} us to the pulse at most");
}

fn accomplished(flight: &Flight) {
    assert!(
        flight.passed(),
        "{:?} {:?}\n{}",
        flight.record.outcome,
        flight.gaps,
        log(flight)
    );
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn the_image_perches_at_half_an_instruction_a_cycle() {
    let flight = fly(&scenario("perch-short.toml"), 0.5, &[]);
    accomplished(&flight);
    for task in FLIGHT_LEVEL {
        assert_eq!(flight.board.overruns.get(task), None, "{task}\n{}", log(&flight));
    }
    for esc in flight.board.run.escs {
        assert!(esc.frames > 50_000 && esc.bad == 0, "{esc:?}");
    }
    let latency = flight.board.run.latency_us;
    assert!(latency.count > 20_000 && latency.worst < 250.0, "{latency:?}");
    assert_eq!(flight.record.grip.len(), 4);
    answers_contact_in_time(&flight, 60);
    assert!(flight.board.resets.is_empty() && flight.board.malformed == 0);
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn the_small_board_perches() {
    let flight = fly_small(&scenario("perch-short.toml"), &[]);
    accomplished(&flight);
    assert!(flight.board.overruns.is_empty(), "{:?}", flight.board.overruns);
    assert_eq!(flight.record.grip.len(), 4);
    answers_contact_in_time(&flight, 60);
}

/// A hold by the flow module on the board's line: outcome and phases equal the host's.
fn holds_by_flow(flight: &Flight) {
    accomplished(flight);
    let host = sophie_sim::flight::fly(&scenario("hold-flow.toml"), &mut Silent);
    assert!(host.outcome.accomplished, "{:?}", host.outcome);
    assert!(compare::alike(&host, &flight.record));
    let held = |record: &FlightRecord| record.samples.iter().filter(|s| s.mode == Mode::Hold).count();
    let (board, host) = (held(&flight.record), held(&host));
    println!("in HOLD for {board} samples, {host} on the host");
    // The self-test shifts the pilot against the gusts, so the time to the point differs.
    assert!(4 * board > 3 * host && 4 * host > 3 * board, "{board} {host}");
    assert!(flight.board.overruns.is_empty(), "{:?}", flight.board.overruns);
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn the_image_holds_by_flow() {
    holds_by_flow(&fly(&scenario("hold-flow.toml"), 1.0, &[]));
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn the_small_board_holds_by_flow() {
    holds_by_flow(&fly_small(&scenario("hold-flow.toml"), &[]));
}

#[test]
fn the_small_board_flies_in_time() {
    let flight = fly_small(&scenario("hover.toml"), &[]);
    accomplished(&flight);
    assert!(flight.board.overruns.is_empty(), "{:?}", flight.board.overruns);
    for esc in flight.board.run.escs {
        assert!(esc.frames > 20_000 && esc.bad == 0, "{esc:?}");
    }
    let latency = flight.board.run.latency_us;
    assert!(latency.count > 10_000 && latency.worst <= 150.0, "{latency:?}");
    answers_contact_in_time(&flight, 15);
    assert!(flight.board.resets.is_empty() && flight.board.malformed == 0);
}

/// Arm buses as slow as clock stretching makes them, and a log line at least every 50 ms: sensors lost and found, buses
/// freed, pressure sensors cut and mended.
fn background_at_its_worst() -> Vec<(f64, Trouble)> {
    let mut troubles = Vec::new();
    for bus in 0..2 {
        troubles.push((AIRBORNE, Trouble::Board(BoardFault::ClockHeld(bus, 300))));
    }
    for turn in 0..40u32 {
        let t = AIRBORNE + 0.1 * f64::from(turn);
        let (arm, lost) = (turn as usize / 2 % 4, turn % 2 == 0);
        troubles.push((t, Trouble::Board(BoardFault::ArmUnplugged(arm, lost))));
        troubles.push((t + 0.05, Trouble::Fsr(arm, lost.then_some(FsrBreak::Short))));
    }
    troubles
}

/// Requires no overruns of the flight level, and frames within `longest` µs of data-ready, at most `jitter` over the
/// mean.
fn in_time(flight: &Flight, longest: f64, jitter: f64) {
    assert_eq!(flight.gaps, [], "{}", log(flight));
    for task in FLIGHT_LEVEL {
        assert_eq!(flight.board.overruns.get(task), None, "{task}\n{}", log(flight));
    }
    assert!(
        running(flight, AIRBORNE, AIRBORNE + 4.0) && logged_at(flight, AIRBORNE, "BNO055: ").is_some(),
        "{}",
        log(flight)
    );
    // The buses were slow.
    assert!(flight.board.overruns.contains_key("arms"), "{}", log(flight));
    let latency = flight.board.run.latency_us;
    // For docs/timing.md.
    println!(
        "{:.1} us in the mean, {:.1} at most",
        latency.mean(),
        latency.worst
    );
    assert!(
        latency.count > 5_000 && latency.worst <= longest && latency.worst - latency.mean() <= jitter,
        "{latency:?}"
    );
    answers_contact_in_time(flight, 3);
    assert!(flight.board.resets.is_empty() && flight.board.malformed == 0);
}

/// The barometer answers no more in these seconds, on sound buses.
const NO_BAROMETER: [f64; 2] = [3.5, 5.0];
/// From the repair of the worst buses on: the longest pause of a driver after failures, and its start.
const REPAIRED: f64 = AIRBORNE + 4.0;
const BACK: f64 = REPAIRED + 1.5;

/// Requires the barometer's 25 and the arm sensors' 100 measurements a second, the latter also where the barometer on their
/// bus is missing, and again once clocks were held on it.
fn shares_its_bus(flight: &Flight) {
    let reads = &flight.board.run.reads;
    let [missing, found] = NO_BAROMETER;
    for (from, to, pressures) in [
        (2.5, missing, 24.5..25.6),
        // Reset and set up after a pause of a second at most.
        (missing + 0.1, found, 0.0..0.1),
        (found + 1.5, AIRBORNE, 24.5..25.6),
        (BACK, BACK + 1.0, 23.9..26.1),
    ] {
        let (barometer, arms) = reads.rates(from, to);
        // For docs/timing.md.
        println!("{from} to {to} s: barometer {barometer:.1} Hz, arms {arms:.1?} Hz");
        assert!(
            pressures.contains(&barometer) && arms.iter().all(|rate| (98.0..102.0).contains(rate)),
            "{from} to {to} s: {barometer} {arms:?}\n{}",
            log(flight)
        );
    }
    let named = logged_at(flight, missing, "DPS310: ");
    assert!(named.is_some_and(|t| t < missing + 0.3), "{}", log(flight));
    // While the buses are sound no measurement is late, whichever chip is missing.
    let late = flight
        .board
        .lines
        .iter()
        .find(|line| line.text.contains(" overruns in "));
    assert!(
        late.is_none_or(|line| line.ms as f64 * 1e-3 > AIRBORNE),
        "{}",
        log(flight)
    );
}

#[test]
fn the_flight_level_is_in_time_while_the_background_is_at_its_worst() {
    let [missing, found] = NO_BAROMETER;
    let mut scenario = hover(BACK + 1.0);
    let s = &mut scenario.sensors;
    (s.barometer_fault, s.pose_fails_at, s.pose_fails_for) =
        (BarometerFault::Silent, missing, found - missing);
    let mut troubles = background_at_its_worst();
    for bus in 0..2 {
        troubles.push((REPAIRED, Trouble::Board(BoardFault::ClockHeld(bus, 0))));
    }
    let flight = fly(&scenario, 1.0, &troubles);
    in_time(&flight, 30.0, 5.0);
    shares_its_bus(&flight);
}

#[test]
fn so_it_is_on_the_small_board() {
    let mut troubles = background_at_its_worst();
    // At the end of a flight no bus may be in the midst of being freed, its pins taken from the peripheral.
    for bus in 0..2 {
        troubles.push((REPAIRED, Trouble::Board(BoardFault::ClockHeld(bus, 0))));
    }
    let flight = fly_small(&hover(REPAIRED + 0.5), &troubles);
    // The largest is 50.2 us; the mean has fallen to 44.8 (docs/timing.md).
    in_time(&flight, 60.0, 6.0);
}
