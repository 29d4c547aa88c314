//! Units, signs and limits of every message, against numbers that are written down here.

use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_6};

use sophie_control::allocation::motor_pulses::MotorPulses;
use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::battery::{Battery, ServoBattery, ServoSupply};
use sophie_control::gripper::grip::{ArmGrip, ArmState, GripState};
use sophie_control::maths::scalar::deg;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::mode::{Mode, Reason};
use sophie_control::params::{MotorProtocol, Params};
use sophie_control::pilot::rc::{ArmChoice, StickMode, Sticks};
use sophie_control::vibration::Vibration;
use sophie_mavlink::Vehicle;
use sophie_mavlink::services::telemetry::*;

use sophie_dialect::*;

use crate::station::{Station, vehicle};

const ARMED: u8 = 128;

fn in_mode(mode: Mode) -> Vehicle {
    vehicle(mode)
}

fn near(a: f32, b: f32) -> bool {
    (a - b).abs() < 1e-3
}

#[test]
fn a_heartbeat_names_the_mode_and_is_armed_where_rotors_may_turn() {
    for mode in Mode::ALL {
        let beat = heartbeat(&in_mode(mode));
        assert_eq!(beat.custom_mode, mode as u32);
        assert_eq!(beat.base_mode & ARMED != 0, !mode.rotors_stand(), "{mode:?}");
        // Manual or automatic, never both.
        assert!(beat.base_mode & 64 == 0 || beat.base_mode & 4 == 0, "{mode:?}");
    }
    assert_eq!(
        (
            heartbeat(&in_mode(Mode::Failsafe)).system_status,
            heartbeat(&in_mode(Mode::Calibrating)).system_status,
            heartbeat(&in_mode(Mode::Disarmed)).system_status,
            heartbeat(&in_mode(Mode::Perched)).system_status,
            heartbeat(&Vehicle::default()).system_status
        ),
        (5, 2, 3, 4, 0)
    );
    let beat = heartbeat(&Vehicle::default());
    assert_eq!((beat.mavtype, beat.autopilot, beat.mavlink_version), (2, 0, 3));
}

#[test]
fn attitude_has_the_signs_of_frd_and_ned() {
    let mut v = vehicle(Mode::Flight);
    let estimate = v.attitude.as_mut().unwrap();
    // Right side down by 30 degrees, nose up by 20, heading east.
    estimate.q = Quat::from_euler(deg(30.0), deg(20.0), deg(90.0));
    estimate.rate = Vec3::new(0.1, -0.2, 0.3);
    let a = attitude(&v, 1234).unwrap();
    assert!(
        near(a.roll, FRAC_PI_6) && near(a.pitch, 0.3491) && near(a.yaw, FRAC_PI_2),
        "{a:?}"
    );
    assert_eq!(
        (a.rollspeed, a.pitchspeed, a.yawspeed, a.time_boot_ms),
        (0.1, -0.2, 0.3, 1234)
    );
    let estimate = v.attitude.as_mut().unwrap();
    estimate.q = Quat::from_euler(0.0, 0.0, deg(90.0));
    let q = attitude_quaternion(&v, 1).unwrap();
    assert!(
        near(q.q1, FRAC_1_SQRT_2) && near(q.q4, FRAC_1_SQRT_2) && near(q.q2, 0.0) && near(q.q3, 0.0),
        "{q:?}"
    );
    v.attitude = None;
    assert!(attitude(&v, 1).is_none() && attitude_quaternion(&v, 1).is_none() && scaled_imu(&v, 1).is_none());
}

