//! Broken, missing or wrong sensors: displayed, arming inhibited meanwhile, flights continued where possible.

use super::vehicle::Vehicle;
use sophie_control::arming::ArmingInhibit;
use sophie_control::mode::{Mode, Reason};
use sophie_control::pilot::rc::Sticks;
use sophie_fakes::Answer;
use sophie_ports::error::PortError;

type Break = fn(&Vehicle);

const ERRORS: [(PortError, ArmingInhibit); 3] = [
    (PortError::Absent, ArmingInhibit::ImuAbsent),
    (PortError::WrongPart, ArmingInhibit::ImuWrongPart),
    (PortError::Corrupt, ArmingInhibit::ImuCorrupt),
];

fn ready() -> Vehicle {
    let mut v = Vehicle::new();
    v.run(4000);
    assert_eq!((v.mode(), v.reason()), (Mode::Disarmed, None));
    v
}

/// Whether the arming gesture, held for 1.2 s, arms.
fn tries_to_arm(v: &mut Vehicle) -> bool {
    v.sticks = Some(Sticks {
        arm_switch: true,
        yaw: 1.0,
        ..Sticks::default()
    });
    v.run(1200);
    let armed = v.mode() == Mode::Armed;
    assert_eq!(v.motors_run(), armed);
    v.sticks = Some(Sticks::default());
    v.run(200);
    armed
}

fn holds(v: &Vehicle, reason: ArmingInhibit) -> bool {
    v.links.hardware().contains(reason)
}

#[test]
fn a_sound_vehicle_has_nothing_to_report_from_power_up_on() {
    let mut v = Vehicle::new();
    for _ in 0..4000 {
        v.run(1);
        assert!(
            v.links.hardware().is_empty(),
            "{} ms",
            v.links.hardware().iter().count()
        );
    }
    assert!(tries_to_arm(&mut v));
}

#[test]
fn arm_sensors_that_take_their_time_to_start_raise_no_alarm() {
    // A BNO055 answers after 650 ms; its driver has configured it after at most 2.1 s.
    let mut v = Vehicle::new();
    v.arms.0.answer.set(Answer::Refuses);
    for _ in 0..2300 {
        v.run(1);
        assert!(v.links.hardware().is_empty());
    }
    v.arms.0.answer.set(Answer::Sound);
    for _ in 0..3000 {
        v.run(1);
        assert!(v.links.hardware().is_empty());
    }
    assert!(tries_to_arm(&mut v));
}

#[test]
fn a_wrong_answer_of_the_inertial_sensor_is_named_while_calibrating() {
    for (error, reason) in ERRORS {
        let mut v = Vehicle::new();
        v.imu.0.answer.set(Answer::Errs(error));
        v.run(500);
        assert!(v.links.hardware().iter().eq([reason]), "{error:?}");
        assert_eq!(
            (v.mode(), v.reason()),
            (Mode::Calibrating, Some(Reason::Check(reason)))
        );
        v.imu.0.answer.set(Answer::Errs(PortError::Corrupt));
        v.run(100);
        assert!(
            v.links.hardware().iter().eq([ArmingInhibit::ImuCorrupt]),
            "{error:?}"
        );
        v.imu.0.answer.set(Answer::Sound);
        v.run(4000);
        assert!(v.links.hardware().is_empty());
        assert!(tries_to_arm(&mut v), "{error:?}: {:?}", v.reason());
    }
}

#[test]
fn a_silent_inertial_sensor_stays_silent_in_words_too() {
    for answer in [Answer::Hangs, Answer::Fails] {
        let mut v = Vehicle::new();
        v.imu.0.answer.set(answer);
        v.run(1000);
        assert!(v.links.hardware().is_empty(), "{answer:?}");
        assert_eq!(
            (v.mode(), v.reason()),
            (Mode::Calibrating, Some(Reason::IMU_SILENT))
        );
    }
}

#[test]
fn one_bad_answer_is_no_fault_and_many_are_one_until_it_is_quiet_again() {
    for (error, reason) in ERRORS {
        let mut v = Vehicle::flying();
        // One or two every 250 ms: glitches.
        for _ in 0..20 {
            v.imu.0.answer.set(Answer::Errs(error));
            v.until(4, |v| v.imu.0.failed.get() > 0);
            v.imu.0.answer.set(Answer::Sound);
            v.imu.0.failed.set(0);
            for _ in 0..250 {
                v.run(1);
                assert!(!holds(&v, reason), "{error:?}");
            }
        }
        assert_eq!((v.mode(), v.reason()), (Mode::Flight, None));
        // One every 20 ms: the third is reported, without flapping.
        let mut changes = 0;
        let mut before = false;
        for _ in 0..50 {
            v.imu.0.answer.set(Answer::Errs(error));
            v.until(4, |v| v.imu.0.failed.get() > 0);
            v.imu.0.answer.set(Answer::Sound);
            v.imu.0.failed.set(0);
            for _ in 0..20 {
                v.run(1);
                changes += u32::from(holds(&v, reason) != before);
                before = holds(&v, reason);
            }
        }
        assert_eq!((changes, before), (1, true), "{error:?}");
        assert!(v.motors_run() && v.mode() == Mode::Flight && v.reason().is_none());
        let healed = v.until(300, |v| !holds(v, reason));
        assert!((70..=100).contains(&healed), "{error:?}: {healed} ms");
        assert!(v.motors_run() && v.mode() == Mode::Flight);
    }
}

