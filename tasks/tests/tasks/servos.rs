//! Pulses for forces: when there are none, their speed, standing still.

use embassy_time::{Duration, Instant};
use sophie_control::allocation::wrench::PerArm;
use sophie_control::arming::ArmingInhibit;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::params::{Params, ServoMarks};
use sophie_control::pilot::actuator_test::Place;
use sophie_control::pilot::rc::ArmChoice;
use sophie_ports::retained::StartCause;
use sophie_tasks::links::Links;
use sophie_tasks::links::link::Stamped;
use sophie_tasks::links::messages::ArmAngles;
use sophie_tasks::links::tendon_order::{TendonForce, TendonForces, TendonOrder};
use sophie_tasks::perching::servos;
use sophie_tasks::schedule::timing::Quantity;
use sophie_tasks::start::Start;
use sophie_tasks::start::retained_state::RetainedState;

use crate::rig::{Rig, calibrated};
use sophie_fakes::FakeServos;

const CLOSED: f32 = -1.2;

fn started(start: Start) -> (Rig, FakeServos) {
    started_with(calibrated(), start)
}

fn started_with(params: Params, start: Start) -> (Rig, FakeServos) {
    let (rig, port) = (Rig::starting(params, start), FakeServos::default());
    rig.time.spawn(servos::run(rig.links, port.clone()));
    (rig, port)
}

/// Pulse of `angle` (rad), µs: 550 to 2450 µs are 4.71 rad.
fn pulse(angle: f32) -> f32 {
    550.0 + 1900.0 * angle / 4.71
}

fn speak(links: &Links, at: Instant, forces: Option<TendonForces>, tilt: f32) {
    if let Some(forces) = forces {
        links.tendons.send(at, TendonOrder::Measured(forces));
    }
    links.arms.send(at, ArmAngles::at(at, [Some(tilt); 4]));
}

fn forces(force: f32, wound_at_power_on: bool) -> TendonForces {
    TendonForces {
        arms: [TendonForce {
            force,
            stiffness: 1.0,
            hold_position: false,
        }; 4],
        wound_at_power_on,
    }
}

fn near(pulses: PerArm<f32>, expected: f32) -> bool {
    pulses.iter().all(|p| (p - expected).abs() < 1.0)
}

#[test]
fn a_servo_without_marks_gets_a_pulse_on_the_bench_alone() {
    let blank = |links: &Links| links.hardware().contains(ArmingInhibit::ServoUnmarked);
    let (mut rig, port) = started_with(Params::default(), Start::COLD);
    for order in [forces(0.0, false), forces(60.0, false), forces(60.0, true)] {
        rig.run_with(1000, |links, at| speak(links, at, Some(order), CLOSED));
    }
    // Stale ones neither.
    rig.run(1000);
    assert!(port.pulses.borrow().iter().all(|p| *p == [0.0; 4]) && blank(rig.links));
    // The one on the bench, at once and alone.
    port.pulses.borrow_mut().clear();
    let place = Place {
        servo: 2,
        pulse_us: 1500.0,
    };
    rig.run_with(500, |links, at| {
        let forces = forces(0.0, false);
        links.tendons.send(at, TendonOrder::Placed { forces, place });
    });
    let pulses = port.pulses.borrow().clone();
    let placed = [0.0, 0.0, 1500.0, 0.0];
    assert!(
        pulses.len() == 25 && pulses[2..].iter().all(|p| *p == placed),
        "{pulses:?}"
    );
    rig.run_with(100, |links, at| {
        speak(links, at, Some(forces(0.0, false)), CLOSED)
    });
    assert_eq!(port.now(), [0.0; 4]);

    // Those that have theirs are driven beside those that do not, and arming waits for all.
    for (servo_marks, expected) in [
        (ServoMarks::S13, [550.0, 0.0, 550.0, 0.0]),
        (ServoMarks::S1234, [550.0; 4]),
    ] {
        let params = Params {
            servo_marks,
            ..Params::default()
        };
        let (mut rig, port) = started_with(params, Start::COLD);
        rig.run_with(200, |links, at| {
            speak(links, at, Some(forces(0.0, false)), CLOSED)
        });
        assert_eq!(port.now(), expected);
        assert_eq!(blank(rig.links), servo_marks != ServoMarks::S1234);
    }
}

