//! Escapes: start, course and end; arms that do not let go.

use super::rig::{DT, Rig};
use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::grip::ArmState;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::scalar::{GRAVITY, deg};
use crate::maths::vector::{Quat, Vec3};
use crate::mode::states::escaping::{FREE_MAX, TAKE_OVER_SHARE, TAKE_OVER_TIME};
use crate::mode::*;
use crate::params::Params;
use crate::pilot::rc::ArmChoice;
use crate::pilot::release_throttle::release_thrust;

impl Rig {
    /// Leans right by `degrees`, turning further at `rate`, rad/s.
    fn leans(&mut self, degrees: f32, rate: f32) {
        self.inputs.motion = Some(Motion {
            q: Quat::from_euler(deg(degrees), 0.0, 0.0),
            rate: Vec3::new(rate, 0.0, 0.0),
            calibrated: true,
            ..Motion::default()
        });
    }

    /// Turns about the pipe's axis by `degrees`, at `rate` rad/s, headed `across` (degrees) off it, and by `twist` about its own.
    fn turns(&mut self, [degrees, rate, across]: [f32; 3], [twist, spin]: [f32; 2]) {
        let (cos, sin) = (deg(across).cos(), deg(across).sin());
        self.inputs.motion = Some(Motion {
            q: Quat::from_euler(deg(degrees) * cos, deg(degrees) * sin, deg(twist)),
            rate: Vec3::new(rate * cos, rate * sin, spin),
            calibrated: true,
            ..Motion::default()
        });
    }

    fn weight(&self) -> f32 {
        self.params.mass * GRAVITY
    }

    /// Sliding off while the arms close.
    fn escaping() -> Self {
        let mut r = Self::clamping();
        r.leans(20.0, 0.5);
        r.expect(0.05, Mode::Escaping);
        r
    }
}

#[test]
fn a_lean_that_grows_or_is_hopeless_ends_the_closing() {
    for (degrees, rate, ends) in [
        (20.0, 0.5, true),
        (-20.0, -0.5, true),
        (26.0, 0.0, true),
        (-26.0, 0.0, true),
        // Rocking on the pads; slow; returning.
        (10.0, 0.05, false),
        (20.0, 0.09, false),
        (20.0, -0.5, false),
        (-20.0, 0.5, false),
    ] {
        for make in [Rig::touched as fn() -> Rig, Rig::clamping] {
            let mut r = make();
            r.leans(degrees, rate);
            let mode = r.run(0.05);
            assert_eq!(
                mode == Mode::Escaping,
                ends,
                "{degrees} deg at {rate} rad/s: {mode:?}"
            );
            assert!(!ends || r.out.reason == Some(Reason::SlidesOff));
        }
    }
    // Pressed, and not proven.
    let mut r = Rig::clamping();
    r.grip(false, false, ArmState::Touching, 800.0);
    r.run(0.5);
    r.leans(20.0, 0.5);
    r.expect(0.05, Mode::Escaping);
    // Holding arms need no rotors.
    let mut r = Rig::clamping();
    r.grip(true, false, ArmState::Holding, 950.0);
    r.run(0.5);
    r.leans(26.0, 0.5);
    r.expect(0.5, Mode::Clamping);
}

/// Headed off the pipe, a turn about its axis is one of roll and pitch.
#[test]
fn a_slide_counts_however_the_vehicle_is_headed() {
    for across in [0.0, 20.0, -45.0, 90.0] {
        for (degrees, rate, ends) in [
            (18.0, 0.4, true),
            (-18.0, -0.4, true),
            (18.0, -0.4, false),
            (18.0, 0.2, false),
            (10.0, 0.4, false),
        ] {
            let mut r = Rig::touched();
            r.turns([degrees, rate, across], [0.0, 0.0]);
            let ended = r.run(0.05) == Mode::Escaping;
            assert_eq!(ended, ends, "{degrees} deg at {rate} rad/s, {across} deg across");
        }
    }
}

