//! The whole stack with faults in flight: silent sensor, hung task, dead radio.

use super::links::links_with;
use super::vehicle::Vehicle;
use embassy_time::Instant;
use sophie_control::allocation::mixer::Flexible;
use sophie_control::allocation::wrench::Configuration;
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::mode::{Mode, Reason};
use sophie_control::params::Params;
use sophie_control::pilot::rc::Sticks;
use sophie_fakes::{Answer, FakeImu, FakeMotors};
use sophie_sim::clock::VirtualTime;

/// Requires that a silent inertial sensor stops the motors permanently within the mix's limit, and a reset.
fn a_lost_sensor_stops_the_motors(answer: Answer) {
    let mut v = Vehicle::flying();
    v.imu.0.answer.set(answer);
    let stopped = v.until(30, Vehicle::motors_stand);
    assert!((5..=12).contains(&stopped), "{answer:?}: {stopped} ms");
    assert!(v.links.attitude.fresh().is_none());
    v.until(80, |v| v.mode() == Mode::Disarmed);
    assert_eq!(v.links.setpoint.fresh(), Some(Setpoint::Stop));
    assert_eq!(v.reason(), Some(Reason::IMU_SILENT));
    assert!(!v.imu.0.spun.get(), "asked a thousand times without waiting");
    v.run(400);
    assert_eq!(v.fed_over(200), 0, "the watchdog would have reset the board");

    v.imu.0.answer.set(Answer::Sound);
    v.run(500);
    assert!(v.motors_stand() && v.mode() == Mode::Disarmed);
    assert!(v.links.attitude.fresh().is_some() && v.fed_over(200) >= 19);
}

#[test]
fn a_sensor_that_never_answers_stops_the_motors() {
    a_lost_sensor_stops_the_motors(Answer::Hangs);
}

#[test]
fn a_sensor_that_only_gives_errors_stops_the_motors() {
    a_lost_sensor_stops_the_motors(Answer::Fails);
}

#[test]
fn a_sensor_that_refuses_at_once_stops_the_motors_and_starves_no_task() {
    a_lost_sensor_stops_the_motors(Answer::Refuses);
}

#[test]
fn a_gap_in_the_samples_shorter_than_the_limit_is_flown_through() {
    let mut v = Vehicle::flying();
    for _ in 0..20 {
        v.imu.0.answer.set(Answer::Fails);
        v.run(4);
        v.imu.0.answer.set(Answer::Sound);
        v.run(50);
        assert!(v.motors_run());
    }
    assert_eq!((v.mode(), v.reason()), (Mode::Flight, None));
}

#[test]
fn a_setpoint_that_is_not_renewed_stops_the_rotors() {
    // All tasks but the commander, which sent one message.
    let (time, links, motors) = (
        VirtualTime::new(),
        links_with(Params::default()),
        FakeMotors::default(),
    );
    time.spawn(sophie_tasks::flight::imu::run(links, FakeImu::default()));
    time.spawn(sophie_tasks::flight::estimator::run(links));
    time.spawn(sophie_tasks::flight::control::run(links));
    let mixer = |p: &_| Flexible::new(Configuration::B, p);
    time.spawn(sophie_tasks::flight::mixer::run(links, mixer));
    time.spawn(sophie_tasks::flight::motors::run(links, motors.clone()));
    let setpoint = Setpoint::Angle {
        roll: 0.0,
        pitch: 0.0,
        yaw_rate: 0.0,
        thrust: 17.0,
    };
    for ms in 1..=4000 {
        time.run_until(ms * 1000);
        links.setpoint.send(Instant::now(), setpoint);
    }
    time.run_until(4_049_000);
    assert!(motors.commands.get().iter().all(|c| *c > 0.0));
    time.run_until(4_053_000);
    assert_eq!(motors.commands.get(), [0.0; 4]);
}

#[test]
fn a_hung_port_of_any_watched_task_leaves_the_watchdog_unfed() {
    type Break = fn(&Vehicle);
    let cases: [(&str, Break); 3] = [
        ("motors", |v| v.motors.part.answer.set(Answer::Hangs)),
        ("analog", |v| v.converter.part.answer.set(Answer::Hangs)),
        ("servos", |v| v.servos.part.answer.set(Answer::Hangs)),
    ];
    for (name, hang) in cases {
        let mut v = Vehicle::flying();
        hang(&v);
        v.run(200);
        // The window of the hang may contain enough runs.
        v.run(1000);
        assert_eq!(v.fed_over(1000), 0, "{name}");
    }
}

#[test]
fn a_hung_arm_sensor_or_a_lost_radio_does_not_reset_the_board() {
    let mut v = Vehicle::flying();
    v.arms.0.answer.set(Answer::Hangs);
    v.run(1000);
    assert_eq!(v.links.tilts().values(), [None; 4]);
    assert!(v.fed_over(900) >= 89 && v.motors_run());
    v.sticks = None;
    v.run(1000);
    assert_eq!((v.mode(), v.reason()), (Mode::Failsafe, Some(Reason::RADIO_LOST)));
    assert!(v.fed_over(900) >= 89);
}

#[test]
fn a_board_whose_sensor_never_came_up_is_fed_but_never_arms() {
    // A reset would not cure it, and the pilot can read the reason.
    let mut v = Vehicle::new();
    v.imu.0.answer.set(Answer::Hangs);
    v.sticks = Some(Sticks::default());
    v.run(3500);
    v.sticks = Some(Sticks {
        arm_switch: true,
        yaw: 1.0,
        ..Sticks::default()
    });
    v.run(3000);
    assert_eq!(
        (v.mode(), v.reason()),
        (Mode::Calibrating, Some(Reason::IMU_SILENT))
    );
    assert!(v.motors_stand() && v.fed_over(1000) >= 99);
}
