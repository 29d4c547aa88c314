//! Every trouble in each state where it can occur.

use super::rig::Rig;
use crate::arming::{ArmingInhibit, ArmingInhibits};
use crate::attitude::motion::Motion;
use crate::battery::ServoSupply;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::grip::ArmState;
use crate::gripper::grip_geometry::Misfit;
use crate::maths::scalar::{GRAVITY, deg};
use crate::maths::vector::{Quat, Vec3};
use crate::mode::inputs::dangers::{BATTERY_TIME, IMU_LOST_TIME, TIPPED_TIME};
use crate::mode::shared::on_pipe::SPOOL_DOWN_TIME;
use crate::mode::states::clamping::{HOPELESS_TIME, STOP_TIME};
use crate::mode::states::contact::CONTACT_TIME;
use crate::mode::states::failsafe::RESUME_TIME;
use crate::mode::*;
use crate::params::{ImuGyroRange, Params};
use crate::pilot::rc::{ArmChoice, StickMode, Sticks};

#[test]
fn the_arm_switch_stops_the_rotors_in_one_step_and_never_opens_a_grip() {
    for (make, after, closed) in [
        (Rig::armed as fn() -> Rig, Mode::Disarmed, false),
        (Rig::flying, Mode::Disarmed, false),
        (Rig::touched, Mode::Disarmed, false),
        (Rig::clamping, Mode::Disarmed, true),
        (Rig::perched, Mode::Perched, true),
        (Rig::releasing, Mode::Perched, true),
    ] {
        let mut r = make();
        r.sticks().arm_switch = false;
        r.step();
        assert_eq!((r.out.mode, r.out.rotors), (after, Setpoint::Stop));
        assert_eq!(r.out.tendons != ClampCommand::Release, closed, "{after:?}");
        r.expect(3.0, after);
    }
}

#[test]
fn arming_is_refused_with_a_reason_that_can_be_read() {
    let mut r = Rig::new();
    r.sticks().arm_switch = true;
    r.inputs.motion = Some(Motion {
        calibrated: true,
        ..Default::default()
    });
    r.sticks().yaw = 1.0;
    r.expect(3.0, Mode::Disarmed);
    assert_eq!(
        r.out.reason,
        Some(Reason::Check(ArmingInhibit::SwitchOnAtPowerUp))
    );
    r.sticks().arm_switch = false;
    r.run(0.1);
    r.sticks().arm_switch = true;
    r.inputs.battery = Some(13.0);
    r.expect(3.0, Mode::Disarmed);
    assert_eq!(r.out.reason, Some(Reason::Check(ArmingInhibit::BatteryLow)));
    assert!(r.out.inhibits.contains(ArmingInhibit::BatteryLow));
    r.inputs.battery = Some(16.0);
    r.inputs.fsr_fault = [false, true, false, false];
    r.sticks().arms = ArmChoice::Front;
    r.run(0.1);
    assert!(r.out.inhibits.is_empty(), "a sensor that nobody needs");
    // Arms 2 and 4 are the rear ones.
    r.inputs.hardware = ArmingInhibits::NONE
        .with(ArmingInhibit::FsrRange2)
        .with(ArmingInhibit::FsrRange4);
    r.run(0.1);
    assert!(r.out.inhibits.is_empty(), "a range that nobody needs");
    r.inputs.hardware = r.inputs.hardware.with(ArmingInhibit::FsrRange3);
    r.run(0.1);
    assert!(r.out.inhibits.iter().eq([ArmingInhibit::FsrRange3]));
    assert_eq!(r.out.reason, Some(Reason::Check(ArmingInhibit::FsrRange3)));
    r.inputs.hardware = ArmingInhibits::NONE;
    r.run(0.1);
    r.sticks().yaw = 0.0;
    r.run(0.1);
    r.sticks().yaw = 1.0;
    r.expect(1.1, Mode::Armed);
}

