use super::*;
use crate::plant::STEP as DT;

fn run(t: &mut Tendon, pulse: f64, alpha: f64, seconds: f64) -> f64 {
    (0..(seconds / DT) as u64).fold(0.0, |_, _| t.step(DT, 1.0, pulse, alpha))
}

#[test]
fn a_torn_tendon_pulls_nothing_and_a_stuck_servo_stays() {
    let taut = |broken| {
        let mut t = paper().breaking(broken, 1.0);
        run(&mut t, 1500.0, 0.0, 0.9);
        let pulled = t.tension();
        run(&mut t, 1500.0, 0.0, 0.2);
        let held = (pulled, t.servo_angle());
        run(&mut t, 1000.0, 0.0, 0.9);
        (held, (t.tension(), t.servo_angle()))
    };
    let ((pulled, at), (after, then)) = taut(Some(TendonBreak::Torn));
    assert!(pulled > 1.0 && after == 0.0 && then < at);
    let ((pulled, at), (after, then)) = taut(Some(TendonBreak::Stuck));
    assert!(
        (after / pulled - 1.0).abs() < 0.05 && (then - at).abs() < 0.3,
        "{pulled} {after} {at} {then}"
    );
    let ((_, at), (_, then)) = taut(None);
    assert!(at - then > 0.5);
}

fn paper() -> Tendon {
    Tendon::new(ServoProfile::Paper.into(), TendonSpec::default())
}

#[test]
fn a_released_tendon_is_slack_in_flight_and_at_rest() {
    let mut t = paper();
    for alpha in [-0.55, -0.2, 0.0, 0.35] {
        assert!(
            run(&mut t, 550.0, alpha, 0.2) == 0.0 && t.tension() == 0.0,
            "{alpha}"
        );
    }
}

#[test]
fn the_tension_by_hand() {
    // 1150/1900 · 4.71 rad = 2.85079 rad on 15 mm are 42.762 mm; at -1 rad 25 mm · 1.4 = 35 mm are taken up: 7.762
    // mm of stretch, 62.09 N, 1.552 N·m on the arm, 0.931 N·m on the servo.
    let mut t = paper();
    let moment = run(&mut t, 1700.0, -1.0, 3.0);
    assert!(
        (t.tension() - 62.09).abs() < 0.02 && (moment + 1.5523).abs() < 1e-3,
        "{}",
        t.tension()
    );
    assert!((t.servo_torque() - 0.9314).abs() < 1e-3);
}

#[test]
fn a_servo_obeys_pulses_between_its_marks() {
    let spec = ServoSpec::from(ServoProfile::Paper).marked(2330.0, 830.0, 333.0);
    assert!((spec.frame - 3.003e-3).abs() < 1e-6);
    let mut t = Tendon::new(spec, TendonSpec::default());
    // Half of 2330 to 830 µs is half the travel.
    for (pulse, angle) in [(2330.0, 0.0), (1580.0, 2.355), (1581.5, 2.355), (830.0, 4.71)] {
        run(&mut t, pulse, -2.5, 1.0);
        assert!(
            (t.servo_angle() - angle).abs() < 1e-3,
            "{pulse}: {}",
            t.servo_angle()
        );
    }
}

#[test]
fn the_servo_takes_its_time() {
    let mut t = paper();
    // 4.71 rad at 6.16 rad/s, slack tendon: 0.765 s and a frame.
    run(&mut t, 2450.0, -2.5, 0.74);
    assert!(t.servo_angle() < 4.6);
    run(&mut t, 2450.0, -2.5, 0.1);
    assert!((t.servo_angle() - 4.71).abs() < 1e-6);
}

#[test]
fn a_weak_servo_stalls_below_its_target() {
    let mut t = Tendon::new(ServoProfile::Mg996r.into(), TendonSpec::default());
    run(&mut t, 2450.0, 0.0, 5.0);
    assert!((t.servo_torque() - 0.922).abs() < 1e-3 && t.servo_angle() < 3.0);
}

#[test]
fn without_pulses_the_gears_hold_and_slip_under_too_much() {
    let mut t = paper();
    run(&mut t, 1700.0, -1.0, 3.0);
    let angle = t.servo_angle();
    run(&mut t, 0.0, -1.0, 3.0);
    assert!((t.servo_angle() - angle).abs() < 1e-12);
    // The arm is forced up: gears slip beyond 0.35 · 3.432 N·m.
    run(&mut t, 0.0, -0.6, 3.0);
    assert!(t.servo_angle() < angle && (t.servo_torque() - 1.2012).abs() < 1e-2);
}

#[test]
fn changes_within_the_deadband_are_ignored() {
    let mut t = paper();
    run(&mut t, 1500.0, -2.0, 2.0);
    let angle = t.servo_angle();
    run(&mut t, 1501.5, -2.0, 1.0);
    assert!((t.servo_angle() - angle).abs() < 1e-12);
    run(&mut t, 1503.0, -2.0, 1.0);
    assert!(t.servo_angle() > angle);
}

fn with_errors(errors: ServoErrors) -> Tendon {
    let servo = ServoSpec {
        errors,
        ..ServoProfile::Paper.into()
    };
    Tendon::new(servo, TendonSpec::default())
}

fn with_spec(friction: f64, creep: f64) -> Tendon {
    let spec = TendonSpec {
        friction,
        creep,
        ..TendonSpec::default()
    };
    Tendon::new(ServoProfile::Paper.into(), spec)
}

