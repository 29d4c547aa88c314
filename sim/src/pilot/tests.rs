//! The pilot alone, on a simple vehicle.

use glam::{DVec2, DVec3};
use sophie_control::mode::Mode;

use super::toy::Toy;
use super::*;
use crate::scenario::World;

fn scenario(seed: u64, steps: &[Step]) -> Scenario {
    let mut s = Scenario {
        seed,
        steps: steps.to_vec(),
        ..Scenario::default_mission()
    };
    s.world = World {
        gust_force: 0.1,
        pipe_diameter: 0.3,
        pipe_top: 1.5,
        pipe_position: [3.0, 0.0],
        ..s.world
    };
    s
}

const UP: [Step; 2] = [Step::Arm, Step::TakeOff { height: 3.0 }];

fn with(steps: &[Step]) -> Vec<Step> {
    UP.iter().chain(steps).cloned().collect()
}

#[test]
fn a_hover_stays_within_15_cm_rms_in_light_gusts_and_steady_wind() {
    for (seed, wind) in [(1, 0.0), (2, 0.0), (3, 0.5)] {
        let s = scenario(seed, &with(&[Step::Hover { seconds: 90.0 }]));
        let mut toy = Toy::new(&s);
        toy.wind = DVec3::new(0.7 * wind, -0.7 * wind, 0.0);
        let (mut sum, mut count, mut spot, mut began) = (DVec3::ZERO, 0.0, DVec3::ZERO, 0.0);
        toy.fly(120.0, |toy, out| {
            if out.events.contains(&StepEvent::Began(2)) {
                (spot, began) = (toy.seen.position, toy.seen.t);
            }
            // After the wind is trimmed out.
            if began > 0.0 && toy.seen.t > began + 15.0 {
                let e = toy.seen.position - spot;
                sum += e * e;
                count += 1.0;
            }
        });
        assert!(
            toy.pilot.outcome().unwrap().accomplished,
            "{:?}",
            toy.pilot.outcome()
        );
        let rms = (sum / count).map(f64::sqrt);
        println!("wind {wind} N: {rms:.3}");
        assert!(rms.truncate().length() < 0.15 && rms.z < 0.08, "{rms}");
    }
}

/// 1.4 m/s²: the drag of a vehicle of the campaigns in 6 m/s. Gains alone stand 1 m off, too far to learn the trim as on
/// the way; with the trim he stays within half of that.
#[test]
fn a_strong_wind_is_leaned_against_from_afar() {
    let s = scenario(3, &with(&[Step::Hover { seconds: 60.0 }]));
    let mut toy = Toy::new(&s);
    toy.wind = DVec3::new(0.0, -1.4 * f64::from(s.params.mass), 0.0);
    let (mut spot, mut began, mut farthest) = (DVec3::ZERO, 0.0, 0.0_f64);
    toy.fly(120.0, |toy, out| {
        if out.events.contains(&StepEvent::Began(2)) {
            (spot, began) = (toy.seen.position, toy.seen.t);
        }
        if began > 0.0 && toy.seen.t > began + 30.0 {
            farthest = farthest.max((toy.seen.position - spot).length());
        }
    });
    assert!(farthest > 0.0 && farthest < 0.5, "{farthest}");
}

/// As the pipe's ground effect does: he is astray again and again at the gate.
#[test]
fn a_pipe_that_pushes_the_vehicle_off_its_crown_is_touched() {
    let touched = (1..9).filter(|seed| {
        let s = scenario(*seed, &with(&[Step::FlyToPipe, Step::Touch]));
        let mut toy = Toy::new(&s);
        toy.push_off = 6.0;
        toy.fly(300.0, |_, _| ());
        println!("{seed}: {:.0} s, {:?}", toy.seen.t, toy.pilot.outcome());
        toy.pilot.outcome().unwrap().accomplished
    });
    let touched = touched.count();
    assert!(touched >= 6, "{touched} of 8");
}