#[test]
fn a_closing_without_grip_is_given_up_and_not_tried_again_by_itself() {
    for (state, seconds, why) in [
        (ArmState::Closing, 10.0, Reason::GripNotProven),
        (ArmState::ForceLimited, HOPELESS_TIME, Reason::ForceLimit),
        (ArmState::Faulty, HOPELESS_TIME, Reason::ArmFault(None)),
    ] {
        let mut r = Rig::clamping();
        r.grip(false, false, state, 500.0);
        r.expect(seconds + 0.1, Mode::Escaping);
        assert_eq!(r.out.reason, Some(why));
        assert!(r.out.rotors.spin());
        r.run(0.1);
        assert_eq!(r.out.tendons, ClampCommand::Release);
        r.grip(false, true, ArmState::Free, 0.0);
        r.carried = false;
        r.sticks().throttle = 0.53;
        r.expect(3.0, Mode::Flight);
        r.carried = true;
        r.sticks().throttle = 0.3;
        r.expect(1.0, Mode::Flight);
        assert_eq!(r.out.reason, Some(Reason::PerchSwitchNotOff));
        r.sticks().perch_switch = false;
        r.run(0.1);
        r.sticks().perch_switch = true;
        r.expect(0.1, Mode::Contact);
    }
}

#[test]
fn arms_that_press_and_hold_no_pipe_are_given_up_with_the_reason() {
    for (misfit, why) in [
        (Misfit::Thickness, Reason::PipeMisfit),
        (Misfit::Oblique, Reason::PipeOblique),
        (Misfit::Uneven, Reason::ArmsUneven),
        (Misfit::Opposed, Reason::ArmsOpposed),
    ] {
        let mut r = Rig::clamping();
        r.grip(false, false, ArmState::Holding, 950.0);
        r.inputs.grip.as_mut().unwrap().misfit = Some(misfit);
        // An oblique pipe comes no better.
        let time = if misfit == Misfit::Oblique {
            0.1
        } else {
            HOPELESS_TIME
        };
        r.expect(time - 0.05, Mode::Clamping);
        assert!(r.out.rotors.thrust() > 6.6, "the rotors keep their share");
        r.expect(0.1, Mode::Escaping);
        assert_eq!(r.out.reason, Some(why));
    }
}

#[test]
fn a_grip_that_leans_where_friction_alone_would_not_hold_it_is_given_up() {
    // On 0.3 of friction and 0.3 m a push is held up to 5.8 degrees (the friction limit's own test).
    let slippery = Params {
        pipe_friction: 0.3,
        perch_lift: 0.1,
        ..Params::default()
    };
    for (lean, mode) in [(5.0, Mode::Perched), (6.5, Mode::Escaping)] {
        let mut r = Rig::clamping_with(slippery);
        let motion = r.inputs.motion.as_mut().unwrap();
        motion.q = Quat::from_euler(deg(lean), 0.0, 0.0);
        r.grip(true, false, ArmState::Holding, 950.0);
        r.run(HOPELESS_TIME + 0.05);
        let why = (mode == Mode::Escaping).then_some(Reason::LeansToStay);
        assert!(why.is_none() || r.out.reason == why, "{lean}: {:?}", r.out.reason);
        r.run(SPOOL_DOWN_TIME + STOP_TIME);
        assert_eq!(r.out.mode, mode, "{lean} deg");
    }
}

#[test]
fn a_grip_lost_while_spooling_down_brings_the_rotors_back() {
    let mut r = Rig::clamping();
    r.grip(true, false, ArmState::Holding, 950.0);
    r.run(1.0);
    let low = r.out.rotors.thrust();
    r.grip(false, false, ArmState::Touching, 700.0);
    r.run(0.2);
    assert!(r.out.rotors.thrust() < low, "outside its tolerance, but it holds");
    r.grip(false, false, ArmState::Touching, 100.0);
    r.expect(2.0, Mode::Clamping);
    assert!(r.out.rotors.thrust() > 6.6);
}

