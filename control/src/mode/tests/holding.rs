//! Holding a position: how it begins, what ends it, and what the sticks ask for meanwhile.

use super::rig::{DT, Rig};
use crate::chain::setpoint::Setpoint;
use crate::maths::vector::Vec3;
use crate::mode::*;
use crate::navigation::estimate::Estimate;
use crate::navigation::fix_age::{COAST_AGE, FRESH_AGE, HEIGHT_AGE};
use crate::params::Params;
use crate::pilot::rc::{StickMode, Sticks};

/// Flying with a position that is `age` s old.
fn placed(age: f32) -> Rig {
    let mut r = Rig::flying();
    set_age(&mut r, age);
    r
}

fn set_age(r: &mut Rig, age: f32) {
    r.inputs.position = Some(Estimate {
        age,
        ..r.inputs.position.unwrap_or_default()
    });
}

fn holding() -> Rig {
    let mut r = placed(0.02);
    r.sticks().hold_switch = true;
    r.step();
    assert_eq!(r.out.mode, Mode::Hold);
    r.sticks().throttle = 0.5;
    r
}

/// Roll, pitch, yaw rate, thrust.
pub(super) fn angles(r: &Rig) -> [f32; 4] {
    assert!(
        matches!(r.out.rotors, Setpoint::Angle { .. }),
        "{:?}",
        r.out.rotors
    );
    r.out.rotors.numbers()
}

#[test]
fn a_turn_of_the_switch_holds_and_another_hands_back_within_a_step() {
    let mut r = holding();
    r.expect(2.0, Mode::Hold);
    assert_eq!(r.out.reason, None);
    *r.sticks() = Sticks {
        hold_switch: false,
        roll: 1.0,
        ..*r.sticks()
    };
    r.step();
    assert_eq!(r.out.mode, Mode::Flight);
    assert!(angles(&r)[0] == r.params.stick_angle, "{:?}", r.out.rotors);
}

#[test]
fn another_stick_mode_hands_back_too() {
    let changes: [fn(&mut Sticks); 2] = [
        |s| s.stick_mode = StickMode::Rate,
        |s| s.stick_mode = StickMode::Direct,
    ];
    for change in changes {
        let mut r = holding();
        change(r.sticks());
        r.step();
        assert_eq!(r.out.mode, Mode::Flight);
        // It does not come back by itself.
        *r.sticks() = Sticks {
            stick_mode: StickMode::Angle,
            ..*r.sticks()
        };
        r.expect(0.1, Mode::Flight);
        assert_eq!(r.out.reason, Some(Reason::HoldSwitchNotOff));
    }
}

#[test]
fn motors_slower_than_those_that_were_flown_are_not_held() {
    for (motor_tau, mode) in [(0.2, Mode::Hold), (0.21, Mode::Flight)] {
        let mut r = Rig::with(Params {
            motor_tau,
            ..Params::DEFAULT
        });
        r.fly();
        set_age(&mut r, 0.0);
        r.sticks().hold_switch = true;
        r.expect(0.1, mode);
        let refused = mode == Mode::Flight;
        assert_eq!(
            r.out.reason,
            refused.then_some(Reason::MotorsTooSlow),
            "{motor_tau}"
        );
    }
}

#[test]
fn a_swing_in_flight_that_no_hand_makes_is_named_and_slows_the_loops_until_disarmed() {
    let turning = |hz: f32| {
        let mut r = Rig::flying();
        swing(&mut r, hz);
        assert_eq!(r.out.mode, Mode::Flight);
        r
    };
    let mut r = turning(3.0);
    assert!(r.out.gentle);
    assert_eq!(r.out.reason, Some(Reason::Swings));
    r.run(60.0);
    assert!(r.out.gentle && r.out.reason.is_none());
    r.sticks().arm_switch = false;
    r.expect(0.1, Mode::Disarmed);
    assert!(!r.out.gentle);
    // What sticks may do is the pilot's.
    assert!(!turning(1.2).out.gentle);
}

