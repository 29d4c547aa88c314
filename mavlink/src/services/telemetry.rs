//! The messages of the vehicle's state, in MAVLink's units.
//!
//! Frames are the same here and there: the body is FRD, the world NED, quaternions have w first. Only units change. An
//! unknown value is sent as the standard's own value for "unknown".

use sophie_control::allocation::wrench::PerArm;
use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::battery::ServoSupply;
use sophie_control::calibration::Unfit;
use sophie_control::calibration::procedure::{Finding, Outcome};
use sophie_control::gripper::grip::ArmState;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::mode::Mode;
use sophie_control::pilot::rc::{ArmChoice, StickMode, Sticks};

use crate::vehicle::Vehicle;
use sophie_dialect::*;

/// Protocol version in heartbeats.
const MAVLINK_VERSION: u8 = 3;
/// Pulse of a centred stick, µs.
const PULSE_CENTRE: f32 = 1500.0;
/// From the centre to an end, µs.
const PULSE_HALF: f32 = 500.0;
/// `a * 1e3 / GRAVITY`: thousandths of standard gravity.
const MILLI_G: f32 = 1e3 / GRAVITY;

/// Kind, mode and state of the vehicle.
pub fn heartbeat(vehicle: &Vehicle) -> HEARTBEAT_DATA {
    let mut base_mode = MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED;
    let mode = vehicle.mode();
    if mode.is_some_and(|mode| !mode.rotors_stand()) {
        base_mode |= MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED | MavModeFlag::MAV_MODE_FLAG_STABILIZE_ENABLED;
        base_mode |= match mode {
            Some(Mode::Failsafe | Mode::Escaping) => MavModeFlag::MAV_MODE_FLAG_AUTO_ENABLED,
            _ => MavModeFlag::MAV_MODE_FLAG_MANUAL_INPUT_ENABLED,
        };
    }
    let state = match mode {
        None => MavState::MAV_STATE_UNINIT,
        Some(Mode::Calibrating) => MavState::MAV_STATE_CALIBRATING,
        Some(Mode::Disarmed) => MavState::MAV_STATE_STANDBY,
        Some(Mode::Failsafe) => MavState::MAV_STATE_CRITICAL,
        Some(_) => MavState::MAV_STATE_ACTIVE,
    };
    HEARTBEAT_DATA {
        custom_mode: custom_mode(vehicle),
        mavtype: MavType::MAV_TYPE_QUADROTOR as u8,
        autopilot: MavAutopilot::MAV_AUTOPILOT_GENERIC as u8,
        base_mode: base_mode.bits() as u8,
        system_status: state as u8,
        mavlink_version: MAVLINK_VERSION,
    }
}

fn custom_mode(vehicle: &Vehicle) -> u32 {
    vehicle.mode().map_or(0, |mode| mode as u32)
}

/// The present mode, which is not one of the standard's.
pub fn current_mode(vehicle: &Vehicle) -> CURRENT_MODE_DATA {
    CURRENT_MODE_DATA {
        custom_mode: custom_mode(vehicle),
        intended_custom_mode: 0,
        standard_mode: MavStandardMode::MAV_STANDARD_MODE_NON_STANDARD as u8,
    }
}

/// The mode at `index`, from 1. Only the commander changes the mode: a ground station cannot select it.
pub fn available_mode(index: u8) -> Option<AVAILABLE_MODES_DATA> {
    let mode = Mode::ALL.get(usize::from(index).checked_sub(1)?)?;
    Some(AVAILABLE_MODES_DATA {
        number_modes: Mode::ALL.len() as u8,
        mode_index: index,
        standard_mode: MavStandardMode::MAV_STANDARD_MODE_NON_STANDARD as u8,
        custom_mode: *mode as u32,
        properties: MavModeProperty::MAV_MODE_PROPERTY_NOT_USER_SELECTABLE
            .bits()
            .into(),
        mode_name: text::<35>(mode.name()).into(),
    })
}

/// `from`, padded with zeros or cut to `N` bytes.
pub fn text<const N: usize>(from: &str) -> [u8; N] {
    let mut bytes = [0; N];
    for (to, from) in bytes.iter_mut().zip(from.bytes()) {
        *to = from;
    }
    bytes
}