#[test]
fn a_push_that_rocks_a_perched_body_on_its_pads_tightens_nothing() {
    for (bent, tightens) in [(0.7, false), (0.0, true), (f32::NAN, true)] {
        let mut r = Rig::perched();
        r.inputs.tilts = [Some(-1.2); 4];
        r.run(1.0);
        let motion = r.inputs.motion.as_mut().unwrap();
        motion.q = Quat::from_euler(deg(0.7), 0.0, 0.0);
        let bent = deg(bent);
        r.inputs.tilts = [-1.2 - bent, -1.2 - bent, -1.2 + bent, -1.2 + bent].map(Some);
        r.run(1.0);
        let presses = matches!(r.out.tendons, ClampCommand::Tighten { .. });
        assert_eq!(presses, tightens, "bent by {bent}");
    }
}

#[test]
fn nothing_but_the_pilot_starts_the_rotors_of_a_perched_vehicle() {
    type Edit = fn(&mut Rig);
    let cases: [(Edit, Reason); 6] = [
        (
            |r| r.grip(false, false, ArmState::Touching, 100.0),
            Reason::GripLost,
        ),
        (|r| r.inputs.grip = None, Reason::ClampSilent),
        (|r| r.inputs.sticks = None, Reason::RADIO_LOST),
        (|r| r.inputs.motion = None, Reason::IMU_SILENT),
        (|r| r.inputs.battery = Some(12.0), Reason::BatteryCritical),
        (|r| r.inputs.battery = None, Reason::BATTERY_SILENT),
    ];
    for (edit, why) in cases {
        let mut r = Rig::perched();
        edit(&mut r);
        r.expect(10.0, Mode::Perched);
        assert_eq!((r.out.reason, r.out.rotors), (Some(why), Setpoint::Stop));
        assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
    }
    for throttle in [0.0, 0.19, 0.43, 1.0] {
        let mut r = Rig::perched();
        r.sticks().throttle = throttle;
        r.sticks().perch_switch = false;
        r.expect(1.0, Mode::Perched);
    }
}

#[test]
fn a_person_opens_the_arms_of_a_disarmed_vehicle_on_purpose() {
    let mut r = Rig::perched();
    r.sticks().arm_switch = false;
    r.sticks().yaw = -1.0;
    r.expect(1.1, Mode::Disarmed);
    assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
    // Only a lost grip forbids arming.
    assert!(!r.out.inhibits.contains(ArmingInhibit::ArmsClosed));
    r.grip(false, false, ArmState::Touching, 100.0);
    r.run(0.1);
    assert!(r.out.inhibits.contains(ArmingInhibit::ArmsClosed));
    r.sticks().perch_switch = false;
    r.run(0.1);
    assert_eq!(r.out.tendons, ClampCommand::Release);
}

#[test]
fn a_lost_radio_in_flight_sinks_and_stops_on_what_carries() {
    let mut r = Rig::flying();
    r.inputs.sticks = None;
    r.expect(0.02, Mode::Failsafe);
    r.run(0.6);
    let weight = r.params.mass * GRAVITY;
    let share = r.out.rotors.thrust() / weight;
    assert!((0.84..1.0).contains(&share), "{share}");
    assert!(matches!(
        r.out.rotors,
        Setpoint::Angle {
            roll: 0.0,
            pitch: 0.0,
            yaw_rate: 0.0,
            ..
        }
    ));
    r.expect(20.0, Mode::Failsafe);
    r.carried = true;
    // The sink rate must fade first.
    r.expect(10.0, Mode::Disarmed);
    assert_eq!(r.out.reason, Some(Reason::RADIO_LOST));
}