#[test]
fn a_step_of_3_m_settles() {
    let s = scenario(
        4,
        &with(&[Step::FlyTo {
            north: 3.0,
            east: 0.0,
            height: 3.0,
        }]),
    );
    let mut toy = Toy::new(&s);
    let (mut began, mut last_out, mut worst) = (0.0, 0.0, f64::MIN);
    toy.fly(60.0, |toy, out| {
        if out.events.contains(&StepEvent::Began(2)) {
            began = toy.seen.t;
        }
        let off = (toy.seen.position.truncate() - DVec2::new(3.0, 0.0)).length();
        if began > 0.0 && off > 0.3 {
            last_out = toy.seen.t - began;
        }
        worst = worst.max(toy.seen.position.x);
    });
    println!("settled after {last_out:.1} s, farthest {worst:.2} m");
    assert!(
        toy.pilot.outcome().unwrap().accomplished,
        "{:?}",
        toy.pilot.outcome()
    );
    assert!(last_out < 6.5 && worst < 3.3, "{last_out} s, {worst} m");
}

#[test]
fn the_nose_turns_to_any_heading_stays_there_and_is_back_at_the_pipe() {
    let degrees = f64::to_radians;
    for heading in [90.0, -170.0] {
        let yaw = Step::Yaw {
            heading: degrees(heading),
            seconds: 3.0,
        };
        let away = Step::FlyTo {
            north: 1.0,
            east: 1.0,
            height: 3.0,
        };
        let s = scenario(6, &with(&[yaw, away, Step::FlyToPipe, Step::Touch]));
        let mut toy = Toy::new(&s);
        let (mut step, mut turned, mut kept, mut farthest) = (0, false, 0.0_f64, 0.0_f64);
        toy.fly(120.0, |toy, out| {
            step = out.step;
            let off = wrap(toy.seen.yaw - degrees(heading)).abs();
            turned |= step == 2 && off < degrees(5.0);
            if step == 2 {
                farthest = farthest.max(toy.seen.position.truncate().length());
            }
            if step == 3 {
                kept = kept.max(off);
            }
        });
        let outcome = toy.pilot.outcome().unwrap();
        assert!(outcome.accomplished, "{heading}: {outcome:?}");
        assert!(
            turned && kept < degrees(8.0) && farthest < 0.6,
            "{kept} {farthest}"
        );
        assert!(toy.seen.yaw.abs() < degrees(5.0), "{}", toy.seen.yaw);
    }
}

#[test]
fn the_touch_is_within_6_cm_of_the_crown() {
    let mut worst: f64 = 0.0;
    for seed in 10..22 {
        let s = scenario(seed, &with(&[Step::FlyToPipe, Step::Touch]));
        let mut toy = Toy::new(&s);
        toy.fly(200.0, |_, _| ());
        assert!(
            toy.pilot.outcome().unwrap().accomplished,
            "{seed}: {:?}",
            toy.pilot.outcome()
        );
        assert!((toy.seen.position.z + 1.54).abs() < 0.03, "on the pipe");
        worst = worst.max(toy.seen.position.y.abs());
    }
    println!("worst {worst:.3} m");
    assert!(worst <= 0.06, "{worst}");
}

#[test]
fn the_whole_mission_passes_the_modes_in_order() {
    let steps = with(&[
        Step::Hover { seconds: 3.0 },
        Step::Roll {
            angle: 0.436,
            seconds: 2.5,
        },
        Step::FlyToPipe,
        Step::Touch,
        Step::Perch { throttle: 0.3 },
        Step::Hold {
            seconds: 5.0,
            push: 0.0,
            lapse: 0.0,
        },
        Step::Release,
        Step::FlyTo {
            north: 0.0,
            east: 0.0,
            height: 2.0,
        },
        Step::Land,
        Step::Disarm,
    ]);
    for (seed, strength) in [(30, 1.0), (31, 0.93), (32, 1.07)] {
        let s = scenario(seed, &steps);
        let mut toy = Toy::new(&s);
        toy.strength = strength;
        let (mut modes, mut ended, mut leant) = (Vec::new(), 0, 0.0f64);
        toy.fly(300.0, |toy, out| {
            if modes.last() != Some(&toy.out.mode) {
                modes.push(toy.out.mode);
            }
            for event in &out.events {
                println!("{:6.1} {event:?}", toy.seen.t);
                ended += usize::from(matches!(event, StepEvent::Ended { done: true, .. }));
            }
            if out.step == 3 {
                leant = leant.max(toy.seen.roll.abs());
            }
        });
        println!("{:?} {modes:?}", toy.pilot.outcome());
        assert!(toy.pilot.outcome().unwrap().accomplished);
        assert_eq!(ended, steps.len());
        assert!((0.34..0.46).contains(&leant), "leant by {leant}");
        use Mode::*;
        let order = [
            Calibrating,
            Disarmed,
            Armed,
            Flight,
            Contact,
            Clamping,
            Perched,
            Releasing,
            Flight,
            Landed,
            Disarmed,
        ];
        assert_eq!(modes, order);
    }
}

