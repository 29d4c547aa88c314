//! Reasons shown to the pilot, and their priority.

use super::rig::Rig;
use crate::arming::{ArmingInhibit, ArmingInhibits};
use crate::mode::*;
use crate::pilot::rc::Sticks;

#[test]
fn a_vehicle_on_the_ground_says_what_is_broken_and_what_keeps_it_from_arming() {
    let broken = ArmingInhibits::default().with(ArmingInhibit::ImuAbsent);
    // Calibrating: a silent sensor, a defect, or the need for rest.
    let mut r = Rig::new();
    r.expect(0.1, Mode::Calibrating);
    assert_eq!(r.out.reason, Some(Reason::KeepStill));
    r.inputs.hardware = broken;
    r.step();
    assert_eq!(r.out.reason, Some(Reason::Check(ArmingInhibit::ImuAbsent)));
    r.inputs.hardware = ArmingInhibits::default();
    r.inputs.motion = None;
    r.step();
    assert_eq!(r.out.reason, Some(Reason::Check(ArmingInhibit::ImuStale)));

    // Disarmed: a defect at once, all else on an attempt to arm.
    let mut r = Rig::armed();
    r.sticks().yaw = -1.0;
    r.expect(1.1, Mode::Disarmed);
    *r.sticks() = Sticks::default();
    r.run(0.1);
    r.inputs.battery = Some(13.0);
    r.step();
    assert_eq!(r.out.reason, None, "nobody tries to arm");
    r.inputs.hardware = broken;
    r.step();
    assert_eq!(r.out.reason, Some(Reason::Check(ArmingInhibit::ImuAbsent)));
    r.inputs.hardware = ArmingInhibits::default();
    r.sticks().arm_switch = true;
    r.step();
    assert_eq!(r.out.reason, Some(Reason::Check(ArmingInhibit::BatteryLow)));
    r.inputs.sticks = None;
    r.step();
    assert_eq!(
        r.out.reason, None,
        "the radio is nothing to a vehicle on the ground"
    );
}

#[test]
fn what_just_happened_comes_before_what_keeps_from_arming() {
    let mut r = Rig::flying();
    r.inputs.sticks = None;
    r.run(20.0);
    r.carried = true;
    r.expect(10.0, Mode::Disarmed);
    r.inputs.sticks = Some(Sticks {
        arm_switch: true,
        throttle: 0.5,
        ..Sticks::default()
    });
    r.run(0.1);
    assert_eq!(r.out.reason, Some(Reason::RADIO_LOST));
    r.run(10.0);
    assert_eq!(r.out.reason, r.out.inhibits.first().map(Reason::Check));
    assert!(r.out.reason.is_some());
}

#[test]
fn a_vehicle_on_the_pipe_says_what_is_lost() {
    let mut r = Rig::clamping();
    r.inputs.sticks = None;
    r.step();
    assert_eq!(r.out.reason, Some(Reason::RADIO_LOST));
    let mut r = Rig::clamping();
    r.inputs.battery = Some(12.0);
    r.run(0.9);
    assert_eq!(r.out.reason, None);
    r.run(0.2);
    assert_eq!(r.out.reason, Some(Reason::BatteryCritical));
}

#[test]
fn every_reason_has_a_short_text_of_its_own() {
    let checks = ArmingInhibit::ALL.into_iter().map(Reason::Check);
    let all = || Reason::PLAIN.iter().copied().chain(checks.clone());
    for (i, a) in all().enumerate() {
        let text = a.text();
        assert!(
            text.is_ascii() && !text.is_empty() && text.len() <= 40,
            "{a:?}: {text}"
        );
        for b in all().skip(i + 1) {
            assert_ne!(text, b.text(), "{a:?} {b:?}");
        }
    }
}