#[test]
fn a_battery_that_is_no_longer_measured_lands_like_a_low_one() {
    for lost in [None, Some(f32::NAN)] {
        let mut r = Rig::flying();
        // A few conversions that gave nothing are no blindness.
        for _ in 0..20 {
            r.inputs.battery = lost;
            r.expect(0.9, Mode::Flight);
            r.inputs.battery = Some(16.0);
            r.expect(0.01, Mode::Flight);
        }
        r.inputs.battery = lost;
        r.expect(0.98, Mode::Flight);
        assert_eq!(r.out.reason, None);
        r.expect(0.04, Mode::Failsafe);
        assert_eq!(r.out.reason, Some(Reason::BATTERY_SILENT));
        // The pilot steers, and a reading that comes back does not end it: it was good for a moment before as well.
        r.sticks().roll = 0.5;
        r.inputs.battery = Some(16.0);
        r.run(0.6);
        assert!(
            matches!(r.out.rotors, Setpoint::Angle { roll, .. } if roll > 0.2),
            "{:?}",
            r.out.rotors
        );
        r.expect(2.0, Mode::Failsafe);
        assert_eq!(r.out.reason, Some(Reason::BATTERY_SILENT));
    }
    // With the radio back the landing goes on for the battery.
    let mut r = Rig::flying();
    r.inputs.sticks = None;
    r.inputs.battery = None;
    r.expect(2.0, Mode::Failsafe);
    assert_eq!(r.out.reason, Some(Reason::RADIO_LOST));
    r.inputs.sticks = Some(Sticks {
        arm_switch: true,
        throttle: 0.5,
        ..Sticks::default()
    });
    r.expect(0.1, Mode::Failsafe);
    assert_eq!(r.out.reason, Some(Reason::BATTERY_SILENT));
}

#[test]
fn a_servo_battery_that_is_low_or_not_measured_begins_no_perch() {
    for (supply, why) in [
        (ServoSupply::Low, ArmingInhibit::ServoBatteryLow),
        (ServoSupply::Silent, ArmingInhibit::ServoBatterySilent),
    ] {
        let mut r = Rig::flying();
        r.inputs.servo_supply = supply;
        r.expect(1.0, Mode::Flight);
        assert_eq!(r.out.reason, None);
        // It is named before the pipe is reached, and on it the arms stay open.
        r.sticks().throttle = 0.3;
        r.sticks().perch_switch = true;
        r.expect(0.1, Mode::Flight);
        assert_eq!(r.out.reason, Some(Reason::Check(why)));
        r.carried = true;
        r.expect(2.0, Mode::Flight);
        assert_eq!(r.out.tendons, ClampCommand::Release);
        // Near its end it still closes.
        r.inputs.servo_supply = ServoSupply::NearEnd;
        r.expect(0.1, Mode::Contact);

        // On the ground it is one more reason against arming.
        let mut r = Rig::armed();
        r.sticks().arm_switch = false;
        r.expect(0.1, Mode::Disarmed);
        r.inputs.servo_supply = supply;
        r.run(0.1);
        assert!(r.out.inhibits.contains(why));
    }
}

#[test]
fn a_perched_vehicle_says_that_its_servos_lose_their_power_and_may_leave() {
    let mut r = Rig::perched();
    r.inputs.servo_supply = ServoSupply::Low;
    r.expect(30.0, Mode::Perched);
    let low = Reason::Check(ArmingInhibit::ServoBatteryLow);
    assert_eq!((r.out.reason, r.out.rotors), (Some(low), Setpoint::Stop));
    assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
    // Disarmed meanwhile, it may be armed again to leave.
    r.sticks().arm_switch = false;
    r.sticks().yaw = -1.0;
    r.expect(1.1, Mode::Disarmed);
    assert_eq!(
        r.out
            .inhibits
            .iter()
            .find(|i| *i == ArmingInhibit::ServoBatteryLow),
        None
    );
    r.sticks().arm_switch = true;
    r.sticks().yaw = 1.0;
    r.expect(1.1, Mode::Perched);
    // What a release lacks is said before it.
    r.sticks().yaw = 0.0;
    r.sticks().perch_switch = false;
    r.sticks().throttle = 0.5;
    r.expect(0.1, Mode::Perched);
    assert_eq!(r.out.reason, Some(Reason::ThrottleTooHigh));
    r.sticks().throttle = 0.3;
    r.expect(0.1, Mode::Releasing);
}