#[test]
fn the_pitch_before_the_touch_is_no_lean() {
    for (before, leaves) in [(12.0f32, false), (0.0, true)] {
        let mut r = Rig::flying();
        r.inputs.motion = Some(Motion {
            q: Quat::from_euler(0.0, deg(before), 0.0),
            calibrated: true,
            ..Motion::default()
        });
        r.sticks().throttle = 0.3;
        r.sticks().perch_switch = true;
        r.run(1.0);
        r.carried = true;
        r.expect(0.18, Mode::Contact);
        r.inputs.motion = Some(Motion {
            q: Quat::from_euler(deg(12.0), deg(12.0), 0.0),
            rate: Vec3::new(0.5, 0.0, 0.0),
            calibrated: true,
            ..Motion::default()
        });
        assert_eq!(
            r.run(0.05) == Mode::Escaping,
            leaves,
            "{before} deg of pitch before"
        );
    }
}

#[test]
fn a_heading_that_turns_on_the_pads_ends_the_closing_until_the_arms_hold() {
    for (twist, spin, ends) in [
        (14.0, 0.2, true),
        (-14.0, -0.2, true),
        (12.0, 0.5, false),
        (14.0, 0.0, false),
        (14.0, -0.5, false),
    ] {
        for make in [Rig::touched as fn() -> Rig, Rig::clamping] {
            let mut r = make();
            r.turns([0.0; 3], [twist, spin]);
            let ended = r.run(0.05) == Mode::Escaping;
            assert_eq!(ended, ends, "{twist} deg at {spin} rad/s");
        }
    }
    let mut r = Rig::clamping();
    r.grip(false, false, ArmState::Touching, 700.0);
    r.turns([0.0; 3], [14.0, 0.2]);
    r.expect(0.1, Mode::Clamping);
}

/// Arms that are still bent round the pipe would hook it.
#[test]
fn an_escape_from_a_stand_rises_when_the_arms_are_free_where_friction_holds() {
    let stands = |lean: f32| {
        let mut r = Rig::clamping();
        r.grip(false, false, ArmState::Touching, 400.0);
        r.leans(lean, 0.0);
        r.run(0.2);
        r.sticks().perch_switch = false;
        r.expect(0.05, Mode::Escaping);
        r
    };
    let share = |r: &Rig| r.out.rotors.thrust() / r.weight();
    let mut r = stands(5.0);
    r.run(1.7);
    assert!(
        share(&r) < 0.45 && r.out.tendons == ClampCommand::Release,
        "{}",
        share(&r)
    );
    // At most 2 s: a sensor may say that an arm is closed.
    let mut late = r.clone();
    late.run(0.8);
    assert!(share(&late) > 1.2, "{}", share(&late));
    r.grip(false, true, ArmState::Free, 0.0);
    r.run(0.6);
    assert!(share(&r) > 1.2 && r.out.mode == Mode::Escaping, "{}", share(&r));
    // Friction does not hold 17° at a release's share of the weight.
    let mut r = stands(17.0);
    r.run(0.9);
    assert!(share(&r) > 1.2, "{}", share(&r));
    // Nor a slide: at once.
    let mut r = stands(5.0);
    r.leans(20.0, 0.5);
    r.run(0.15);
    assert!(share(&r) > 1.2, "{}", share(&r));
}

#[test]
fn a_touch_that_leans_too_much_is_left_before_an_arm_closes() {
    for (degrees, carried, switch, leaves) in [
        (17.0, true, true, true),
        (-17.0, true, true, true),
        (14.0, true, true, false),
        (17.0, false, true, false),
        (17.0, true, false, false),
    ] {
        let mut r = Rig::flying();
        r.sticks().throttle = 0.3;
        r.sticks().perch_switch = switch;
        r.run(1.0);
        r.carried = carried;
        r.leans(degrees, 0.0);
        let mode = r.run(0.4);
        assert_eq!(
            mode == Mode::Escaping,
            leaves,
            "{degrees} {carried} {switch}: {mode:?}"
        );
        assert!(!leaves || (r.out.grip_memory, r.out.tendons) == (GripMemory::Open, ClampCommand::Release));
    }
}