#[test]
fn each_arm_sensor_is_named_and_refuses_arming_until_it_answers() {
    let reasons = [
        ArmingInhibit::ArmSensor1,
        ArmingInhibit::ArmSensor2,
        ArmingInhibit::ArmSensor3,
        ArmingInhibit::ArmSensor4,
    ];
    for answer in [
        Answer::Fails,
        Answer::Refuses,
        Answer::Errs(PortError::Corrupt),
        Answer::Hangs,
    ] {
        for (arm, reason) in reasons.into_iter().enumerate() {
            let mut v = ready();
            v.arms.1[arm].answer.set(answer);
            let took = v.until(1500, |v| !v.links.hardware().is_empty());
            assert!((950..=1150).contains(&took), "{answer:?}: {took} ms");
            v.run(2000);
            assert!(v.links.hardware().iter().eq([reason]), "{answer:?} on arm {arm}");
            let tilts = v.links.tilts().values();
            for (other, tilt) in tilts.into_iter().enumerate() {
                assert_eq!(tilt.is_some(), other != arm, "{answer:?} on arm {arm}: {other}");
            }
            assert_eq!(
                (v.mode(), v.reason()),
                (Mode::Disarmed, Some(Reason::Check(reason)))
            );
            assert!(!tries_to_arm(&mut v));
            v.arms.1[arm].answer.set(Answer::Sound);
            v.until(50, |v| v.links.hardware().is_empty());
            v.run(20);
            assert_eq!(v.reason(), None);
            assert!(tries_to_arm(&mut v), "{answer:?} on arm {arm}: {:?}", v.reason());
        }
    }
}

#[test]
fn an_arm_sensor_that_never_was_there_is_named_before_the_first_arming() {
    let mut v = Vehicle::new();
    v.arms.1[2].answer.set(Answer::Refuses);
    v.run(4000);
    assert_eq!(
        (v.mode(), v.reason()),
        (Mode::Disarmed, Some(Reason::Check(ArmingInhibit::ArmSensor3)))
    );
    assert!(!tries_to_arm(&mut v));
}

#[test]
fn a_hung_bus_names_all_its_arms() {
    let mut v = ready();
    v.arms.0.answer.set(Answer::Hangs);
    v.run(2000);
    assert_eq!(v.links.hardware().iter().count(), 4);
    assert_eq!(v.reason(), Some(Reason::Check(ArmingInhibit::ArmSensor1)));
    v.arms.0.answer.set(Answer::Sound);
    v.run(200);
    assert!(v.links.hardware().is_empty());
}

#[test]
fn a_converter_that_stops_is_named_and_refuses_arming_until_it_converts() {
    for answer in [Answer::Fails, Answer::Refuses, Answer::Hangs] {
        let mut v = ready();
        v.converter.part.answer.set(answer);
        let took = v.until(300, |v| holds(v, ArmingInhibit::AnalogSilent));
        assert!((95..=110).contains(&took), "{answer:?}: {took} ms");
        v.run(20);
        assert_eq!(
            (v.mode(), v.reason()),
            (Mode::Disarmed, Some(Reason::Check(ArmingInhibit::AnalogSilent)))
        );
        assert!(!tries_to_arm(&mut v), "{answer:?}");
        if answer == Answer::Hangs {
            assert_eq!(v.fed_over(500), 0);
            continue;
        }
        v.converter.part.answer.set(Answer::Sound);
        v.until(10, |v| !holds(v, ArmingInhibit::AnalogSilent));
        v.run(1000);
        assert!(tries_to_arm(&mut v), "{answer:?}: {:?}", v.reason());
    }
}

#[test]
fn gaps_shorter_than_the_limits_are_not_reported() {
    let mut v = ready();
    for _ in 0..10 {
        v.converter.part.answer.set(Answer::Fails);
        v.run(90);
        assert!(v.links.hardware().is_empty());
        v.converter.part.answer.set(Answer::Sound);
        v.run(20);
        v.arms.0.answer.set(Answer::Refuses);
        v.run(900);
        assert!(v.links.hardware().is_empty());
        v.arms.0.answer.set(Answer::Sound);
        v.run(30);
    }
}

