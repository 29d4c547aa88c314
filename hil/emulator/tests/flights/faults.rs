//! Hardware faults at the wires: effect on log and pins.

use sophie_emulator::wires::BoardFault;
use sophie_sim::sensors::fsr::FsrBreak;

use super::*;

/// On the H743, airborne when the trouble starts.
fn with(trouble: Trouble, seconds: f64) -> Flight {
    sound_before(fly(&hover(seconds), 1.0, &[(AIRBORNE, trouble)]))
}

/// On the F405.
fn with_small(trouble: Trouble, seconds: f64) -> Flight {
    sound_before(fly_small(&hover(seconds), &[(AIRBORNE, trouble)]))
}

fn sound_before(flight: Flight) -> Flight {
    assert!(
        logged_at(&flight, 0.0, "FLIGHT").is_some_and(|t| t < AIRBORNE),
        "{}",
        log(&flight)
    );
    assert!(running(&flight, AIRBORNE - 0.5, AIRBORNE));
    assert_eq!(flight.gaps, [], "{}", log(&flight));
    flight
}

#[test]
fn an_unplugged_inertial_sensor_is_named_stops_the_motors_and_restarts_the_board() {
    let flight = with(Trouble::Board(BoardFault::ImuUnplugged(true)), AIRBORNE + 2.0);
    assert!(
        logged_at(&flight, AIRBORNE, "ICM-42688-P: no answer").is_some(),
        "{}",
        log(&flight)
    );
    let t = logged_at(&flight, AIRBORNE, "DISARMED: inertial sensor silent");
    assert!(t.is_some_and(|t| t < AIRBORNE + 0.3), "{}", log(&flight));
    // Until the pilot reads it and ends the flight, 0.3 s after the loss.
    assert!(
        stopped(&flight, AIRBORNE + 0.1, f64::INFINITY),
        "{}",
        log(&flight)
    );
    // Without flight level the supervisor does not feed the watchdog.
    assert!(
        logged_at(&flight, AIRBORNE, "start after Watchdog").is_some(),
        "{}",
        log(&flight)
    );
}

/// Requires a reported watchdog reset within `within` s and no running motor from `stopped_by` s after the trouble:
/// without software no frame follows, and the controllers stop.
fn ended_by_the_watchdog(flight: &Flight, within: f64, stopped_by: f64) {
    let [(ms, cause)] = &flight.board.resets[..] else {
        panic!("{:?}\n{}", flight.board.resets, log(flight))
    };
    assert!(cause.contains("IWDG"), "{cause}");
    let after = ms * 1e-3 - AIRBORNE;
    assert!((0.2..within).contains(&after), "{after}");
    assert!(
        logged_at(flight, AIRBORNE, "start after Watchdog").is_some(),
        "{}",
        log(flight)
    );
    let still = stopped_by.max(after + 0.05);
    assert!(
        stopped(flight, AIRBORNE + still, f64::INFINITY),
        "{}",
        log(flight)
    );
}

const CUT: Trouble = Trouble::Board(BoardFault::DataReadyCut(true));
const JOINED: Trouble = Trouble::Board(BoardFault::DataReadyCut(false));
const LINE: &str = "inertial sensor: data-ready line silent";