#[test]
fn an_escape_lifts_nearly_level_until_the_throttle_carries() {
    for side in [1.0f32, -1.0] {
        let mut r = Rig::clamping();
        r.leans(20.0 * side, 0.5 * side);
        r.expect(0.05, Mode::Escaping);
        r.run(0.2);
        assert!(
            r.out.rotors.thrust() >= 1.34 * r.weight(),
            "{}",
            r.out.rotors.thrust()
        );
        let Setpoint::Escape {
            roll,
            pitch,
            yaw_rate,
            ..
        } = r.out.rotors
        else {
            panic!("{:?}", r.out.rotors)
        };
        // 8° of the 20° stay, away from the pipe.
        assert!((roll - deg(8.0 * side)).abs() < 1e-4 && pitch == 0.0 && yaw_rate == 0.0);
        assert_eq!(
            (r.out.tendons, r.out.grip_memory),
            (ClampCommand::Release, GripMemory::Controlled(ArmChoice::All))
        );
        r.grip(false, true, ArmState::Free, 0.0);
        r.carried = false;
        r.leans(0.0, 0.0);
        // Resting throttle would drop it.
        r.sticks().roll = 0.5;
        r.expect(1.5, Mode::Escaping);
        assert_eq!(r.out.grip_memory, GripMemory::Open);
        assert!(
            matches!(r.out.rotors, Setpoint::Escape { roll, .. } if roll > 0.3),
            "clear: the pilot steers"
        );
        r.sticks().throttle = TAKE_OVER_SHARE * r.weight() / 33.2 - 0.01;
        r.expect(0.1, Mode::Escaping);
        r.sticks().throttle += 0.02;
        r.expect(0.02, Mode::Flight);
    }
}

#[test]
fn an_escape_climbs_and_then_keeps_its_height() {
    let mut r = Rig::escaping();
    r.grip(false, true, ArmState::Free, 0.0);
    r.carried = false;
    r.leans(0.0, 0.0);
    let mut climb = 0.0f32;
    let mut most = 0.0f32;
    for _ in 0..(4.0 / DT) as u32 {
        r.step();
        climb += (r.out.rotors.thrust() / r.params.mass - GRAVITY) * DT;
        most = most.max(climb);
    }
    assert_eq!(r.out.mode, Mode::Escaping);
    assert!(
        (0.3..0.7).contains(&most) && climb.abs() < 0.1,
        "{most} then {climb} m/s"
    );
}

#[test]
fn nobody_on_the_throttle_is_brought_down_and_may_still_take_over() {
    let mut r = Rig::escaping();
    r.grip(false, true, ArmState::Free, 0.0);
    r.carried = false;
    r.leans(0.0, 0.0);
    r.expect(TAKE_OVER_TIME - 0.2, Mode::Escaping);
    r.expect(0.3, Mode::Failsafe);
    assert_eq!(r.out.reason, Some(Reason::NotTakenOver));
    r.run(1.0);
    assert!((0.8..1.0).contains(&(r.out.rotors.thrust() / r.weight())));
    r.sticks().throttle = 0.55;
    r.expect(0.02, Mode::Flight);
}

#[test]
fn an_escape_outlives_the_radio_until_the_vehicle_is_clear() {
    let mut r = Rig::escaping();
    r.inputs.sticks = None;
    r.carried = false;
    r.leans(0.0, 0.0);
    r.grip(false, true, ArmState::Free, 0.0);
    r.expect(0.6, Mode::Escaping);
    r.expect(0.2, Mode::Failsafe);
    assert_eq!(r.out.reason, Some(Reason::RADIO_LOST));
    let mut r = Rig::escaping();
    r.inputs.battery = Some(12.0);
    r.carried = false;
    r.leans(0.0, 0.0);
    r.grip(false, true, ArmState::Free, 0.0);
    r.expect(1.2, Mode::Failsafe);
    assert_eq!(r.out.reason, Some(Reason::BatteryCritical));
}