/// Health of the vehicle's parts, by the arming checks.
pub fn sys_status(vehicle: &Vehicle) -> SYS_STATUS_DATA {
    let present = SENSORS
        .iter()
        .fold(MavSysStatusSensor::empty(), |all, part| all | part.bit);
    let inhibits = vehicle.condition.map_or(ArmingInhibits::NONE, |c| c.inhibits);
    let sick = |part: &&Part| {
        part.inhibits.iter().any(|&i| inhibits.contains(i))
            || match part.needs {
                Needs::Attitude => vehicle.attitude.is_none(),
                Needs::Radio => vehicle.sticks.is_none(),
                Needs::Battery => vehicle.battery.is_none(),
                Needs::FreeArming => vehicle.condition.is_none() || !inhibits.is_empty(),
                Needs::Nothing => false,
            }
    };
    let health = SENSORS
        .iter()
        .filter(sick)
        .fold(present, |all, part| all & !part.bit);
    let battery = vehicle.battery;
    SYS_STATUS_DATA {
        onboard_control_sensors_present: present.bits(),
        onboard_control_sensors_enabled: present.bits(),
        onboard_control_sensors_health: health.bits(),
        load: vehicle.load,
        voltage_battery: battery.map_or(u16::MAX, |b| (b.voltage * 1e3 + 0.5) as u16),
        current_battery: current(vehicle),
        battery_remaining: remaining(vehicle),
        ..SYS_STATUS_DATA::DEFAULT
    }
}

/// Further condition of a healthy part: arming checks do not run in flight.
enum Needs {
    Nothing,
    Attitude,
    Radio,
    Battery,
    FreeArming,
}

/// A part of the vehicle, and the arming checks that fail with it.
struct Part {
    bit: MavSysStatusSensor,
    inhibits: &'static [ArmingInhibit],
    needs: Needs,
}

const INERTIAL: &[ArmingInhibit] = &[
    ArmingInhibit::ImuAbsent,
    ArmingInhibit::ImuWrongPart,
    ArmingInhibit::ImuSelfTest,
    ArmingInhibit::ImuCorrupt,
    ArmingInhibit::ImuLineSilent,
    ArmingInhibit::ImuStale,
];

const SENSORS: &[Part] = &[
    Part {
        bit: MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_3D_GYRO,
        inhibits: INERTIAL,
        needs: Needs::Attitude,
    },
    Part {
        bit: MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_3D_ACCEL,
        inhibits: INERTIAL,
        needs: Needs::Attitude,
    },
    Part {
        bit: MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_ANGULAR_RATE_CONTROL,
        inhibits: &[ArmingInhibit::Overruns],
        needs: Needs::Attitude,
    },
    Part {
        bit: MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_ATTITUDE_STABILIZATION,
        inhibits: &[ArmingInhibit::Overruns],
        needs: Needs::Attitude,
    },
    Part {
        bit: MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS,
        inhibits: &[ArmingInhibit::Overruns],
        needs: Needs::Nothing,
    },
    Part {
        bit: MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_RC_RECEIVER,
        inhibits: &[ArmingInhibit::RcLost],
        needs: Needs::Radio,
    },
    Part {
        bit: MavSysStatusSensor::MAV_SYS_STATUS_AHRS,
        inhibits: &[ArmingInhibit::NotCalibrated, ArmingInhibit::ImuStale],
        needs: Needs::Attitude,
    },
    Part {
        bit: MavSysStatusSensor::MAV_SYS_STATUS_SENSOR_BATTERY,
        inhibits: &[
            ArmingInhibit::BatteryLow,
            ArmingInhibit::BatterySilent,
            ArmingInhibit::AnalogSilent,
        ],
        needs: Needs::Battery,
    },
    Part {
        bit: MavSysStatusSensor::MAV_SYS_STATUS_PREARM_CHECK,
        inhibits: &[],
        needs: Needs::FreeArming,
    },
];

/// Current, cA; -1 if unknown.
fn current(vehicle: &Vehicle) -> i16 {
    let current = vehicle.battery.and_then(|b| b.current);
    current.map_or(-1, |current| (current * 1e2 + 0.5) as i16)
}

/// Charge drawn, A·s.
fn used(vehicle: &Vehicle) -> Option<f32> {
    vehicle.battery?.used
}