#[test]
fn specific_force_is_in_thousandths_of_gravity_and_limited() {
    let mut v = vehicle(Mode::Disarmed);
    let level = scaled_imu(&v, 1).unwrap();
    assert_eq!((level.xacc, level.yacc, level.zacc), (0, 0, -1000));
    let estimate = v.attitude.as_mut().unwrap();
    estimate.accel = Vec3::new(9.80665, -4.903_325, 1e9);
    estimate.rate = Vec3::new(-1.2345, f32::NAN, 1e9);
    let imu = scaled_imu(&v, 1).unwrap();
    assert_eq!((imu.xacc, imu.yacc, imu.zacc), (1000, -500, i16::MAX));
    assert_eq!((imu.xgyro, imu.ygyro, imu.zgyro), (-1235, 0, i16::MAX));
}

#[test]
fn sticks_come_as_pulses_in_the_transmitters_order() {
    let mut v = vehicle(Mode::Flight);
    v.sticks = Some(Sticks {
        roll: 1.0,
        pitch: 0.5,
        yaw: -1.0,
        throttle: 0.25,
        arm_switch: true,
        perch_switch: false,
        hold_switch: false,
        stick_mode: StickMode::Rate,
        arms: ArmChoice::Rear,
    });
    let rc = rc_channels(&v, 7);
    let first = [rc.chan1_raw, rc.chan2_raw, rc.chan3_raw, rc.chan4_raw];
    // Nose up is the stick pulled: low on the wire.
    assert_eq!(first, [2000, 1250, 1250, 1000]);
    let switches = [rc.chan5_raw, rc.chan6_raw, rc.chan7_raw, rc.chan8_raw];
    assert_eq!(switches, [2000, 1500, 1000, 2000]);
    assert_eq!((rc.chancount, rc.chan9_raw, rc.rssi), (8, u16::MAX, u8::MAX));
    v.sticks = None;
    let rc = rc_channels(&v, 7);
    assert_eq!((rc.chancount, rc.chan1_raw), (0, u16::MAX));
}

#[test]
fn the_battery_is_in_mv_ca_mah_and_percent() {
    let mut v = vehicle(Mode::Flight);
    v.battery = Some(Battery {
        voltage: 15.264,
        current: Some(21.3),
        used: Some(1620.0),
        ratio: 1.0,
    });
    let b = battery_status(&v);
    assert_eq!((b.voltages[0], b.voltages[1]), (15264, u16::MAX));
    assert_eq!(
        (b.current_battery, b.current_consumed, b.battery_remaining),
        (2130, 450, 75)
    );
    let s = sys_status(&v);
    assert_eq!(
        (s.voltage_battery, s.current_battery, s.battery_remaining),
        (15264, 2130, 75)
    );
    // Beyond what the fields hold.
    v.battery = Some(Battery {
        voltage: 1e6,
        current: Some(1e6),
        used: Some(1e6),
        ratio: 1.0,
    });
    let s = sys_status(&v);
    assert_eq!(
        (s.voltage_battery, s.current_battery, s.battery_remaining),
        (u16::MAX, i16::MAX, 0)
    );
    // A current that is no measurement, and with it the charge, is marked; the voltage goes on.
    v.battery = Some(Battery {
        voltage: 15.0,
        current: None,
        used: None,
        ratio: 1.0,
    });
    let (b, s) = (battery_status(&v), sys_status(&v));
    assert_eq!((b.voltages[0], s.voltage_battery), (15_000, 15_000));
    assert_eq!(
        (b.current_battery, b.current_consumed, b.battery_remaining),
        (-1, -1, -1)
    );
    assert_eq!((s.current_battery, s.battery_remaining), (-1, -1));
    v.battery = None;
    let b = battery_status(&v);
    assert_eq!(
        (
            b.voltages[0],
            b.current_battery,
            b.current_consumed,
            b.battery_remaining
        ),
        (u16::MAX, -1, -1, -1)
    );
    assert_eq!(b.charge_state, 0);
    let mut v = vehicle(Mode::Disarmed);
    assert_eq!(battery_status(&v).charge_state, 1);
    v.condition.as_mut().unwrap().inhibits = ArmingInhibits::NONE.with(ArmingInhibit::BatteryLow);
    assert_eq!(battery_status(&v).charge_state, 2);
    v.condition.as_mut().unwrap().reason = Some(Reason::BatteryCritical);
    assert_eq!(battery_status(&v).charge_state, 3);
}