#[test]
fn a_release_that_nothing_carries_is_an_escape() {
    let mut r = Rig::releasing();
    r.expect(1.8, Mode::Releasing);
    assert_eq!(r.out.tendons, ClampCommand::Release);
    r.carried = false;
    // 0.05 s without support, through its low pass of 5 Hz.
    let mut most = 0.0f32;
    for _ in 0..35 {
        r.step();
        most = most.max(r.out.rotors.thrust());
    }
    assert_eq!(r.out.mode, Mode::Escaping);
    assert!(most > 1.25 * r.weight(), "{most}");
    let mut r = Rig::releasing();
    r.grip(false, false, ArmState::Releasing, 100.0);
    r.run(1.8);
    r.leans(20.0, 0.5);
    r.expect(0.05, Mode::Escaping);
}

#[test]
fn arms_that_do_not_come_free_are_not_pulled_at_for_ever() {
    let mut r = Rig::escaping();
    r.leans(0.0, 0.0);
    r.expect(FREE_MAX - 0.2, Mode::Escaping);
    r.expect(0.3, Mode::Releasing);
    assert_eq!(
        (r.out.reason, r.out.tendons),
        (Some(Reason::ArmsStuck), ClampCommand::Release)
    );
    r.run(1.0);
    assert!(
        r.out.rotors.thrust() <= 0.42 * 33.2 + 0.1,
        "the pipe carries the rest"
    );
    // Also reported on a release.
    let mut r = Rig::releasing();
    r.expect(9.8, Mode::Releasing);
    assert_eq!(r.out.reason, None);
    r.expect(0.3, Mode::Releasing);
    assert_eq!(r.out.reason, Some(Reason::ArmsStuck));
    // Arms sensed as closed may be free.
    let mut r = Rig::escaping();
    r.leans(0.0, 0.0);
    r.carried = false;
    r.sticks().throttle = 0.55;
    r.expect(FREE_MAX - 0.2, Mode::Escaping);
    r.expect(0.3, Mode::Flight);
}

#[test]
fn the_arm_switch_ends_an_escape_as_it_ends_a_release() {
    for (free, grip_memory) in [
        (false, GripMemory::Controlled(ArmChoice::All)),
        (true, GripMemory::Open),
    ] {
        for make in [Rig::escaping as fn() -> Rig, Rig::releasing] {
            let mut r = make();
            r.run(1.8);
            r.grip(false, free, ArmState::Releasing, 0.0);
            r.sticks().arm_switch = false;
            r.step();
            assert_eq!(
                (r.out.mode, r.out.rotors, r.out.grip_memory),
                (Mode::Disarmed, Setpoint::Stop, grip_memory)
            );
            r.run(2.0);
            assert_eq!(
                r.out.grip_memory, grip_memory,
                "opening again takes a new turn of the switch"
            );
        }
    }
}