#[test]
fn frames_come_at_the_servos_rate() {
    assert_eq!(servos::period(50.0).as_micros(), 20_000);
    assert_eq!(servos::period(333.0).as_micros(), 3003);
    let (mut rig, port) = started(Start::COLD);
    rig.run(999);
    assert_eq!(port.pulses.borrow().len(), 50);
}

#[test]
fn tendons_wound_at_power_on_pay_out_slowly_from_where_they_are_taut() {
    // Just taut at -1.2 rad: 15 mm/15 mm·(0.4 + 1.2) = 1.6 rad, 1195 µs; from there 3 rad/s, 0.06 rad a frame.
    let (mut rig, port) = started(Start::COLD);
    rig.run_with(100, |links, at| speak(links, at, None, CLOSED));
    assert!(
        port.pulses.borrow().iter().all(|p| *p == [0.0; 4]),
        "a pulse before it is told"
    );
    port.pulses.borrow_mut().clear();
    rig.run_with(1200, |links, at| {
        speak(links, at, Some(forces(0.0, true)), CLOSED)
    });
    let pulses = port.pulses.borrow();
    for (frame, pulses) in pulses.iter().enumerate() {
        let angle = (1.6 - 0.06 * (frame + 1) as f32).max(0.0);
        assert!(
            near(*pulses, pulse(angle)),
            "frame {frame}: {pulses:?}, {}",
            pulse(angle)
        );
    }
    // Home for good after 0.53 s, though the tendons are still reported as wound.
    assert!(pulses.len() == 60 && near(pulses[59], 550.0));
}

#[test]
fn tendons_not_wound_at_power_on_are_at_release_from_the_first_pulse_on() {
    let (mut rig, port) = started(Start::COLD);
    rig.run_with(200, |links, at| {
        speak(links, at, Some(forces(0.0, false)), CLOSED)
    });
    let mut pulses = port.pulses.borrow().clone();
    pulses.retain(|p| *p != [0.0; 4]);
    assert!(
        pulses.len() >= 9 && pulses.iter().all(|p| near(*p, 550.0)),
        "{pulses:?}"
    );
}

#[test]
fn forces_wind_at_nine_tenths_of_the_servos_speed_and_old_ones_hold() {
    let (mut rig, port) = started(Start::COLD);
    // At 0 N 0.9·6.16 = 5.54 rad/s: 1.66 rad in 15 frames; at -1.2 rad the tendon is hardly taut.
    rig.run_with(301, |links, at| {
        speak(links, at, Some(forces(60.0, false)), CLOSED)
    });
    let angle = rig.links.reel_angle.fresh().unwrap();
    assert!(
        angle.iter().all(|a| (a - 15.5 * 0.1109).abs() < 0.06),
        "{angle:?}"
    );
    // Takes up 1.6 rad and stretches by 60 N/(8 kN/m)/15 mm = 0.5 rad.
    rig.run_with(2000, |links, at| {
        speak(links, at, Some(forces(60.0, false)), CLOSED)
    });
    assert!(near(port.now(), pulse(2.1)), "{:?}", port.now());
    let tension = rig.links.tension.fresh().unwrap();
    assert!(tension.iter().all(|t| (t - 60.0).abs() < 0.5), "{tension:?}");
    rig.run_with(250, |links, at| speak(links, at, None, CLOSED));
    let held = port.now();
    rig.run_with(1000, |links, at| speak(links, at, None, -0.6));
    assert_eq!(port.now(), held);
    assert!(rig.links.tension.fresh().is_some());
}