#[test]
fn a_rubbing_thread_pulls_the_arm_less_on_the_way_in_and_more_on_the_way_out() {
    let mut t = with_spec(0.4, 0.0);
    let moment = run(&mut t, 1700.0, -1.0, 3.0);
    // The reel pulls with the 62.09 N of a smooth thread; the arm gets (1 - exp(-0.4))/0.4 of the
    // most that it pulled, 1.5 N of damping more.
    let share = moment / (-0.025 * t.tension());
    assert!(
        (t.tension() - 62.09).abs() < 0.02 && (0.82..0.84).contains(&share),
        "{share}"
    );
    // Unwound: the arm is eased late, and gets up to (exp(0.4) - 1)/0.4 of what the reel pulls in the end.
    let (wound, pulled) = (moment, t.tension());
    let eased = run(&mut t, 1670.0, -1.0, 1.0) / wound;
    assert!(eased > 0.93 && t.tension() < 0.86 * pulled, "{eased}");
    let moment = run(&mut t, 1570.0, -1.0, 1.0);
    let share = moment / (-0.025 * t.tension());
    assert!((1.15..1.23).contains(&share), "{share}");
}

#[test]
fn a_creeping_thread_lets_a_held_grip_go_slowly() {
    let pull = |creep: f64, seconds: f64| {
        let mut t = with_spec(0.0, creep);
        run(&mut t, 1700.0, -1.0, seconds);
        t.tension()
    };
    // 4 % a decade: from 3 s to 103 s 1.4 decades after the first second.
    let (early, late) = (pull(0.04, 3.0), pull(0.04, 103.0));
    assert!((1.0 - late / early - 0.055).abs() < 0.012, "{early} {late}");
    assert!((pull(0.0, 3.0) - pull(0.0, 103.0)).abs() < 1e-9);
}

#[test]
fn a_servo_with_a_stop_error_stands_anywhere_within_it() {
    let band = 1.0_f64.to_radians();
    let mut t = with_errors(ServoErrors {
        stop: band,
        ..ServoErrors::default()
    });
    // 1 us is 0.142 deg: seven of them are within the band, eight beyond.
    let angle = |us: f64| (us - 550.0) / 1900.0 * 4.71;
    run(&mut t, 1500.0, -2.5, 2.0);
    let stands = t.servo_angle();
    assert!((stands - angle(1500.0)).abs() <= 0.21 * band, "{stands}");
    let mut moved = 0;
    for us in 1..=40 {
        let (before, pulse) = (t.servo_angle(), 1500.0 + f64::from(us));
        run(&mut t, pulse, -2.5, 0.2);
        assert!((t.servo_angle() - angle(pulse)).abs() <= 1.001 * band);
        moved += i32::from(t.servo_angle() != before);
    }
    assert!((4..=8).contains(&moved), "{moved}");
}

#[test]
fn a_loaded_servo_gives_way_and_a_warm_day_moves_its_zero() {
    let errors = ServoErrors {
        backlash: 1.0_f64.to_radians(),
        sag: 1.5_f64.to_radians(),
        ..ServoErrors::default()
    };
    let (mut stiff, mut soft) = (paper(), with_errors(errors));
    run(&mut stiff, 1700.0, -1.0, 3.0);
    run(&mut soft, 1700.0, -1.0, 3.0);
    let given = 1.0_f64.to_radians() + 1.5_f64.to_radians() * soft.servo_torque();
    assert!((stiff.servo_angle() - soft.servo_angle() - given).abs() < 1e-6);
    // Of the reel's 15 mm and 8 kN/m: 120 N a radian.
    assert!((stiff.tension() - soft.tension() - 120.0 * given).abs() < 0.01);
    let mut warm = with_errors(ServoErrors {
        zero: 0.02,
        ..ServoErrors::default()
    });
    run(&mut warm, 1700.0, -1.0, 3.0);
    assert!((warm.tension() - stiff.tension() - 2.4).abs() < 0.01);
}

#[test]
fn an_overheated_servo_lets_its_arm_go() {
    let servo = ServoSpec {
        errors: ServoErrors {
            heat: 400.0,
            air: 23.0,
            ..ServoErrors::default()
        },
        ..ServoProfile::Mg996r.into()
    };
    let mut t = Tendon::new(servo, TendonSpec::default());
    run(&mut t, 1542.0, -0.4, 5.0);
    let held = t.servo_torque();
    // 0.6 of the stall: 144 K in the end.
    assert!((0.55..0.65).contains(&(held / 0.922)), "{held}");
    run(&mut t, 1542.0, -0.4, 400.0);
    assert!((t.servo_torque() - held).abs() < 1e-3, "{}", t.servo_torque());
    run(&mut t, 1542.0, -0.4, 400.0);
    // The gears alone: 0.35 of the stall.
    assert!(
        (t.servo_torque() / 0.922 - 0.35).abs() < 0.01,
        "{}",
        t.servo_torque()
    );
}

#[test]
fn every_servo_and_thread_comes_to_rest() {
    for stiffness in [1000.0, 8000.0, 20_000.0] {
        for friction in [0.0, 1.0] {
            let servo = ServoSpec {
                errors: ServoErrors {
                    stop: 3.0_f64.to_radians(),
                    backlash: 3.0_f64.to_radians(),
                    sag: 5.0_f64.to_radians(),
                    ..ServoErrors::default()
                },
                ..ServoProfile::Paper.into()
            };
            let spec = TendonSpec {
                stiffness,
                friction,
                ..TendonSpec::default()
            };
            let mut t = Tendon::new(servo, spec);
            run(&mut t, 1600.0, -1.0, 3.0);
            let pull = t.tension();
            let swing = (0..2000).fold(0.0_f64, |most, _| {
                t.step(DT, 1.0, 1600.0, -1.0);
                most.max((t.tension() - pull).abs())
            });
            assert!(
                pull > 0.5 && swing < 0.01 * pull,
                "{stiffness} {friction}: {pull} {swing}"
            );
        }
    }
}