/// Charge left, %; -1 if unknown.
fn remaining(vehicle: &Vehicle) -> i8 {
    match used(vehicle) {
        Some(used) if vehicle.capacity > 0.0 => {
            let left = 100.0 * (1.0 - used / vehicle.capacity);
            // The conversion makes 0 of NaN.
            left.clamp(0.0, 100.0) as i8
        }
        _ => -1,
    }
}

/// The flight battery as one cell: the cells are not measured.
pub fn battery_status(vehicle: &Vehicle) -> BATTERY_STATUS_DATA {
    let low = |inhibit| vehicle.condition.is_some_and(|c| c.inhibits.contains(inhibit));
    let critical = vehicle
        .condition
        .is_some_and(|c| c.reason == Some(sophie_control::mode::Reason::BatteryCritical));
    let charge = if vehicle.battery.is_none() {
        MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_UNDEFINED
    } else if critical {
        MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_CRITICAL
    } else if low(ArmingInhibit::BatteryLow) {
        MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_LOW
    } else {
        MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_OK
    };
    let mut voltages = [u16::MAX; 10];
    if let (Some(battery), [first, ..]) = (vehicle.battery, &mut voltages) {
        *first = (battery.voltage * 1e3 + 0.5) as u16;
    }
    BATTERY_STATUS_DATA {
        // A·s to mAh.
        current_consumed: used(vehicle).map_or(-1, |used| (used / 3.6) as i32),
        energy_consumed: -1,
        temperature: i16::MAX,
        voltages,
        current_battery: current(vehicle),
        battery_function: MavBatteryFunction::MAV_BATTERY_FUNCTION_ALL as u8,
        mavtype: MavBatteryType::MAV_BATTERY_TYPE_LIPO as u8,
        battery_remaining: remaining(vehicle),
        charge_state: charge as u8,
        ..BATTERY_STATUS_DATA::DEFAULT
    }
}

/// The servo battery; only its voltage is measured. `None` without one.
pub fn servo_battery_status(vehicle: &Vehicle) -> Option<BATTERY_STATUS_DATA> {
    let battery = vehicle.servo_battery?;
    let charge = match battery.supply {
        ServoSupply::Low => MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_CRITICAL,
        ServoSupply::NearEnd => MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_LOW,
        _ => MavBatteryChargeState::MAV_BATTERY_CHARGE_STATE_OK,
    };
    let mut voltages = [u16::MAX; 10];
    let [first, ..] = &mut voltages;
    *first = (battery.voltage * 1e3 + 0.5) as u16;
    Some(BATTERY_STATUS_DATA {
        id: 1,
        current_consumed: -1,
        energy_consumed: -1,
        temperature: i16::MAX,
        voltages,
        current_battery: -1,
        battery_function: MavBatteryFunction::MAV_BATTERY_FUNCTION_PAYLOAD as u8,
        battery_remaining: -1,
        charge_state: charge as u8,
        ..BATTERY_STATUS_DATA::DEFAULT
    })
}

/// Roll, pitch and yaw with the body's rates.
pub fn attitude(vehicle: &Vehicle, time_boot_ms: u32) -> Option<ATTITUDE_DATA> {
    let estimate = vehicle.attitude?;
    let (roll, pitch, yaw) = estimate.q.to_euler();
    Some(ATTITUDE_DATA {
        time_boot_ms,
        roll,
        pitch,
        yaw,
        rollspeed: estimate.rate.x,
        pitchspeed: estimate.rate.y,
        yawspeed: estimate.rate.z,
    })
}

/// Body to world, w first, with the body's rates.
pub fn attitude_quaternion(vehicle: &Vehicle, time_boot_ms: u32) -> Option<ATTITUDE_QUATERNION_DATA> {
    let estimate = vehicle.attitude?;
    Some(ATTITUDE_QUATERNION_DATA {
        time_boot_ms,
        q1: estimate.q.w,
        q2: estimate.q.x,
        q3: estimate.q.y,
        q4: estimate.q.z,
        rollspeed: estimate.rate.x,
        pitchspeed: estimate.rate.y,
        yawspeed: estimate.rate.z,
        repr_offset_q: [0.0; 4],
    })
}