#[test]
fn an_arm_that_holds_position_ignores_its_force() {
    let (mut rig, port) = started(Start::COLD);
    rig.run_with(2000, |links, at| {
        speak(links, at, Some(forces(60.0, false)), CLOSED)
    });
    let mut order = forces(0.0, false);
    for (arm, hold_position) in order.arms.iter_mut().zip([false, true, false, true]) {
        arm.hold_position = hold_position;
    }
    rig.run_with(2000, |links, at| speak(links, at, Some(order), CLOSED));
    let [a, b, c, d] = port.now();
    assert!(
        near([a, c, a, c], 550.0) && near([b, d, b, d], pulse(2.1)),
        "{:?}",
        port.now()
    );
}

#[test]
fn after_a_restart_the_drives_go_on_where_they_were_unless_only_the_gears_know() {
    for (grip_memory, first) in [
        (GripMemory::Controlled(ArmChoice::All), pulse(2.0)),
        (GripMemory::Open, pulse(2.0)),
        (GripMemory::HeldByGears(ArmChoice::All), 550.0),
    ] {
        let retained = RetainedState {
            grip_memory,
            angle: [2.0; 4],
            ..RetainedState::default()
        };
        let (mut rig, port) = started(Start {
            cause: StartCause::Watchdog,
            retained: Some(retained),
            sequence: 1,
        });
        let order = TendonForces {
            arms: [TendonForce {
                force: 0.0,
                stiffness: 1.0,
                hold_position: true,
            }; 4],
            wound_at_power_on: false,
        };
        rig.run_with(30, |links, at| speak(links, at, Some(order), CLOSED));
        assert!(near(port.now(), first), "{grip_memory:?}: {:?}", port.now());
    }
}

/// A resumed grip goes on from this tension: by the stiffness as told it would be wound 1 / 0.3 times as tight.
#[test]
fn a_servo_that_is_held_reads_the_tension_of_the_learnt_stiffness() {
    let tension = |stiffness: f32, order: fn(TendonForces) -> TendonOrder| {
        let retained = RetainedState {
            grip_memory: GripMemory::Controlled(ArmChoice::All),
            angle: [2.0; 4],
            ..RetainedState::default()
        };
        let (mut rig, _) = started(Start {
            cause: StartCause::Watchdog,
            retained: Some(retained),
            sequence: 1,
        });
        let forces = TendonForces {
            arms: [TendonForce {
                force: 50.0,
                stiffness,
                hold_position: true,
            }; 4],
            wound_at_power_on: false,
        };
        rig.run_with(200, |links, at| {
            links.arms.send(at, ArmAngles::at(at, [Some(CLOSED); 4]));
            links.tendons.send(at, order(forces));
        });
        let [first, ..] = rig.links.tension.fresh().unwrap();
        first
    };
    for order in [
        TendonOrder::Measured as fn(TendonForces) -> TendonOrder,
        TendonOrder::Resumed,
    ] {
        let (told, learnt) = (tension(1.0, order), tension(0.3, order));
        assert!(
            told > 10.0 && (learnt / told - 0.3).abs() < 0.01,
            "{told} {learnt}"
        );
    }
}

/// Each 10 ms an order for pressures `age` ms old; `servos` reads it 0.9 ms later.
fn ordered(rig: &mut Rig, ms: u64, age: u64, order: fn(TendonForces) -> TendonOrder) {
    rig.run_with(ms, |links, at| {
        links.arms.send(at, ArmAngles::at(at, [Some(CLOSED); 4]));
        if at.as_millis() % 10 == 0 && at.as_millis() >= age {
            links
                .tendons
                .send(at - Duration::from_millis(age), order(forces(60.0, false)));
        }
    });
}

