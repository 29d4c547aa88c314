//! Radio lost, or one non-finite message, at any step of any state: no rotor stops in the air, no arm opens before the
//! rotors carry, and the state becomes that of an undisturbed vehicle.

use super::rig::Rig;
use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::grip::ArmState;
use crate::maths::vector::{Quat, Vec3};
use crate::mode::states::clamping::HOPELESS_TIME;
use crate::mode::states::releasing::FREE_TIME;
use crate::mode::*;
use crate::pilot::release_throttle::RELEASE_THROTTLE_MIN;

/// Every state in which rotors turn, or stand on the pipe.
const STATES: [fn() -> Rig; 7] = [
    Rig::armed,
    Rig::flying,
    Rig::touched,
    Rig::clamping,
    Rig::perched,
    Rig::releasing,
    released,
];

/// Arms open and free, nothing carries.
fn released() -> Rig {
    let mut r = Rig::releasing();
    r.run(2.0);
    r.grip(false, true, ArmState::Free, 0.0);
    r.carried = false;
    r
}

/// Rotors may stand on the ground, and on the pipe with a proven grip.
fn may_stand(r: &Rig) -> bool {
    matches!(r.out.mode, Mode::Calibrating | Mode::Disarmed | Mode::Perched)
        || r.out.mode == Mode::Clamping && r.inputs.grip.is_some_and(|g| g.proven)
}

#[test]
fn a_radio_lost_at_any_step_stops_no_rotor_in_the_air() {
    for (state, make) in STATES.into_iter().enumerate() {
        let mut r = make();
        for at in 0..(2.0 * FREE_TIME * 100.0) as u32 {
            let mut lost = r.clone();
            lost.inputs.sticks = None;
            for after in 0..200 {
                lost.step();
                let Outputs { mode, rotors, .. } = lost.out;
                assert!(
                    rotors != Setpoint::Stop || may_stand(&lost),
                    "state {state}, lost at step {at}: {mode:?} after {after}"
                );
            }
            r.step();
        }
    }
}

#[test]
fn no_arm_opens_on_the_pipe_before_the_rotors_have_the_least_throttle() {
    type Cancel = fn(&mut Rig);
    let cancels: [Cancel; 3] = [
        |r| r.sticks().perch_switch = false,
        |r| r.grip(false, false, ArmState::ForceLimited, 500.0),
        |r| r.grip(false, false, ArmState::Faulty, 500.0),
    ];
    let least = RELEASE_THROTTLE_MIN * 4.0 * Rig::new().params.thrust_max;
    for throttle in [0.0, 0.1, 0.19, 0.3, 0.42] {
        for (i, cancel) in cancels.iter().enumerate() {
            let mut r = Rig::clamping();
            r.sticks().throttle = throttle;
            r.grip(false, false, ArmState::Touching, 500.0);
            r.run(2.0);
            cancel(&mut r);
            let opened = (0..((HOPELESS_TIME + 3.0) * 100.0) as u32).find(|_| {
                r.step();
                r.out.tendons == ClampCommand::Release
            });
            let thrust = r.out.rotors.thrust();
            assert!(opened.is_some(), "throttle {throttle}, case {i}: never opened");
            assert!(
                thrust >= least,
                "throttle {throttle}, case {i}: opened at {thrust} of {least} N"
            );
        }
    }
}

#[test]
fn a_message_with_a_non_finite_value_counts_as_missing() {
    type Spoil = fn(&mut Inputs);
    let cases: [Spoil; 6] = [
        |i| {
            i.motion.iter_mut().for_each(|m| {
                m.q = Quat {
                    w: f32::NAN,
                    x: 0.0,
                    y: 0.0,
                    z: 0.0,
                }
            })
        },
        |i| {
            i.motion.iter_mut().for_each(|m| {
                m.q = Quat {
                    w: 1.0,
                    x: 0.0,
                    y: f32::INFINITY,
                    z: 0.0,
                }
            })
        },
        |i| {
            i.motion
                .iter_mut()
                .for_each(|m| m.rate = Vec3::new(0.0, f32::NAN, 0.0))
        },
        |i| {
            i.motion
                .iter_mut()
                .for_each(|m| m.accel = Vec3::new(f32::NAN, 0.0, f32::NEG_INFINITY))
        },
        |i| i.lift = f32::NAN,
        |i| i.battery = Some(f32::NAN),
    ];
    for (state, make) in STATES.into_iter().enumerate() {
        for (case, spoil) in cases.iter().enumerate() {
            let mut r = make();
            let mut sound = r.clone();
            for step in 0..120 {
                sound.step();
                if step == 20 {
                    let inputs = r.inputs;
                    r.inputs.lift = r.out.rotors.thrust();
                    spoil(&mut r.inputs);
                    r.out = r.logic.step(&r.inputs, super::rig::DT);
                    r.inputs = inputs;
                } else {
                    r.step();
                }
                let Outputs { mode, rotors, .. } = r.out;
                assert!(
                    rotors != Setpoint::Stop || may_stand(&r),
                    "state {state}, case {case}: {mode:?} at {step}"
                );
            }
            assert_eq!(
                (r.out.mode, r.out.tendons),
                (sound.out.mode, sound.out.tendons),
                "state {state}, case {case}"
            );
        }
    }
}

#[test]
fn a_non_finite_attitude_is_neither_held_on_the_pipe_nor_taken_for_a_touch() {
    let nowhere = Some(Motion {
        q: Quat {
            w: f32::NAN,
            x: 0.0,
            y: 0.0,
            z: 0.0,
        },
        calibrated: true,
        ..Motion::default()
    });
    // The held attitude follows the present one in spool-down.
    let mut r = Rig::clamping();
    r.grip(true, false, ArmState::Holding, 950.0);
    r.run(0.5);
    let motion = core::mem::replace(&mut r.inputs.motion, nowhere);
    r.step();
    r.inputs.motion = motion;
    r.run(0.2);
    r.sticks().perch_switch = false;
    r.expect(0.5, Mode::Releasing);
    assert!(
        r.out.rotors.spin() && r.out.rotors.thrust() > 1.0,
        "{:?}",
        r.out.rotors
    );

    let mut r = Rig::flying();
    r.sticks().throttle = 0.3;
    r.sticks().perch_switch = true;
    r.run(1.0);
    r.carried = true;
    let mut sound = r.clone();
    let touch = (0..100).position(|_| {
        sound.step();
        sound.out.mode == Mode::Contact
    });
    for _ in 1..touch.unwrap_or_default() {
        r.step();
    }
    let motion = core::mem::replace(&mut r.inputs.motion, nowhere);
    for _ in 0..3 {
        r.step();
        assert_eq!(r.out.mode, Mode::Flight);
    }
    r.inputs.motion = motion;
    r.expect(0.1, Mode::Contact);
}