#[test]
fn a_grip_that_is_not_proven_fails_the_mission_and_names_the_reason() {
    let s = scenario(
        40,
        &with(&[Step::FlyToPipe, Step::Touch, Step::Perch { throttle: 0.3 }]),
    );
    let mut toy = Toy::new(&s);
    toy.pressure = 600.0;
    toy.fly(200.0, |_, _| ());
    let outcome = toy.pilot.outcome().unwrap();
    assert!(!outcome.accomplished);
    assert!(
        outcome.reason.starts_with("perch: no proven grip"),
        "{}",
        outcome.reason
    );
}

#[test]
fn a_vehicle_that_spins_has_lost_yaw_and_one_too_weak_does_not_get_up() {
    let s = scenario(50, &with(&[Step::Hover { seconds: 30.0 }]));
    let mut toy = Toy::new(&s);
    toy.fly(60.0, |_, _| ());
    assert!(toy.pilot.outcome().unwrap().accomplished);
    let mut toy = Toy::new(&s);
    toy.spin = 1.0;
    toy.fly(60.0, |_, _| ());
    let reason = &toy.pilot.outcome().unwrap().reason;
    assert!(reason.contains("lost yaw"), "{reason}");
    let mut toy = Toy::new(&s);
    toy.strength = 0.5;
    toy.fly(60.0, |_, _| ());
    let reason = &toy.pilot.outcome().unwrap().reason;
    assert!(
        reason.starts_with("take-off: not done after 24 s: height 0.0"),
        "{reason}"
    );
}

#[test]
fn a_vehicle_on_the_wrong_side_of_the_referee_is_lost() {
    let mut referee = referee::Referee::default();
    let good = VisibleState::default();
    assert_eq!(referee.judge(&good, 0.0, 0.01), None);
    let lost = [
        (VisibleState { roll: 1.5, ..good }, "tipped over"),
        (
            VisibleState {
                position: DVec3::new(0.0, 0.0, 0.6),
                ..good
            },
            "height -0.60 m",
        ),
        (
            VisibleState {
                position: DVec3::new(31.0, 0.0, -2.0),
                ..good
            },
            "31 m away",
        ),
        (
            VisibleState {
                position: DVec3::NAN,
                ..good
            },
            "no number",
        ),
    ];
    for (seen, words) in lost {
        let why = referee.judge(&seen, 0.0, 0.01).unwrap();
        assert!(why.contains(words), "{why}");
    }
}

#[test]
fn frames_come_150_times_a_second_and_one_seed_gives_one_flight() {
    let fly = || {
        let s = scenario(60, &with(&[Step::Hover { seconds: 2.0 }]));
        let mut toy = Toy::new(&s);
        let mut bytes = Vec::new();
        for _ in 0..5000 {
            if let Some(frame) = toy.step().rc_bytes {
                bytes.extend_from_slice(&frame);
            }
        }
        bytes
    };
    let bytes = fly();
    assert!(
        (bytes.len() as i64 / 26 - 1500).abs() <= 1,
        "{}",
        bytes.len() / 26
    );
    assert!(bytes == fly());
}