#[test]
fn without_a_fresh_position_it_does_not_begin_and_says_so() {
    for age in [None, Some(FRESH_AGE + 0.01)] {
        let mut r = Rig::flying();
        if let Some(age) = age {
            set_age(&mut r, age);
        }
        r.sticks().hold_switch = true;
        r.expect(0.1, Mode::Flight);
        assert_eq!(r.out.reason, Some(Reason::NoPosition));
        set_age(&mut r, FRESH_AGE);
        r.expect(0.02, Mode::Hold);
        assert_eq!(r.out.reason, None);
    }
    // NaN is no position.
    let mut r = placed(f32::NAN);
    r.sticks().hold_switch = true;
    r.expect(0.1, Mode::Flight);
}

#[test]
fn a_switch_left_on_holds_nothing() {
    let mut r = Rig::armed();
    r.sticks().hold_switch = true;
    r.logic.clone_from(&ModeLogic::new(&r.params));
    r.inputs.position = Some(Estimate::default());
    r.sticks().arm_switch = false;
    r.expect(0.1, Mode::Disarmed);
    *r.sticks() = Sticks {
        arm_switch: true,
        hold_switch: true,
        yaw: 1.0,
        ..Sticks::default()
    };
    r.expect(1.2, Mode::Armed);
    r.carried = false;
    *r.sticks() = Sticks {
        yaw: 0.0,
        throttle: 0.53,
        ..*r.sticks()
    };
    r.expect(1.0, Mode::Flight);
    assert_eq!(r.out.reason, Some(Reason::HoldSwitchNotOff));
}

#[test]
fn on_something_that_carries_it_does_not_begin() {
    let mut r = placed(0.02);
    r.carried = true;
    r.sticks().throttle = 0.3;
    r.expect(1.0, Mode::Flight);
    r.sticks().hold_switch = true;
    r.expect(0.5, Mode::Flight);
}

#[test]
fn a_silent_source_costs_position_then_height_then_the_hold() {
    let mut r = holding();
    set_age(&mut r, COAST_AGE);
    r.expect(0.1, Mode::Hold);
    assert_eq!(r.out.reason, None);
    set_age(&mut r, COAST_AGE + 0.01);
    r.expect(0.1, Mode::Hold);
    assert_eq!(r.out.reason, Some(Reason::PositionStale));
    set_age(&mut r, HEIGHT_AGE);
    r.expect(0.1, Mode::Hold);
    set_age(&mut r, HEIGHT_AGE + 0.01);
    r.expect(0.02, Mode::Flight);
    assert_eq!(r.out.reason, Some(Reason::PositionLost));
    // With a position again it waits for the switch.
    set_age(&mut r, 0.02);
    r.expect(0.5, Mode::Flight);
    r.sticks().hold_switch = false;
    r.step();
    r.sticks().hold_switch = true;
    r.expect(0.02, Mode::Hold);
}

#[test]
fn a_source_that_comes_back_in_time_holds_where_the_vehicle_is_then() {
    let mut r = holding();
    r.run(1.0);
    set_age(&mut r, 2.0);
    r.run(1.0);
    let away = Vec3::new(0.8, -0.5, 0.0);
    r.inputs.position = Some(Estimate {
        position: away,
        age: 0.02,
        ..Estimate::default()
    });
    r.expect(0.01, Mode::Hold);
    let [roll, pitch, ..] = angles(&r);
    assert!(
        r.out.reason.is_none() && roll.abs() < 0.01 && pitch.abs() < 0.01,
        "{roll} {pitch}"
    );
}

#[test]
fn with_the_height_by_pressure_the_hold_lasts_for_nine_seconds() {
    let mut r = holding();
    r.run(1.0);
    let by_pressure = |r: &mut Rig, age, by_pressure| {
        r.inputs.position = Some(Estimate {
            age,
            by_pressure,
            ..r.inputs.position.unwrap()
        });
    };
    by_pressure(&mut r, 8.9, true);
    r.expect(0.5, Mode::Hold);
    assert_eq!(r.out.reason, Some(Reason::PositionStale));
    by_pressure(&mut r, 9.1, true);
    r.expect(0.02, Mode::Flight);
    // Where the pressure ends as well, it is as without.
    let mut r = holding();
    r.run(1.0);
    by_pressure(&mut r, 4.1, true);
    r.expect(0.5, Mode::Hold);
    by_pressure(&mut r, 4.1, false);
    r.expect(0.02, Mode::Flight);
}