/// Specific force and rates in body axes: a level vehicle at rest shows -1000 along z.
pub fn scaled_imu(vehicle: &Vehicle, time_boot_ms: u32) -> Option<SCALED_IMU_DATA> {
    let estimate = vehicle.attitude?;
    let [xacc, yacc, zacc] = estimate.accel.map(|a| a * MILLI_G).to_array().map(nearest);
    let [xgyro, ygyro, zgyro] = estimate.rate.map(|r| r * 1e3).to_array().map(nearest);
    Some(SCALED_IMU_DATA {
        time_boot_ms,
        xacc,
        yacc,
        zacc,
        xgyro,
        ygyro,
        zgyro,
        ..SCALED_IMU_DATA::DEFAULT
    })
}

/// Rounded to a whole number, limited to the type's range.
fn nearest(value: f32) -> i16 {
    (value + if value < 0.0 { -0.5 } else { 0.5 }) as i16
}

/// The pilot's sticks and switches as pulses of the transmitter's channels, 1000 to 2000 µs.
pub fn rc_channels(vehicle: &Vehicle, time_boot_ms: u32) -> RC_CHANNELS_DATA {
    let none = RC_CHANNELS_DATA {
        time_boot_ms,
        chan1_raw: u16::MAX,
        chan2_raw: u16::MAX,
        chan3_raw: u16::MAX,
        chan4_raw: u16::MAX,
        chan5_raw: u16::MAX,
        chan6_raw: u16::MAX,
        chan7_raw: u16::MAX,
        chan8_raw: u16::MAX,
        chan9_raw: u16::MAX,
        chan10_raw: u16::MAX,
        chan11_raw: u16::MAX,
        chan12_raw: u16::MAX,
        chan13_raw: u16::MAX,
        chan14_raw: u16::MAX,
        chan15_raw: u16::MAX,
        chan16_raw: u16::MAX,
        chan17_raw: u16::MAX,
        chan18_raw: u16::MAX,
        chancount: 0,
        rssi: u8::MAX,
    };
    let Some(sticks) = vehicle.sticks else {
        return none;
    };
    let [roll, pitch, throttle, yaw, arm, mode, perch, arms] = channels(&sticks);
    RC_CHANNELS_DATA {
        chancount: 8,
        chan1_raw: roll,
        chan2_raw: pitch,
        chan3_raw: throttle,
        chan4_raw: yaw,
        chan5_raw: arm,
        chan6_raw: mode,
        chan7_raw: perch,
        chan8_raw: arms,
        ..none
    }
}

/// In the order of the transmitter's channels.
fn channels(sticks: &Sticks) -> [u16; 8] {
    let switch = |on| if on { 1.0 } else { -1.0 };
    let shares = [
        sticks.roll,
        // The sign of the stick: pushed forward is high, and lowers the nose.
        -sticks.pitch,
        2.0 * sticks.throttle - 1.0,
        sticks.yaw,
        switch(sticks.arm_switch),
        match sticks.stick_mode {
            StickMode::Angle => -1.0,
            StickMode::Rate => 0.0,
            StickMode::Direct => 1.0,
        },
        switch(sticks.perch_switch),
        match sticks.arms {
            ArmChoice::All => -1.0,
            ArmChoice::Front => 0.0,
            ArmChoice::Rear => 1.0,
        },
    ];
    shares.map(|share| (PULSE_CENTRE + PULSE_HALF * share + 0.5) as u16)
}

/// Motors 1 to 4 as pulses between their ends (DShot as 1000 to 2000 µs), tendon servos 5 to 8; 0 for an output without
/// pulses.
pub fn servo_output_raw(vehicle: &Vehicle, time_boot_ms: u32) -> SERVO_OUTPUT_RAW_DATA {
    let pulse = |command: f32| (vehicle.motor_pulses.pulse_us(command) + 0.5) as u16;
    let [servo1_raw, servo2_raw, servo3_raw, servo4_raw] =
        vehicle.motors.map_or([0; 4], |motors| motors.map(pulse));
    let [servo5_raw, servo6_raw, servo7_raw, servo8_raw] = vehicle
        .servos
        .map_or([0; 4], |servos| servos.map(|us| (us + 0.5) as u16));
    SERVO_OUTPUT_RAW_DATA {
        // Wraps after 71 minutes, as the standard's field does.
        time_usec: time_boot_ms.wrapping_mul(1000),
        servo1_raw,
        servo2_raw,
        servo3_raw,
        servo4_raw,
        servo5_raw,
        servo6_raw,
        servo7_raw,
        servo8_raw,
        ..SERVO_OUTPUT_RAW_DATA::DEFAULT
    }
}