#[test]
fn the_servo_battery_is_a_second_one_of_which_the_voltage_is_known() {
    let mut v = vehicle(Mode::Perched);
    assert_eq!(servo_battery_status(&v), None);
    for (supply, charge) in [
        (ServoSupply::Good, 1),
        (ServoSupply::NearEnd, 2),
        (ServoSupply::Low, 3),
    ] {
        v.servo_battery = Some(ServoBattery {
            voltage: 7.164,
            supply,
        });
        let b = servo_battery_status(&v).unwrap();
        assert_eq!((b.id, b.voltages[0], b.voltages[1]), (1, 7164, u16::MAX));
        assert_eq!(
            (b.current_battery, b.current_consumed, b.battery_remaining),
            (-1, -1, -1)
        );
        // MAV_BATTERY_FUNCTION_PAYLOAD.
        assert_eq!((b.charge_state, b.battery_function), (charge, 4));
    }
}

#[test]
fn each_sick_part_loses_its_bit_and_arming_with_it() {
    let healthy = sys_status(&vehicle(Mode::Disarmed));
    assert_eq!(
        healthy.onboard_control_sensors_health,
        healthy.onboard_control_sensors_present
    );
    const PREARM: u32 = 1 << 28;
    for (inhibit, bits) in [
        (ArmingInhibit::ImuAbsent, 1 | 2),
        (ArmingInhibit::RcLost, 1 << 16),
        (ArmingInhibit::BatteryLow, 1 << 25),
        (ArmingInhibit::BatterySilent, 1 << 25),
        (ArmingInhibit::NotCalibrated, 1 << 21),
        (ArmingInhibit::Overruns, 1 << 10 | 1 << 11 | 1 << 15),
        (ArmingInhibit::PerchSwitchOn, 0),
    ] {
        let mut v = vehicle(Mode::Disarmed);
        v.condition.as_mut().unwrap().inhibits = ArmingInhibits::NONE.with(inhibit);
        let s = sys_status(&v);
        let lost = s.onboard_control_sensors_present & !s.onboard_control_sensors_health;
        assert_eq!(lost, bits | PREARM, "{inhibit:?}");
    }
    // In flight, where no arming check is made.
    let mut v = vehicle(Mode::Flight);
    v.sticks = None;
    let s = sys_status(&v);
    assert_eq!(
        s.onboard_control_sensors_present & !s.onboard_control_sensors_health,
        1 << 16
    );
}

#[test]
fn outputs_are_pulses_and_zero_where_not_driven() {
    let mut v = vehicle(Mode::Flight);
    v.motors = Some([0.0, 0.25, 0.5, 1.0]);
    v.servos = Some([550.0, 1500.4, 1500.6, 2450.0]);
    let o = servo_output_raw(&v, 3);
    assert_eq!(
        [o.servo1_raw, o.servo2_raw, o.servo3_raw, o.servo4_raw],
        [1000, 1250, 1500, 2000]
    );
    assert_eq!(
        [o.servo5_raw, o.servo6_raw, o.servo7_raw, o.servo8_raw],
        [550, 1500, 1501, 2450]
    );
    assert_eq!(o.time_usec, 3000);
    let dji = Params {
        motor_protocol: MotorProtocol::Pwm,
        motor_pulse_min: 1120.0,
        motor_pulse_idle: 1180.0,
        motor_pulse_max: 1920.0,
        ..Params::default()
    };
    v.motor_pulses = MotorPulses::shown(&dji).unwrap();
    let o = servo_output_raw(&v, 3);
    assert_eq!(
        [o.servo1_raw, o.servo2_raw, o.servo3_raw, o.servo4_raw],
        [1120, 1320, 1520, 1920]
    );
    let o = servo_output_raw(&Vehicle::default(), 3);
    assert_eq!([o.servo1_raw, o.servo8_raw], [0, 0]);
}