#[test]
fn the_learnt_wind_is_leant_against_without_a_position_and_the_sticks_tilt() {
    let wind = 0.55;
    let mut r = placed(0.02);
    r.inputs.position = Some(Estimate {
        disturbance: Vec3::new(0.0, wind, 0.0),
        ..Estimate::default()
    });
    r.sticks().hold_switch = true;
    r.run(1.0);
    set_age(&mut r, 2.0);
    // What it feels now is no longer learnt in full: only the roll against the wind stays.
    r.run(0.1);
    let [roll, pitch, ..] = angles(&r);
    assert!(
        (roll + wind / 9.81).abs() < 2e-3 && pitch.abs() < 1e-3,
        "{roll} {pitch}"
    );
    r.sticks().pitch = 0.5;
    r.run(0.1);
    let [_, pitch, ..] = angles(&r);
    assert!((pitch - 0.5 * r.params.stick_angle).abs() < 0.02, "{pitch}");
}

#[test]
fn the_throttle_asks_for_a_climb_only_after_it_was_centred() {
    let mut r = placed(0.02);
    r.sticks().hold_switch = true;
    r.sticks().throttle = 0.75;
    r.run(1.0);
    let hover = r.params.mass * 9.806_65;
    assert!((angles(&r)[3] - hover).abs() < 0.3, "{:?}", r.out.rotors);
    r.sticks().throttle = 0.5;
    r.run(0.1);
    r.sticks().throttle = 0.75;
    r.run(0.3);
    assert!(angles(&r)[3] > hover + 0.5, "{:?}", r.out.rotors);
}

#[test]
fn what_ends_a_flight_ends_a_hold() {
    let mut r = holding();
    r.inputs.sticks = None;
    r.expect(0.02, Mode::Failsafe);
    let mut r = holding();
    r.inputs.battery = Some(10.0);
    assert_eq!(r.run(10.0), Mode::Failsafe);
    let mut r = holding();
    r.sticks().arm_switch = false;
    r.expect(0.01, Mode::Disarmed);
    let mut r = holding();
    r.sticks().throttle = 0.0;
    r.carried = true;
    assert!(matches!(r.run(6.0), Mode::Landed | Mode::Disarmed));
}

/// Pitch rates of four periods of a swing.
fn swing(r: &mut Rig, hz: f32) {
    for i in 0..(4.0 / hz / DT) as u32 {
        let rate = 2.7 * (core::f32::consts::TAU * hz * DT * i as f32).sin();
        if let Some(motion) = &mut r.inputs.motion {
            motion.rate = Vec3::new(0.0, rate, 0.0);
        }
        r.step();
    }
    if let Some(motion) = &mut r.inputs.motion {
        motion.rate = Vec3::ZERO;
    }
}

#[test]
fn a_swing_is_held_gently_and_one_that_goes_on_is_handed_back() {
    for hz in [1.3, 3.0] {
        let mut r = holding();
        swing(&mut r, hz);
        assert_eq!(
            (r.out.mode, r.out.reason),
            (Mode::Hold, Some(Reason::Swings)),
            "{hz} Hz"
        );
        assert!(r.out.gentle);
        r.expect(2.0, Mode::Hold);
        swing(&mut r, hz);
        assert_eq!(
            (r.out.mode, r.out.reason),
            (Mode::Flight, Some(Reason::Swings)),
            "{hz} Hz"
        );
    }
}

#[test]
fn a_swing_by_hand_before_the_hold_does_not_count() {
    let mut r = placed(0.02);
    swing(&mut r, 1.3);
    r.sticks().hold_switch = true;
    r.step();
    r.sticks().throttle = 0.5;
    r.expect(2.0, Mode::Hold);
    assert_eq!(r.out.reason, None);
}