#[test]
fn the_radio_comes_back_by_itself_at_once_and_by_the_sticks_later() {
    let back = |after: f32, roll: f32| {
        let mut r = Rig::flying();
        let sticks = r.inputs.sticks.take();
        r.run(after);
        r.inputs.sticks = sticks;
        r.sticks().roll = roll;
        r.run(0.05)
    };
    assert_eq!(back(RESUME_TIME - 0.1, 0.0), Mode::Flight);
    assert_eq!(back(RESUME_TIME + 0.1, 0.0), Mode::Failsafe);
    assert_eq!(back(RESUME_TIME + 0.1, -0.4), Mode::Flight);
}

#[test]
fn a_lost_radio_on_the_pipe_keeps_closing_and_holds() {
    for make in [Rig::touched as fn() -> Rig, Rig::clamping, Rig::releasing] {
        let mut r = make();
        r.inputs.sticks = None;
        r.expect(CONTACT_TIME + 0.05, Mode::Clamping);
        assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
        r.grip(true, false, ArmState::Holding, 950.0);
        r.expect(4.0, Mode::Perched);
    }
    let mut r = Rig::releasing();
    let sticks = r.inputs.sticks.take();
    r.expect(4.0, Mode::Perched);
    r.inputs.sticks = sticks;
    r.expect(4.0, Mode::Perched);
    assert_eq!(r.out.reason, Some(Reason::PerchSwitchNotOn));
    let mut r = Rig::clamping();
    r.inputs.sticks = None;
    r.inputs.battery = Some(12.0);
    r.expect(5.0, Mode::Disarmed);
    assert_eq!(
        r.out.tendons,
        ClampCommand::Close { arms: ArmChoice::All },
        "no proof, no battery, no radio: hold on"
    );
    // A returning receiver with the switch off drops nothing: opening takes a new turn.
    let closed = ClampCommand::Close { arms: ArmChoice::All };
    for (perch_switch, tendons) in [(false, closed), (true, closed), (false, ClampCommand::Release)] {
        *r.sticks() = Sticks {
            perch_switch,
            ..Sticks::default()
        };
        r.expect(0.5, Mode::Disarmed);
        assert_eq!(r.out.tendons, tendons, "perch switch {perch_switch}");
    }
}

#[test]
fn a_turn_at_the_gyros_full_scale_stops_the_rotors_once_it_may_have_hidden_thirty_degrees() {
    let turning = |dps: f32| {
        Some(Motion {
            rate: Vec3::new(1.0, -deg(dps), 0.0),
            calibrated: true,
            ..Default::default()
        })
    };
    // 30 degrees are 15 ms at 2000 deg/s and 120 ms at 250, looked at every 10 ms.
    for (range, dps, steps) in [
        (ImuGyroRange::Dps2000, 1970.0, 2),
        (ImuGyroRange::Dps500, 495.0, 7),
        (ImuGyroRange::Dps250, 247.0, 13),
    ] {
        let params = Params {
            imu_gyro_range: range,
            ..Params::default()
        };
        let mut r = Rig::with(params);
        r.calibrated();
        r.run(0.1);
        r.arm();
        // Knocks that are shorter, and faster turns that the gyro still measures, are flown.
        for _ in 0..5 {
            r.inputs.motion = turning(dps);
            for _ in 0..steps - 1 {
                r.step();
            }
            r.inputs.motion = turning(0.95 * dps);
            r.step();
        }
        assert_eq!(r.out.mode, Mode::Armed, "{dps}");
        r.inputs.motion = turning(dps);
        for _ in 0..steps - 1 {
            r.step();
        }
        assert_eq!(r.out.mode, Mode::Armed, "{dps}");
        r.step();
        assert_eq!((r.out.mode, r.out.rotors), (Mode::Disarmed, Setpoint::Stop));
        assert_eq!(r.out.reason, Some(Reason::TippedOver));
    }
}