/// Requires a normal landing with its reason after the line is cut in hover.
fn lands_without_data_ready(flight: &Flight) {
    let t = logged_at(flight, AIRBORNE, &format!("FAILSAFE: {LINE}"));
    assert!(t.is_some_and(|t| t < AIRBORNE + 0.4), "{}", log(flight));
    let down = logged_at(flight, AIRBORNE, &format!("DISARMED: {LINE}"))
        .unwrap_or_else(|| panic!("{}", log(flight)));
    assert!(running(flight, AIRBORNE - 0.5, down - 0.1), "{}", log(flight));
    // At most descent speed, 10 degrees from level, and down from 3 m.
    for s in samples(flight, AIRBORNE, down) {
        let [.., sink] = s.velocity;
        let [roll, pitch, _] = s.attitude.map(f64::to_degrees);
        assert!(sink < 1.3 && roll.abs() < 10.0 && pitch.abs() < 10.0, "{s:?}");
    }
    let last = samples(flight, 0.0, down).last().unwrap();
    assert!(last.position[2] > -0.3, "{last:?}");
    for task in FLIGHT_LEVEL {
        assert_eq!(flight.board.overruns.get(task), None, "{task}\n{}", log(flight));
    }
    // 87 us with the line; polling adds a quarter of 250 us and the status' transfer.
    let latency = flight.board.run.latency_us;
    assert!(latency.worst < 170.0, "{latency:?}");
    assert!(flight.board.resets.is_empty(), "{:?}", flight.board.resets);
    assert_eq!(flight.gaps, []);
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_cut_data_ready_line_is_named_and_the_vehicle_lands_on_timed_reads() {
    lands_without_data_ready(&with(CUT, AIRBORNE + 15.0));
}

#[test]
fn a_cut_data_ready_line_is_landed_with_on_the_small_board() {
    lands_without_data_ready(&fly_small(&hover(AIRBORNE + 15.0), &[(AIRBORNE, CUT)]));
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_data_ready_line_that_is_cut_from_the_start_refuses_arming_until_it_is_joined() {
    let flight = fly(&hover(22.0), 1.0, &[(0.0, CUT), (8.0, JOINED)]);
    let refused = logged_at(&flight, 0.0, &format!("DISARMED: {LINE}"));
    assert!(refused.is_some_and(|t| t < 6.0), "{}", log(&flight));
    assert!(
        logged_at(&flight, 0.0, "self-test passed").is_some(),
        "{}",
        log(&flight)
    );
    assert!(stopped(&flight, 0.0, 8.0), "{}", log(&flight));
    let freed = logged_at(&flight, 8.0, &format!("no longer blocked: {LINE}"));
    assert!(freed.is_some_and(|t| t < 9.0), "{}", log(&flight));
    assert!(logged_at(&flight, 8.0, "FLIGHT").is_some(), "{}", log(&flight));
    assert_eq!(flight.board.overruns.get("imu"), None, "{}", log(&flight));
    assert_eq!(flight.gaps, []);
}

#[test]
fn a_flipped_word_of_the_inertial_sensor_now_and_then_is_flown_through() {
    let words = (0..40).map(|n| {
        (
            AIRBORNE + 0.2 * f64::from(n),
            Trouble::Board(BoardFault::ImuWord(0x40)),
        )
    });
    let troubles: Vec<_> = words.collect();
    let flight = fly_small(&hop(), &troubles);
    assert!(flight.passed(), "{:?}\n{}", flight.record.outcome, log(&flight));
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_silenced_arm_sensor_is_named_and_flown_without() {
    let troubles = [
        (AIRBORNE, Trouble::Board(BoardFault::ArmUnplugged(2, true))),
        (AIRBORNE + 3.0, Trouble::Board(BoardFault::ArmUnplugged(2, false))),
    ];
    let flight = fly_small(&hop(), &troubles);
    assert!(
        logged_at(&flight, AIRBORNE, "BNO055").is_some(),
        "{}",
        log(&flight)
    );
    assert!(flight.passed(), "{:?}\n{}", flight.record.outcome, log(&flight));
}

/// Every third byte from the receiver, from the start.
const NOISE: Trouble = Trouble::Board(BoardFault::ReceiverNoise(333_333));

/// Without the receiver's link the pilot cannot arm.
fn keeps_its_link(flight: Flight) {
    let flight = sound_before(flight);
    for lost in ["radio lost", "FAILSAFE"] {
        assert_eq!(logged_at(&flight, 0.0, lost), None, "{}", log(&flight));
    }
}

#[test]
fn noise_on_the_receivers_line_does_not_cost_the_link() {
    keeps_its_link(fly_small(&hover(AIRBORNE), &[(0.0, NOISE)]));
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn noise_on_the_receivers_line_does_not_cost_the_link_of_the_h743() {
    keeps_its_link(fly(&hover(AIRBORNE), 1.0, &[(0.0, NOISE)]));
}

#[test]
fn a_silent_receiver_ends_in_the_failsafe() {
    let flight = with_small(Trouble::RadioSilent(true), AIRBORNE + 3.0);
    let t = logged_at(&flight, AIRBORNE, "FAILSAFE: radio lost");
    assert!(t.is_some_and(|t| t < AIRBORNE + 2.0), "{}", log(&flight));
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn flipped_bits_on_the_receivers_line_are_flown_through() {
    let flight = fly_small(&hop(), &[(AIRBORNE, Trouble::RadioBits(97))]);
    assert!(flight.passed(), "{:?}\n{}", flight.record.outcome, log(&flight));
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_sagging_battery_ends_in_the_failsafe() {
    let flight = with_small(Trouble::BatteryShare(0.75), AIRBORNE + 10.0);
    assert!(
        logged_at(&flight, AIRBORNE, "battery").is_some(),
        "{}",
        log(&flight)
    );
}

#[test]
fn a_processor_that_stands_still_is_reset_by_its_watchdog_with_the_motors_stopped() {
    let flight = with(Trouble::Board(BoardFault::Hang(true)), AIRBORNE + 1.5);
    ended_by_the_watchdog(&flight, 0.5, 0.4);
}

#[test]
fn a_pulled_reset_pin_is_named_as_the_cause() {
    let flight = with_small(Trouble::Board(BoardFault::ResetPin), AIRBORNE + 2.0);
    assert!(
        logged_at(&flight, AIRBORNE, "start after Pin").is_some(),
        "{}",
        log(&flight)
    );
    assert!(
        stopped(&flight, AIRBORNE + 0.3, f64::INFINITY),
        "{}",
        log(&flight)
    );
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_bus_whose_clock_is_held_keeps_the_background_only() {
    // 300 us per byte: reading a sensor takes 4 ms.
    let troubles = [(AIRBORNE, Trouble::Board(BoardFault::ClockHeld(0, 300)))];
    let flight = fly(&hover(AIRBORNE + 3.0), 1.0, &troubles);
    assert!(
        running(&flight, AIRBORNE - 0.5, f64::INFINITY),
        "{}",
        log(&flight)
    );
    for task in FLIGHT_LEVEL {
        assert_eq!(flight.board.overruns.get(task), None, "{task}\n{}", log(&flight));
    }
    let latency = flight.board.run.latency_us;
    assert!(latency.worst < 60.0, "{latency:?}");
    assert!(flight.board.resets.is_empty());
    assert_eq!(flight.gaps, []);
}

#[test]
fn a_task_that_hangs_ends_in_a_reset_by_the_watchdog_with_the_motors_stopped() {
    let flight = with(Trouble::Board(BoardFault::TaskHung("commander")), AIRBORNE + 2.0);
    ended_by_the_watchdog(&flight, 1.0, 0.2);
}

/// Requires that a stack overflow in hover stops the motors and the next start reports it.
fn overflows(task: &'static str, small: bool) {
    let trouble = Trouble::Board(BoardFault::StackOverflow(task));
    let troubles = [(AIRBORNE, trouble)];
    let scenario = hover(AIRBORNE + 0.6);
    let flight = if small {
        fly_small(&scenario, &troubles)
    } else {
        fly(&scenario, 1.0, &troubles)
    };
    assert!(running(&flight, AIRBORNE - 0.5, AIRBORNE), "{}", log(&flight));
    let [(ms, cause)] = &flight.board.resets[..] else {
        panic!("{:?}\n{}", flight.board.resets, log(&flight))
    };
    // At once: the watchdog would take 0.2 s.
    let after = ms * 1e-3 - AIRBORNE;
    assert!((0.0..0.1).contains(&after), "{after} {cause}");
    for text in [
        "start after Software",
        "previous run ended with: stack overflow",
        "restarted after a fault",
    ] {
        assert!(
            logged_at(&flight, AIRBORNE, text).is_some(),
            "{text}\n{}",
            log(&flight)
        );
    }
    assert!(
        stopped(&flight, AIRBORNE + after + 0.1, f64::INFINITY),
        "{}",
        log(&flight)
    );
    // The emulator allows accesses to unmapped memory: the fault comes when a return address is read there.
    let bottom = if small { 0x1000_0000 } else { 0x2000_0000 };
    let below = |gap: &&sophie_emulator::wires::Gap| {
        let at = u64::from_str_radix(gap.at.trim_start_matches("0x"), 16).unwrap_or_default();
        gap.kind == "unmapped" && (bottom - (16 << 20)..bottom).contains(&at)
    };
    assert_eq!(flight.gaps.iter().find(|gap| !below(gap)), None);
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_stack_overflow_stops_the_motors_and_is_reported_at_the_next_start() {
    overflows("control", false);
}

#[test]
fn so_does_one_of_the_background_on_the_small_board() {
    overflows("report", true);
}

#[test]
fn a_fault_within_a_fault_locks_up_and_ends_by_the_watchdog_with_the_motors_stopped() {
    let flight = with_small(Trouble::Board(BoardFault::LockUp("control")), AIRBORNE + 1.2);
    ended_by_the_watchdog(&flight, 0.6, 0.4);
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_battery_that_sags_until_the_supply_breaks_down_stops_the_motors_for_good() {
    let troubles = [
        (AIRBORNE, Trouble::BatteryShare(0.4)),
        (AIRBORNE + 0.02, Trouble::Board(BoardFault::Supply(false))),
        (AIRBORNE + 0.1, Trouble::Board(BoardFault::Supply(true))),
        (AIRBORNE + 0.1, Trouble::BatteryShare(1.0)),
    ];
    let flight = fly(&hover(AIRBORNE + 2.5), 1.0, &troubles);
    assert!(running(&flight, AIRBORNE - 0.5, AIRBORNE), "{}", log(&flight));
    assert!(
        logged_at(&flight, AIRBORNE, "start after BrownOut").is_some(),
        "{}",
        log(&flight)
    );
    assert!(
        stopped(&flight, AIRBORNE + 0.3, f64::INFINITY),
        "{}",
        log(&flight)
    );
    assert_eq!(flight.gaps, []);
}

#[test]
fn a_shorted_pressure_sensor_speaks_before_the_arms_close() {
    let troubles = [(2.0, Trouble::Fsr(1, Some(FsrBreak::Short)))];
    let flight = fly_small(&hover(4.0), &troubles);
    assert!(logged_at(&flight, 2.0, "pressure").is_some(), "{}", log(&flight));
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_cut_pressure_sensor_proves_no_grip_and_the_rotors_keep_turning() {
    // In still air the pilot touches at the first try.
    let mut scenario = Scenario {
        time_limit: 56.0,
        ..scenario("perch-short.toml")
    };
    (scenario.world.gust_force, scenario.world.gust_moment) = (0.0, 0.0);
    let flight = fly_small(&scenario, &[(20.0, Trouble::Fsr(1, Some(FsrBreak::Open)))]);
    let closing =
        logged_at(&flight, 20.0, "CLAMPING").unwrap_or_else(|| panic!("no perch\n{}", log(&flight)));
    // A sound grip is proven after four seconds.
    for never in ["grip proven", "PERCHED"] {
        assert_eq!(logged_at(&flight, closing, never), None, "{}", log(&flight));
    }
    assert!(closing < 50.0, "{closing}");
    assert!(running(&flight, closing, f64::INFINITY), "{}", log(&flight));
}
