//! Hand-over between states: the collective, the held attitude, the failsafe's command.

use super::rig::{DT, Rig};
use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::grip::ArmState;
use crate::maths::scalar::GRAVITY;
use crate::maths::vector::Quat;
use crate::mode::shared::collective::HAND_OVER_TIME;
use crate::mode::shared::on_pipe::SPOOL_DOWN_TIME;
use crate::mode::states::failsafe::RESUME_TIME;
use crate::mode::*;
use crate::params::Params;
use crate::pilot::rc::StickMode;

/// Four rotors of 8.3 N.
const FULL: f32 = 33.2;

#[test]
fn a_radio_that_comes_back_in_direct_mode_takes_the_collective_over_without_a_step() {
    for throttle in [0.2, 0.9] {
        let mut r = Rig::flown();
        let sticks = r.inputs.sticks.take();
        r.expect(0.5, Mode::Failsafe);
        let from = r.out.rotors.thrust();
        r.inputs.sticks = sticks;
        r.sticks().stick_mode = StickMode::Direct;
        r.sticks().throttle = throttle;
        let mut offset = None;
        for step in 1..=50 {
            r.step();
            // A throttle stands for a command, whatever thrust the vehicle has learnt.
            let to = throttle * FULL * r.out.thrust_factor.value;
            assert_eq!(r.out.mode, Mode::Flight);
            assert!(matches!(r.out.rotors, Setpoint::Direct { .. }));
            // A straight line over half a second.
            let share = step as f32 * DT / HAND_OVER_TIME;
            let offset = *offset.get_or_insert(from - to);
            let wanted = to + offset * (1.0 - share);
            assert!(
                (r.out.rotors.thrust() - wanted).abs() < 0.05,
                "step {step}: {} of {wanted} N",
                r.out.rotors.thrust()
            );
        }
    }
    let mut r = Rig::flying();
    r.sticks().stick_mode = StickMode::Direct;
    r.sticks().throttle = 1.5;
    r.run(1.0);
    assert!(
        (r.out.rotors.thrust() - FULL * r.out.thrust_factor.value).abs() < 1e-3,
        "no more than four rotors give"
    );
}

#[test]
fn on_the_pipe_thrust_is_limited_to_a_share_of_the_weight_and_stops_with_the_proven_grip() {
    let weight = Params::default().mass * GRAVITY;
    for (throttle, wanted) in [(0.3, 0.375 * weight), (0.4, 0.375 * weight), (0.15, 0.15 * FULL)] {
        let mut r = Rig::touched();
        r.sticks().throttle = throttle;
        r.run(0.05);
        let thrust = r.out.rotors.thrust();
        assert!((thrust - wanted).abs() < 1e-3, "at once: {thrust} of {wanted} N");
    }
    let mut r = Rig::clamping();
    r.run(1.0);
    assert!((r.out.rotors.thrust() - 0.375 * weight).abs() < 1e-3);
    r.grip(true, false, ArmState::Holding, 950.0);
    r.expect(SPOOL_DOWN_TIME + 0.05, Mode::Clamping);
    assert_eq!(r.out.rotors, Setpoint::Stop, "not a thrust of zero");
}

#[test]
fn the_pilot_takes_over_by_roll_or_pitch_to_either_side() {
    for (roll, pitch, taken) in [
        (0.31, 0.0, true),
        (-0.31, 0.0, true),
        (0.0, 0.31, true),
        (0.0, -0.31, true),
        (0.29, -0.29, false),
        (0.0, 0.0, false),
    ] {
        let mut r = Rig::flying();
        let sticks = r.inputs.sticks.take();
        r.run(RESUME_TIME + 0.2);
        r.inputs.sticks = sticks;
        (r.sticks().roll, r.sticks().pitch) = (roll, pitch);
        let mode = r.run(0.05);
        assert_eq!(mode == Mode::Flight, taken, "{roll} {pitch}");
    }
}

#[test]
fn on_the_ground_the_failsafe_takes_the_thrust_away_at_its_rate() {
    let mut r = Rig::flying();
    r.inputs.sticks = None;
    r.run(20.0);
    r.carried = true;
    let weight = r.params.mass * GRAVITY;
    let (mut from, mut to) = (None, None);
    for step in 0..2000 {
        r.step();
        let share = r.out.rotors.thrust() / weight;
        if share < 0.55 && from.is_none() {
            from = Some(step);
        }
        if share < 0.31 && to.is_none() {
            to = Some(step);
        }
    }
    // Three times half the weight a second: 0.24 of it takes 0.16 s.
    let (Some(from), Some(to)) = (from, to) else {
        panic!("the thrust stays")
    };
    assert!((13..=19).contains(&(to - from)), "{} steps", to - from);
}

#[test]
fn the_attitude_held_follows_the_present_one_while_the_rotors_spool_down() {
    for (roll, pitch) in [(0.2, 0.0), (-0.2, 0.0), (0.0, 0.1), (0.0, -0.1), (0.15, -0.08)] {
        let mut r = Rig::clamping();
        r.grip(true, false, ArmState::Holding, 950.0);
        r.step();
        r.inputs.motion = Some(Motion {
            q: Quat::from_euler(roll, pitch, 0.0),
            calibrated: true,
            ..Motion::default()
        });
        r.run(1.0);
        let Setpoint::Resting {
            roll: held,
            pitch: pitched,
            ..
        } = r.out.rotors
        else {
            panic!("{:?}", r.out.rotors)
        };
        // One time constant of 1 s in steps of 10 ms: 1 - (100/101)^100 = 0.630; the arc tangent is off by 3.5e-3.
        assert!((held - 0.630 * roll).abs() < 4e-3, "{held} of {roll}");
        assert!((pitched - 0.630 * pitch).abs() < 4e-3, "{pitched} of {pitch}");
        r.expect(SPOOL_DOWN_TIME - 0.5, Mode::Perched);
    }
}