#[test]
fn an_attitude_that_is_not_that_of_gravity_does_not_arm() {
    // The rig's accelerometer reads the weight along body z.
    for (lean, off) in [
        (0.0, false),
        (9.0, false),
        (-11.0, true),
        (11.0, true),
        (180.0, true),
    ] {
        let mut r = Rig::new();
        r.inputs.motion = Some(Motion {
            q: Quat::from_euler(0.0, deg(lean), 0.0),
            calibrated: true,
            ..Default::default()
        });
        r.run(0.1);
        assert_eq!(r.out.mode, Mode::Disarmed);
        let refused = r.out.inhibits.contains(ArmingInhibit::NotCalibrated);
        assert_eq!(refused, off, "{lean}");
    }
    // Falling or knocked it says nothing of down.
    for (g, says) in [(0.0, false), (0.7, false), (0.9, true), (1.1, true), (1.3, false)] {
        let motion = Motion {
            q: Quat::from_euler(deg(20.0), 0.0, 0.0),
            accel: Vec3::new(0.0, 0.0, -GRAVITY * g),
            ..Default::default()
        };
        assert_eq!(motion.leans_unseen(), says, "{g}");
    }
}

#[test]
fn a_silent_sensor_or_a_crash_stops_the_rotors() {
    let over = Motion {
        q: Quat::from_euler(deg(120.0), 0.0, 0.0),
        calibrated: true,
        ..Default::default()
    };
    let broken = Motion {
        rate: Vec3::new(f32::NAN, 0.0, 0.0),
        calibrated: true,
        ..Default::default()
    };
    for (motion, after) in [
        (None, IMU_LOST_TIME),
        (Some(over), TIPPED_TIME),
        (Some(broken), IMU_LOST_TIME),
    ] {
        for make in [
            Rig::armed as fn() -> Rig,
            Rig::flying,
            Rig::touched,
            Rig::clamping,
        ] {
            let mut r = make();
            r.inputs.motion = motion;
            r.run(after + 0.03);
            assert_eq!((r.out.mode, r.out.rotors), (Mode::Disarmed, Setpoint::Stop));
            let clamped = matches!(r.out.tendons, ClampCommand::Close { arms: _ });
            assert_eq!(clamped, r.out.inhibits.contains(ArmingInhibit::ArmsClosed));
        }
    }
}

#[test]
fn an_empty_battery_lands_under_the_pilots_sticks() {
    let mut r = Rig::flying();
    r.inputs.battery = Some(12.5);
    r.expect(BATTERY_TIME - 0.1, Mode::Flight);
    r.expect(0.2, Mode::Failsafe);
    assert_eq!(r.out.reason, Some(Reason::BatteryCritical));
    r.sticks().roll = 0.5;
    r.sticks().stick_mode = StickMode::Direct;
    r.run(1.0);
    assert!(matches!(r.out.rotors, Setpoint::Angle { roll, .. } if roll > 0.3));
    r.carried = true;
    r.expect(6.0, Mode::Disarmed);
}

impl Rig {
    fn line_silent(&mut self, silent: bool) {
        let reason = ArmingInhibit::ImuLineSilent;
        let hardware = self.inputs.hardware;
        self.inputs.hardware = if silent {
            hardware.with(reason)
        } else {
            hardware.without(reason)
        };
    }
}

#[test]
fn a_silent_data_ready_line_refuses_arming_and_stops_rotors_that_idle() {
    let mut r = Rig::armed();
    r.line_silent(true);
    r.step();
    assert_eq!(
        (r.out.mode, r.out.rotors, r.out.reason),
        (Mode::Disarmed, Setpoint::Stop, Some(Reason::LINE_SILENT))
    );
    r.run(0.5);
    r.sticks().yaw = 1.0;
    r.expect(12.0, Mode::Disarmed);
    assert_eq!(r.out.reason, Some(Reason::LINE_SILENT));
    assert!(r.out.inhibits.iter().eq([ArmingInhibit::ImuLineSilent]));
    // Rearming takes a new gesture.
    r.line_silent(false);
    r.expect(0.5, Mode::Disarmed);
    assert_eq!(r.out.reason, None);
    r.sticks().yaw = 0.0;
    r.run(0.1);
    r.sticks().yaw = 1.0;
    r.expect(1.1, Mode::Armed);
}

