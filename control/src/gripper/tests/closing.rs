//! Approach, take-over of the tendon's force, resumption after a restart, release.

use super::*;

#[test]
fn the_approach_rises_with_the_arm_s_stiffness() {
    // Infill 6.9, K 7.75: 8.2210 °/N = 0.14348 rad/N; times 2 · 0.015/0.178: 0.024182 rad/N. 0.7 rad/s over that: 28.95
    // N/s.
    let cfg = config();
    assert!(close(cfg.bend_per_force, 0.024_182, 1e-5) && close(cfg.approach_rate, 28.95, 0.02));
    let mut arm = ArmGripper::default();
    let grip = run(&mut arm, &cfg, 0.0, 1.0);
    assert!(
        grip.state == ArmState::Closing && close(grip.force, 28.95, 1.1),
        "{grip:?}"
    );
}

#[test]
fn a_touch_takes_the_tendon_s_own_force_over_without_a_kick() {
    let cfg = config();
    let mut arm = ArmGripper::default();
    run(&mut arm, &cfg, 0.0, 1.5);
    let asked = arm.force;
    // The tendon lacks 12 N; the pressure jumps to 300 Pa.
    let mut last = asked;
    for _ in 0..50 {
        let i = ArmInput {
            tension: Some(asked - 12.0),
            ..input(&cfg, &arm, 300.0)
        };
        let force = arm.step(&cfg, &i, DT).force;
        assert!((force - last).abs() < 2.0, "{last} {force}");
        last = force;
    }
    // The surplus is gone (two filters at 25 rad/s, 0.5 s); the integral has added at most 0.05·650·0.5 = 16 N, 40 % of
    // it in the reference's first two time constants, and P 0.0035·560.
    assert!((-9.0..4.0).contains(&(last - asked)), "{}", last - asked);
}

#[test]
fn a_resumed_grip_goes_on_from_its_force_without_a_kick() {
    let cfg = config();
    let before = holding(&cfg).force;
    let mut arm = ArmGripper::resume(before, None, None);
    // The tilt precedes the drive's tension, 4 N more by the new attitude.
    let has = before + 4.0;
    for (pressure, tension, tilt, seconds, force, stays) in [
        (Pressure::Stale, None, None, 0.05, before, true),
        (Pressure::Known(960.0), Some(0.5), None, 0.1, before, true),
        (Pressure::Known(960.0), Some(0.5), Some(-1.2), 0.03, before, true),
        (Pressure::Known(960.0), Some(has), Some(-1.2), 0.15, before, true),
        (Pressure::Known(960.0), Some(has), Some(-1.2), 0.5, has, false),
    ] {
        for step in 0..(seconds / DT + 0.5) as u32 {
            let i = ArmInput {
                close: true,
                pressure,
                turn_on: 0.0,
                thrust: 0.0,
                tension,
                tilt,
            };
            let grip = arm.step(&cfg, &i, DT);
            if stays || step > 2 {
                assert!((grip.force - force).abs() < 0.5, "{} {force}", grip.force);
                assert!(matches!(arm.phase, Phase::Resume(_)) == stays);
            }
        }
    }
    assert!(run(&mut arm, &cfg, 950.0, 1.0).state == ArmState::Holding);
}

#[test]
fn a_resumed_arm_that_does_not_touch_goes_on_closing() {
    let cfg = config();
    let mut arm = ArmGripper::resume(30.0, None, None);
    let grip = run(&mut arm, &cfg, 0.0, 0.5);
    assert!(close(grip.force, 30.0 + 0.3 * 28.95, 1.0) && grip.state == ArmState::Closing);
    for _ in 0..100 {
        arm.step(&cfg, &released(input(&cfg, &arm, 0.0)), DT);
    }
    assert!(arm.force == 0.0);
}

#[test]
fn restart_after_restart_leaves_the_force_where_it_is() {
    let cfg = config();
    let before = holding(&cfg).force;
    let mut force = before;
    let unknown = ArmInput {
        close: true,
        ..ArmInput::default()
    };
    for _ in 0..200 {
        let mut arm = ArmGripper::resume(force, None, None);
        // 70 ms each, the first two steps without pressure.
        arm.step(&cfg, &unknown, DT);
        arm.step(&cfg, &unknown, DT);
        force = run(&mut arm, &cfg, 950.0, 0.05).force;
    }
    assert!((force - before).abs() < 0.5, "{before} {force}");
}

#[test]
fn a_stopped_rotor_is_fed_forward() {
    let cfg = config();
    // 0.55 · 0.178/0.015 = 6.527 N for each newton of thrust.
    assert!(close(cfg.per_thrust, 6.5267, 1e-3));
    let mut arm = ArmGripper::default();
    let step = |arm: &mut ArmGripper, pressure: f32, thrust: f32| {
        let i = ArmInput {
            thrust,
            ..input(&cfg, arm, pressure)
        };
        arm.step(&cfg, &i, DT).force
    };
    for _ in 0..200 {
        step(&mut arm, 0.0, 2.5);
    }
    for _ in 0..300 {
        step(&mut arm, 950.0, 2.5);
    }
    let before = arm.force;
    for _ in 0..100 {
        step(&mut arm, 950.0, 0.0);
    }
    assert!(close(before - arm.force, 16.32, 0.5), "{}", before - arm.force);
}

#[test]
fn the_integral_waits_at_the_limit() {
    let cfg = config();
    let mut arm = ArmGripper::default();
    run(&mut arm, &cfg, 0.0, 1.5);
    // 6.2 Pa/N give 830 Pa at the limit, which is reported.
    let mut grip = ArmGrip::default();
    for _ in 0..3000 {
        let pressure = 150.0 + 6.2 * scalar::clamp(arm.force - 52.0, 0.0, 1e3);
        grip = run(&mut arm, &cfg, pressure, DT);
    }
    assert!(
        grip.state == ArmState::ForceLimited && close(grip.force, cfg.limit, 1e-2),
        "{grip:?}"
    );
    // Leaves the limit at once, without 30 s of unwinding.
    assert!(run(&mut arm, &cfg, 1200.0, 0.3).force < cfg.limit - 2.0);
}

#[test]
fn a_servo_at_the_end_of_its_travel_is_reported_and_not_wound_up() {
    let cfg = config();
    let mut arm = holding(&cfg);
    let stuck = arm.force;
    let mut grip = ArmGrip::default();
    for _ in 0..1000 {
        let i = ArmInput {
            tension: Some(stuck),
            ..input(&cfg, &arm, 500.0)
        };
        grip = arm.step(&cfg, &i, DT);
    }
    assert!(
        grip.state == ArmState::ForceLimited && grip.force < stuck + LAG_MAX + 5.0,
        "{grip:?}"
    );
}

#[test]
fn release_falls_at_its_rate_and_ends_free() {
    let cfg = config();
    let mut arm = holding(&cfg);
    let from = arm.force;
    let mut time = 0.0;
    while arm.force > 0.0 {
        let i = input(&cfg, &arm, 500.0);
        assert!(arm.step(&cfg, &released(i), DT).state == ArmState::Releasing);
        time += DT;
        assert!(time < 5.0);
    }
    assert!(close(time, from / cfg.release_rate, 0.03));
    // Pressed; light and wound back.
    for (pressure, state) in [(500.0, ArmState::Releasing), (0.0, ArmState::Free)] {
        let mut grip = ArmGrip::default();
        for _ in 0..50 {
            grip = arm.step(&cfg, &released(input(&cfg, &arm, pressure)), DT);
        }
        assert!(grip.state == state, "{grip:?}");
    }
}
