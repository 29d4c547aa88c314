//! An arm's faults: detected, force held, ended when allowed.

use super::*;

#[test]
fn a_fault_that_stays_until_release_outlives_a_restart() {
    let cfg = config();
    for fault in [GripFault::Sensor, GripFault::Unfelt, GripFault::Ceiling] {
        let mut arm = ArmGripper::resume(50.0, Some(fault), None);
        let grip = run(&mut arm, &cfg, 0.0, 3.0);
        assert!(grip.force == 50.0 && grip.fault == Some(fault), "{grip:?}");
    }
    let mut arm = ArmGripper::resume(50.0, Some(GripFault::Tilt), None);
    assert!(run(&mut arm, &cfg, 950.0, 0.1).fault.is_none());
}

/// Reading (Pa) of a pad of which the converter sees a `part` of the voltage: at P = pressure / 692.5 Pa the pad has P
/// / (1 + P) of the supply.
fn behind(part: f32, pressure: f32) -> f32 {
    let x = part * pressure / (692.5 + pressure);
    692.5 * x / (1.0 - x)
}

/// Closes an arm on a skin of 70 Pa/N, met at 52 N, read through `sensor`.
fn closing_on_a_skin(sensor: impl Fn(f32) -> f32) -> (ArmGripper, ArmGrip) {
    let cfg = config();
    let mut arm = ArmGripper::default();
    let mut grip = ArmGrip::default();
    for _ in 0..1500 {
        let pressure = 70.0 * scalar::clamp(arm.force - 52.0, 0.0, 1e3);
        grip = run(&mut arm, &cfg, sensor(pressure), DT);
    }
    (arm, grip)
}

#[test]
fn a_sensor_that_cannot_read_the_grip_pressure_stops_the_winding() {
    let (_, grip) = closing_on_a_skin(|pressure| pressure);
    assert!(grip.state == ArmState::Holding, "{grip:?}");
    // Behind 1:2 the reading ends at 692 Pa; from 40 N of tension on the skin it rises by less than 6 Pa/N.
    let (mut arm, grip) = closing_on_a_skin(|pressure| behind(0.5, pressure));
    assert!(
        grip.fault == Some(GripFault::Ceiling) && grip.force < 52.0 + 50.0,
        "{grip:?}"
    );
    assert!(grip.state == ArmState::Faulty && grip.pressure < 692.5);
    // Fault and force stay until release.
    let cfg = config();
    let later = run(&mut arm, &cfg, 950.0, 3.0);
    assert!(later.fault == Some(GripFault::Ceiling) && later.force == grip.force);
    arm.step(&cfg, &released(input(&cfg, &arm, 500.0)), DT);
    assert!(arm.fault().is_none());
    for ceiling in [150.0, 400.0, 800.0] {
        let (_, grip) = closing_on_a_skin(|pressure| scalar::clamp(pressure, 0.0, ceiling));
        assert!(grip.fault == Some(GripFault::Ceiling), "{ceiling}: {grip:?}");
        assert!(grip.force < 52.0 + 35.0, "{ceiling}: {grip:?}");
    }
}

#[test]
fn a_sensor_that_has_read_the_grip_pressure_has_the_range() {
    let cfg = config();
    let mut arm = holding(&cfg);
    let force = arm.force;
    // The load pulls as fast as the tendon.
    let grip = run(&mut arm, &cfg, 700.0, 3.0);
    assert!(grip.force > force + 20.0 && grip.fault.is_none(), "{grip:?}");
}

#[test]
fn a_rotor_that_starts_is_no_ceiling() {
    let cfg = config();
    let mut arm = ArmGripper::default();
    let mut grip = ArmGrip::default();
    for step in 0..1500 {
        // 0.1 s after the touch the rotor gives 5 N, 32.6 N of the tendon's.
        let thrust = if step > 190 { 5.0 } else { 0.0 };
        let pressure = 70.0 * scalar::clamp(arm.force - cfg.per_thrust * thrust - 52.0, 0.0, 1e3);
        let i = ArmInput {
            thrust,
            ..input(&cfg, &arm, if step > 180 { pressure + 120.0 } else { pressure })
        };
        grip = arm.step(&cfg, &i, DT);
    }
    assert!(grip.state == ArmState::Holding, "{grip:?}");
}

