//! Texts: what happens is said once, to each who comes.

use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::mode::{Mode, Reason};
use sophie_dialect::HEARTBEAT_DATA;
use sophie_mavlink::services::texts::{ARMING, LONGEST};

use crate::station::{Station, frame, vehicle};

#[test]
fn every_text_fits_its_message() {
    for inhibit in ArmingInhibit::ALL {
        assert!(ARMING.len() + inhibit.text().len() <= LONGEST, "{inhibit:?}");
    }
    for reason in Reason::PLAIN {
        assert!(reason.text().len() <= LONGEST, "{reason:?}");
    }
}

#[test]
fn each_arming_check_is_named_when_it_begins_to_fail_and_again_to_a_new_listener() {
    let mut station = Station::new();
    let all: ArmingInhibits = ArmingInhibit::ALL.into_iter().collect();
    station.vehicle.condition.as_mut().unwrap().inhibits = all;
    station.run(3000);
    let expected: Vec<String> = std::iter::once("DISARMED".to_string())
        .chain(ArmingInhibit::ALL.map(|i| format!("arming: {}", i.text())))
        .collect();
    assert_eq!(station.texts(), expected);
    station.sent.clear();
    // One ends and comes back.
    let condition = station.vehicle.condition.as_mut().unwrap();
    condition.inhibits = all.without(ArmingInhibit::RcLost);
    station.run(100);
    station.vehicle.condition.as_mut().unwrap().inhibits = all;
    station.run(100);
    assert_eq!(station.texts(), ["arming: radio lost"]);
    station.sent.clear();
    for _ in 0..5 {
        station.say(&frame(&HEARTBEAT_DATA::default()));
        station.run(1000);
    }
    assert_eq!(station.texts(), expected);
}

#[test]
fn modes_reasons_and_warnings_are_said_as_they_change() {
    let mut station = Station::new();
    station.vehicle = vehicle(Mode::Flight);
    station.run(100);
    station.vehicle = vehicle(Mode::Failsafe);
    station.vehicle.condition.as_mut().unwrap().reason = Some(Reason::RADIO_LOST);
    station.vehicle.condition.as_mut().unwrap().warning = "arm tilt beyond its model";
    station.run(1000);
    assert_eq!(
        station.texts(),
        ["FLIGHT", "FAILSAFE", "radio lost", "arm tilt beyond its model"]
    );
}