#[test]
fn a_broken_part_does_not_end_the_flight() {
    let breaks: [(Break, &[ArmingInhibit]); 2] = [
        (
            |v| v.arms.1[1].answer.set(Answer::Refuses),
            &[ArmingInhibit::ArmSensor2],
        ),
        (
            |v| v.arms.1.iter().for_each(|arm| arm.answer.set(Answer::Hangs)),
            &[
                ArmingInhibit::ArmSensor1,
                ArmingInhibit::ArmSensor2,
                ArmingInhibit::ArmSensor3,
                ArmingInhibit::ArmSensor4,
            ],
        ),
    ];
    for (breaks, reasons) in breaks {
        let mut v = Vehicle::flying();
        let overruns = |v: &Vehicle| {
            use sophie_tasks::schedule::TaskId;
            [
                TaskId::Imu,
                TaskId::Estimator,
                TaskId::Control,
                TaskId::Mixer,
                TaskId::Motors,
            ]
            .map(|task| v.links.timing.task(task).overruns)
        };
        let before = overruns(&v);
        breaks(&v);
        for _ in 0..3000 {
            v.run(1);
            assert!(
                v.motors_run() && v.mode() == Mode::Flight,
                "{reasons:?}: {:?}",
                v.reason()
            );
        }
        assert!(
            v.links.hardware().iter().eq(reasons.iter().copied()),
            "{reasons:?}"
        );
        assert_eq!(overruns(&v), before, "{reasons:?}");
        assert_eq!(v.reason(), None, "{reasons:?}");
        v.sticks = Some(Sticks::default());
        v.until(50, |v| v.mode() == Mode::Disarmed);
        v.run(11_000);
        assert_eq!(v.reason(), Some(Reason::Check(reasons[0])));
        assert!(!tries_to_arm(&mut v));
    }
}

/// Only the battery voltage shows how long the rotors can carry the vehicle.
#[test]
fn a_converter_that_falls_silent_in_flight_lands_the_vehicle_with_its_rotors_turning() {
    let mut v = Vehicle::flying();
    v.converter.part.answer.set(Answer::Fails);
    for ms in 0..3000 {
        v.run(1);
        assert!(v.motors_run(), "{ms} ms: {:?}", v.reason());
        // The link's limit of 0.5 s and a second of doubt, from the last conversion on.
        let lands = v.mode() == Mode::Failsafe;
        assert!(!lands || ms >= 1400, "{ms} ms");
        assert!(lands || ms <= 1700, "{ms} ms: {:?}", v.mode());
    }
    assert_eq!(v.reason(), Some(Reason::Check(ArmingInhibit::BatterySilent)));
    assert!(v.links.hardware().contains(ArmingInhibit::AnalogSilent));
}

#[test]
fn whatever_start_up_and_storage_report_refuses_arming_while_it_holds() {
    for reason in [
        ArmingInhibit::ImuSelfTest,
        ArmingInhibit::ImuLineSilent,
        ArmingInhibit::BrownOut,
        ArmingInhibit::StorageUnreadable,
        ArmingInhibit::StorageFull,
        ArmingInhibit::Storing,
    ] {
        let mut v = ready();
        v.links.report(reason, true);
        v.run(20);
        assert_eq!(
            (v.mode(), v.reason()),
            (Mode::Disarmed, Some(Reason::Check(reason)))
        );
        assert!(!tries_to_arm(&mut v), "{reason:?}");
        v.links.report(reason, false);
        assert!(tries_to_arm(&mut v), "{reason:?}: {:?}", v.reason());
    }
}

#[test]
fn a_silent_data_ready_line_refuses_arming_and_brings_a_flight_down_with_its_rotors_turning() {
    let silent = Some(Reason::LINE_SILENT);
    let mut v = ready();
    v.imu.1.set(true);
    v.run(20);
    assert_eq!((v.mode(), v.reason()), (Mode::Disarmed, silent));
    assert!(!tries_to_arm(&mut v));
    v.imu.1.set(false);
    v.run(20);
    assert_eq!(v.reason(), None);
    assert!(tries_to_arm(&mut v), "{:?}", v.reason());

    let mut v = Vehicle::flying();
    v.imu.1.set(true);
    let took = v.until(30, |v| v.mode() == Mode::Failsafe);
    assert!(took <= 12, "{took} ms");
    assert_eq!(v.reason(), silent);
    assert!(v.motors_run() && v.fed_over(10) == 1);
}