#[test]
fn no_arm_lets_go_beyond_the_lean_at_which_the_belly_stays() {
    for (degrees, after) in [
        (27.0, Mode::Releasing),
        (29.0, Mode::Perched),
        (-29.0, Mode::Perched),
    ] {
        let mut r = Rig::perched();
        r.leans(degrees, 0.0);
        r.sticks().throttle = 0.3;
        r.sticks().perch_switch = false;
        r.expect(0.5, after);
        assert_eq!(
            r.out.reason == Some(Reason::LeansTooFar),
            after == Mode::Perched,
            "{:?}",
            r.out.reason
        );
    }
    // The lean grows in spool-up.
    let mut r = Rig::releasing();
    r.run(1.0);
    r.leans(29.0, 0.0);
    r.expect(0.3, Mode::Releasing);
    for _ in 0..30 {
        r.step();
        assert!(r.out.tendons != ClampCommand::Release, "not for one step");
    }
    assert_eq!(r.out.mode, Mode::Clamping);
    assert_eq!(
        (r.out.reason, r.out.tendons),
        (
            Some(Reason::LeansTooFar),
            ClampCommand::Close { arms: ArmChoice::All }
        )
    );
    // Cancelled in the grip: closed, the rotors stop.
    let mut r = Rig::clamping();
    r.grip(true, false, ArmState::Holding, 950.0);
    r.run(0.5);
    r.leans(29.0, 0.0);
    r.sticks().perch_switch = false;
    r.expect(0.5, Mode::Clamping);
    assert_eq!(r.out.reason, Some(Reason::LeansTooFar));
    r.expect(3.5, Mode::Perched);
    // Upright: a release.
    let mut r = Rig::clamping();
    r.grip(true, false, ArmState::Holding, 950.0);
    r.run(0.5);
    r.sticks().perch_switch = false;
    r.expect(0.1, Mode::Releasing);
}

#[test]
fn a_lean_that_friction_does_not_hold_is_lifted_off_as_the_arms_open() {
    for (degrees, lifted) in [(14.0, false), (-14.0, false), (18.0, true), (-18.0, true)] {
        let mut r = Rig::releasing();
        r.leans(degrees, 0.0);
        r.expect(1.3, Mode::Releasing);
        assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
        let mode = r.run(0.3);
        assert_eq!(mode == Mode::Escaping, lifted, "{degrees}: {mode:?}");
        if lifted {
            // Rotors first: they begin with the least thrust of a release and reach more than the weight.
            assert_eq!(r.out.reason, Some(Reason::LiftsOff));
            assert_eq!(r.out.tendons, ClampCommand::Release);
            r.run(0.7);
            assert!(r.out.rotors.thrust() > 1.3 * r.weight());
        }
    }
}

#[test]
fn a_lean_that_creeps_out_while_the_arms_close_is_left() {
    for (from, to, rate, leaves) in [
        (0.0, 7.0, 0.2, true),
        (10.0, 17.0, 0.2, true),
        (-10.0, -17.0, -0.2, true),
        // Not far enough; standing; rocking back.
        (10.0, 14.0, 0.2, false),
        (0.0, 7.0, 0.05, false),
        (-10.0, -17.0, 0.2, false),
    ] {
        let mut r = Rig::touched();
        r.grip(false, false, ArmState::Closing, 0.0);
        r.leans(from, 0.0);
        r.expect(0.4, Mode::Clamping);
        r.leans(to, rate);
        let mode = r.run(0.05);
        assert_eq!(
            mode == Mode::Escaping,
            leaves,
            "{from} to {to} at {rate}: {mode:?}"
        );
    }
}

#[test]
fn a_touch_without_lasting_support_is_escaped_and_a_bounce_is_not() {
    for (seconds, leaves) in [(0.15, false), (0.5, true)] {
        let mut r = Rig::touched();
        r.carried = false;
        let mode = r.run(seconds);
        assert_eq!(mode == Mode::Escaping, leaves, "{seconds} s: {mode:?}");
    }
    // What slides off soon after a touch is left where nothing carries any more.
    let mut r = Rig::flying();
    r.sticks().throttle = 0.3;
    r.sticks().perch_switch = true;
    r.run(1.0);
    r.carried = true;
    r.leans(5.0, 0.9);
    r.expect(0.1, Mode::Flight);
    r.carried = false;
    r.leans(17.0, 0.9);
    r.expect(0.1, Mode::Escaping);
}

#[test]
fn a_lower_friction_refuses_smaller_leans() {
    for (friction, lean, refused) in [(0.6, 14.0, false), (0.3, 10.0, true), (0.3, 7.0, false)] {
        let mut r = Rig::with(Params {
            pipe_friction: friction,
            ..Params::default()
        });
        r.fly();
        r.sticks().throttle = 0.3;
        r.sticks().perch_switch = true;
        r.run(1.0);
        r.carried = true;
        r.leans(lean, 0.0);
        let mode = r.run(0.1);
        assert_eq!(mode == Mode::Escaping, refused, "{friction} {lean}: {mode:?}");
    }
}