#[test]
fn a_transmitter_that_is_off_sends_nothing_and_shows_nothing() {
    let s = scenario(
        61,
        &with(&[
            Step::Hover { seconds: 1.0 },
            Step::RadioOff { seconds: 2.0 },
            Step::Hover { seconds: 1.0 },
        ]),
    );
    let mut toy = Toy::new(&s);
    let (mut began, mut frames, mut shown) = (f64::NAN, 0, 0);
    toy.fly(60.0, |toy, out| {
        if out.events.contains(&StepEvent::Began(3)) {
            began = toy.seen.t;
        }
        if toy.seen.t > began + 0.01 && toy.seen.t < began + 1.99 {
            frames += u32::from(out.rc_bytes.is_some());
            shown += u32::from(toy.pilot.telemetry().mode.is_some());
        }
    });
    let outcome = toy.pilot.outcome().unwrap();
    assert!(began > 0.0 && outcome.accomplished, "{outcome:?}");
    assert_eq!((frames, shown), (0, 0));
}

#[test]
fn every_step_ends_on_a_failsafe_with_its_reason() {
    let mission = with(&[
        Step::Hover { seconds: 20.0 },
        Step::Roll {
            angle: 0.436,
            seconds: 2.5,
        },
        Step::FlyToPipe,
        Step::Touch,
        Step::Clamp { throttle: 0.3 },
        Step::Perch { throttle: 0.3 },
        Step::Hold {
            seconds: 5.0,
            push: 0.0,
            lapse: 0.0,
        },
        Step::Open,
        Step::Release,
        Step::FlyTo {
            north: 0.0,
            east: 0.0,
            height: 2.0,
        },
        Step::Land,
        Step::Disarm,
    ]);
    // Before arming no failsafe occurs.
    for (index, step) in mission.iter().enumerate().skip(1) {
        for why in ["battery critical", "radio lost"] {
            let mut toy = Toy::new(&scenario(1, &mission));
            let mut since = None;
            let mut took = f64::NAN;
            for _ in 0..(400.0 / toy::DT) as u64 {
                let out = toy.step();
                let began = out
                    .events
                    .contains(&StepEvent::Began(index))
                    .then_some(toy.seen.t);
                since = since.or(began);
                // On the ground rotors just stop; the take-off's failsafe is one in the air.
                let up = !matches!(step, Step::TakeOff { .. }) || toy.seen.position.z < -1.0;
                let due = up && since.is_some_and(|since| toy.seen.t > since + 0.3)
                    || toy.deaf
                    || toy.battery < 13.0;
                toy.battery = if due && why == "battery critical" {
                    12.0
                } else {
                    15.5
                };
                toy.deaf = due && why == "radio lost";
                if out.outcome.is_some() {
                    took = toy.seen.t - since.unwrap_or(f64::NAN);
                    break;
                }
            }
            let outcome = toy.pilot.outcome().cloned();
            let outcome = outcome.unwrap_or_else(|| panic!("{} goes on under {why}", step.name()));
            println!("{:12} {why:16} {took:5.1} s  {}", step.name(), outcome.reason);
            // A landing may end well; a perch is left only with a sound vehicle.
            let ends_well = matches!(step, Step::Land | Step::Disarm);
            assert!(
                outcome.accomplished || outcome.reason.contains(why),
                "{}: {}",
                step.name(),
                outcome.reason
            );
            assert!(
                ends_well || !outcome.accomplished,
                "{}: {}",
                step.name(),
                outcome.reason
            );
            if matches!(step, Step::Hold { .. } | Step::Open) {
                let words = format!("open: arms not opened, display PERCHED: {why}");
                assert!(
                    outcome.reason.contains(&words),
                    "{}: {}",
                    step.name(),
                    outcome.reason
                );
            }
            let flying = index < 6 || matches!(step, Step::FlyTo { .. });
            if !ends_well && flying {
                let words = format!(": failsafe, {why}: rotors stopped");
                assert!(
                    outcome.reason.contains(&words),
                    "{}: {}",
                    step.name(),
                    outcome.reason
                );
            }
            assert!(took < 35.0, "{}: {took:.1} s, {}", step.name(), outcome.reason);
        }
    }
}