#[test]
fn stale_pressure_holds_and_goes_on_without_a_jump() {
    let cfg = config();
    let mut arm = holding(&cfg);
    let force = arm.force;
    for _ in 0..100 {
        let i = ArmInput {
            pressure: Pressure::Stale,
            ..input(&cfg, &arm, 0.0)
        };
        let grip = arm.step(&cfg, &i, DT);
        assert!(grip.state == ArmState::Faulty && close(grip.force, force, 1e-6));
    }
    assert!(arm.fault() == Some(GripFault::Stale));
    let grip = run(&mut arm, &cfg, 950.0, 0.1);
    assert!(
        grip.state == ArmState::Touching && close(grip.force, force, 1.0),
        "{grip:?}"
    );
    assert!(run(&mut arm, &cfg, 950.0, 1.5).state == ArmState::Holding);
}

#[test]
fn a_failed_sensor_stays_failed_until_release() {
    let cfg = config();
    let mut arm = holding(&cfg);
    let force = arm.force;
    let i = ArmInput {
        pressure: Pressure::Faulty,
        ..input(&cfg, &arm, 0.0)
    };
    assert!(arm.step(&cfg, &i, DT).state == ArmState::Faulty);
    assert!(run(&mut arm, &cfg, 950.0, 5.0).state == ArmState::Faulty);
    assert!(arm.fault() == Some(GripFault::Sensor) && close(arm.force, force, 1e-6));
    let i = input(&cfg, &arm, 950.0);
    assert!(arm.step(&cfg, &released(i), DT).state == ArmState::Releasing && arm.fault().is_none());
}

#[test]
fn numbers_that_are_none_hold_the_force() {
    let cfg = config();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut arm = holding(&cfg);
        let force = arm.force;
        let i = input(&cfg, &arm, 950.0);
        for i in [
            ArmInput {
                pressure: Pressure::Known(bad),
                ..i
            },
            ArmInput { thrust: bad, ..i },
        ] {
            let grip = arm.step(&cfg, &i, DT);
            assert!(grip.state == ArmState::Faulty && close(grip.force, force, 1e-6));
            assert!(arm.fault() == Some(GripFault::NotFinite));
        }
    }
}

#[test]
fn a_missing_tilt_holds_at_once_and_is_faulty_when_it_lasts() {
    let cfg = config();
    let mut arm = holding(&cfg);
    let force = arm.force;
    let mut blind = |seconds: f32| {
        let mut grip = ArmGrip::default();
        for _ in 0..(seconds / DT + 0.5) as u32 {
            let i = ArmInput {
                tilt: None,
                ..input(&cfg, &arm, 900.0)
            };
            grip = arm.step(&cfg, &i, DT);
        }
        (grip, arm.fault())
    };
    let (grip, fault) = blind(0.4);
    assert!(grip.state == ArmState::Holding && close(grip.force, force, 1e-6) && fault.is_none());
    let (grip, fault) = blind(0.2);
    assert!(grip.state == ArmState::Faulty && close(grip.force, force, 1e-6));
    assert!(fault == Some(GripFault::Tilt));
}

#[test]
fn an_arm_that_stands_still_under_a_rising_force_without_pressure_is_faulty() {
    let cfg = config();
    let mut arm = ArmGripper::default();
    run(&mut arm, &cfg, 0.0, 1.0);
    let (force, tilt) = (arm.force, -0.2 - cfg.bend_per_force * arm.force);
    let mut largest = 0.0;
    for _ in 0..500 {
        let i = ArmInput {
            tilt: Some(tilt),
            ..input(&cfg, &arm, 0.0)
        };
        let grip = arm.step(&cfg, &i, DT);
        largest = if grip.force > largest { grip.force } else { largest };
    }
    assert!(arm.fault() == Some(GripFault::Unfelt) && largest < force + 20.0);
    // Back to the force before the vain rise.
    assert!(arm.force < force + 8.0);
}

#[test]
fn a_bounce_across_the_sensors_turn_on_force_is_no_broken_lead() {
    let cfg = config();
    // It reads 0 below 400 Pa, and 500 Pa just above.
    for (turn_on, before, fault) in [
        (400.0, 500.0, None),
        (400.0, 900.0, Some(GripFault::Sensor)),
        (650.0, 900.0, Some(GripFault::Sensor)),
        (0.0, 500.0, Some(GripFault::Sensor)),
    ] {
        let mut arm = holding(&cfg);
        for pressure in [before, 0.0] {
            let i = ArmInput {
                turn_on,
                ..input(&cfg, &arm, pressure)
            };
            arm.step(&cfg, &i, DT);
        }
        assert_eq!(arm.fault(), fault, "{turn_on} {before}");
    }
}
