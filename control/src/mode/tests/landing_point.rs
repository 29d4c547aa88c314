//! The failsafe with a position: straight down, beside the pipe where it has just left it, and by the pilot's sticks.

use super::holding::angles;
use super::rig::Rig;
use crate::gripper::grip::ArmState;
use crate::maths::scalar::deg;
use crate::maths::vector::Vec3;
use crate::mode::*;
use crate::navigation::estimate::Estimate;
use crate::navigation::fix_age::{FRESH_AGE, HEIGHT_AGE};

fn at(r: &mut Rig, position: Vec3, age: f32) {
    r.inputs.position = Some(Estimate {
        position,
        age,
        ..Estimate::default()
    });
}

/// A radio lost in flight by hand, with a position that is `age` s old.
fn sinking(age: f32) -> Rig {
    let mut r = Rig::flying();
    at(&mut r, Vec3::ZERO, age);
    r.run(0.1);
    r.inputs.sticks = None;
    r.expect(0.01, Mode::Failsafe);
    r
}

#[test]
fn a_vehicle_that_drifts_leans_back_over_its_spot_and_sinks_as_without_a_position() {
    let mut r = sinking(0.02);
    let mut blind = sinking(f32::MAX);
    // 0.2 m north and east of the landing point: nose down is negative pitch, so back is up, and left.
    at(&mut r, Vec3::new(0.2, 0.2, 0.0), 0.02);
    r.step();
    blind.step();
    let [roll, pitch, _, thrust] = angles(&r);
    assert!(roll < -deg(5.0) && pitch > deg(5.0), "{roll} {pitch}");
    let [level_roll, level_pitch, _, level_thrust] = angles(&blind);
    assert_eq!((level_roll, level_pitch), (0.0, 0.0));
    assert!(
        thrust >= level_thrust && thrust < 1.05 * level_thrust,
        "{thrust} {level_thrust}"
    );
}

#[test]
fn a_position_that_comes_late_is_taken_and_one_that_ends_is_left() {
    let mut r = sinking(FRESH_AGE + 0.01);
    let off = |r: &mut Rig, age| {
        at(r, Vec3::new(0.3, 0.0, 0.0), age);
        r.step();
        angles(r)[1]
    };
    assert_eq!(off(&mut r, FRESH_AGE + 0.01), 0.0);
    // Where it is then is its landing point.
    assert!(off(&mut r, 0.02).abs() < 1e-3);
    at(&mut r, Vec3::new(0.5, 0.0, 0.0), 0.02);
    r.step();
    assert!(angles(&r)[1] > deg(2.0));
    assert_eq!(off(&mut r, HEIGHT_AGE + 0.01), 0.0);
    r.inputs.position = None;
    r.step();
    assert_eq!(angles(&r)[1], 0.0);
}

#[test]
fn what_carries_is_no_place_to_be_moved_on() {
    let mut r = sinking(0.02);
    r.carried = true;
    r.run(0.5);
    at(&mut r, Vec3::new(0.2, 0.2, 0.0), 0.02);
    r.step();
    assert_eq!(r.out.mode, Mode::Failsafe);
    let [roll, pitch, ..] = angles(&r);
    assert_eq!((roll, pitch), (0.0, 0.0));
}

#[test]
fn with_an_empty_battery_the_hold_switch_says_what_the_sticks_ask_for() {
    for held in [true, false] {
        let mut r = Rig::flying();
        at(&mut r, Vec3::ZERO, 0.02);
        r.sticks().hold_switch = held;
        r.inputs.battery = Some(10.0);
        assert_eq!(r.run(10.0), Mode::Failsafe);
        r.sticks().roll = 0.5;
        r.run(0.02);
        let asked = 0.5 * r.params.stick_angle;
        let [roll, ..] = angles(&r);
        if held {
            // A velocity: it leans as far as the command has grown.
            assert!(roll > 0.0 && roll < 0.5 * asked, "{roll}");
        } else {
            assert!((roll - asked).abs() < 1e-4, "{roll}");
        }
    }
}

#[test]
fn off_the_pipe_it_moves_aside_before_it_sinks() {
    let mut r = Rig::releasing();
    at(&mut r, Vec3::ZERO, 0.02);
    r.run(2.0);
    r.grip(false, true, ArmState::Free, 0.0);
    r.carried = false;
    r.inputs.sticks = None;
    let mut waited = 0;
    while r.out.mode != Mode::Failsafe {
        r.step();
        waited += 1;
        assert!(waited < 100, "{:?}", r.out);
    }
    r.run(1.0);
    let weight = r.params.mass * 9.806_65;
    let [roll, _, _, thrust] = angles(&r);
    assert!(roll > deg(1.0) && thrust > 0.98 * weight, "{roll} {thrust}");
    // Then it sinks: the rig's vehicle has stayed, so that it is drawn to where it should be.
    r.falling = 0.0;
    r.run(1.5);
    assert!(angles(&r)[3] < 0.97 * weight, "{}", angles(&r)[3]);
}
