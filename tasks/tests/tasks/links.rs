//! Ages of messages, notified readers, initial values.

use embassy_time::{Duration, Instant};
use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::params::Params;
use sophie_ports::retained::StartCause;
use sophie_tasks::schedule::timing::{Quantity, Run};
use sophie_tasks::schedule::{Level, TaskId};
use sophie_tasks::start::Start;

use crate::rig::Rig;

#[test]
fn a_message_is_fresh_up_to_its_limit_and_not_a_microsecond_longer() {
    let mut rig = Rig::new();
    assert!(rig.links.setpoint.latest().is_none() && rig.links.setpoint.fresh().is_none());
    rig.links.setpoint.send(Instant::now(), Setpoint::Idle);
    rig.run(50);
    assert_eq!(rig.links.setpoint.fresh(), Some(Setpoint::Idle));
    rig.time.run_until(50_001);
    assert_eq!(rig.links.setpoint.fresh(), None);
    assert_eq!(rig.links.setpoint.latest().map(|m| m.value), Some(Setpoint::Idle));
    // A stamp from the future, by another level's clock, counts as now.
    rig.links
        .setpoint
        .send(Instant::from_micros(50_100), Setpoint::Stop);
    assert_eq!(rig.links.setpoint.fresh(), Some(Setpoint::Stop));
}

#[test]
fn every_link_goes_stale_when_the_safety_of_its_readers_wants_it() {
    let rig = Rig::new();
    let l = rig.links;
    // ms: the flight level's five samples; motors stop after 10, rotors after 50; the radio after 500.
    for (name, limit, ms) in [
        ("imu", l.imu.stale_after, 5),
        ("attitude", l.attitude.stale_after, 5),
        ("demand", l.demand.stale_after, 5),
        ("mix", l.mix.stale_after, 10),
        ("contact", l.contact.stale_after, 20),
        ("setpoint", l.setpoint.stale_after, 50),
        ("target", l.target.stale_after, 50),
        ("arms", l.arms.stale_after, 100),
        ("grip", l.grip.stale_after, 100),
        ("clamp_command", l.clamp_command.stale_after, 200),
        ("tendons", l.tendons.stale_after, 200),
        ("tension", l.tension.stale_after, 200),
        ("reel_angle", l.reel_angle.stale_after, 200),
        ("grip_memory", l.grip_memory.stale_after, 200),
        ("status", l.status.stale_after, 200),
        ("battery", l.battery.stale_after, 500),
        ("servo_battery", l.servo_battery.stale_after, 500),
        ("rc", l.rc.stale_after, 500),
    ] {
        assert_eq!(limit, Duration::from_millis(ms), "{name}");
    }
}

#[test]
fn reports_stand_side_by_side_until_they_are_taken_back() {
    let links = Rig::new().links;
    links.report(ArmingInhibit::ArmSensor2, true);
    links.report(ArmingInhibit::AnalogSilent, true);
    links.report(ArmingInhibit::ArmSensor2, true);
    let both = ArmingInhibits::NONE
        .with(ArmingInhibit::ArmSensor2)
        .with(ArmingInhibit::AnalogSilent);
    assert_eq!(links.hardware(), both);
    links.report(ArmingInhibit::ArmSensor2, false);
    assert!(links.hardware().iter().eq([ArmingInhibit::AnalogSilent]));
    links.report(ArmingInhibit::Storing, false);
    assert!(links.hardware().iter().eq([ArmingInhibit::AnalogSilent]));
}

#[test]
fn only_a_brown_out_forbids_arming_from_the_start() {
    for cause in [
        StartCause::PowerOn,
        StartCause::BrownOut,
        StartCause::Watchdog,
        StartCause::Fault,
        StartCause::Software,
    ] {
        let start = Start { cause, ..Start::COLD };
        let hardware = Rig::starting(Params::default(), start).links.hardware();
        assert_eq!(
            hardware.contains(ArmingInhibit::BrownOut),
            cause == StartCause::BrownOut
        );
        assert_eq!(
            hardware.iter().count(),
            usize::from(cause == StartCause::BrownOut)
        );
    }
}

#[test]
fn a_miss_is_told_of_the_flight_level_alone_and_recorded_of_every_task() {
    let late = Run {
        released: Instant::from_micros(0),
        started: Instant::from_micros(100),
        ended: Instant::from_micros(700),
        deadline: Duration::from_micros(600),
        skipped: 0,
    };
    let punctual = Run {
        deadline: Duration::from_micros(700),
        ..late
    };
    for task in TaskId::ALL {
        let links = Rig::new().links;
        links.timing.record(task, &punctual);
        assert!(!links.timing.missed.signaled(), "{task:?}");
        links.timing.record(task, &late);
        assert_eq!(
            links.timing.missed.signaled(),
            task.level() == Level::Flight,
            "{task:?}"
        );
        for other in TaskId::ALL {
            let timing = links.timing.task(other);
            let own = u32::from(other == task);
            assert_eq!(
                (timing.runs, timing.overruns),
                (2 * own, own),
                "{task:?} {other:?}"
            );
        }
        assert_eq!(links.timing.take_histogram(task, Quantity::Response).max(), 700);
        assert_eq!(links.timing.take_histogram(task, Quantity::Response).count(), 0);
    }
}