#[test]
fn the_pilot_reads_on_which_side_the_crown_is() {
    // 0.3 N m over 17.7 N less 6.6 N: 27 mm; 0.1 N m: 9 mm.
    for (moment, shown) in [
        (-0.3, Some(Reason::CrownLeft)),
        (0.3, Some(Reason::CrownRight)),
        (0.1, None),
        (f32::NAN, None),
    ] {
        let mut r = Rig::clamping();
        r.inputs.roll_moment = moment;
        r.run(1.0);
        assert_eq!(r.out.reason, shown, "{moment} N m");
    }
}

#[test]
fn a_perched_vehicle_that_turns_round_the_pipe_is_tightened_a_few_times() {
    let tight = |times| ClampCommand::Tighten {
        arms: ArmChoice::All,
        times,
    };
    let closed = ClampCommand::Close { arms: ArmChoice::All };
    // A push, and what the spool-down leaves.
    let mut r = Rig::perched();
    r.leans(-6.0, 0.0);
    r.expect(0.4, Mode::Perched);
    r.leans(0.4, 0.0);
    r.expect(5.0, Mode::Perched);
    assert_eq!((r.out.reason, r.out.tendons), (None, closed));
    // A sensor that drifts by two degrees in ten minutes.
    for second in 0..600u16 {
        r.leans(0.4 + f32::from(second) / 300.0, 0.0);
        r.run(1.0);
        assert_eq!((r.out.reason, r.out.tendons), (None, closed), "{second} s");
    }

    // Creeping on after each answer, then at once.
    let mut r = Rig::perched();
    r.leans(3.0, 0.0);
    r.expect(0.6, Mode::Perched);
    assert_eq!(
        (r.out.reason, r.out.tendons),
        (Some(Reason::TightensOnce), tight(1))
    );
    r.leans(4.5, 0.2);
    r.expect(0.15, Mode::Perched);
    assert_eq!(r.out.tendons, tight(1), "too soon for another");
    r.expect(0.1, Mode::Perched);
    assert_eq!(
        (r.out.reason, r.out.tendons),
        (Some(Reason::TightensLast), tight(2))
    );
    r.leans(7.0, 0.0);
    r.expect(0.6, Mode::Perched);
    assert_eq!((r.out.reason, r.out.tendons), (Some(Reason::Slips), tight(2)));

    // The rotors are up at once, and do not wait for the arms.
    r.sticks().throttle = 0.3;
    r.sticks().perch_switch = false;
    r.expect(0.02, Mode::Escaping);
    assert_eq!(
        (r.out.reason, r.out.tendons),
        (Some(Reason::LiftsOff), ClampCommand::Release)
    );
    assert!(r.out.rotors.thrust() >= release_thrust(&r.params) - 0.1);
    r.run(0.08);
    r.run(0.7);
    assert!(r.out.rotors.thrust() > 1.2 * r.weight());
}

#[test]
fn a_lean_that_grows_as_the_rotors_spool_up_ends_the_release() {
    for (degrees, rate, ends) in [
        (8.5, 0.2, true),
        (7.5, 0.2, false),
        (8.5, 0.0, false),
        (8.5, -0.2, false),
    ] {
        let mut r = Rig::perched();
        r.leans(6.0, 0.0);
        // Tightened arms leave otherwise.
        r.inputs.grip.as_mut().unwrap().arms[0].force = 1000.0;
        r.run(1.0);
        r.sticks().throttle = 0.3;
        r.sticks().perch_switch = false;
        r.expect(0.5, Mode::Releasing);
        r.leans(degrees, rate);
        let ended = r.run(0.06) == Mode::Escaping;
        assert_eq!(ended, ends, "{degrees} deg at {rate} rad/s");
    }
}