/// Landed state. Perched is reported as on the ground: the rotors stand.
pub fn extended_sys_state(vehicle: &Vehicle) -> EXTENDED_SYS_STATE_DATA {
    let landed = match vehicle.mode() {
        None => MavLandedState::MAV_LANDED_STATE_UNDEFINED,
        Some(Mode::Calibrating | Mode::Disarmed | Mode::Armed | Mode::Landed | Mode::Perched) => {
            MavLandedState::MAV_LANDED_STATE_ON_GROUND
        }
        Some(Mode::Flight | Mode::Hold | Mode::Approach | Mode::Escaping | Mode::Failsafe) => {
            MavLandedState::MAV_LANDED_STATE_IN_AIR
        }
        Some(Mode::Contact | Mode::Clamping) => MavLandedState::MAV_LANDED_STATE_LANDING,
        Some(Mode::Releasing) => MavLandedState::MAV_LANDED_STATE_TAKEOFF,
    };
    EXTENDED_SYS_STATE_DATA {
        vtol_state: MavVtolState::MAV_VTOL_STATE_UNDEFINED as u8,
        landed_state: landed as u8,
    }
}

/// Arms and grip.
pub fn arms(vehicle: &Vehicle, time_boot_ms: u32) -> SOPHIE_ARMS_DATA {
    let unknown = [f32::NAN; 4];
    let of = |f: fn(&sophie_control::gripper::grip::ArmGrip) -> f32| -> PerArm<f32> {
        vehicle.grip.map_or(unknown, |grip| grip.arms.map(|arm| f(&arm)))
    };
    let flags = vehicle.grip.map_or(SophieGripFlags::empty(), |grip| {
        let mut flags = SophieGripFlags::empty();
        flags.set(SophieGripFlags::SOPHIE_GRIP_FLAGS_PROVEN, grip.proven);
        flags.set(SophieGripFlags::SOPHIE_GRIP_FLAGS_RELEASED, grip.released);
        flags
    });
    let state = |state| match state {
        ArmState::Free => SophieArmState::SOPHIE_ARM_STATE_FREE,
        ArmState::Closing => SophieArmState::SOPHIE_ARM_STATE_CLOSING,
        ArmState::Touching => SophieArmState::SOPHIE_ARM_STATE_TOUCHING,
        ArmState::Holding => SophieArmState::SOPHIE_ARM_STATE_HOLDING,
        ArmState::ForceLimited => SophieArmState::SOPHIE_ARM_STATE_FORCE_LIMITED,
        ArmState::Faulty => SophieArmState::SOPHIE_ARM_STATE_FAULTY,
        ArmState::Releasing => SophieArmState::SOPHIE_ARM_STATE_RELEASING,
    };
    SOPHIE_ARMS_DATA {
        time_boot_ms,
        tilt: vehicle.tilt,
        pressure: of(|arm| arm.pressure),
        force: of(|arm| arm.force),
        reel: vehicle.reel,
        closure: of(|arm| arm.closure.unwrap_or(f32::NAN)),
        state: vehicle
            .grip
            .map_or([SophieArmState::SOPHIE_ARM_STATE_UNKNOWN as u8; 4], |grip| {
                grip.arms.map(|arm| state(arm.state) as u8)
            }),
        flags: flags.bits() as u8,
    }
}

/// Capabilities of the autopilot. Every parameter is a float, for which both encodings of the protocol are equal.
pub fn autopilot_version(vehicle: &Vehicle) -> AUTOPILOT_VERSION_DATA {
    let can = MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_MAVLINK2
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_COMMAND_INT
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_FTP
        | MavProtocolCapability::MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE;
    AUTOPILOT_VERSION_DATA {
        capabilities: can.bits().into(),
        flight_sw_version: VERSION,
        flight_custom_version: custom_version(vehicle),
        ..AUTOPILOT_VERSION_DATA::DEFAULT
    }
}