#[test]
fn a_silent_data_ready_line_lands_under_the_pilots_sticks_even_if_it_comes_back() {
    for comes_back in [false, true] {
        let mut r = Rig::flying();
        r.line_silent(true);
        r.expect(0.02, Mode::Failsafe);
        assert_eq!(r.out.reason, Some(Reason::LINE_SILENT));
        assert!(r.out.rotors.spin());
        r.line_silent(!comes_back);
        r.sticks().roll = 0.5;
        r.run(1.0);
        assert!(matches!(r.out.rotors, Setpoint::Angle { roll, .. } if roll > 0.3));
        let share = r.out.rotors.thrust() / (r.params.mass * GRAVITY);
        assert!((0.84..1.0).contains(&share), "{share}");
        r.expect(5.0, Mode::Failsafe);
        r.carried = true;
        r.expect(6.0, Mode::Disarmed);
        assert_eq!(r.out.reason, Some(Reason::LINE_SILENT));
    }
    // The radio is lost too, and returns.
    let mut r = Rig::flying();
    let sticks = r.inputs.sticks.take();
    r.expect(0.5, Mode::Failsafe);
    r.line_silent(true);
    r.inputs.sticks = sticks;
    r.expect(0.5, Mode::Failsafe);
    assert_eq!(r.out.reason, Some(Reason::LINE_SILENT));
    // An empty battery has priority.
    let mut r = Rig::flying();
    r.inputs.battery = Some(12.0);
    r.expect(BATTERY_TIME + 0.1, Mode::Failsafe);
    r.line_silent(true);
    r.expect(0.5, Mode::Failsafe);
    assert_eq!(r.out.reason, Some(Reason::BatteryCritical));
}

#[test]
fn a_silent_data_ready_line_on_the_pipe_stays_there() {
    for make in [Rig::touched as fn() -> Rig, Rig::clamping] {
        let mut r = make();
        r.line_silent(true);
        r.expect(CONTACT_TIME + 0.05, Mode::Clamping);
        assert_eq!(r.out.reason, Some(Reason::LINE_SILENT));
        r.grip(true, false, ArmState::Holding, 950.0);
        r.run(0.5);
        // No cancelling once the arms hold.
        r.sticks().perch_switch = false;
        r.expect(4.0, Mode::Perched);
        assert_eq!(
            (r.out.reason, r.out.rotors),
            (Some(Reason::LINE_SILENT), Setpoint::Stop)
        );
    }
    // Perched: no spool-up.
    let mut r = Rig::perched();
    r.line_silent(true);
    r.sticks().perch_switch = false;
    r.sticks().throttle = 0.3;
    for _ in 0..1000 {
        r.step();
        assert_eq!((r.out.mode, r.out.rotors), (Mode::Perched, Setpoint::Stop));
        assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
    }
    assert_eq!(r.out.reason, Some(Reason::LINE_SILENT));
    r.line_silent(false);
    r.expect(0.1, Mode::Releasing);
    // Spooling up with closed arms: back onto the grip.
    r.run(0.5);
    assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
    r.line_silent(true);
    r.expect(0.1, Mode::Clamping);
    r.expect(4.0, Mode::Perched);
    assert_eq!(r.out.reason, Some(Reason::LINE_SILENT));
    // Opening arms let go, and the failsafe descends.
    let mut r = Rig::releasing();
    r.run(2.0);
    assert_eq!(r.out.tendons, ClampCommand::Release);
    r.line_silent(true);
    r.grip(false, true, ArmState::Free, 0.0);
    r.carried = false;
    for _ in 0..100 {
        r.step();
        assert!(r.out.rotors.spin());
    }
    assert_eq!(
        (r.out.mode, r.out.reason),
        (Mode::Failsafe, Some(Reason::LINE_SILENT))
    );
    // A closing without grip ends in the failsafe.
    let mut r = Rig::clamping();
    r.line_silent(true);
    r.grip(false, false, ArmState::ForceLimited, 500.0);
    r.expect(HOPELESS_TIME + 0.1, Mode::Escaping);
    r.grip(false, true, ArmState::Free, 0.0);
    r.carried = false;
    r.expect(3.0, Mode::Failsafe);
    assert_eq!(r.out.reason, Some(Reason::LINE_SILENT));
}