#[test]
fn arms_that_have_no_force_left_are_not_tightened() {
    for (state, force) in [
        (ArmState::Holding, 1000.0),
        (ArmState::ForceLimited, 40.0),
        (ArmState::Faulty, 40.0),
    ] {
        let mut r = Rig::perched();
        let grip = r.inputs.grip.as_mut().unwrap();
        grip.arms[2].state = state;
        grip.arms[2].force = force;
        // Faulty, it holds nothing that counts.
        let why = if state == ArmState::Faulty {
            Reason::GripLost
        } else {
            Reason::Slips
        };
        r.leans(4.0, 0.0);
        r.expect(3.0, Mode::Perched);
        assert_eq!(r.out.reason, Some(why), "{state:?}");
        assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
    }
}

/// Set down beside the pipe at 20° of lean, where no support is ever felt: the throttle of a set-down would let it fall.
#[test]
fn a_vehicle_that_falls_beside_the_pipe_is_caught() {
    for (degrees, switch, caught) in [
        (20.0, true, true),
        (-20.0, true, true),
        // The switch is off again before the throttle follows.
        (20.0, false, true),
        // What leans less may still be coming down.
        (8.0, true, false),
    ] {
        let mut r = Rig::flying();
        r.leans(degrees, 0.0);
        r.sticks().perch_switch = true;
        r.expect(0.1, Mode::Flight);
        r.sticks().throttle = 0.3;
        r.sticks().perch_switch = switch;
        let mode = r.run(0.3);
        assert_eq!(mode == Mode::Escaping, caught, "{degrees} deg: {mode:?}");
    }
    // A switch that has been off for long means no pipe.
    let mut r = Rig::flying();
    r.sticks().perch_switch = true;
    r.expect(0.1, Mode::Flight);
    r.sticks().perch_switch = false;
    r.expect(1.1, Mode::Flight);
    r.leans(20.0, 0.0);
    r.sticks().throttle = 0.3;
    r.expect(0.5, Mode::Flight);
}

/// Called off at the touch while it slides: until the throttle follows, that is a slide like any other.
#[test]
fn a_touch_called_off_in_a_slide_is_left_at_once() {
    let mut r = Rig::touched();
    r.sticks().perch_switch = false;
    r.leans(12.0, 0.8);
    r.expect(0.02, Mode::Flight);
    r.leans(18.0, 0.8);
    r.expect(0.1, Mode::Escaping);
}

/// What it fell before counts: the collective is what stops it, and it ends in a climb.
#[test]
fn an_escape_of_a_falling_vehicle_stops_the_fall() {
    let mut r = Rig::flying();
    r.leans(20.0, 0.0);
    r.sticks().perch_switch = true;
    r.expect(0.1, Mode::Flight);
    r.sticks().throttle = 0.25;
    while r.run(DT) == Mode::Flight {}
    assert_eq!(r.out.mode, Mode::Escaping);
    let fallen = r.falling;
    let most = (0..10).fold(0.0, |most: f32, _| {
        r.step();
        most.max(r.out.rotors.thrust())
    });
    // Level and from rest it would be 1.35 of the weight.
    assert!(
        fallen > 0.25 && most > 1.5 * r.weight() && most < 1.7 * r.weight() / deg(20.0).cos(),
        "{fallen} m/s: {most} N"
    );
    r.leans(0.0, 0.0);
    let least = (0..60).fold(f32::MAX, |least, _| {
        r.step();
        least.min(r.falling)
    });
    assert!(least < -0.3, "{least} m/s downwards");
}

/// He may see it slide: his throttle is there within 0.1 s.
#[test]
fn a_pilot_who_calls_off_has_his_throttle_soon() {
    let mut r = Rig::touched();
    r.run(0.1);
    r.sticks().throttle = 0.9;
    r.expect(0.12, Mode::Flight);
    assert!(
        (r.out.rotors.thrust() - 0.9 * 33.2).abs() < 0.01,
        "{:?}",
        r.out.rotors
    );
}
