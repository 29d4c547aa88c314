//! Every transition of a flight without trouble.

use super::rig::{DT, Rig};
use crate::allocation::wrench::Wrench;
use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::grip::ArmState;
use crate::maths::scalar::deg;
use crate::maths::vector::{Quat, Vec3};
use crate::mode::shared::on_pipe::{SPOOL_DOWN_TIME, SPOOL_TIME};
use crate::mode::states::armed::IDLE_MAX;
use crate::mode::states::landed::LANDED_TIME;
use crate::mode::states::releasing::FREE_TIME;
use crate::mode::*;
use crate::pilot::rc::{ArmChoice, StickMode, Sticks};

#[test]
fn a_whole_mission_passes_every_state_in_order() {
    let mut r = Rig::releasing();
    r.expect(SPOOL_TIME - 0.2, Mode::Releasing);
    assert_eq!(
        r.out.tendons,
        ClampCommand::Close { arms: ArmChoice::All },
        "not before the rotors carry"
    );
    r.run(0.2);
    assert_eq!(r.out.tendons, ClampCommand::Release);
    assert!((r.out.rotors.thrust() - 0.3 * 33.2).abs() < 0.1);
    r.grip(false, true, ArmState::Free, 0.0);
    r.expect(FREE_TIME - 0.05, Mode::Releasing);
    r.expect(0.1, Mode::Flight);
    r.carried = false;
    r.sticks().throttle = 0.55;
    r.expect(5.0, Mode::Flight);
    r.sticks().throttle = 0.0;
    r.expect(1.0, Mode::Flight);
    r.carried = true;
    r.expect(0.7, Mode::Landed);
    r.expect(LANDED_TIME + 0.1, Mode::Disarmed);
    assert_eq!(r.out.rotors, Setpoint::Stop);
}

#[test]
fn the_collective_never_steps_while_the_rotors_work() {
    let mut r = Rig::clamping();
    let mut last = r.out.rotors.thrust();
    let mut smooth = |r: &mut Rig, seconds: f32| {
        for _ in 0..(seconds / DT) as u32 {
            r.step();
            let now = r.out.rotors.thrust();
            assert!((now - last).abs() <= 0.25, "{last} -> {now} in {:?}", r.out.mode);
            last = now;
        }
    };
    smooth(&mut r, 1.0);
    r.grip(true, false, ArmState::Holding, 950.0);
    smooth(&mut r, 3.5);
    assert_eq!(r.out.mode, Mode::Perched);
    r.sticks().perch_switch = false;
    smooth(&mut r, 2.0);
    r.grip(false, true, ArmState::Free, 0.0);
    smooth(&mut r, 1.0);
    assert_eq!(r.out.mode, Mode::Flight);
}

#[test]
fn sticks_mean_what_the_stick_mode_says() {
    let mut r = Rig::flying();
    *r.sticks() = Sticks {
        roll: 0.5,
        pitch: -0.5,
        yaw: 1.0,
        throttle: 0.5,
        arm_switch: true,
        ..Default::default()
    };
    r.run(1.0);
    let thrust = r.out.rotors.thrust();
    let yaw_rate = r.params.stick_yaw_rate;
    assert!((thrust - 16.6).abs() < 1e-3);
    assert_eq!(
        r.out.rotors,
        Setpoint::Angle {
            roll: 0.305,
            pitch: -0.305,
            yaw_rate,
            thrust
        }
    );
    r.sticks().stick_mode = StickMode::Rate;
    r.step();
    assert_eq!(
        r.out.rotors,
        Setpoint::Rate {
            rate: Vec3::new(1.5, -1.5, yaw_rate),
            thrust
        }
    );
    r.sticks().stick_mode = StickMode::Direct;
    r.step();
    let wrench = Wrench {
        thrust,
        roll: 0.5,
        pitch: -0.5,
        yaw: 0.1,
    };
    assert_eq!(r.out.rotors, Setpoint::Direct { wrench });
}