#[test]
fn the_time_from_conversion_to_pulse_is_recorded_once_for_each_conversion_that_becomes_a_pulse() {
    let (mut rig, port) = started(Start::COLD);
    // Each pulse begins 0.5 ms after the write, which takes 20 us.
    port.frame_us.set(500);
    ordered(&mut rig, 1000, 1, TendonOrder::Measured);
    let timing = rig.links.timing.contact();
    // Frames of 20 ms to 980 ms overtake the orders in between.
    assert_eq!((timing.runs, timing.overruns), (49, 0));
    // To the frame after the clamp's step, for a just missed conversion.
    assert_eq!(timing.deadline_us, 3500);
    let take = |quantity| rig.links.timing.take_contact_histogram(quantity);
    let [late, frame, all] = [Quantity::Lateness, Quantity::Execution, Quantity::Response].map(take);
    assert_eq!((late.min(), late.max()), (1900, 1900));
    assert_eq!((frame.min(), frame.max()), (520, 520));
    assert_eq!((all.min(), all.max(), all.count()), (2420, 2420, 49));
    rig.run_with(100, |links, at| speak(links, at, None, CLOSED));
    assert_eq!(rig.links.timing.contact().runs, 50);
}

#[test]
fn frames_out_of_the_clamps_phase_have_a_longer_deadline() {
    for (hz, us) in [
        (50.0, 3500),
        (100.0, 3500),
        (200.0, 3500),
        (333.0, 6503),
        (60.0, 20_167),
    ] {
        assert_eq!(
            servos::chain_deadline(servos::period(hz)).as_micros(),
            us,
            "{hz} Hz"
        );
    }
}

#[test]
fn a_pulse_that_comes_too_late_is_a_missed_deadline() {
    for (age, missed) in [(2, 0), (3, 1), (190, 1)] {
        let (mut rig, port) = started(Start::COLD);
        port.frame_us.set(480);
        rig.run(210);
        ordered(&mut rig, 20, age, TendonOrder::Measured);
        let timing = rig.links.timing.contact();
        assert_eq!((timing.runs, timing.overruns), (1, missed), "{age} ms");
        assert_eq!(u64::from(timing.worst_response_us), 1000 * age + 1400);
    }
}

#[test]
fn forces_that_follow_from_no_pressure_are_obeyed_and_not_measured() {
    for (order, winds) in [
        (TendonOrder::Blind as fn(TendonForces) -> TendonOrder, true),
        (TendonOrder::Resumed, false),
    ] {
        let (mut rig, port) = started(Start::COLD);
        ordered(&mut rig, 500, 4, order);
        assert_eq!(rig.links.timing.contact().runs, 0);
        assert_eq!(port.now()[0] > 1000.0, winds, "{:?}", port.now());
    }
}

#[test]
fn forces_of_old_pressures_hold_although_they_were_sent_just_now() {
    let (mut rig, port) = started(Start::COLD);
    ordered(&mut rig, 300, 4, TendonOrder::Measured);
    let held = port.now();
    assert!(held[0] > 1000.0, "{held:?}");
    // Fresh orders for pressures 201 ms old.
    ordered(&mut rig, 20, 201, TendonOrder::Measured);
    let held = port.now();
    let runs = rig.links.timing.contact().runs;
    ordered(&mut rig, 300, 201, TendonOrder::Measured);
    assert_eq!(port.now(), held);
    assert_eq!(rig.links.timing.contact().runs, runs);
}

#[test]
fn the_tension_is_as_old_as_the_oldest_tilt_in_it() {
    let (mut rig, _) = started(Start::COLD);
    rig.run_with(101, |links, at| {
        links.tendons.send(at, TendonOrder::Measured(forces(60.0, false)));
        let mut angles = ArmAngles::at(at, [Some(CLOSED); 4]);
        angles.tilt[2] = (at.as_millis() > 30).then(|| Stamped {
            at: at - Duration::from_millis(30),
            value: CLOSED,
        });
        links.arms.send(angles.oldest().unwrap(), angles);
    });
    assert_eq!(rig.links.tension.latest().unwrap().at.as_millis(), 70);
}