#[test]
fn perched_stands_and_leaving_takes_off() {
    let landed = |mode| extended_sys_state(&vehicle(mode)).landed_state;
    assert_eq!(
        [
            Mode::Disarmed,
            Mode::Landed,
            Mode::Perched,
            Mode::Flight,
            Mode::Failsafe,
            Mode::Clamping,
            Mode::Releasing
        ]
        .map(landed),
        [1, 1, 1, 2, 2, 4, 3]
    );
    assert_eq!(extended_sys_state(&Vehicle::default()).landed_state, 0);
}

#[test]
fn arms_have_si_units_and_nan_where_nothing_is_known() {
    let mut v = vehicle(Mode::Clamping);
    let mut grip = GripState::default();
    grip.arms[2] = ArmGrip {
        state: ArmState::Holding,
        pressure: 951.0,
        force: 42.0,
        closure: Some(2.61),
        fault: None,
        response: None,
    };
    grip.proven = true;
    v.grip = Some(grip);
    v.tilt = [-0.2, 0.3, f32::NAN, 0.0];
    v.reel = [0.0, 1.0, 2.0, 3.0];
    let a = arms(&v, 5);
    assert_eq!(
        (a.pressure[2], a.force[2], a.closure[2], a.state[2], a.flags),
        (951.0, 42.0, 2.61, 3, 1)
    );
    assert_eq!((a.tilt[0], a.reel[3]), (-0.2, 3.0));
    assert!(a.tilt[2].is_nan() && a.closure[0].is_nan());
    let a = arms(&Vehicle::default(), 5);
    assert!(a.pressure.iter().all(|p| p.is_nan()) && a.state == [255; 4] && a.flags == 0);
}

#[test]
fn every_mode_can_be_listed_once() {
    let all: Vec<_> = (1..).map_while(available_mode).collect();
    assert_eq!(all.len(), Mode::ALL.len());
    for (mode, listed) in Mode::ALL.iter().zip(&all) {
        assert_eq!(listed.mode_name.to_str().unwrap(), mode.name());
        let count = Mode::ALL.len() as u8;
        assert_eq!((listed.custom_mode, listed.number_modes), (*mode as u32, count));
    }
    assert!(available_mode(0).is_none());
}

#[test]
fn a_second_battery_follows_the_first_as_often_and_on_request() {
    let mut station = Station::new();
    station.run(3000);
    let ids = |station: &Station| -> Vec<u8> {
        let got = station.got::<BATTERY_STATUS_DATA>();
        got.iter().map(|battery| battery.id).collect()
    };
    assert_eq!(ids(&station), [0; 3]);
    station.vehicle.servo_battery = Some(ServoBattery {
        voltage: 7.6,
        supply: ServoSupply::Good,
    });
    station.sent.clear();
    station.run(3000);
    assert_eq!(ids(&station), [0, 1, 0, 1, 0, 1]);
    station.sent.clear();
    station.command(MavCmd::MAV_CMD_REQUEST_MESSAGE, [147.0, 0.0]);
    station.run(100);
    assert_eq!(ids(&station), [0, 1]);
}

#[test]
fn vibration_is_in_m_s2_of_each_axis_with_what_clipped() {
    let mut v = vehicle(Mode::Flight);
    v.vibration = Some(Vibration {
        rms: Vec3::new(1.5, 2.5, 3.5),
        clipped: 7,
    });
    let sent = vibration(&v, 5_000_000).unwrap();
    let axes = [sent.vibration_x, sent.vibration_y, sent.vibration_z];
    assert_eq!((axes, sent.time_usec), ([1.5, 2.5, 3.5], 5_000_000));
    assert_eq!((sent.clipping_0, sent.clipping_1, sent.clipping_2), (7, 0, 0));
    v.vibration = None;
    assert_eq!(vibration(&v, 1), None);
}