#[test]
fn idling_ends_by_gesture_by_time_or_in_flight() {
    let mut r = Rig::armed();
    r.sticks().yaw = -1.0;
    r.expect(1.1, Mode::Disarmed);
    let mut r = Rig::armed();
    r.expect(IDLE_MAX + 0.1, Mode::Disarmed);
    assert_eq!(r.out.inhibits.first(), None, "free to arm again");
    let mut r = Rig::armed();
    r.inputs.sticks = None;
    r.expect(0.02, Mode::Disarmed);
    let mut r = Rig::armed();
    r.sticks().throttle = 0.06;
    r.expect(0.02, Mode::Flight);
    r.sticks().throttle = 0.0;
    r.expect(0.6, Mode::Landed);
    r.sticks().throttle = 0.1;
    r.expect(0.02, Mode::Flight);
}

#[test]
fn the_landing_on_the_pipe_needs_switch_throttle_and_evidence() {
    for (perch_switch, throttle, carried, tilt) in [
        (false, 0.3, true, 0.0),
        (true, 0.43, true, 0.0),
        (true, 0.3, false, 0.0),
        (true, 0.3, false, deg(12.0)),
    ] {
        let mut r = Rig::flying();
        r.sticks().throttle = throttle;
        r.run(0.1);
        r.sticks().perch_switch = perch_switch;
        r.carried = carried;
        let q = Quat::from_euler(tilt, 0.0, 0.0);
        r.inputs.motion = Some(Motion {
            q,
            calibrated: true,
            ..Default::default()
        });
        r.expect(3.0, Mode::Flight);
    }
}

#[test]
fn a_contact_that_is_lost_or_called_off_is_flight_again() {
    let mut r = Rig::touched();
    r.sticks().perch_switch = false;
    r.expect(0.02, Mode::Flight);
    let mut r = Rig::touched();
    r.sticks().throttle = 0.5;
    r.expect(0.02, Mode::Flight);
}

#[test]
fn the_pilot_calls_a_closing_off_or_a_release_back() {
    let mut r = Rig::clamping();
    r.sticks().perch_switch = false;
    r.expect(0.1, Mode::Escaping);
    let mut r = Rig::releasing();
    r.sticks().perch_switch = true;
    r.expect(0.1, Mode::Clamping);
}

#[test]
fn a_lean_is_taken_out_on_the_pipe_and_left_to_the_grip_when_it_holds() {
    let lean = |rotors| match rotors {
        Setpoint::Resting { roll, pitch, .. } => (roll, pitch),
        other => panic!("{other:?}"),
    };
    let mut r = Rig::flying();
    r.sticks().throttle = 0.3;
    r.sticks().perch_switch = true;
    r.carried = true;
    let q = Quat::from_euler(0.15, 0.1, 0.0);
    r.inputs.motion = Some(Motion {
        q,
        calibrated: true,
        ..Default::default()
    });
    r.expect(0.15, Mode::Contact);
    let (roll, pitch) = lean(r.out.rotors);
    assert!(
        (0.12..0.16).contains(&roll) && (pitch - 0.1).abs() < 0.01,
        "{roll} {pitch}"
    );
    r.expect(2.0, Mode::Clamping);
    let (roll, pitch) = lean(r.out.rotors);
    assert!(
        roll.abs() < 1e-3 && (pitch - 0.1).abs() < 0.01,
        "levelled across the pipe: {roll} {pitch}"
    );
    r.grip(true, false, ArmState::Holding, 950.0);
    r.expect(0.45 * SPOOL_DOWN_TIME, Mode::Clamping);
    assert!(
        lean(r.out.rotors).0 > 0.1,
        "the grip holds the lean: little moment is left"
    );
    r.expect(0.3 * SPOOL_DOWN_TIME, Mode::Clamping);
    let lifting = |w: Wrench| w.thrust > 0.0 && w.roll.abs() + w.pitch.abs() + w.yaw.abs() <= 0.0;
    assert!(matches!(r.out.rotors, Setpoint::Direct { wrench } if lifting(wrench)));
}