/// Major, minor and patch in the upper three bytes; 0 below marks a development version.
const VERSION: u32 = number(env!("CARGO_PKG_VERSION_MAJOR")) << 24
    | number(env!("CARGO_PKG_VERSION_MINOR")) << 16
    | number(env!("CARGO_PKG_VERSION_PATCH")) << 8;

const fn number(text: &str) -> u32 {
    let mut value = 0;
    let mut rest = text.as_bytes();
    while let [digit, after @ ..] = rest {
        value = 10 * value + (*digit - b'0') as u32;
        rest = after;
    }
    value
}

/// The end of a calibration step; its time is set when it is sent.
pub fn calibration_result(finding: &Finding) -> SOPHIE_CALIBRATION_RESULT_DATA {
    let outcome = match finding.result {
        Ok(Outcome::Taken) => SophieCalibrationOutcome::SOPHIE_CALIBRATION_OUTCOME_TAKEN,
        Ok(Outcome::Done(_)) => SophieCalibrationOutcome::SOPHIE_CALIBRATION_OUTCOME_DONE,
        Err(_) => SophieCalibrationOutcome::SOPHIE_CALIBRATION_OUTCOME_UNFIT,
    };
    let unfit = finding.result.err().unwrap_or(Unfit {
        what: "",
        value: f32::NAN,
        allowed: [f32::NAN; 2],
        unit: "",
    });
    let [least, most] = unfit.allowed;
    SOPHIE_CALIBRATION_RESULT_DATA {
        time_boot_ms: 0,
        value: unfit.value,
        least,
        most,
        figures: finding.figures,
        calibration: finding.step.calibration as u8,
        index: finding.step.part_number(),
        step: finding.step.number,
        outcome: outcome as u8,
        quantity: text::<28>(unfit.what).into(),
        unit: text::<8>(unfit.unit).into(),
    }
}

/// Identity of the image, then of its table of parameters, each with its most significant byte first.
fn custom_version(vehicle: &Vehicle) -> [u8; 8] {
    let [image, table] = vehicle.build.map(u32::to_be_bytes);
    let mut bytes = [0; 8];
    for (byte, from) in bytes.iter_mut().zip(image.into_iter().chain(table)) {
        *byte = from;
    }
    bytes
}

/// Board, version and chip.
pub fn component(vehicle: &Vehicle, ms: u32) -> COMPONENT_INFORMATION_BASIC_DATA {
    COMPONENT_INFORMATION_BASIC_DATA {
        time_boot_ms: ms,
        vendor_name: text::<32>("SOPHIE").into(),
        model_name: text::<32>(vehicle.board).into(),
        software_version: text::<24>(env!("CARGO_PKG_VERSION")).into(),
        hardware_version: vehicle.chip.into(),
        ..COMPONENT_INFORMATION_BASIC_DATA::DEFAULT
    }
}

/// The failing arming checks; `None` while the commander is silent.
pub fn arming(vehicle: &Vehicle, ms: u32) -> Option<SOPHIE_ARMING_DATA> {
    Some(SOPHIE_ARMING_DATA {
        failing: vehicle.condition?.inhibits.bits(),
        time_boot_ms: ms,
    })
}

/// The barometer; `None` without a fresh sample.
pub fn scaled_pressure(vehicle: &Vehicle, ms: u32) -> Option<SCALED_PRESSURE_DATA> {
    let air = vehicle.air?;
    Some(SCALED_PRESSURE_DATA {
        time_boot_ms: ms,
        press_abs: air.pascal / 100.0,
        temperature: (air.celsius * 100.0) as i16,
        ..SCALED_PRESSURE_DATA::DEFAULT
    })
}

/// Vibration of the last second; `None` before the first.
pub fn vibration(vehicle: &Vehicle, us: u64) -> Option<VIBRATION_DATA> {
    let vibration = vehicle.vibration?;
    let [vibration_x, vibration_y, vibration_z] = vibration.rms.to_array();
    Some(VIBRATION_DATA {
        time_usec: us,
        vibration_x,
        vibration_y,
        vibration_z,
        clipping_0: vibration.clipped,
        ..VIBRATION_DATA::DEFAULT
    })
}
