#![no_std]
#![doc = "MAVLink sophie dialect."]
#![doc = ""]
#![doc = "This file was automatically generated, do not edit."]
#![allow(deprecated)]
#![allow(clippy::match_single_binding)]
#![allow(rustdoc::broken_intra_doc_links)]
#[cfg(feature = "arbitrary")]
use arbitrary::Arbitrary;
#[allow(unused_imports)]
use bitflags::{Flags, bitflags};
#[allow(unused_imports)]
use mavlink_core::{
    MavlinkVersion, Message, MessageData, bytes::Bytes, bytes_mut::BytesMut, types::CharArray,
};
#[allow(unused_imports)]
use num_derive::{FromPrimitive, ToPrimitive};
#[allow(unused_imports)]
use num_traits::{FromPrimitive, ToPrimitive};
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};
#[cfg(feature = "ts-rs")]
use ts_rs::TS;
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum GripperActions {
    GRIPPER_ACTION_RELEASE = 0,
    GRIPPER_ACTION_GRAB = 1,
    GRIPPER_ACTION_HOLD = 2,
}
impl GripperActions {
    pub const DEFAULT: Self = Self::GRIPPER_ACTION_RELEASE;
}
impl Default for GripperActions {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavAutopilot {
    MAV_AUTOPILOT_GENERIC = 0,
    MAV_AUTOPILOT_INVALID = 8,
}
impl MavAutopilot {
    pub const DEFAULT: Self = Self::MAV_AUTOPILOT_GENERIC;
}
impl Default for MavAutopilot {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavBatteryChargeState {
    MAV_BATTERY_CHARGE_STATE_UNDEFINED = 0,
    MAV_BATTERY_CHARGE_STATE_OK = 1,
    MAV_BATTERY_CHARGE_STATE_LOW = 2,
    MAV_BATTERY_CHARGE_STATE_CRITICAL = 3,
}
impl MavBatteryChargeState {
    pub const DEFAULT: Self = Self::MAV_BATTERY_CHARGE_STATE_UNDEFINED;
}
impl Default for MavBatteryChargeState {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavBatteryFunction {
    MAV_BATTERY_FUNCTION_ALL = 1,
    MAV_BATTERY_FUNCTION_PAYLOAD = 4,
}
impl MavBatteryFunction {
    pub const DEFAULT: Self = Self::MAV_BATTERY_FUNCTION_ALL;
}
impl Default for MavBatteryFunction {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavBatteryType {
    MAV_BATTERY_TYPE_LIPO = 1,
}
impl MavBatteryType {
    pub const DEFAULT: Self = Self::MAV_BATTERY_TYPE_LIPO;
}
impl Default for MavBatteryType {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavCmd {
    MAV_CMD_DO_SET_SERVO = 183,
    MAV_CMD_DO_MOTOR_TEST = 209,
    MAV_CMD_DO_GRIPPER = 211,
    MAV_CMD_PREFLIGHT_CALIBRATION = 241,
    MAV_CMD_PREFLIGHT_STORAGE = 245,
    MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN = 246,
    MAV_CMD_COMPONENT_ARM_DISARM = 400,
    MAV_CMD_GET_MESSAGE_INTERVAL = 510,
    MAV_CMD_SET_MESSAGE_INTERVAL = 511,
    MAV_CMD_REQUEST_MESSAGE = 512,
    MAV_CMD_DO_SET_STANDARD_MODE = 262,
    MAV_CMD_USER_1 = 31010,
    #[doc = "Measures one step of a calibration, at rest. Answered in progress, then at its end, behind SOPHIE_CALIBRATION_RESULT."]
    #[doc = ""]
    #[doc = "# Parameters"]
    #[doc = ""]
    #[doc = "| Parameter | Description | Values |"]
    #[doc = "| --------- | ----------- | ------ |"]
    #[doc = "| 1 (Calibration)| Which.      | [`SophieCalibration`] |"]
    #[doc = "| 2 (Index) | Arm, pressure sensor or servo, 1 to 4; else 0.| 0 .. 4 |"]
    #[doc = "| 3 (Step)  | Step, from 1; a step wants those before it.| &ge; 1 |"]
    #[doc = "| 4 (Value) | Battery: V by a meter. Servo: pulse at release, us. Pressure sensor, steps 2 to 6: load on its pad, N.|  |"]
    #[doc = "| 5 (Value 2)| Servo: pulse at the full mark, us.|  |"]
    MAV_CMD_SOPHIE_CALIBRATE = 53000,
    #[doc = "Sends a report as SOPHIE_CHECK, row by row, then the acknowledgement."]
    #[doc = ""]
    #[doc = "# Parameters"]
    #[doc = ""]
    #[doc = "| Parameter | Description | Values |"]
    #[doc = "| --------- | ----------- | ------ |"]
    #[doc = "| 1 (Report)| Which.      | [`SophieReport`] |"]
    MAV_CMD_SOPHIE_REPORT = 53001,
    #[doc = "Writes the chip's brown-out level into its option bytes, for good, and restarts."]
    #[doc = ""]
    #[doc = "# Parameters"]
    #[doc = ""]
    #[doc = "| Parameter | Description | Values |"]
    #[doc = "| --------- | ----------- | ------ |"]
    #[doc = "| 1 (Confirm)| 1.          | 1 .. 1 |"]
    MAV_CMD_SOPHIE_SET_BROWN_OUT = 53002,
    #[doc = "Runs rotors with propellers on, the vehicle tied down. Sent again with the same run at least once a second, or the run ends; a run that has ended does not begin again."]
    #[doc = ""]
    #[doc = "# Parameters"]
    #[doc = ""]
    #[doc = "| Parameter | Description | Values | Units |"]
    #[doc = "| --------- | ----------- | ------ | ----- |"]
    #[doc = "| 1 (Rotor) | 1 to 4; 0 for all.| 0 .. 4 |  |"]
    #[doc = "| 2 (Drive) | Share of full drive, 5 at least; 0 ends the run.| 0 .. 100 | % |"]
    #[doc = "| 3 (Other drive)| Five steps to this drive and back, 50 away at most; 0: steady.| 0 .. 100 | % |"]
    #[doc = "| 4 (Time)  | Time at each drive, 0.5 to 10, of steps 2 at most; 0: 5, of steps 1.| 0 .. 10 | s |"]
    #[doc = "| 5 (Run)   | Number of the run, another one for each.| &ge; 1 |  |"]
    MAV_CMD_SOPHIE_STATIC_THRUST = 53003,
}
impl MavCmd {
    pub const DEFAULT: Self = Self::MAV_CMD_DO_SET_SERVO;
}
impl Default for MavCmd {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavComponent {
    MAV_COMP_ID_ALL = 0,
    MAV_COMP_ID_AUTOPILOT1 = 1,
}
impl MavComponent {
    pub const DEFAULT: Self = Self::MAV_COMP_ID_ALL;
}
impl Default for MavComponent {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavLandedState {
    MAV_LANDED_STATE_UNDEFINED = 0,
    MAV_LANDED_STATE_ON_GROUND = 1,
    MAV_LANDED_STATE_IN_AIR = 2,
    MAV_LANDED_STATE_TAKEOFF = 3,
    MAV_LANDED_STATE_LANDING = 4,
}
impl MavLandedState {
    pub const DEFAULT: Self = Self::MAV_LANDED_STATE_UNDEFINED;
}
impl Default for MavLandedState {
    fn default() -> Self {
        Self::DEFAULT
    }
}
bitflags! { # [cfg_attr (feature = "ts-rs" , derive (TS))] # [cfg_attr (feature = "ts-rs" , ts (export , type = "number"))] # [cfg_attr (feature = "serde" , derive (Serialize , Deserialize))] # [cfg_attr (feature = "arbitrary" , derive (Arbitrary))] # [derive (Debug , Copy , Clone , PartialEq)] pub struct MavModeFlag : u16 { const MAV_MODE_FLAG_SAFETY_ARMED = 128 ; const MAV_MODE_FLAG_MANUAL_INPUT_ENABLED = 64 ; const MAV_MODE_FLAG_STABILIZE_ENABLED = 16 ; const MAV_MODE_FLAG_AUTO_ENABLED = 4 ; const MAV_MODE_FLAG_CUSTOM_MODE_ENABLED = 1 ; } }
impl MavModeFlag {
    pub const DEFAULT: Self = Self::MAV_MODE_FLAG_SAFETY_ARMED;
}
impl Default for MavModeFlag {
    fn default() -> Self {
        Self::DEFAULT
    }
}
bitflags! { # [cfg_attr (feature = "ts-rs" , derive (TS))] # [cfg_attr (feature = "ts-rs" , ts (export , type = "number"))] # [cfg_attr (feature = "serde" , derive (Serialize , Deserialize))] # [cfg_attr (feature = "arbitrary" , derive (Arbitrary))] # [derive (Debug , Copy , Clone , PartialEq)] pub struct MavModeProperty : u16 { const MAV_MODE_PROPERTY_ADVANCED = 1 ; const MAV_MODE_PROPERTY_NOT_USER_SELECTABLE = 2 ; const MAV_MODE_PROPERTY_AUTO_MODE = 4 ; } }
impl MavModeProperty {
    pub const DEFAULT: Self = Self::MAV_MODE_PROPERTY_ADVANCED;
}
impl Default for MavModeProperty {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavParamType {
    MAV_PARAM_TYPE_INT32 = 6,
    MAV_PARAM_TYPE_REAL32 = 9,
}
impl MavParamType {
    pub const DEFAULT: Self = Self::MAV_PARAM_TYPE_INT32;
}
impl Default for MavParamType {
    fn default() -> Self {
        Self::DEFAULT
    }
}
bitflags! { # [cfg_attr (feature = "ts-rs" , derive (TS))] # [cfg_attr (feature = "ts-rs" , ts (export , type = "number"))] # [cfg_attr (feature = "serde" , derive (Serialize , Deserialize))] # [cfg_attr (feature = "arbitrary" , derive (Arbitrary))] # [derive (Debug , Copy , Clone , PartialEq)] pub struct MavProtocolCapability : u32 { const MAV_PROTOCOL_CAPABILITY_COMMAND_INT = 8 ; const MAV_PROTOCOL_CAPABILITY_FTP = 32 ; const MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE = 16 ; const MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST = 131072 ; const MAV_PROTOCOL_CAPABILITY_MAVLINK2 = 8192 ; } }
impl MavProtocolCapability {
    pub const DEFAULT: Self = Self::MAV_PROTOCOL_CAPABILITY_COMMAND_INT;
}
impl Default for MavProtocolCapability {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavResult {
    MAV_RESULT_ACCEPTED = 0,
    MAV_RESULT_TEMPORARILY_REJECTED = 1,
    MAV_RESULT_DENIED = 2,
    MAV_RESULT_UNSUPPORTED = 3,
    MAV_RESULT_FAILED = 4,
    MAV_RESULT_IN_PROGRESS = 5,
    MAV_RESULT_CANCELLED = 6,
}
impl MavResult {
    pub const DEFAULT: Self = Self::MAV_RESULT_ACCEPTED;
}
impl Default for MavResult {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavSeverity {
    MAV_SEVERITY_EMERGENCY = 0,
    MAV_SEVERITY_ALERT = 1,
    MAV_SEVERITY_CRITICAL = 2,
    MAV_SEVERITY_ERROR = 3,
    MAV_SEVERITY_WARNING = 4,
    MAV_SEVERITY_NOTICE = 5,
    MAV_SEVERITY_INFO = 6,
    MAV_SEVERITY_DEBUG = 7,
}
impl MavSeverity {
    pub const DEFAULT: Self = Self::MAV_SEVERITY_EMERGENCY;
}
impl Default for MavSeverity {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavStandardMode {
    MAV_STANDARD_MODE_NON_STANDARD = 0,
}
impl MavStandardMode {
    pub const DEFAULT: Self = Self::MAV_STANDARD_MODE_NON_STANDARD;
}
impl Default for MavStandardMode {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavState {
    MAV_STATE_UNINIT = 0,
    MAV_STATE_BOOT = 1,
    MAV_STATE_CALIBRATING = 2,
    MAV_STATE_STANDBY = 3,
    MAV_STATE_ACTIVE = 4,
    MAV_STATE_CRITICAL = 5,
    MAV_STATE_EMERGENCY = 6,
    MAV_STATE_POWEROFF = 7,
    MAV_STATE_FLIGHT_TERMINATION = 8,
}
impl MavState {
    pub const DEFAULT: Self = Self::MAV_STATE_UNINIT;
}
impl Default for MavState {
    fn default() -> Self {
        Self::DEFAULT
    }
}
bitflags! { # [cfg_attr (feature = "ts-rs" , derive (TS))] # [cfg_attr (feature = "ts-rs" , ts (export , type = "number"))] # [cfg_attr (feature = "serde" , derive (Serialize , Deserialize))] # [cfg_attr (feature = "arbitrary" , derive (Arbitrary))] # [derive (Debug , Copy , Clone , PartialEq)] pub struct MavSysStatusSensor : u32 { const MAV_SYS_STATUS_SENSOR_3D_GYRO = 1 ; const MAV_SYS_STATUS_SENSOR_3D_ACCEL = 2 ; const MAV_SYS_STATUS_SENSOR_ANGULAR_RATE_CONTROL = 1024 ; const MAV_SYS_STATUS_SENSOR_ATTITUDE_STABILIZATION = 2048 ; const MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS = 32768 ; const MAV_SYS_STATUS_SENSOR_RC_RECEIVER = 65536 ; const MAV_SYS_STATUS_AHRS = 2097152 ; const MAV_SYS_STATUS_SENSOR_BATTERY = 33554432 ; const MAV_SYS_STATUS_PREARM_CHECK = 268435456 ; } }
impl MavSysStatusSensor {
    pub const DEFAULT: Self = Self::MAV_SYS_STATUS_SENSOR_3D_GYRO;
}
impl Default for MavSysStatusSensor {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavType {
    MAV_TYPE_QUADROTOR = 2,
    MAV_TYPE_GCS = 6,
}
impl MavType {
    pub const DEFAULT: Self = Self::MAV_TYPE_QUADROTOR;
}
impl Default for MavType {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MavVtolState {
    MAV_VTOL_STATE_UNDEFINED = 0,
}
impl MavVtolState {
    pub const DEFAULT: Self = Self::MAV_VTOL_STATE_UNDEFINED;
}
impl Default for MavVtolState {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum MotorTestThrottleType {
    MOTOR_TEST_THROTTLE_PERCENT = 0,
    MOTOR_TEST_THROTTLE_PWM = 1,
}
impl MotorTestThrottleType {
    pub const DEFAULT: Self = Self::MOTOR_TEST_THROTTLE_PERCENT;
}
impl Default for MotorTestThrottleType {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum SerialControlDev {
    SERIAL_CONTROL_DEV_SHELL = 10,
}
impl SerialControlDev {
    pub const DEFAULT: Self = Self::SERIAL_CONTROL_DEV_SHELL;
}
impl Default for SerialControlDev {
    fn default() -> Self {
        Self::DEFAULT
    }
}
bitflags! { # [cfg_attr (feature = "ts-rs" , derive (TS))] # [cfg_attr (feature = "ts-rs" , ts (export , type = "number"))] # [cfg_attr (feature = "serde" , derive (Serialize , Deserialize))] # [cfg_attr (feature = "arbitrary" , derive (Arbitrary))] # [derive (Debug , Copy , Clone , PartialEq)] pub struct SerialControlFlag : u16 { const SERIAL_CONTROL_FLAG_REPLY = 1 ; const SERIAL_CONTROL_FLAG_RESPOND = 2 ; const SERIAL_CONTROL_FLAG_EXCLUSIVE = 4 ; } }
impl SerialControlFlag {
    pub const DEFAULT: Self = Self::SERIAL_CONTROL_FLAG_REPLY;
}
impl Default for SerialControlFlag {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum SophieArmState {
    #[doc = "Tendon slack, no pressure."]
    SOPHIE_ARM_STATE_FREE = 0,
    #[doc = "Tendon winding, no contact yet."]
    SOPHIE_ARM_STATE_CLOSING = 1,
    #[doc = "Pressure rising."]
    SOPHIE_ARM_STATE_TOUCHING = 2,
    #[doc = "Pressure within its tolerance, force below its limit, for the dwell time."]
    SOPHIE_ARM_STATE_HOLDING = 3,
    #[doc = "Force limit reached before the pressure."]
    SOPHIE_ARM_STATE_FORCE_LIMITED = 4,
    #[doc = "A sensor failed: the force is held."]
    SOPHIE_ARM_STATE_FAULTY = 5,
    #[doc = "Tendon paying out."]
    SOPHIE_ARM_STATE_RELEASING = 6,
    #[doc = "The clamp loop is silent."]
    SOPHIE_ARM_STATE_UNKNOWN = 255,
}
impl SophieArmState {
    pub const DEFAULT: Self = Self::SOPHIE_ARM_STATE_FREE;
}
impl Default for SophieArmState {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum SophieCalibration {
    #[doc = "Ends the running one."]
    SOPHIE_CALIBRATION_NONE = 0,
    #[doc = "Gyro at rest; nothing is stored."]
    SOPHIE_CALIBRATION_GYRO = 1,
    #[doc = "Bias of the accelerometer on a level table."]
    SOPHIE_CALIBRATION_LEVEL = 2,
    #[doc = "Bias and scale of the accelerometer. Steps: belly, back, nose, tail, right side, left side down."]
    SOPHIE_CALIBRATION_ACCEL = 3,
    #[doc = "Mounting of the inertial sensor. Steps: belly, nose, right side down."]
    SOPHIE_CALIBRATION_MOUNTING = 4,
    #[doc = "Divider of the flight battery's voltage."]
    SOPHIE_CALIBRATION_BATTERY = 5,
    #[doc = "Release and full mark of one tendon servo."]
    SOPHIE_CALIBRATION_SERVO = 6,
    #[doc = "Line and hysteresis of one pressure sensor. Steps: empty, three known loads up, two down, empty."]
    SOPHIE_CALIBRATION_FSR = 7,
    #[doc = "Zero and sign of one arm's tilt sensor. Steps: arm straight, its tip bent up."]
    SOPHIE_CALIBRATION_ARM = 8,
    #[doc = "Scale and mounting of the flow module, turned for 8 s a step. Steps: 0.5 m, 1.5 m above a floor."]
    SOPHIE_CALIBRATION_FLOW = 9,
}
impl SophieCalibration {
    pub const DEFAULT: Self = Self::SOPHIE_CALIBRATION_NONE;
}
impl Default for SophieCalibration {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum SophieCalibrationOutcome {
    #[doc = "The step is measured; another follows."]
    SOPHIE_CALIBRATION_OUTCOME_TAKEN = 0,
    #[doc = "Complete: its parameters are set."]
    SOPHIE_CALIBRATION_OUTCOME_DONE = 1,
    #[doc = "A quantity is outside its range: nothing is set."]
    SOPHIE_CALIBRATION_OUTCOME_UNFIT = 2,
}
impl SophieCalibrationOutcome {
    pub const DEFAULT: Self = Self::SOPHIE_CALIBRATION_OUTCOME_TAKEN;
}
impl Default for SophieCalibrationOutcome {
    fn default() -> Self {
        Self::DEFAULT
    }
}
bitflags! { # [cfg_attr (feature = "ts-rs" , derive (TS))] # [cfg_attr (feature = "ts-rs" , ts (export , type = "number"))] # [cfg_attr (feature = "serde" , derive (Serialize , Deserialize))] # [cfg_attr (feature = "arbitrary" , derive (Arbitrary))] # [derive (Debug , Copy , Clone , PartialEq)] pub struct SophieGripFlags : u16 { # [doc = "Every chosen arm holds."] const SOPHIE_GRIP_FLAGS_PROVEN = 1 ; # [doc = "Every arm is free."] const SOPHIE_GRIP_FLAGS_RELEASED = 2 ; } }
impl SophieGripFlags {
    pub const DEFAULT: Self = Self::SOPHIE_GRIP_FLAGS_PROVEN;
}
impl Default for SophieGripFlags {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[derive(Debug, Copy, Clone, PartialEq, FromPrimitive, ToPrimitive)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[repr(u32)]
pub enum SophieReport {
    #[doc = "Self-test of all parts that need not move."]
    SOPHIE_REPORT_SELF_TEST = 1,
    #[doc = "Settings of the chip, as the start has read them."]
    SOPHIE_REPORT_CHIP = 2,
}
impl SophieReport {
    pub const DEFAULT: Self = Self::SOPHIE_REPORT_SELF_TEST;
}
impl Default for SophieReport {
    fn default() -> Self {
        Self::DEFAULT
    }
}
#[doc = "ID: 30"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct ATTITUDE_DATA {
    pub time_boot_ms: u32,
    pub roll: f32,
    pub pitch: f32,
    pub yaw: f32,
    pub rollspeed: f32,
    pub pitchspeed: f32,
    pub yawspeed: f32,
}
impl ATTITUDE_DATA {
    pub const ENCODED_LEN: usize = 28usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        roll: 0.0_f32,
        pitch: 0.0_f32,
        yaw: 0.0_f32,
        rollspeed: 0.0_f32,
        pitchspeed: 0.0_f32,
        yawspeed: 0.0_f32,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for ATTITUDE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for ATTITUDE_DATA {
    type Message = MavMessage;
    const ID: u32 = 30u32;
    const NAME: &'static str = "ATTITUDE";
    const EXTRA_CRC: u8 = 39u8;
    const ENCODED_LEN: usize = 28usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.roll = buf.get_f32_le()?;
        __struct.pitch = buf.get_f32_le()?;
        __struct.yaw = buf.get_f32_le()?;
        __struct.rollspeed = buf.get_f32_le()?;
        __struct.pitchspeed = buf.get_f32_le()?;
        __struct.yawspeed = buf.get_f32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_f32_le(self.roll);
        __tmp.put_f32_le(self.pitch);
        __tmp.put_f32_le(self.yaw);
        __tmp.put_f32_le(self.rollspeed);
        __tmp.put_f32_le(self.pitchspeed);
        __tmp.put_f32_le(self.yawspeed);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 31"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct ATTITUDE_QUATERNION_DATA {
    pub time_boot_ms: u32,
    pub q1: f32,
    pub q2: f32,
    pub q3: f32,
    pub q4: f32,
    pub rollspeed: f32,
    pub pitchspeed: f32,
    pub yawspeed: f32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub repr_offset_q: [f32; 4],
}
impl ATTITUDE_QUATERNION_DATA {
    pub const ENCODED_LEN: usize = 48usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        q1: 0.0_f32,
        q2: 0.0_f32,
        q3: 0.0_f32,
        q4: 0.0_f32,
        rollspeed: 0.0_f32,
        pitchspeed: 0.0_f32,
        yawspeed: 0.0_f32,
        repr_offset_q: [0.0_f32; 4usize],
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for ATTITUDE_QUATERNION_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for ATTITUDE_QUATERNION_DATA {
    type Message = MavMessage;
    const ID: u32 = 31u32;
    const NAME: &'static str = "ATTITUDE_QUATERNION";
    const EXTRA_CRC: u8 = 246u8;
    const ENCODED_LEN: usize = 48usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.q1 = buf.get_f32_le()?;
        __struct.q2 = buf.get_f32_le()?;
        __struct.q3 = buf.get_f32_le()?;
        __struct.q4 = buf.get_f32_le()?;
        __struct.rollspeed = buf.get_f32_le()?;
        __struct.pitchspeed = buf.get_f32_le()?;
        __struct.yawspeed = buf.get_f32_le()?;
        for v in &mut __struct.repr_offset_q {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_f32_le(self.q1);
        __tmp.put_f32_le(self.q2);
        __tmp.put_f32_le(self.q3);
        __tmp.put_f32_le(self.q4);
        __tmp.put_f32_le(self.rollspeed);
        __tmp.put_f32_le(self.pitchspeed);
        __tmp.put_f32_le(self.yawspeed);
        if matches!(version, MavlinkVersion::V2) {
            for val in &self.repr_offset_q {
                __tmp.put_f32_le(*val);
            }
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 138"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct ATT_POS_MOCAP_DATA {
    pub time_usec: u64,
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub q: [f32; 4],
    pub x: f32,
    pub y: f32,
    pub z: f32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub covariance: [f32; 21],
}
impl ATT_POS_MOCAP_DATA {
    pub const ENCODED_LEN: usize = 120usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u64,
        q: [0.0_f32; 4usize],
        x: 0.0_f32,
        y: 0.0_f32,
        z: 0.0_f32,
        covariance: [0.0_f32; 21usize],
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for ATT_POS_MOCAP_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for ATT_POS_MOCAP_DATA {
    type Message = MavMessage;
    const ID: u32 = 138u32;
    const NAME: &'static str = "ATT_POS_MOCAP";
    const EXTRA_CRC: u8 = 109u8;
    const ENCODED_LEN: usize = 120usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u64_le()?;
        for v in &mut __struct.q {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        __struct.x = buf.get_f32_le()?;
        __struct.y = buf.get_f32_le()?;
        __struct.z = buf.get_f32_le()?;
        for v in &mut __struct.covariance {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_usec);
        for val in &self.q {
            __tmp.put_f32_le(*val);
        }
        __tmp.put_f32_le(self.x);
        __tmp.put_f32_le(self.y);
        __tmp.put_f32_le(self.z);
        if matches!(version, MavlinkVersion::V2) {
            for val in &self.covariance {
                __tmp.put_f32_le(*val);
            }
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 148"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct AUTOPILOT_VERSION_DATA {
    pub capabilities: u64,
    pub uid: u64,
    pub flight_sw_version: u32,
    pub middleware_sw_version: u32,
    pub os_sw_version: u32,
    pub board_version: u32,
    pub vendor_id: u16,
    pub product_id: u16,
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub flight_custom_version: [u8; 8],
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub middleware_custom_version: [u8; 8],
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub os_custom_version: [u8; 8],
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub uid2: [u8; 18],
}
impl AUTOPILOT_VERSION_DATA {
    pub const ENCODED_LEN: usize = 78usize;
    pub const DEFAULT: Self = Self {
        capabilities: 0_u64,
        uid: 0_u64,
        flight_sw_version: 0_u32,
        middleware_sw_version: 0_u32,
        os_sw_version: 0_u32,
        board_version: 0_u32,
        vendor_id: 0_u16,
        product_id: 0_u16,
        flight_custom_version: [0_u8; 8usize],
        middleware_custom_version: [0_u8; 8usize],
        os_custom_version: [0_u8; 8usize],
        uid2: [0_u8; 18usize],
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for AUTOPILOT_VERSION_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for AUTOPILOT_VERSION_DATA {
    type Message = MavMessage;
    const ID: u32 = 148u32;
    const NAME: &'static str = "AUTOPILOT_VERSION";
    const EXTRA_CRC: u8 = 178u8;
    const ENCODED_LEN: usize = 78usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.capabilities = buf.get_u64_le()?;
        __struct.uid = buf.get_u64_le()?;
        __struct.flight_sw_version = buf.get_u32_le()?;
        __struct.middleware_sw_version = buf.get_u32_le()?;
        __struct.os_sw_version = buf.get_u32_le()?;
        __struct.board_version = buf.get_u32_le()?;
        __struct.vendor_id = buf.get_u16_le()?;
        __struct.product_id = buf.get_u16_le()?;
        for v in &mut __struct.flight_custom_version {
            let val = buf.get_u8()?;
            *v = val;
        }
        for v in &mut __struct.middleware_custom_version {
            let val = buf.get_u8()?;
            *v = val;
        }
        for v in &mut __struct.os_custom_version {
            let val = buf.get_u8()?;
            *v = val;
        }
        for v in &mut __struct.uid2 {
            let val = buf.get_u8()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.capabilities);
        __tmp.put_u64_le(self.uid);
        __tmp.put_u32_le(self.flight_sw_version);
        __tmp.put_u32_le(self.middleware_sw_version);
        __tmp.put_u32_le(self.os_sw_version);
        __tmp.put_u32_le(self.board_version);
        __tmp.put_u16_le(self.vendor_id);
        __tmp.put_u16_le(self.product_id);
        for val in &self.flight_custom_version {
            __tmp.put_u8(*val);
        }
        for val in &self.middleware_custom_version {
            __tmp.put_u8(*val);
        }
        for val in &self.os_custom_version {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            for val in &self.uid2 {
                __tmp.put_u8(*val);
            }
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 435"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct AVAILABLE_MODES_DATA {
    pub custom_mode: u32,
    pub properties: u32,
    pub number_modes: u8,
    pub mode_index: u8,
    pub standard_mode: u8,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub mode_name: CharArray<35>,
}
impl AVAILABLE_MODES_DATA {
    pub const ENCODED_LEN: usize = 46usize;
    pub const DEFAULT: Self = Self {
        custom_mode: 0_u32,
        properties: 0_u32,
        number_modes: 0_u8,
        mode_index: 0_u8,
        standard_mode: 0_u8,
        mode_name: CharArray::new([0_u8; 35usize]),
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for AVAILABLE_MODES_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for AVAILABLE_MODES_DATA {
    type Message = MavMessage;
    const ID: u32 = 435u32;
    const NAME: &'static str = "AVAILABLE_MODES";
    const EXTRA_CRC: u8 = 134u8;
    const ENCODED_LEN: usize = 46usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.custom_mode = buf.get_u32_le()?;
        __struct.properties = buf.get_u32_le()?;
        __struct.number_modes = buf.get_u8()?;
        __struct.mode_index = buf.get_u8()?;
        __struct.standard_mode = buf.get_u8()?;
        let mut tmp = [0_u8; 35usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.mode_name = CharArray::new(tmp);
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.custom_mode);
        __tmp.put_u32_le(self.properties);
        __tmp.put_u8(self.number_modes);
        __tmp.put_u8(self.mode_index);
        __tmp.put_u8(self.standard_mode);
        for val in &self.mode_name {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 437"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct AVAILABLE_MODES_MONITOR_DATA {
    pub seq: u8,
}
impl AVAILABLE_MODES_MONITOR_DATA {
    pub const ENCODED_LEN: usize = 1usize;
    pub const DEFAULT: Self = Self { seq: 0_u8 };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for AVAILABLE_MODES_MONITOR_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for AVAILABLE_MODES_MONITOR_DATA {
    type Message = MavMessage;
    const ID: u32 = 437u32;
    const NAME: &'static str = "AVAILABLE_MODES_MONITOR";
    const EXTRA_CRC: u8 = 30u8;
    const ENCODED_LEN: usize = 1usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.seq = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.seq);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 147"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct BATTERY_STATUS_DATA {
    pub current_consumed: i32,
    pub energy_consumed: i32,
    pub temperature: i16,
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub voltages: [u16; 10],
    pub current_battery: i16,
    pub id: u8,
    pub battery_function: u8,
    pub mavtype: u8,
    pub battery_remaining: i8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub time_remaining: i32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub charge_state: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub voltages_ext: [u16; 4],
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub mode: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub fault_bitmask: u32,
}
impl BATTERY_STATUS_DATA {
    pub const ENCODED_LEN: usize = 54usize;
    pub const DEFAULT: Self = Self {
        current_consumed: 0_i32,
        energy_consumed: 0_i32,
        temperature: 0_i16,
        voltages: [0_u16; 10usize],
        current_battery: 0_i16,
        id: 0_u8,
        battery_function: 0_u8,
        mavtype: 0_u8,
        battery_remaining: 0_i8,
        time_remaining: 0_i32,
        charge_state: 0_u8,
        voltages_ext: [0_u16; 4usize],
        mode: 0_u8,
        fault_bitmask: 0_u32,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for BATTERY_STATUS_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for BATTERY_STATUS_DATA {
    type Message = MavMessage;
    const ID: u32 = 147u32;
    const NAME: &'static str = "BATTERY_STATUS";
    const EXTRA_CRC: u8 = 154u8;
    const ENCODED_LEN: usize = 54usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.current_consumed = buf.get_i32_le()?;
        __struct.energy_consumed = buf.get_i32_le()?;
        __struct.temperature = buf.get_i16_le()?;
        for v in &mut __struct.voltages {
            let val = buf.get_u16_le()?;
            *v = val;
        }
        __struct.current_battery = buf.get_i16_le()?;
        __struct.id = buf.get_u8()?;
        __struct.battery_function = buf.get_u8()?;
        __struct.mavtype = buf.get_u8()?;
        __struct.battery_remaining = buf.get_i8()?;
        __struct.time_remaining = buf.get_i32_le()?;
        __struct.charge_state = buf.get_u8()?;
        for v in &mut __struct.voltages_ext {
            let val = buf.get_u16_le()?;
            *v = val;
        }
        __struct.mode = buf.get_u8()?;
        __struct.fault_bitmask = buf.get_u32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i32_le(self.current_consumed);
        __tmp.put_i32_le(self.energy_consumed);
        __tmp.put_i16_le(self.temperature);
        for val in &self.voltages {
            __tmp.put_u16_le(*val);
        }
        __tmp.put_i16_le(self.current_battery);
        __tmp.put_u8(self.id);
        __tmp.put_u8(self.battery_function);
        __tmp.put_u8(self.mavtype);
        __tmp.put_i8(self.battery_remaining);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_i32_le(self.time_remaining);
            __tmp.put_u8(self.charge_state);
            for val in &self.voltages_ext {
                __tmp.put_u16_le(*val);
            }
            __tmp.put_u8(self.mode);
            __tmp.put_u32_le(self.fault_bitmask);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 77"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct COMMAND_ACK_DATA {
    pub command: u16,
    pub result: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub progress: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub result_param2: i32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub target_system: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub target_component: u8,
}
impl COMMAND_ACK_DATA {
    pub const ENCODED_LEN: usize = 10usize;
    pub const DEFAULT: Self = Self {
        command: 0_u16,
        result: 0_u8,
        progress: 0_u8,
        result_param2: 0_i32,
        target_system: 0_u8,
        target_component: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for COMMAND_ACK_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for COMMAND_ACK_DATA {
    type Message = MavMessage;
    const ID: u32 = 77u32;
    const NAME: &'static str = "COMMAND_ACK";
    const EXTRA_CRC: u8 = 143u8;
    const ENCODED_LEN: usize = 10usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.command = buf.get_u16_le()?;
        __struct.result = buf.get_u8()?;
        __struct.progress = buf.get_u8()?;
        __struct.result_param2 = buf.get_i32_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u16_le(self.command);
        __tmp.put_u8(self.result);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.progress);
            __tmp.put_i32_le(self.result_param2);
            __tmp.put_u8(self.target_system);
            __tmp.put_u8(self.target_component);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 75"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct COMMAND_INT_DATA {
    pub param1: f32,
    pub param2: f32,
    pub param3: f32,
    pub param4: f32,
    pub x: i32,
    pub y: i32,
    pub z: f32,
    pub command: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub frame: u8,
    pub current: u8,
    pub autocontinue: u8,
}
impl COMMAND_INT_DATA {
    pub const ENCODED_LEN: usize = 35usize;
    pub const DEFAULT: Self = Self {
        param1: 0.0_f32,
        param2: 0.0_f32,
        param3: 0.0_f32,
        param4: 0.0_f32,
        x: 0_i32,
        y: 0_i32,
        z: 0.0_f32,
        command: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        frame: 0_u8,
        current: 0_u8,
        autocontinue: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for COMMAND_INT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for COMMAND_INT_DATA {
    type Message = MavMessage;
    const ID: u32 = 75u32;
    const NAME: &'static str = "COMMAND_INT";
    const EXTRA_CRC: u8 = 158u8;
    const ENCODED_LEN: usize = 35usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param1 = buf.get_f32_le()?;
        __struct.param2 = buf.get_f32_le()?;
        __struct.param3 = buf.get_f32_le()?;
        __struct.param4 = buf.get_f32_le()?;
        __struct.x = buf.get_i32_le()?;
        __struct.y = buf.get_i32_le()?;
        __struct.z = buf.get_f32_le()?;
        __struct.command = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.frame = buf.get_u8()?;
        __struct.current = buf.get_u8()?;
        __struct.autocontinue = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.param1);
        __tmp.put_f32_le(self.param2);
        __tmp.put_f32_le(self.param3);
        __tmp.put_f32_le(self.param4);
        __tmp.put_i32_le(self.x);
        __tmp.put_i32_le(self.y);
        __tmp.put_f32_le(self.z);
        __tmp.put_u16_le(self.command);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.frame);
        __tmp.put_u8(self.current);
        __tmp.put_u8(self.autocontinue);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 76"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct COMMAND_LONG_DATA {
    pub param1: f32,
    pub param2: f32,
    pub param3: f32,
    pub param4: f32,
    pub param5: f32,
    pub param6: f32,
    pub param7: f32,
    pub command: u16,
    pub target_system: u8,
    pub target_component: u8,
    pub confirmation: u8,
}
impl COMMAND_LONG_DATA {
    pub const ENCODED_LEN: usize = 33usize;
    pub const DEFAULT: Self = Self {
        param1: 0.0_f32,
        param2: 0.0_f32,
        param3: 0.0_f32,
        param4: 0.0_f32,
        param5: 0.0_f32,
        param6: 0.0_f32,
        param7: 0.0_f32,
        command: 0_u16,
        target_system: 0_u8,
        target_component: 0_u8,
        confirmation: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for COMMAND_LONG_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for COMMAND_LONG_DATA {
    type Message = MavMessage;
    const ID: u32 = 76u32;
    const NAME: &'static str = "COMMAND_LONG";
    const EXTRA_CRC: u8 = 152u8;
    const ENCODED_LEN: usize = 33usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param1 = buf.get_f32_le()?;
        __struct.param2 = buf.get_f32_le()?;
        __struct.param3 = buf.get_f32_le()?;
        __struct.param4 = buf.get_f32_le()?;
        __struct.param5 = buf.get_f32_le()?;
        __struct.param6 = buf.get_f32_le()?;
        __struct.param7 = buf.get_f32_le()?;
        __struct.command = buf.get_u16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        __struct.confirmation = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.param1);
        __tmp.put_f32_le(self.param2);
        __tmp.put_f32_le(self.param3);
        __tmp.put_f32_le(self.param4);
        __tmp.put_f32_le(self.param5);
        __tmp.put_f32_le(self.param6);
        __tmp.put_f32_le(self.param7);
        __tmp.put_u16_le(self.command);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        __tmp.put_u8(self.confirmation);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 396"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct COMPONENT_INFORMATION_BASIC_DATA {
    pub capabilities: u64,
    pub time_boot_ms: u32,
    pub time_manufacture_s: u32,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub vendor_name: CharArray<32>,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub model_name: CharArray<32>,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub software_version: CharArray<24>,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub hardware_version: CharArray<24>,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub serial_number: CharArray<32>,
}
impl COMPONENT_INFORMATION_BASIC_DATA {
    pub const ENCODED_LEN: usize = 160usize;
    pub const DEFAULT: Self = Self {
        capabilities: 0_u64,
        time_boot_ms: 0_u32,
        time_manufacture_s: 0_u32,
        vendor_name: CharArray::new([0_u8; 32usize]),
        model_name: CharArray::new([0_u8; 32usize]),
        software_version: CharArray::new([0_u8; 24usize]),
        hardware_version: CharArray::new([0_u8; 24usize]),
        serial_number: CharArray::new([0_u8; 32usize]),
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for COMPONENT_INFORMATION_BASIC_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for COMPONENT_INFORMATION_BASIC_DATA {
    type Message = MavMessage;
    const ID: u32 = 396u32;
    const NAME: &'static str = "COMPONENT_INFORMATION_BASIC";
    const EXTRA_CRC: u8 = 50u8;
    const ENCODED_LEN: usize = 160usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.capabilities = buf.get_u64_le()?;
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.time_manufacture_s = buf.get_u32_le()?;
        let mut tmp = [0_u8; 32usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.vendor_name = CharArray::new(tmp);
        let mut tmp = [0_u8; 32usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.model_name = CharArray::new(tmp);
        let mut tmp = [0_u8; 24usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.software_version = CharArray::new(tmp);
        let mut tmp = [0_u8; 24usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.hardware_version = CharArray::new(tmp);
        let mut tmp = [0_u8; 32usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.serial_number = CharArray::new(tmp);
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.capabilities);
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_u32_le(self.time_manufacture_s);
        for val in &self.vendor_name {
            __tmp.put_u8(*val);
        }
        for val in &self.model_name {
            __tmp.put_u8(*val);
        }
        for val in &self.software_version {
            __tmp.put_u8(*val);
        }
        for val in &self.hardware_version {
            __tmp.put_u8(*val);
        }
        for val in &self.serial_number {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 397"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct COMPONENT_METADATA_DATA {
    pub time_boot_ms: u32,
    pub file_crc: u32,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub uri: CharArray<100>,
}
impl COMPONENT_METADATA_DATA {
    pub const ENCODED_LEN: usize = 108usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        file_crc: 0_u32,
        uri: CharArray::new([0_u8; 100usize]),
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for COMPONENT_METADATA_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for COMPONENT_METADATA_DATA {
    type Message = MavMessage;
    const ID: u32 = 397u32;
    const NAME: &'static str = "COMPONENT_METADATA";
    const EXTRA_CRC: u8 = 182u8;
    const ENCODED_LEN: usize = 108usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.file_crc = buf.get_u32_le()?;
        let mut tmp = [0_u8; 100usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.uri = CharArray::new(tmp);
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_u32_le(self.file_crc);
        for val in &self.uri {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 436"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct CURRENT_MODE_DATA {
    pub custom_mode: u32,
    pub intended_custom_mode: u32,
    pub standard_mode: u8,
}
impl CURRENT_MODE_DATA {
    pub const ENCODED_LEN: usize = 9usize;
    pub const DEFAULT: Self = Self {
        custom_mode: 0_u32,
        intended_custom_mode: 0_u32,
        standard_mode: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for CURRENT_MODE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for CURRENT_MODE_DATA {
    type Message = MavMessage;
    const ID: u32 = 436u32;
    const NAME: &'static str = "CURRENT_MODE";
    const EXTRA_CRC: u8 = 193u8;
    const ENCODED_LEN: usize = 9usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.custom_mode = buf.get_u32_le()?;
        __struct.intended_custom_mode = buf.get_u32_le()?;
        __struct.standard_mode = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.custom_mode);
        __tmp.put_u32_le(self.intended_custom_mode);
        __tmp.put_u8(self.standard_mode);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 132"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct DISTANCE_SENSOR_DATA {
    pub time_boot_ms: u32,
    pub min_distance: u16,
    pub max_distance: u16,
    pub current_distance: u16,
    pub mavtype: u8,
    pub id: u8,
    pub orientation: u8,
    pub covariance: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub horizontal_fov: f32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub vertical_fov: f32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub quaternion: [f32; 4],
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub signal_quality: u8,
}
impl DISTANCE_SENSOR_DATA {
    pub const ENCODED_LEN: usize = 39usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        min_distance: 0_u16,
        max_distance: 0_u16,
        current_distance: 0_u16,
        mavtype: 0_u8,
        id: 0_u8,
        orientation: 0_u8,
        covariance: 0_u8,
        horizontal_fov: 0.0_f32,
        vertical_fov: 0.0_f32,
        quaternion: [0.0_f32; 4usize],
        signal_quality: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for DISTANCE_SENSOR_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for DISTANCE_SENSOR_DATA {
    type Message = MavMessage;
    const ID: u32 = 132u32;
    const NAME: &'static str = "DISTANCE_SENSOR";
    const EXTRA_CRC: u8 = 85u8;
    const ENCODED_LEN: usize = 39usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.min_distance = buf.get_u16_le()?;
        __struct.max_distance = buf.get_u16_le()?;
        __struct.current_distance = buf.get_u16_le()?;
        __struct.mavtype = buf.get_u8()?;
        __struct.id = buf.get_u8()?;
        __struct.orientation = buf.get_u8()?;
        __struct.covariance = buf.get_u8()?;
        __struct.horizontal_fov = buf.get_f32_le()?;
        __struct.vertical_fov = buf.get_f32_le()?;
        for v in &mut __struct.quaternion {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        __struct.signal_quality = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_u16_le(self.min_distance);
        __tmp.put_u16_le(self.max_distance);
        __tmp.put_u16_le(self.current_distance);
        __tmp.put_u8(self.mavtype);
        __tmp.put_u8(self.id);
        __tmp.put_u8(self.orientation);
        __tmp.put_u8(self.covariance);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_f32_le(self.horizontal_fov);
            __tmp.put_f32_le(self.vertical_fov);
            for val in &self.quaternion {
                __tmp.put_f32_le(*val);
            }
            __tmp.put_u8(self.signal_quality);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 245"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct EXTENDED_SYS_STATE_DATA {
    pub vtol_state: u8,
    pub landed_state: u8,
}
impl EXTENDED_SYS_STATE_DATA {
    pub const ENCODED_LEN: usize = 2usize;
    pub const DEFAULT: Self = Self {
        vtol_state: 0_u8,
        landed_state: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for EXTENDED_SYS_STATE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for EXTENDED_SYS_STATE_DATA {
    type Message = MavMessage;
    const ID: u32 = 245u32;
    const NAME: &'static str = "EXTENDED_SYS_STATE";
    const EXTRA_CRC: u8 = 130u8;
    const ENCODED_LEN: usize = 2usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.vtol_state = buf.get_u8()?;
        __struct.landed_state = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.vtol_state);
        __tmp.put_u8(self.landed_state);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 110"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct FILE_TRANSFER_PROTOCOL_DATA {
    pub target_network: u8,
    pub target_system: u8,
    pub target_component: u8,
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub payload: [u8; 251],
}
impl FILE_TRANSFER_PROTOCOL_DATA {
    pub const ENCODED_LEN: usize = 254usize;
    pub const DEFAULT: Self = Self {
        target_network: 0_u8,
        target_system: 0_u8,
        target_component: 0_u8,
        payload: [0_u8; 251usize],
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for FILE_TRANSFER_PROTOCOL_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for FILE_TRANSFER_PROTOCOL_DATA {
    type Message = MavMessage;
    const ID: u32 = 110u32;
    const NAME: &'static str = "FILE_TRANSFER_PROTOCOL";
    const EXTRA_CRC: u8 = 84u8;
    const ENCODED_LEN: usize = 254usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.target_network = buf.get_u8()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        for v in &mut __struct.payload {
            let val = buf.get_u8()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.target_network);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        for val in &self.payload {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 0"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct HEARTBEAT_DATA {
    pub custom_mode: u32,
    pub mavtype: u8,
    pub autopilot: u8,
    pub base_mode: u8,
    pub system_status: u8,
    pub mavlink_version: u8,
}
impl HEARTBEAT_DATA {
    pub const ENCODED_LEN: usize = 9usize;
    pub const DEFAULT: Self = Self {
        custom_mode: 0_u32,
        mavtype: 0_u8,
        autopilot: 0_u8,
        base_mode: 0_u8,
        system_status: 0_u8,
        mavlink_version: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for HEARTBEAT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for HEARTBEAT_DATA {
    type Message = MavMessage;
    const ID: u32 = 0u32;
    const NAME: &'static str = "HEARTBEAT";
    const EXTRA_CRC: u8 = 50u8;
    const ENCODED_LEN: usize = 9usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.custom_mode = buf.get_u32_le()?;
        __struct.mavtype = buf.get_u8()?;
        __struct.autopilot = buf.get_u8()?;
        __struct.base_mode = buf.get_u8()?;
        __struct.system_status = buf.get_u8()?;
        __struct.mavlink_version = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.custom_mode);
        __tmp.put_u8(self.mavtype);
        __tmp.put_u8(self.autopilot);
        __tmp.put_u8(self.base_mode);
        __tmp.put_u8(self.system_status);
        __tmp.put_u8(self.mavlink_version);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 149"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct LANDING_TARGET_DATA {
    pub time_usec: u64,
    pub angle_x: f32,
    pub angle_y: f32,
    pub distance: f32,
    pub size_x: f32,
    pub size_y: f32,
    pub target_num: u8,
    pub frame: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub x: f32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub y: f32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub z: f32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub q: [f32; 4],
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub mavtype: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub position_valid: u8,
}
impl LANDING_TARGET_DATA {
    pub const ENCODED_LEN: usize = 60usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u64,
        angle_x: 0.0_f32,
        angle_y: 0.0_f32,
        distance: 0.0_f32,
        size_x: 0.0_f32,
        size_y: 0.0_f32,
        target_num: 0_u8,
        frame: 0_u8,
        x: 0.0_f32,
        y: 0.0_f32,
        z: 0.0_f32,
        q: [0.0_f32; 4usize],
        mavtype: 0_u8,
        position_valid: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for LANDING_TARGET_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for LANDING_TARGET_DATA {
    type Message = MavMessage;
    const ID: u32 = 149u32;
    const NAME: &'static str = "LANDING_TARGET";
    const EXTRA_CRC: u8 = 200u8;
    const ENCODED_LEN: usize = 60usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u64_le()?;
        __struct.angle_x = buf.get_f32_le()?;
        __struct.angle_y = buf.get_f32_le()?;
        __struct.distance = buf.get_f32_le()?;
        __struct.size_x = buf.get_f32_le()?;
        __struct.size_y = buf.get_f32_le()?;
        __struct.target_num = buf.get_u8()?;
        __struct.frame = buf.get_u8()?;
        __struct.x = buf.get_f32_le()?;
        __struct.y = buf.get_f32_le()?;
        __struct.z = buf.get_f32_le()?;
        for v in &mut __struct.q {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        __struct.mavtype = buf.get_u8()?;
        __struct.position_valid = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_usec);
        __tmp.put_f32_le(self.angle_x);
        __tmp.put_f32_le(self.angle_y);
        __tmp.put_f32_le(self.distance);
        __tmp.put_f32_le(self.size_x);
        __tmp.put_f32_le(self.size_y);
        __tmp.put_u8(self.target_num);
        __tmp.put_u8(self.frame);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_f32_le(self.x);
            __tmp.put_f32_le(self.y);
            __tmp.put_f32_le(self.z);
            for val in &self.q {
                __tmp.put_f32_le(*val);
            }
            __tmp.put_u8(self.mavtype);
            __tmp.put_u8(self.position_valid);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 244"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct MESSAGE_INTERVAL_DATA {
    pub interval_us: i32,
    pub message_id: u16,
}
impl MESSAGE_INTERVAL_DATA {
    pub const ENCODED_LEN: usize = 6usize;
    pub const DEFAULT: Self = Self {
        interval_us: 0_i32,
        message_id: 0_u16,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for MESSAGE_INTERVAL_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for MESSAGE_INTERVAL_DATA {
    type Message = MavMessage;
    const ID: u32 = 244u32;
    const NAME: &'static str = "MESSAGE_INTERVAL";
    const EXTRA_CRC: u8 = 95u8;
    const ENCODED_LEN: usize = 6usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.interval_us = buf.get_i32_le()?;
        __struct.message_id = buf.get_u16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i32_le(self.interval_us);
        __tmp.put_u16_le(self.message_id);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 251"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct NAMED_VALUE_FLOAT_DATA {
    pub time_boot_ms: u32,
    pub value: f32,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub name: CharArray<10>,
}
impl NAMED_VALUE_FLOAT_DATA {
    pub const ENCODED_LEN: usize = 18usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        value: 0.0_f32,
        name: CharArray::new([0_u8; 10usize]),
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for NAMED_VALUE_FLOAT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for NAMED_VALUE_FLOAT_DATA {
    type Message = MavMessage;
    const ID: u32 = 251u32;
    const NAME: &'static str = "NAMED_VALUE_FLOAT";
    const EXTRA_CRC: u8 = 170u8;
    const ENCODED_LEN: usize = 18usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.value = buf.get_f32_le()?;
        let mut tmp = [0_u8; 10usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.name = CharArray::new(tmp);
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_f32_le(self.value);
        for val in &self.name {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 331"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct ODOMETRY_DATA {
    pub time_usec: u64,
    pub x: f32,
    pub y: f32,
    pub z: f32,
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub q: [f32; 4],
    pub vx: f32,
    pub vy: f32,
    pub vz: f32,
    pub rollspeed: f32,
    pub pitchspeed: f32,
    pub yawspeed: f32,
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub pose_covariance: [f32; 21],
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub velocity_covariance: [f32; 21],
    pub frame_id: u8,
    pub child_frame_id: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub reset_counter: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub estimator_type: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub quality: i8,
}
impl ODOMETRY_DATA {
    pub const ENCODED_LEN: usize = 233usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u64,
        x: 0.0_f32,
        y: 0.0_f32,
        z: 0.0_f32,
        q: [0.0_f32; 4usize],
        vx: 0.0_f32,
        vy: 0.0_f32,
        vz: 0.0_f32,
        rollspeed: 0.0_f32,
        pitchspeed: 0.0_f32,
        yawspeed: 0.0_f32,
        pose_covariance: [0.0_f32; 21usize],
        velocity_covariance: [0.0_f32; 21usize],
        frame_id: 0_u8,
        child_frame_id: 0_u8,
        reset_counter: 0_u8,
        estimator_type: 0_u8,
        quality: 0_i8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for ODOMETRY_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for ODOMETRY_DATA {
    type Message = MavMessage;
    const ID: u32 = 331u32;
    const NAME: &'static str = "ODOMETRY";
    const EXTRA_CRC: u8 = 91u8;
    const ENCODED_LEN: usize = 233usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u64_le()?;
        __struct.x = buf.get_f32_le()?;
        __struct.y = buf.get_f32_le()?;
        __struct.z = buf.get_f32_le()?;
        for v in &mut __struct.q {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        __struct.vx = buf.get_f32_le()?;
        __struct.vy = buf.get_f32_le()?;
        __struct.vz = buf.get_f32_le()?;
        __struct.rollspeed = buf.get_f32_le()?;
        __struct.pitchspeed = buf.get_f32_le()?;
        __struct.yawspeed = buf.get_f32_le()?;
        for v in &mut __struct.pose_covariance {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        for v in &mut __struct.velocity_covariance {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        __struct.frame_id = buf.get_u8()?;
        __struct.child_frame_id = buf.get_u8()?;
        __struct.reset_counter = buf.get_u8()?;
        __struct.estimator_type = buf.get_u8()?;
        __struct.quality = buf.get_i8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_usec);
        __tmp.put_f32_le(self.x);
        __tmp.put_f32_le(self.y);
        __tmp.put_f32_le(self.z);
        for val in &self.q {
            __tmp.put_f32_le(*val);
        }
        __tmp.put_f32_le(self.vx);
        __tmp.put_f32_le(self.vy);
        __tmp.put_f32_le(self.vz);
        __tmp.put_f32_le(self.rollspeed);
        __tmp.put_f32_le(self.pitchspeed);
        __tmp.put_f32_le(self.yawspeed);
        for val in &self.pose_covariance {
            __tmp.put_f32_le(*val);
        }
        for val in &self.velocity_covariance {
            __tmp.put_f32_le(*val);
        }
        __tmp.put_u8(self.frame_id);
        __tmp.put_u8(self.child_frame_id);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.reset_counter);
            __tmp.put_u8(self.estimator_type);
            __tmp.put_i8(self.quality);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 106"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct OPTICAL_FLOW_RAD_DATA {
    pub time_usec: u64,
    pub integration_time_us: u32,
    pub integrated_x: f32,
    pub integrated_y: f32,
    pub integrated_xgyro: f32,
    pub integrated_ygyro: f32,
    pub integrated_zgyro: f32,
    pub time_delta_distance_us: u32,
    pub distance: f32,
    pub temperature: i16,
    pub sensor_id: u8,
    pub quality: u8,
}
impl OPTICAL_FLOW_RAD_DATA {
    pub const ENCODED_LEN: usize = 44usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u64,
        integration_time_us: 0_u32,
        integrated_x: 0.0_f32,
        integrated_y: 0.0_f32,
        integrated_xgyro: 0.0_f32,
        integrated_ygyro: 0.0_f32,
        integrated_zgyro: 0.0_f32,
        time_delta_distance_us: 0_u32,
        distance: 0.0_f32,
        temperature: 0_i16,
        sensor_id: 0_u8,
        quality: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for OPTICAL_FLOW_RAD_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for OPTICAL_FLOW_RAD_DATA {
    type Message = MavMessage;
    const ID: u32 = 106u32;
    const NAME: &'static str = "OPTICAL_FLOW_RAD";
    const EXTRA_CRC: u8 = 138u8;
    const ENCODED_LEN: usize = 44usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u64_le()?;
        __struct.integration_time_us = buf.get_u32_le()?;
        __struct.integrated_x = buf.get_f32_le()?;
        __struct.integrated_y = buf.get_f32_le()?;
        __struct.integrated_xgyro = buf.get_f32_le()?;
        __struct.integrated_ygyro = buf.get_f32_le()?;
        __struct.integrated_zgyro = buf.get_f32_le()?;
        __struct.time_delta_distance_us = buf.get_u32_le()?;
        __struct.distance = buf.get_f32_le()?;
        __struct.temperature = buf.get_i16_le()?;
        __struct.sensor_id = buf.get_u8()?;
        __struct.quality = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_usec);
        __tmp.put_u32_le(self.integration_time_us);
        __tmp.put_f32_le(self.integrated_x);
        __tmp.put_f32_le(self.integrated_y);
        __tmp.put_f32_le(self.integrated_xgyro);
        __tmp.put_f32_le(self.integrated_ygyro);
        __tmp.put_f32_le(self.integrated_zgyro);
        __tmp.put_u32_le(self.time_delta_distance_us);
        __tmp.put_f32_le(self.distance);
        __tmp.put_i16_le(self.temperature);
        __tmp.put_u8(self.sensor_id);
        __tmp.put_u8(self.quality);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 21"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct PARAM_REQUEST_LIST_DATA {
    pub target_system: u8,
    pub target_component: u8,
}
impl PARAM_REQUEST_LIST_DATA {
    pub const ENCODED_LEN: usize = 2usize;
    pub const DEFAULT: Self = Self {
        target_system: 0_u8,
        target_component: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for PARAM_REQUEST_LIST_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for PARAM_REQUEST_LIST_DATA {
    type Message = MavMessage;
    const ID: u32 = 21u32;
    const NAME: &'static str = "PARAM_REQUEST_LIST";
    const EXTRA_CRC: u8 = 159u8;
    const ENCODED_LEN: usize = 2usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 20"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct PARAM_REQUEST_READ_DATA {
    pub param_index: i16,
    pub target_system: u8,
    pub target_component: u8,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub param_id: CharArray<16>,
}
impl PARAM_REQUEST_READ_DATA {
    pub const ENCODED_LEN: usize = 20usize;
    pub const DEFAULT: Self = Self {
        param_index: 0_i16,
        target_system: 0_u8,
        target_component: 0_u8,
        param_id: CharArray::new([0_u8; 16usize]),
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for PARAM_REQUEST_READ_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for PARAM_REQUEST_READ_DATA {
    type Message = MavMessage;
    const ID: u32 = 20u32;
    const NAME: &'static str = "PARAM_REQUEST_READ";
    const EXTRA_CRC: u8 = 214u8;
    const ENCODED_LEN: usize = 20usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param_index = buf.get_i16_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        let mut tmp = [0_u8; 16usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.param_id = CharArray::new(tmp);
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i16_le(self.param_index);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        for val in &self.param_id {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 23"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct PARAM_SET_DATA {
    pub param_value: f32,
    pub target_system: u8,
    pub target_component: u8,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub param_id: CharArray<16>,
    pub param_type: u8,
}
impl PARAM_SET_DATA {
    pub const ENCODED_LEN: usize = 23usize;
    pub const DEFAULT: Self = Self {
        param_value: 0.0_f32,
        target_system: 0_u8,
        target_component: 0_u8,
        param_id: CharArray::new([0_u8; 16usize]),
        param_type: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for PARAM_SET_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for PARAM_SET_DATA {
    type Message = MavMessage;
    const ID: u32 = 23u32;
    const NAME: &'static str = "PARAM_SET";
    const EXTRA_CRC: u8 = 168u8;
    const ENCODED_LEN: usize = 23usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param_value = buf.get_f32_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        let mut tmp = [0_u8; 16usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.param_id = CharArray::new(tmp);
        __struct.param_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.param_value);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        for val in &self.param_id {
            __tmp.put_u8(*val);
        }
        __tmp.put_u8(self.param_type);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 22"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct PARAM_VALUE_DATA {
    pub param_value: f32,
    pub param_count: u16,
    pub param_index: u16,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub param_id: CharArray<16>,
    pub param_type: u8,
}
impl PARAM_VALUE_DATA {
    pub const ENCODED_LEN: usize = 25usize;
    pub const DEFAULT: Self = Self {
        param_value: 0.0_f32,
        param_count: 0_u16,
        param_index: 0_u16,
        param_id: CharArray::new([0_u8; 16usize]),
        param_type: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for PARAM_VALUE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for PARAM_VALUE_DATA {
    type Message = MavMessage;
    const ID: u32 = 22u32;
    const NAME: &'static str = "PARAM_VALUE";
    const EXTRA_CRC: u8 = 220u8;
    const ENCODED_LEN: usize = 25usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.param_value = buf.get_f32_le()?;
        __struct.param_count = buf.get_u16_le()?;
        __struct.param_index = buf.get_u16_le()?;
        let mut tmp = [0_u8; 16usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.param_id = CharArray::new(tmp);
        __struct.param_type = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_f32_le(self.param_value);
        __tmp.put_u16_le(self.param_count);
        __tmp.put_u16_le(self.param_index);
        for val in &self.param_id {
            __tmp.put_u8(*val);
        }
        __tmp.put_u8(self.param_type);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 4"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct PING_DATA {
    pub time_usec: u64,
    pub seq: u32,
    pub target_system: u8,
    pub target_component: u8,
}
impl PING_DATA {
    pub const ENCODED_LEN: usize = 14usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u64,
        seq: 0_u32,
        target_system: 0_u8,
        target_component: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for PING_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for PING_DATA {
    type Message = MavMessage;
    const ID: u32 = 4u32;
    const NAME: &'static str = "PING";
    const EXTRA_CRC: u8 = 237u8;
    const ENCODED_LEN: usize = 14usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u64_le()?;
        __struct.seq = buf.get_u32_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_usec);
        __tmp.put_u32_le(self.seq);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 65"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct RC_CHANNELS_DATA {
    pub time_boot_ms: u32,
    pub chan1_raw: u16,
    pub chan2_raw: u16,
    pub chan3_raw: u16,
    pub chan4_raw: u16,
    pub chan5_raw: u16,
    pub chan6_raw: u16,
    pub chan7_raw: u16,
    pub chan8_raw: u16,
    pub chan9_raw: u16,
    pub chan10_raw: u16,
    pub chan11_raw: u16,
    pub chan12_raw: u16,
    pub chan13_raw: u16,
    pub chan14_raw: u16,
    pub chan15_raw: u16,
    pub chan16_raw: u16,
    pub chan17_raw: u16,
    pub chan18_raw: u16,
    pub chancount: u8,
    pub rssi: u8,
}
impl RC_CHANNELS_DATA {
    pub const ENCODED_LEN: usize = 42usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        chan1_raw: 0_u16,
        chan2_raw: 0_u16,
        chan3_raw: 0_u16,
        chan4_raw: 0_u16,
        chan5_raw: 0_u16,
        chan6_raw: 0_u16,
        chan7_raw: 0_u16,
        chan8_raw: 0_u16,
        chan9_raw: 0_u16,
        chan10_raw: 0_u16,
        chan11_raw: 0_u16,
        chan12_raw: 0_u16,
        chan13_raw: 0_u16,
        chan14_raw: 0_u16,
        chan15_raw: 0_u16,
        chan16_raw: 0_u16,
        chan17_raw: 0_u16,
        chan18_raw: 0_u16,
        chancount: 0_u8,
        rssi: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for RC_CHANNELS_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for RC_CHANNELS_DATA {
    type Message = MavMessage;
    const ID: u32 = 65u32;
    const NAME: &'static str = "RC_CHANNELS";
    const EXTRA_CRC: u8 = 118u8;
    const ENCODED_LEN: usize = 42usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.chan1_raw = buf.get_u16_le()?;
        __struct.chan2_raw = buf.get_u16_le()?;
        __struct.chan3_raw = buf.get_u16_le()?;
        __struct.chan4_raw = buf.get_u16_le()?;
        __struct.chan5_raw = buf.get_u16_le()?;
        __struct.chan6_raw = buf.get_u16_le()?;
        __struct.chan7_raw = buf.get_u16_le()?;
        __struct.chan8_raw = buf.get_u16_le()?;
        __struct.chan9_raw = buf.get_u16_le()?;
        __struct.chan10_raw = buf.get_u16_le()?;
        __struct.chan11_raw = buf.get_u16_le()?;
        __struct.chan12_raw = buf.get_u16_le()?;
        __struct.chan13_raw = buf.get_u16_le()?;
        __struct.chan14_raw = buf.get_u16_le()?;
        __struct.chan15_raw = buf.get_u16_le()?;
        __struct.chan16_raw = buf.get_u16_le()?;
        __struct.chan17_raw = buf.get_u16_le()?;
        __struct.chan18_raw = buf.get_u16_le()?;
        __struct.chancount = buf.get_u8()?;
        __struct.rssi = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_u16_le(self.chan1_raw);
        __tmp.put_u16_le(self.chan2_raw);
        __tmp.put_u16_le(self.chan3_raw);
        __tmp.put_u16_le(self.chan4_raw);
        __tmp.put_u16_le(self.chan5_raw);
        __tmp.put_u16_le(self.chan6_raw);
        __tmp.put_u16_le(self.chan7_raw);
        __tmp.put_u16_le(self.chan8_raw);
        __tmp.put_u16_le(self.chan9_raw);
        __tmp.put_u16_le(self.chan10_raw);
        __tmp.put_u16_le(self.chan11_raw);
        __tmp.put_u16_le(self.chan12_raw);
        __tmp.put_u16_le(self.chan13_raw);
        __tmp.put_u16_le(self.chan14_raw);
        __tmp.put_u16_le(self.chan15_raw);
        __tmp.put_u16_le(self.chan16_raw);
        __tmp.put_u16_le(self.chan17_raw);
        __tmp.put_u16_le(self.chan18_raw);
        __tmp.put_u8(self.chancount);
        __tmp.put_u8(self.rssi);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 26"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct SCALED_IMU_DATA {
    pub time_boot_ms: u32,
    pub xacc: i16,
    pub yacc: i16,
    pub zacc: i16,
    pub xgyro: i16,
    pub ygyro: i16,
    pub zgyro: i16,
    pub xmag: i16,
    pub ymag: i16,
    pub zmag: i16,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub temperature: i16,
}
impl SCALED_IMU_DATA {
    pub const ENCODED_LEN: usize = 24usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        xacc: 0_i16,
        yacc: 0_i16,
        zacc: 0_i16,
        xgyro: 0_i16,
        ygyro: 0_i16,
        zgyro: 0_i16,
        xmag: 0_i16,
        ymag: 0_i16,
        zmag: 0_i16,
        temperature: 0_i16,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for SCALED_IMU_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SCALED_IMU_DATA {
    type Message = MavMessage;
    const ID: u32 = 26u32;
    const NAME: &'static str = "SCALED_IMU";
    const EXTRA_CRC: u8 = 170u8;
    const ENCODED_LEN: usize = 24usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.xacc = buf.get_i16_le()?;
        __struct.yacc = buf.get_i16_le()?;
        __struct.zacc = buf.get_i16_le()?;
        __struct.xgyro = buf.get_i16_le()?;
        __struct.ygyro = buf.get_i16_le()?;
        __struct.zgyro = buf.get_i16_le()?;
        __struct.xmag = buf.get_i16_le()?;
        __struct.ymag = buf.get_i16_le()?;
        __struct.zmag = buf.get_i16_le()?;
        __struct.temperature = buf.get_i16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_i16_le(self.xacc);
        __tmp.put_i16_le(self.yacc);
        __tmp.put_i16_le(self.zacc);
        __tmp.put_i16_le(self.xgyro);
        __tmp.put_i16_le(self.ygyro);
        __tmp.put_i16_le(self.zgyro);
        __tmp.put_i16_le(self.xmag);
        __tmp.put_i16_le(self.ymag);
        __tmp.put_i16_le(self.zmag);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_i16_le(self.temperature);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 29"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct SCALED_PRESSURE_DATA {
    pub time_boot_ms: u32,
    pub press_abs: f32,
    pub press_diff: f32,
    pub temperature: i16,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub temperature_press_diff: i16,
}
impl SCALED_PRESSURE_DATA {
    pub const ENCODED_LEN: usize = 16usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        press_abs: 0.0_f32,
        press_diff: 0.0_f32,
        temperature: 0_i16,
        temperature_press_diff: 0_i16,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for SCALED_PRESSURE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SCALED_PRESSURE_DATA {
    type Message = MavMessage;
    const ID: u32 = 29u32;
    const NAME: &'static str = "SCALED_PRESSURE";
    const EXTRA_CRC: u8 = 115u8;
    const ENCODED_LEN: usize = 16usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.press_abs = buf.get_f32_le()?;
        __struct.press_diff = buf.get_f32_le()?;
        __struct.temperature = buf.get_i16_le()?;
        __struct.temperature_press_diff = buf.get_i16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_f32_le(self.press_abs);
        __tmp.put_f32_le(self.press_diff);
        __tmp.put_i16_le(self.temperature);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_i16_le(self.temperature_press_diff);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 126"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct SERIAL_CONTROL_DATA {
    pub baudrate: u32,
    pub timeout: u16,
    pub device: u8,
    pub flags: u8,
    pub count: u8,
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub data: [u8; 70],
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub target_system: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub target_component: u8,
}
impl SERIAL_CONTROL_DATA {
    pub const ENCODED_LEN: usize = 81usize;
    pub const DEFAULT: Self = Self {
        baudrate: 0_u32,
        timeout: 0_u16,
        device: 0_u8,
        flags: 0_u8,
        count: 0_u8,
        data: [0_u8; 70usize],
        target_system: 0_u8,
        target_component: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for SERIAL_CONTROL_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SERIAL_CONTROL_DATA {
    type Message = MavMessage;
    const ID: u32 = 126u32;
    const NAME: &'static str = "SERIAL_CONTROL";
    const EXTRA_CRC: u8 = 220u8;
    const ENCODED_LEN: usize = 81usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.baudrate = buf.get_u32_le()?;
        __struct.timeout = buf.get_u16_le()?;
        __struct.device = buf.get_u8()?;
        __struct.flags = buf.get_u8()?;
        __struct.count = buf.get_u8()?;
        for v in &mut __struct.data {
            let val = buf.get_u8()?;
            *v = val;
        }
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.baudrate);
        __tmp.put_u16_le(self.timeout);
        __tmp.put_u8(self.device);
        __tmp.put_u8(self.flags);
        __tmp.put_u8(self.count);
        for val in &self.data {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.target_system);
            __tmp.put_u8(self.target_component);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 36"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct SERVO_OUTPUT_RAW_DATA {
    pub time_usec: u32,
    pub servo1_raw: u16,
    pub servo2_raw: u16,
    pub servo3_raw: u16,
    pub servo4_raw: u16,
    pub servo5_raw: u16,
    pub servo6_raw: u16,
    pub servo7_raw: u16,
    pub servo8_raw: u16,
    pub port: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub servo9_raw: u16,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub servo10_raw: u16,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub servo11_raw: u16,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub servo12_raw: u16,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub servo13_raw: u16,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub servo14_raw: u16,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub servo15_raw: u16,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub servo16_raw: u16,
}
impl SERVO_OUTPUT_RAW_DATA {
    pub const ENCODED_LEN: usize = 37usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u32,
        servo1_raw: 0_u16,
        servo2_raw: 0_u16,
        servo3_raw: 0_u16,
        servo4_raw: 0_u16,
        servo5_raw: 0_u16,
        servo6_raw: 0_u16,
        servo7_raw: 0_u16,
        servo8_raw: 0_u16,
        port: 0_u8,
        servo9_raw: 0_u16,
        servo10_raw: 0_u16,
        servo11_raw: 0_u16,
        servo12_raw: 0_u16,
        servo13_raw: 0_u16,
        servo14_raw: 0_u16,
        servo15_raw: 0_u16,
        servo16_raw: 0_u16,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for SERVO_OUTPUT_RAW_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SERVO_OUTPUT_RAW_DATA {
    type Message = MavMessage;
    const ID: u32 = 36u32;
    const NAME: &'static str = "SERVO_OUTPUT_RAW";
    const EXTRA_CRC: u8 = 222u8;
    const ENCODED_LEN: usize = 37usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u32_le()?;
        __struct.servo1_raw = buf.get_u16_le()?;
        __struct.servo2_raw = buf.get_u16_le()?;
        __struct.servo3_raw = buf.get_u16_le()?;
        __struct.servo4_raw = buf.get_u16_le()?;
        __struct.servo5_raw = buf.get_u16_le()?;
        __struct.servo6_raw = buf.get_u16_le()?;
        __struct.servo7_raw = buf.get_u16_le()?;
        __struct.servo8_raw = buf.get_u16_le()?;
        __struct.port = buf.get_u8()?;
        __struct.servo9_raw = buf.get_u16_le()?;
        __struct.servo10_raw = buf.get_u16_le()?;
        __struct.servo11_raw = buf.get_u16_le()?;
        __struct.servo12_raw = buf.get_u16_le()?;
        __struct.servo13_raw = buf.get_u16_le()?;
        __struct.servo14_raw = buf.get_u16_le()?;
        __struct.servo15_raw = buf.get_u16_le()?;
        __struct.servo16_raw = buf.get_u16_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_usec);
        __tmp.put_u16_le(self.servo1_raw);
        __tmp.put_u16_le(self.servo2_raw);
        __tmp.put_u16_le(self.servo3_raw);
        __tmp.put_u16_le(self.servo4_raw);
        __tmp.put_u16_le(self.servo5_raw);
        __tmp.put_u16_le(self.servo6_raw);
        __tmp.put_u16_le(self.servo7_raw);
        __tmp.put_u16_le(self.servo8_raw);
        __tmp.put_u8(self.port);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u16_le(self.servo9_raw);
            __tmp.put_u16_le(self.servo10_raw);
            __tmp.put_u16_le(self.servo11_raw);
            __tmp.put_u16_le(self.servo12_raw);
            __tmp.put_u16_le(self.servo13_raw);
            __tmp.put_u16_le(self.servo14_raw);
            __tmp.put_u16_le(self.servo15_raw);
            __tmp.put_u16_le(self.servo16_raw);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 256"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct SETUP_SIGNING_DATA {
    pub initial_timestamp: u64,
    pub target_system: u8,
    pub target_component: u8,
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub secret_key: [u8; 32],
}
impl SETUP_SIGNING_DATA {
    pub const ENCODED_LEN: usize = 42usize;
    pub const DEFAULT: Self = Self {
        initial_timestamp: 0_u64,
        target_system: 0_u8,
        target_component: 0_u8,
        secret_key: [0_u8; 32usize],
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for SETUP_SIGNING_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SETUP_SIGNING_DATA {
    type Message = MavMessage;
    const ID: u32 = 256u32;
    const NAME: &'static str = "SETUP_SIGNING";
    const EXTRA_CRC: u8 = 71u8;
    const ENCODED_LEN: usize = 42usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.initial_timestamp = buf.get_u64_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        for v in &mut __struct.secret_key {
            let val = buf.get_u8()?;
            *v = val;
        }
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.initial_timestamp);
        __tmp.put_u8(self.target_system);
        __tmp.put_u8(self.target_component);
        for val in &self.secret_key {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "Arming checks that fail."]
#[doc = ""]
#[doc = "ID: 53003"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct SOPHIE_ARMING_DATA {
    #[doc = "Bit n: the check in place n of the table of arming checks."]
    pub failing: u64,
    #[doc = "Time since the start."]
    pub time_boot_ms: u32,
}
impl SOPHIE_ARMING_DATA {
    pub const ENCODED_LEN: usize = 12usize;
    pub const DEFAULT: Self = Self {
        failing: 0_u64,
        time_boot_ms: 0_u32,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for SOPHIE_ARMING_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SOPHIE_ARMING_DATA {
    type Message = MavMessage;
    const ID: u32 = 53003u32;
    const NAME: &'static str = "SOPHIE_ARMING";
    const EXTRA_CRC: u8 = 161u8;
    const ENCODED_LEN: usize = 12usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.failing = buf.get_u64_le()?;
        __struct.time_boot_ms = buf.get_u32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.failing);
        __tmp.put_u32_le(self.time_boot_ms);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "Arms and grip: front-left, rear-left, front-right, rear-right. NaN where nothing fresh is known."]
#[doc = ""]
#[doc = "ID: 53000"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct SOPHIE_ARMS_DATA {
    #[doc = "Time since the start."]
    pub time_boot_ms: u32,
    #[doc = "Tilt of each arm's tip by its own sensor, up positive."]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub tilt: [f32; 4],
    #[doc = "Contact pressure of each arm."]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub pressure: [f32; 4],
    #[doc = "Force asked of each tendon."]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub force: [f32; 4],
    #[doc = "Angle to which each servo is sent, from its release mark."]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub reel: [f32; 4],
    #[doc = "Time from the start of closing until the pressure stayed within its tolerance."]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub closure: [f32; 4],
    #[doc = "SOPHIE_ARM_STATE of each arm."]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub state: [u8; 4],
    #[doc = "SOPHIE_GRIP_FLAGS."]
    pub flags: u8,
}
impl SOPHIE_ARMS_DATA {
    pub const ENCODED_LEN: usize = 89usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        tilt: [0.0_f32; 4usize],
        pressure: [0.0_f32; 4usize],
        force: [0.0_f32; 4usize],
        reel: [0.0_f32; 4usize],
        closure: [0.0_f32; 4usize],
        state: [0_u8; 4usize],
        flags: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for SOPHIE_ARMS_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SOPHIE_ARMS_DATA {
    type Message = MavMessage;
    const ID: u32 = 53000u32;
    const NAME: &'static str = "SOPHIE_ARMS";
    const EXTRA_CRC: u8 = 78u8;
    const ENCODED_LEN: usize = 89usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        for v in &mut __struct.tilt {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        for v in &mut __struct.pressure {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        for v in &mut __struct.force {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        for v in &mut __struct.reel {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        for v in &mut __struct.closure {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        for v in &mut __struct.state {
            let val = buf.get_u8()?;
            *v = val;
        }
        __struct.flags = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        for val in &self.tilt {
            __tmp.put_f32_le(*val);
        }
        for val in &self.pressure {
            __tmp.put_f32_le(*val);
        }
        for val in &self.force {
            __tmp.put_f32_le(*val);
        }
        for val in &self.reel {
            __tmp.put_f32_le(*val);
        }
        for val in &self.closure {
            __tmp.put_f32_le(*val);
        }
        for val in &self.state {
            __tmp.put_u8(*val);
        }
        __tmp.put_u8(self.flags);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "Result of one step of a calibration."]
#[doc = ""]
#[doc = "ID: 53001"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct SOPHIE_CALIBRATION_RESULT_DATA {
    #[doc = "Time since the start."]
    pub time_boot_ms: u32,
    #[doc = "Quantity that is outside its range; NaN if none is."]
    pub value: f32,
    #[doc = "Its least allowed value, NaN if none is."]
    pub least: f32,
    #[doc = "Its largest allowed value, NaN if none is."]
    pub most: f32,
    #[doc = "What was found beside the parameters: gyro: rates x, y, z and noise, deg/s; pressure sensor: half of the 95 % interval at the grip pressure, Pa, half width of the hysteresis, %, reading without a load at the end, Pa; flow: height of the turning point over the lens, m. NaN: unused."]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub figures: [f32; 4],
    #[doc = "SOPHIE_CALIBRATION."]
    pub calibration: u8,
    #[doc = "Arm, pressure sensor or servo, 1 to 4; else 0."]
    pub index: u8,
    #[doc = "Step, from 1."]
    pub step: u8,
    #[doc = "SOPHIE_CALIBRATION_OUTCOME."]
    pub outcome: u8,
    #[doc = "Name of the quantity, for people."]
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub quantity: CharArray<28>,
    #[doc = "Its unit."]
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub unit: CharArray<8>,
}
impl SOPHIE_CALIBRATION_RESULT_DATA {
    pub const ENCODED_LEN: usize = 72usize;
    pub const DEFAULT: Self = Self {
        time_boot_ms: 0_u32,
        value: 0.0_f32,
        least: 0.0_f32,
        most: 0.0_f32,
        figures: [0.0_f32; 4usize],
        calibration: 0_u8,
        index: 0_u8,
        step: 0_u8,
        outcome: 0_u8,
        quantity: CharArray::new([0_u8; 28usize]),
        unit: CharArray::new([0_u8; 8usize]),
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for SOPHIE_CALIBRATION_RESULT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SOPHIE_CALIBRATION_RESULT_DATA {
    type Message = MavMessage;
    const ID: u32 = 53001u32;
    const NAME: &'static str = "SOPHIE_CALIBRATION_RESULT";
    const EXTRA_CRC: u8 = 242u8;
    const ENCODED_LEN: usize = 72usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_boot_ms = buf.get_u32_le()?;
        __struct.value = buf.get_f32_le()?;
        __struct.least = buf.get_f32_le()?;
        __struct.most = buf.get_f32_le()?;
        for v in &mut __struct.figures {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        __struct.calibration = buf.get_u8()?;
        __struct.index = buf.get_u8()?;
        __struct.step = buf.get_u8()?;
        __struct.outcome = buf.get_u8()?;
        let mut tmp = [0_u8; 28usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.quantity = CharArray::new(tmp);
        let mut tmp = [0_u8; 8usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.unit = CharArray::new(tmp);
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.time_boot_ms);
        __tmp.put_f32_le(self.value);
        __tmp.put_f32_le(self.least);
        __tmp.put_f32_le(self.most);
        for val in &self.figures {
            __tmp.put_f32_le(*val);
        }
        __tmp.put_u8(self.calibration);
        __tmp.put_u8(self.index);
        __tmp.put_u8(self.step);
        __tmp.put_u8(self.outcome);
        for val in &self.quantity {
            __tmp.put_u8(*val);
        }
        for val in &self.unit {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "One row of a report."]
#[doc = ""]
#[doc = "ID: 53002"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct SOPHIE_CHECK_DATA {
    #[doc = "Arming checks that belong to the row, as in SOPHIE_ARMING."]
    pub inhibits: u64,
    #[doc = "SOPHIE_REPORT."]
    pub report: u8,
    #[doc = "Row, from 0."]
    pub row: u8,
    #[doc = "Number of rows."]
    pub rows: u8,
    #[doc = "1 if it is as it should be."]
    pub passed: u8,
    #[doc = "What was looked at."]
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub name: CharArray<24>,
    #[doc = "What was found, and what is allowed."]
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub found: CharArray<72>,
}
impl SOPHIE_CHECK_DATA {
    pub const ENCODED_LEN: usize = 108usize;
    pub const DEFAULT: Self = Self {
        inhibits: 0_u64,
        report: 0_u8,
        row: 0_u8,
        rows: 0_u8,
        passed: 0_u8,
        name: CharArray::new([0_u8; 24usize]),
        found: CharArray::new([0_u8; 72usize]),
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for SOPHIE_CHECK_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SOPHIE_CHECK_DATA {
    type Message = MavMessage;
    const ID: u32 = 53002u32;
    const NAME: &'static str = "SOPHIE_CHECK";
    const EXTRA_CRC: u8 = 168u8;
    const ENCODED_LEN: usize = 108usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.inhibits = buf.get_u64_le()?;
        __struct.report = buf.get_u8()?;
        __struct.row = buf.get_u8()?;
        __struct.rows = buf.get_u8()?;
        __struct.passed = buf.get_u8()?;
        let mut tmp = [0_u8; 24usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.name = CharArray::new(tmp);
        let mut tmp = [0_u8; 72usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.found = CharArray::new(tmp);
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.inhibits);
        __tmp.put_u8(self.report);
        __tmp.put_u8(self.row);
        __tmp.put_u8(self.rows);
        __tmp.put_u8(self.passed);
        for val in &self.name {
            __tmp.put_u8(*val);
        }
        for val in &self.found {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 253"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct STATUSTEXT_DATA {
    pub severity: u8,
    #[cfg_attr(feature = "ts-rs", ts(type = "string"))]
    pub text: CharArray<50>,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub id: u16,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub chunk_seq: u8,
}
impl STATUSTEXT_DATA {
    pub const ENCODED_LEN: usize = 54usize;
    pub const DEFAULT: Self = Self {
        severity: 0_u8,
        text: CharArray::new([0_u8; 50usize]),
        id: 0_u16,
        chunk_seq: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for STATUSTEXT_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for STATUSTEXT_DATA {
    type Message = MavMessage;
    const ID: u32 = 253u32;
    const NAME: &'static str = "STATUSTEXT";
    const EXTRA_CRC: u8 = 83u8;
    const ENCODED_LEN: usize = 54usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.severity = buf.get_u8()?;
        let mut tmp = [0_u8; 50usize];
        for v in &mut tmp {
            *v = buf.get_u8()?;
        }
        __struct.text = CharArray::new(tmp);
        __struct.id = buf.get_u16_le()?;
        __struct.chunk_seq = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u8(self.severity);
        for val in &self.text {
            __tmp.put_u8(*val);
        }
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u16_le(self.id);
            __tmp.put_u8(self.chunk_seq);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 1"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct SYS_STATUS_DATA {
    pub onboard_control_sensors_present: u32,
    pub onboard_control_sensors_enabled: u32,
    pub onboard_control_sensors_health: u32,
    pub load: u16,
    pub voltage_battery: u16,
    pub current_battery: i16,
    pub drop_rate_comm: u16,
    pub errors_comm: u16,
    pub errors_count1: u16,
    pub errors_count2: u16,
    pub errors_count3: u16,
    pub errors_count4: u16,
    pub battery_remaining: i8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub onboard_control_sensors_present_extended: u32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub onboard_control_sensors_enabled_extended: u32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub onboard_control_sensors_health_extended: u32,
}
impl SYS_STATUS_DATA {
    pub const ENCODED_LEN: usize = 43usize;
    pub const DEFAULT: Self = Self {
        onboard_control_sensors_present: 0_u32,
        onboard_control_sensors_enabled: 0_u32,
        onboard_control_sensors_health: 0_u32,
        load: 0_u16,
        voltage_battery: 0_u16,
        current_battery: 0_i16,
        drop_rate_comm: 0_u16,
        errors_comm: 0_u16,
        errors_count1: 0_u16,
        errors_count2: 0_u16,
        errors_count3: 0_u16,
        errors_count4: 0_u16,
        battery_remaining: 0_i8,
        onboard_control_sensors_present_extended: 0_u32,
        onboard_control_sensors_enabled_extended: 0_u32,
        onboard_control_sensors_health_extended: 0_u32,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for SYS_STATUS_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for SYS_STATUS_DATA {
    type Message = MavMessage;
    const ID: u32 = 1u32;
    const NAME: &'static str = "SYS_STATUS";
    const EXTRA_CRC: u8 = 124u8;
    const ENCODED_LEN: usize = 43usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.onboard_control_sensors_present = buf.get_u32_le()?;
        __struct.onboard_control_sensors_enabled = buf.get_u32_le()?;
        __struct.onboard_control_sensors_health = buf.get_u32_le()?;
        __struct.load = buf.get_u16_le()?;
        __struct.voltage_battery = buf.get_u16_le()?;
        __struct.current_battery = buf.get_i16_le()?;
        __struct.drop_rate_comm = buf.get_u16_le()?;
        __struct.errors_comm = buf.get_u16_le()?;
        __struct.errors_count1 = buf.get_u16_le()?;
        __struct.errors_count2 = buf.get_u16_le()?;
        __struct.errors_count3 = buf.get_u16_le()?;
        __struct.errors_count4 = buf.get_u16_le()?;
        __struct.battery_remaining = buf.get_i8()?;
        __struct.onboard_control_sensors_present_extended = buf.get_u32_le()?;
        __struct.onboard_control_sensors_enabled_extended = buf.get_u32_le()?;
        __struct.onboard_control_sensors_health_extended = buf.get_u32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u32_le(self.onboard_control_sensors_present);
        __tmp.put_u32_le(self.onboard_control_sensors_enabled);
        __tmp.put_u32_le(self.onboard_control_sensors_health);
        __tmp.put_u16_le(self.load);
        __tmp.put_u16_le(self.voltage_battery);
        __tmp.put_i16_le(self.current_battery);
        __tmp.put_u16_le(self.drop_rate_comm);
        __tmp.put_u16_le(self.errors_comm);
        __tmp.put_u16_le(self.errors_count1);
        __tmp.put_u16_le(self.errors_count2);
        __tmp.put_u16_le(self.errors_count3);
        __tmp.put_u16_le(self.errors_count4);
        __tmp.put_i8(self.battery_remaining);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u32_le(self.onboard_control_sensors_present_extended);
            __tmp.put_u32_le(self.onboard_control_sensors_enabled_extended);
            __tmp.put_u32_le(self.onboard_control_sensors_health_extended);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 111"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct TIMESYNC_DATA {
    pub tc1: i64,
    pub ts1: i64,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub target_system: u8,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub target_component: u8,
}
impl TIMESYNC_DATA {
    pub const ENCODED_LEN: usize = 18usize;
    pub const DEFAULT: Self = Self {
        tc1: 0_i64,
        ts1: 0_i64,
        target_system: 0_u8,
        target_component: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for TIMESYNC_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for TIMESYNC_DATA {
    type Message = MavMessage;
    const ID: u32 = 111u32;
    const NAME: &'static str = "TIMESYNC";
    const EXTRA_CRC: u8 = 34u8;
    const ENCODED_LEN: usize = 18usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.tc1 = buf.get_i64_le()?;
        __struct.ts1 = buf.get_i64_le()?;
        __struct.target_system = buf.get_u8()?;
        __struct.target_component = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_i64_le(self.tc1);
        __tmp.put_i64_le(self.ts1);
        if matches!(version, MavlinkVersion::V2) {
            __tmp.put_u8(self.target_system);
            __tmp.put_u8(self.target_component);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 241"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct VIBRATION_DATA {
    pub time_usec: u64,
    pub vibration_x: f32,
    pub vibration_y: f32,
    pub vibration_z: f32,
    pub clipping_0: u32,
    pub clipping_1: u32,
    pub clipping_2: u32,
}
impl VIBRATION_DATA {
    pub const ENCODED_LEN: usize = 32usize;
    pub const DEFAULT: Self = Self {
        time_usec: 0_u64,
        vibration_x: 0.0_f32,
        vibration_y: 0.0_f32,
        vibration_z: 0.0_f32,
        clipping_0: 0_u32,
        clipping_1: 0_u32,
        clipping_2: 0_u32,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for VIBRATION_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for VIBRATION_DATA {
    type Message = MavMessage;
    const ID: u32 = 241u32;
    const NAME: &'static str = "VIBRATION";
    const EXTRA_CRC: u8 = 90u8;
    const ENCODED_LEN: usize = 32usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.time_usec = buf.get_u64_le()?;
        __struct.vibration_x = buf.get_f32_le()?;
        __struct.vibration_y = buf.get_f32_le()?;
        __struct.vibration_z = buf.get_f32_le()?;
        __struct.clipping_0 = buf.get_u32_le()?;
        __struct.clipping_1 = buf.get_u32_le()?;
        __struct.clipping_2 = buf.get_u32_le()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.time_usec);
        __tmp.put_f32_le(self.vibration_x);
        __tmp.put_f32_le(self.vibration_y);
        __tmp.put_f32_le(self.vibration_z);
        __tmp.put_u32_le(self.clipping_0);
        __tmp.put_u32_le(self.clipping_1);
        __tmp.put_u32_le(self.clipping_2);
        if matches!(version, MavlinkVersion::V2) {
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[doc = "ID: 102"]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
pub struct VISION_POSITION_ESTIMATE_DATA {
    pub usec: u64,
    pub x: f32,
    pub y: f32,
    pub z: f32,
    pub roll: f32,
    pub pitch: f32,
    pub yaw: f32,
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    #[cfg_attr(feature = "serde", serde(with = "serde_arrays"))]
    #[cfg_attr(feature = "ts-rs", ts(type = "Array<number>"))]
    pub covariance: [f32; 21],
    #[cfg_attr(feature = "serde", serde(default = "crate::utils::RustDefault::rust_default"))]
    pub reset_counter: u8,
}
impl VISION_POSITION_ESTIMATE_DATA {
    pub const ENCODED_LEN: usize = 117usize;
    pub const DEFAULT: Self = Self {
        usec: 0_u64,
        x: 0.0_f32,
        y: 0.0_f32,
        z: 0.0_f32,
        roll: 0.0_f32,
        pitch: 0.0_f32,
        yaw: 0.0_f32,
        covariance: [0.0_f32; 21usize],
        reset_counter: 0_u8,
    };
    #[cfg(feature = "arbitrary")]
    pub fn random<R: rand::Rng>(rng: &mut R) -> Self {
        use arbitrary::{Arbitrary, Unstructured};
        let mut buf = [0u8; 1024];
        rng.fill_bytes(&mut buf);
        let mut unstructured = Unstructured::new(&buf);
        Self::arbitrary(&mut unstructured).unwrap_or_default()
    }
}
impl Default for VISION_POSITION_ESTIMATE_DATA {
    fn default() -> Self {
        Self::DEFAULT.clone()
    }
}
impl MessageData for VISION_POSITION_ESTIMATE_DATA {
    type Message = MavMessage;
    const ID: u32 = 102u32;
    const NAME: &'static str = "VISION_POSITION_ESTIMATE";
    const EXTRA_CRC: u8 = 158u8;
    const ENCODED_LEN: usize = 117usize;
    fn deser(_version: MavlinkVersion, __input: &[u8]) -> Result<Self, ::mavlink_core::error::ParserError> {
        let avail_len = __input.len();
        let mut payload_buf;
        let mut buf = if avail_len < Self::ENCODED_LEN {
            payload_buf = [0; Self::ENCODED_LEN];
            payload_buf[0..avail_len].copy_from_slice(__input);
            Bytes::new(&payload_buf)
        } else {
            Bytes::new(__input)
        };
        let mut __struct = Self::default();
        __struct.usec = buf.get_u64_le()?;
        __struct.x = buf.get_f32_le()?;
        __struct.y = buf.get_f32_le()?;
        __struct.z = buf.get_f32_le()?;
        __struct.roll = buf.get_f32_le()?;
        __struct.pitch = buf.get_f32_le()?;
        __struct.yaw = buf.get_f32_le()?;
        for v in &mut __struct.covariance {
            let val = buf.get_f32_le()?;
            *v = val;
        }
        __struct.reset_counter = buf.get_u8()?;
        Ok(__struct)
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        let mut __tmp = BytesMut::new(bytes);
        if __tmp.remaining() < Self::ENCODED_LEN {
            panic!(
                "buffer is too small (need {} bytes, but got {})",
                Self::ENCODED_LEN,
                __tmp.remaining(),
            )
        }
        __tmp.put_u64_le(self.usec);
        __tmp.put_f32_le(self.x);
        __tmp.put_f32_le(self.y);
        __tmp.put_f32_le(self.z);
        __tmp.put_f32_le(self.roll);
        __tmp.put_f32_le(self.pitch);
        __tmp.put_f32_le(self.yaw);
        if matches!(version, MavlinkVersion::V2) {
            for val in &self.covariance {
                __tmp.put_f32_le(*val);
            }
            __tmp.put_u8(self.reset_counter);
            let len = __tmp.len();
            ::mavlink_core::utils::remove_trailing_zeroes(&bytes[..len])
        } else {
            __tmp.len()
        }
    }
}
#[derive(Clone, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "type"))]
#[cfg_attr(feature = "arbitrary", derive(Arbitrary))]
#[cfg_attr(feature = "ts-rs", derive(TS))]
#[cfg_attr(feature = "ts-rs", ts(export))]
#[repr(u32)]
pub enum MavMessage {
    #[doc = "ID: 30"]
    ATTITUDE(ATTITUDE_DATA),
    #[doc = "ID: 31"]
    ATTITUDE_QUATERNION(ATTITUDE_QUATERNION_DATA),
    #[doc = "ID: 138"]
    ATT_POS_MOCAP(ATT_POS_MOCAP_DATA),
    #[doc = "ID: 148"]
    AUTOPILOT_VERSION(AUTOPILOT_VERSION_DATA),
    #[doc = "ID: 435"]
    AVAILABLE_MODES(AVAILABLE_MODES_DATA),
    #[doc = "ID: 437"]
    AVAILABLE_MODES_MONITOR(AVAILABLE_MODES_MONITOR_DATA),
    #[doc = "ID: 147"]
    BATTERY_STATUS(BATTERY_STATUS_DATA),
    #[doc = "ID: 77"]
    COMMAND_ACK(COMMAND_ACK_DATA),
    #[doc = "ID: 75"]
    COMMAND_INT(COMMAND_INT_DATA),
    #[doc = "ID: 76"]
    COMMAND_LONG(COMMAND_LONG_DATA),
    #[doc = "ID: 396"]
    COMPONENT_INFORMATION_BASIC(COMPONENT_INFORMATION_BASIC_DATA),
    #[doc = "ID: 397"]
    COMPONENT_METADATA(COMPONENT_METADATA_DATA),
    #[doc = "ID: 436"]
    CURRENT_MODE(CURRENT_MODE_DATA),
    #[doc = "ID: 132"]
    DISTANCE_SENSOR(DISTANCE_SENSOR_DATA),
    #[doc = "ID: 245"]
    EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA),
    #[doc = "ID: 110"]
    FILE_TRANSFER_PROTOCOL(FILE_TRANSFER_PROTOCOL_DATA),
    #[doc = "ID: 0"]
    HEARTBEAT(HEARTBEAT_DATA),
    #[doc = "ID: 149"]
    LANDING_TARGET(LANDING_TARGET_DATA),
    #[doc = "ID: 244"]
    MESSAGE_INTERVAL(MESSAGE_INTERVAL_DATA),
    #[doc = "ID: 251"]
    NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA),
    #[doc = "ID: 331"]
    ODOMETRY(ODOMETRY_DATA),
    #[doc = "ID: 106"]
    OPTICAL_FLOW_RAD(OPTICAL_FLOW_RAD_DATA),
    #[doc = "ID: 21"]
    PARAM_REQUEST_LIST(PARAM_REQUEST_LIST_DATA),
    #[doc = "ID: 20"]
    PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA),
    #[doc = "ID: 23"]
    PARAM_SET(PARAM_SET_DATA),
    #[doc = "ID: 22"]
    PARAM_VALUE(PARAM_VALUE_DATA),
    #[doc = "ID: 4"]
    PING(PING_DATA),
    #[doc = "ID: 65"]
    RC_CHANNELS(RC_CHANNELS_DATA),
    #[doc = "ID: 26"]
    SCALED_IMU(SCALED_IMU_DATA),
    #[doc = "ID: 29"]
    SCALED_PRESSURE(SCALED_PRESSURE_DATA),
    #[doc = "ID: 126"]
    SERIAL_CONTROL(SERIAL_CONTROL_DATA),
    #[doc = "ID: 36"]
    SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA),
    #[doc = "ID: 256"]
    SETUP_SIGNING(SETUP_SIGNING_DATA),
    #[doc = "Arming checks that fail."]
    #[doc = ""]
    #[doc = "ID: 53003"]
    SOPHIE_ARMING(SOPHIE_ARMING_DATA),
    #[doc = "Arms and grip: front-left, rear-left, front-right, rear-right. NaN where nothing fresh is known."]
    #[doc = ""]
    #[doc = "ID: 53000"]
    SOPHIE_ARMS(SOPHIE_ARMS_DATA),
    #[doc = "Result of one step of a calibration."]
    #[doc = ""]
    #[doc = "ID: 53001"]
    SOPHIE_CALIBRATION_RESULT(SOPHIE_CALIBRATION_RESULT_DATA),
    #[doc = "One row of a report."]
    #[doc = ""]
    #[doc = "ID: 53002"]
    SOPHIE_CHECK(SOPHIE_CHECK_DATA),
    #[doc = "ID: 253"]
    STATUSTEXT(STATUSTEXT_DATA),
    #[doc = "ID: 1"]
    SYS_STATUS(SYS_STATUS_DATA),
    #[doc = "ID: 111"]
    TIMESYNC(TIMESYNC_DATA),
    #[doc = "ID: 241"]
    VIBRATION(VIBRATION_DATA),
    #[doc = "ID: 102"]
    VISION_POSITION_ESTIMATE(VISION_POSITION_ESTIMATE_DATA),
}
impl MavMessage {
    pub const fn all_ids() -> &'static [u32] {
        &[
            0u32, 1u32, 4u32, 20u32, 21u32, 22u32, 23u32, 26u32, 29u32, 30u32, 31u32, 36u32, 65u32, 75u32,
            76u32, 77u32, 102u32, 106u32, 110u32, 111u32, 126u32, 132u32, 138u32, 147u32, 148u32, 149u32,
            241u32, 244u32, 245u32, 251u32, 253u32, 256u32, 331u32, 396u32, 397u32, 435u32, 436u32, 437u32,
            53000u32, 53001u32, 53002u32, 53003u32,
        ]
    }
    pub const fn all_messages() -> &'static [(&'static str, u32)] {
        &[
            (HEARTBEAT_DATA::NAME, HEARTBEAT_DATA::ID),
            (SYS_STATUS_DATA::NAME, SYS_STATUS_DATA::ID),
            (PING_DATA::NAME, PING_DATA::ID),
            (PARAM_REQUEST_READ_DATA::NAME, PARAM_REQUEST_READ_DATA::ID),
            (PARAM_REQUEST_LIST_DATA::NAME, PARAM_REQUEST_LIST_DATA::ID),
            (PARAM_VALUE_DATA::NAME, PARAM_VALUE_DATA::ID),
            (PARAM_SET_DATA::NAME, PARAM_SET_DATA::ID),
            (SCALED_IMU_DATA::NAME, SCALED_IMU_DATA::ID),
            (SCALED_PRESSURE_DATA::NAME, SCALED_PRESSURE_DATA::ID),
            (ATTITUDE_DATA::NAME, ATTITUDE_DATA::ID),
            (ATTITUDE_QUATERNION_DATA::NAME, ATTITUDE_QUATERNION_DATA::ID),
            (SERVO_OUTPUT_RAW_DATA::NAME, SERVO_OUTPUT_RAW_DATA::ID),
            (RC_CHANNELS_DATA::NAME, RC_CHANNELS_DATA::ID),
            (COMMAND_INT_DATA::NAME, COMMAND_INT_DATA::ID),
            (COMMAND_LONG_DATA::NAME, COMMAND_LONG_DATA::ID),
            (COMMAND_ACK_DATA::NAME, COMMAND_ACK_DATA::ID),
            (
                VISION_POSITION_ESTIMATE_DATA::NAME,
                VISION_POSITION_ESTIMATE_DATA::ID,
            ),
            (OPTICAL_FLOW_RAD_DATA::NAME, OPTICAL_FLOW_RAD_DATA::ID),
            (FILE_TRANSFER_PROTOCOL_DATA::NAME, FILE_TRANSFER_PROTOCOL_DATA::ID),
            (TIMESYNC_DATA::NAME, TIMESYNC_DATA::ID),
            (SERIAL_CONTROL_DATA::NAME, SERIAL_CONTROL_DATA::ID),
            (DISTANCE_SENSOR_DATA::NAME, DISTANCE_SENSOR_DATA::ID),
            (ATT_POS_MOCAP_DATA::NAME, ATT_POS_MOCAP_DATA::ID),
            (BATTERY_STATUS_DATA::NAME, BATTERY_STATUS_DATA::ID),
            (AUTOPILOT_VERSION_DATA::NAME, AUTOPILOT_VERSION_DATA::ID),
            (LANDING_TARGET_DATA::NAME, LANDING_TARGET_DATA::ID),
            (VIBRATION_DATA::NAME, VIBRATION_DATA::ID),
            (MESSAGE_INTERVAL_DATA::NAME, MESSAGE_INTERVAL_DATA::ID),
            (EXTENDED_SYS_STATE_DATA::NAME, EXTENDED_SYS_STATE_DATA::ID),
            (NAMED_VALUE_FLOAT_DATA::NAME, NAMED_VALUE_FLOAT_DATA::ID),
            (STATUSTEXT_DATA::NAME, STATUSTEXT_DATA::ID),
            (SETUP_SIGNING_DATA::NAME, SETUP_SIGNING_DATA::ID),
            (ODOMETRY_DATA::NAME, ODOMETRY_DATA::ID),
            (
                COMPONENT_INFORMATION_BASIC_DATA::NAME,
                COMPONENT_INFORMATION_BASIC_DATA::ID,
            ),
            (COMPONENT_METADATA_DATA::NAME, COMPONENT_METADATA_DATA::ID),
            (AVAILABLE_MODES_DATA::NAME, AVAILABLE_MODES_DATA::ID),
            (CURRENT_MODE_DATA::NAME, CURRENT_MODE_DATA::ID),
            (
                AVAILABLE_MODES_MONITOR_DATA::NAME,
                AVAILABLE_MODES_MONITOR_DATA::ID,
            ),
            (SOPHIE_ARMS_DATA::NAME, SOPHIE_ARMS_DATA::ID),
            (
                SOPHIE_CALIBRATION_RESULT_DATA::NAME,
                SOPHIE_CALIBRATION_RESULT_DATA::ID,
            ),
            (SOPHIE_CHECK_DATA::NAME, SOPHIE_CHECK_DATA::ID),
            (SOPHIE_ARMING_DATA::NAME, SOPHIE_ARMING_DATA::ID),
        ]
    }
}
impl Message for MavMessage {
    fn parse(
        version: MavlinkVersion,
        id: u32,
        payload: &[u8],
    ) -> Result<Self, ::mavlink_core::error::ParserError> {
        match id {
            ATTITUDE_DATA::ID => ATTITUDE_DATA::deser(version, payload).map(Self::ATTITUDE),
            ATTITUDE_QUATERNION_DATA::ID => {
                ATTITUDE_QUATERNION_DATA::deser(version, payload).map(Self::ATTITUDE_QUATERNION)
            }
            ATT_POS_MOCAP_DATA::ID => ATT_POS_MOCAP_DATA::deser(version, payload).map(Self::ATT_POS_MOCAP),
            AUTOPILOT_VERSION_DATA::ID => {
                AUTOPILOT_VERSION_DATA::deser(version, payload).map(Self::AUTOPILOT_VERSION)
            }
            AVAILABLE_MODES_DATA::ID => {
                AVAILABLE_MODES_DATA::deser(version, payload).map(Self::AVAILABLE_MODES)
            }
            AVAILABLE_MODES_MONITOR_DATA::ID => {
                AVAILABLE_MODES_MONITOR_DATA::deser(version, payload).map(Self::AVAILABLE_MODES_MONITOR)
            }
            BATTERY_STATUS_DATA::ID => BATTERY_STATUS_DATA::deser(version, payload).map(Self::BATTERY_STATUS),
            COMMAND_ACK_DATA::ID => COMMAND_ACK_DATA::deser(version, payload).map(Self::COMMAND_ACK),
            COMMAND_INT_DATA::ID => COMMAND_INT_DATA::deser(version, payload).map(Self::COMMAND_INT),
            COMMAND_LONG_DATA::ID => COMMAND_LONG_DATA::deser(version, payload).map(Self::COMMAND_LONG),
            COMPONENT_INFORMATION_BASIC_DATA::ID => COMPONENT_INFORMATION_BASIC_DATA::deser(version, payload)
                .map(Self::COMPONENT_INFORMATION_BASIC),
            COMPONENT_METADATA_DATA::ID => {
                COMPONENT_METADATA_DATA::deser(version, payload).map(Self::COMPONENT_METADATA)
            }
            CURRENT_MODE_DATA::ID => CURRENT_MODE_DATA::deser(version, payload).map(Self::CURRENT_MODE),
            DISTANCE_SENSOR_DATA::ID => {
                DISTANCE_SENSOR_DATA::deser(version, payload).map(Self::DISTANCE_SENSOR)
            }
            EXTENDED_SYS_STATE_DATA::ID => {
                EXTENDED_SYS_STATE_DATA::deser(version, payload).map(Self::EXTENDED_SYS_STATE)
            }
            FILE_TRANSFER_PROTOCOL_DATA::ID => {
                FILE_TRANSFER_PROTOCOL_DATA::deser(version, payload).map(Self::FILE_TRANSFER_PROTOCOL)
            }
            HEARTBEAT_DATA::ID => HEARTBEAT_DATA::deser(version, payload).map(Self::HEARTBEAT),
            LANDING_TARGET_DATA::ID => LANDING_TARGET_DATA::deser(version, payload).map(Self::LANDING_TARGET),
            MESSAGE_INTERVAL_DATA::ID => {
                MESSAGE_INTERVAL_DATA::deser(version, payload).map(Self::MESSAGE_INTERVAL)
            }
            NAMED_VALUE_FLOAT_DATA::ID => {
                NAMED_VALUE_FLOAT_DATA::deser(version, payload).map(Self::NAMED_VALUE_FLOAT)
            }
            ODOMETRY_DATA::ID => ODOMETRY_DATA::deser(version, payload).map(Self::ODOMETRY),
            OPTICAL_FLOW_RAD_DATA::ID => {
                OPTICAL_FLOW_RAD_DATA::deser(version, payload).map(Self::OPTICAL_FLOW_RAD)
            }
            PARAM_REQUEST_LIST_DATA::ID => {
                PARAM_REQUEST_LIST_DATA::deser(version, payload).map(Self::PARAM_REQUEST_LIST)
            }
            PARAM_REQUEST_READ_DATA::ID => {
                PARAM_REQUEST_READ_DATA::deser(version, payload).map(Self::PARAM_REQUEST_READ)
            }
            PARAM_SET_DATA::ID => PARAM_SET_DATA::deser(version, payload).map(Self::PARAM_SET),
            PARAM_VALUE_DATA::ID => PARAM_VALUE_DATA::deser(version, payload).map(Self::PARAM_VALUE),
            PING_DATA::ID => PING_DATA::deser(version, payload).map(Self::PING),
            RC_CHANNELS_DATA::ID => RC_CHANNELS_DATA::deser(version, payload).map(Self::RC_CHANNELS),
            SCALED_IMU_DATA::ID => SCALED_IMU_DATA::deser(version, payload).map(Self::SCALED_IMU),
            SCALED_PRESSURE_DATA::ID => {
                SCALED_PRESSURE_DATA::deser(version, payload).map(Self::SCALED_PRESSURE)
            }
            SERIAL_CONTROL_DATA::ID => SERIAL_CONTROL_DATA::deser(version, payload).map(Self::SERIAL_CONTROL),
            SERVO_OUTPUT_RAW_DATA::ID => {
                SERVO_OUTPUT_RAW_DATA::deser(version, payload).map(Self::SERVO_OUTPUT_RAW)
            }
            SETUP_SIGNING_DATA::ID => SETUP_SIGNING_DATA::deser(version, payload).map(Self::SETUP_SIGNING),
            SOPHIE_ARMING_DATA::ID => SOPHIE_ARMING_DATA::deser(version, payload).map(Self::SOPHIE_ARMING),
            SOPHIE_ARMS_DATA::ID => SOPHIE_ARMS_DATA::deser(version, payload).map(Self::SOPHIE_ARMS),
            SOPHIE_CALIBRATION_RESULT_DATA::ID => {
                SOPHIE_CALIBRATION_RESULT_DATA::deser(version, payload).map(Self::SOPHIE_CALIBRATION_RESULT)
            }
            SOPHIE_CHECK_DATA::ID => SOPHIE_CHECK_DATA::deser(version, payload).map(Self::SOPHIE_CHECK),
            STATUSTEXT_DATA::ID => STATUSTEXT_DATA::deser(version, payload).map(Self::STATUSTEXT),
            SYS_STATUS_DATA::ID => SYS_STATUS_DATA::deser(version, payload).map(Self::SYS_STATUS),
            TIMESYNC_DATA::ID => TIMESYNC_DATA::deser(version, payload).map(Self::TIMESYNC),
            VIBRATION_DATA::ID => VIBRATION_DATA::deser(version, payload).map(Self::VIBRATION),
            VISION_POSITION_ESTIMATE_DATA::ID => {
                VISION_POSITION_ESTIMATE_DATA::deser(version, payload).map(Self::VISION_POSITION_ESTIMATE)
            }
            _ => Err(::mavlink_core::error::ParserError::UnknownMessage { id }),
        }
    }
    fn message_name(&self) -> &'static str {
        match self {
            Self::ATTITUDE(..) => ATTITUDE_DATA::NAME,
            Self::ATTITUDE_QUATERNION(..) => ATTITUDE_QUATERNION_DATA::NAME,
            Self::ATT_POS_MOCAP(..) => ATT_POS_MOCAP_DATA::NAME,
            Self::AUTOPILOT_VERSION(..) => AUTOPILOT_VERSION_DATA::NAME,
            Self::AVAILABLE_MODES(..) => AVAILABLE_MODES_DATA::NAME,
            Self::AVAILABLE_MODES_MONITOR(..) => AVAILABLE_MODES_MONITOR_DATA::NAME,
            Self::BATTERY_STATUS(..) => BATTERY_STATUS_DATA::NAME,
            Self::COMMAND_ACK(..) => COMMAND_ACK_DATA::NAME,
            Self::COMMAND_INT(..) => COMMAND_INT_DATA::NAME,
            Self::COMMAND_LONG(..) => COMMAND_LONG_DATA::NAME,
            Self::COMPONENT_INFORMATION_BASIC(..) => COMPONENT_INFORMATION_BASIC_DATA::NAME,
            Self::COMPONENT_METADATA(..) => COMPONENT_METADATA_DATA::NAME,
            Self::CURRENT_MODE(..) => CURRENT_MODE_DATA::NAME,
            Self::DISTANCE_SENSOR(..) => DISTANCE_SENSOR_DATA::NAME,
            Self::EXTENDED_SYS_STATE(..) => EXTENDED_SYS_STATE_DATA::NAME,
            Self::FILE_TRANSFER_PROTOCOL(..) => FILE_TRANSFER_PROTOCOL_DATA::NAME,
            Self::HEARTBEAT(..) => HEARTBEAT_DATA::NAME,
            Self::LANDING_TARGET(..) => LANDING_TARGET_DATA::NAME,
            Self::MESSAGE_INTERVAL(..) => MESSAGE_INTERVAL_DATA::NAME,
            Self::NAMED_VALUE_FLOAT(..) => NAMED_VALUE_FLOAT_DATA::NAME,
            Self::ODOMETRY(..) => ODOMETRY_DATA::NAME,
            Self::OPTICAL_FLOW_RAD(..) => OPTICAL_FLOW_RAD_DATA::NAME,
            Self::PARAM_REQUEST_LIST(..) => PARAM_REQUEST_LIST_DATA::NAME,
            Self::PARAM_REQUEST_READ(..) => PARAM_REQUEST_READ_DATA::NAME,
            Self::PARAM_SET(..) => PARAM_SET_DATA::NAME,
            Self::PARAM_VALUE(..) => PARAM_VALUE_DATA::NAME,
            Self::PING(..) => PING_DATA::NAME,
            Self::RC_CHANNELS(..) => RC_CHANNELS_DATA::NAME,
            Self::SCALED_IMU(..) => SCALED_IMU_DATA::NAME,
            Self::SCALED_PRESSURE(..) => SCALED_PRESSURE_DATA::NAME,
            Self::SERIAL_CONTROL(..) => SERIAL_CONTROL_DATA::NAME,
            Self::SERVO_OUTPUT_RAW(..) => SERVO_OUTPUT_RAW_DATA::NAME,
            Self::SETUP_SIGNING(..) => SETUP_SIGNING_DATA::NAME,
            Self::SOPHIE_ARMING(..) => SOPHIE_ARMING_DATA::NAME,
            Self::SOPHIE_ARMS(..) => SOPHIE_ARMS_DATA::NAME,
            Self::SOPHIE_CALIBRATION_RESULT(..) => SOPHIE_CALIBRATION_RESULT_DATA::NAME,
            Self::SOPHIE_CHECK(..) => SOPHIE_CHECK_DATA::NAME,
            Self::STATUSTEXT(..) => STATUSTEXT_DATA::NAME,
            Self::SYS_STATUS(..) => SYS_STATUS_DATA::NAME,
            Self::TIMESYNC(..) => TIMESYNC_DATA::NAME,
            Self::VIBRATION(..) => VIBRATION_DATA::NAME,
            Self::VISION_POSITION_ESTIMATE(..) => VISION_POSITION_ESTIMATE_DATA::NAME,
        }
    }
    fn message_id(&self) -> u32 {
        match self {
            Self::ATTITUDE(..) => ATTITUDE_DATA::ID,
            Self::ATTITUDE_QUATERNION(..) => ATTITUDE_QUATERNION_DATA::ID,
            Self::ATT_POS_MOCAP(..) => ATT_POS_MOCAP_DATA::ID,
            Self::AUTOPILOT_VERSION(..) => AUTOPILOT_VERSION_DATA::ID,
            Self::AVAILABLE_MODES(..) => AVAILABLE_MODES_DATA::ID,
            Self::AVAILABLE_MODES_MONITOR(..) => AVAILABLE_MODES_MONITOR_DATA::ID,
            Self::BATTERY_STATUS(..) => BATTERY_STATUS_DATA::ID,
            Self::COMMAND_ACK(..) => COMMAND_ACK_DATA::ID,
            Self::COMMAND_INT(..) => COMMAND_INT_DATA::ID,
            Self::COMMAND_LONG(..) => COMMAND_LONG_DATA::ID,
            Self::COMPONENT_INFORMATION_BASIC(..) => COMPONENT_INFORMATION_BASIC_DATA::ID,
            Self::COMPONENT_METADATA(..) => COMPONENT_METADATA_DATA::ID,
            Self::CURRENT_MODE(..) => CURRENT_MODE_DATA::ID,
            Self::DISTANCE_SENSOR(..) => DISTANCE_SENSOR_DATA::ID,
            Self::EXTENDED_SYS_STATE(..) => EXTENDED_SYS_STATE_DATA::ID,
            Self::FILE_TRANSFER_PROTOCOL(..) => FILE_TRANSFER_PROTOCOL_DATA::ID,
            Self::HEARTBEAT(..) => HEARTBEAT_DATA::ID,
            Self::LANDING_TARGET(..) => LANDING_TARGET_DATA::ID,
            Self::MESSAGE_INTERVAL(..) => MESSAGE_INTERVAL_DATA::ID,
            Self::NAMED_VALUE_FLOAT(..) => NAMED_VALUE_FLOAT_DATA::ID,
            Self::ODOMETRY(..) => ODOMETRY_DATA::ID,
            Self::OPTICAL_FLOW_RAD(..) => OPTICAL_FLOW_RAD_DATA::ID,
            Self::PARAM_REQUEST_LIST(..) => PARAM_REQUEST_LIST_DATA::ID,
            Self::PARAM_REQUEST_READ(..) => PARAM_REQUEST_READ_DATA::ID,
            Self::PARAM_SET(..) => PARAM_SET_DATA::ID,
            Self::PARAM_VALUE(..) => PARAM_VALUE_DATA::ID,
            Self::PING(..) => PING_DATA::ID,
            Self::RC_CHANNELS(..) => RC_CHANNELS_DATA::ID,
            Self::SCALED_IMU(..) => SCALED_IMU_DATA::ID,
            Self::SCALED_PRESSURE(..) => SCALED_PRESSURE_DATA::ID,
            Self::SERIAL_CONTROL(..) => SERIAL_CONTROL_DATA::ID,
            Self::SERVO_OUTPUT_RAW(..) => SERVO_OUTPUT_RAW_DATA::ID,
            Self::SETUP_SIGNING(..) => SETUP_SIGNING_DATA::ID,
            Self::SOPHIE_ARMING(..) => SOPHIE_ARMING_DATA::ID,
            Self::SOPHIE_ARMS(..) => SOPHIE_ARMS_DATA::ID,
            Self::SOPHIE_CALIBRATION_RESULT(..) => SOPHIE_CALIBRATION_RESULT_DATA::ID,
            Self::SOPHIE_CHECK(..) => SOPHIE_CHECK_DATA::ID,
            Self::STATUSTEXT(..) => STATUSTEXT_DATA::ID,
            Self::SYS_STATUS(..) => SYS_STATUS_DATA::ID,
            Self::TIMESYNC(..) => TIMESYNC_DATA::ID,
            Self::VIBRATION(..) => VIBRATION_DATA::ID,
            Self::VISION_POSITION_ESTIMATE(..) => VISION_POSITION_ESTIMATE_DATA::ID,
        }
    }
    fn message_id_from_name(name: &str) -> Option<u32> {
        match name {
            ATTITUDE_DATA::NAME => Some(ATTITUDE_DATA::ID),
            ATTITUDE_QUATERNION_DATA::NAME => Some(ATTITUDE_QUATERNION_DATA::ID),
            ATT_POS_MOCAP_DATA::NAME => Some(ATT_POS_MOCAP_DATA::ID),
            AUTOPILOT_VERSION_DATA::NAME => Some(AUTOPILOT_VERSION_DATA::ID),
            AVAILABLE_MODES_DATA::NAME => Some(AVAILABLE_MODES_DATA::ID),
            AVAILABLE_MODES_MONITOR_DATA::NAME => Some(AVAILABLE_MODES_MONITOR_DATA::ID),
            BATTERY_STATUS_DATA::NAME => Some(BATTERY_STATUS_DATA::ID),
            COMMAND_ACK_DATA::NAME => Some(COMMAND_ACK_DATA::ID),
            COMMAND_INT_DATA::NAME => Some(COMMAND_INT_DATA::ID),
            COMMAND_LONG_DATA::NAME => Some(COMMAND_LONG_DATA::ID),
            COMPONENT_INFORMATION_BASIC_DATA::NAME => Some(COMPONENT_INFORMATION_BASIC_DATA::ID),
            COMPONENT_METADATA_DATA::NAME => Some(COMPONENT_METADATA_DATA::ID),
            CURRENT_MODE_DATA::NAME => Some(CURRENT_MODE_DATA::ID),
            DISTANCE_SENSOR_DATA::NAME => Some(DISTANCE_SENSOR_DATA::ID),
            EXTENDED_SYS_STATE_DATA::NAME => Some(EXTENDED_SYS_STATE_DATA::ID),
            FILE_TRANSFER_PROTOCOL_DATA::NAME => Some(FILE_TRANSFER_PROTOCOL_DATA::ID),
            HEARTBEAT_DATA::NAME => Some(HEARTBEAT_DATA::ID),
            LANDING_TARGET_DATA::NAME => Some(LANDING_TARGET_DATA::ID),
            MESSAGE_INTERVAL_DATA::NAME => Some(MESSAGE_INTERVAL_DATA::ID),
            NAMED_VALUE_FLOAT_DATA::NAME => Some(NAMED_VALUE_FLOAT_DATA::ID),
            ODOMETRY_DATA::NAME => Some(ODOMETRY_DATA::ID),
            OPTICAL_FLOW_RAD_DATA::NAME => Some(OPTICAL_FLOW_RAD_DATA::ID),
            PARAM_REQUEST_LIST_DATA::NAME => Some(PARAM_REQUEST_LIST_DATA::ID),
            PARAM_REQUEST_READ_DATA::NAME => Some(PARAM_REQUEST_READ_DATA::ID),
            PARAM_SET_DATA::NAME => Some(PARAM_SET_DATA::ID),
            PARAM_VALUE_DATA::NAME => Some(PARAM_VALUE_DATA::ID),
            PING_DATA::NAME => Some(PING_DATA::ID),
            RC_CHANNELS_DATA::NAME => Some(RC_CHANNELS_DATA::ID),
            SCALED_IMU_DATA::NAME => Some(SCALED_IMU_DATA::ID),
            SCALED_PRESSURE_DATA::NAME => Some(SCALED_PRESSURE_DATA::ID),
            SERIAL_CONTROL_DATA::NAME => Some(SERIAL_CONTROL_DATA::ID),
            SERVO_OUTPUT_RAW_DATA::NAME => Some(SERVO_OUTPUT_RAW_DATA::ID),
            SETUP_SIGNING_DATA::NAME => Some(SETUP_SIGNING_DATA::ID),
            SOPHIE_ARMING_DATA::NAME => Some(SOPHIE_ARMING_DATA::ID),
            SOPHIE_ARMS_DATA::NAME => Some(SOPHIE_ARMS_DATA::ID),
            SOPHIE_CALIBRATION_RESULT_DATA::NAME => Some(SOPHIE_CALIBRATION_RESULT_DATA::ID),
            SOPHIE_CHECK_DATA::NAME => Some(SOPHIE_CHECK_DATA::ID),
            STATUSTEXT_DATA::NAME => Some(STATUSTEXT_DATA::ID),
            SYS_STATUS_DATA::NAME => Some(SYS_STATUS_DATA::ID),
            TIMESYNC_DATA::NAME => Some(TIMESYNC_DATA::ID),
            VIBRATION_DATA::NAME => Some(VIBRATION_DATA::ID),
            VISION_POSITION_ESTIMATE_DATA::NAME => Some(VISION_POSITION_ESTIMATE_DATA::ID),
            _ => None,
        }
    }
    fn default_message_from_id(id: u32) -> Option<Self> {
        match id {
            ATTITUDE_DATA::ID => Some(Self::ATTITUDE(ATTITUDE_DATA::default())),
            ATTITUDE_QUATERNION_DATA::ID => {
                Some(Self::ATTITUDE_QUATERNION(ATTITUDE_QUATERNION_DATA::default()))
            }
            ATT_POS_MOCAP_DATA::ID => Some(Self::ATT_POS_MOCAP(ATT_POS_MOCAP_DATA::default())),
            AUTOPILOT_VERSION_DATA::ID => Some(Self::AUTOPILOT_VERSION(AUTOPILOT_VERSION_DATA::default())),
            AVAILABLE_MODES_DATA::ID => Some(Self::AVAILABLE_MODES(AVAILABLE_MODES_DATA::default())),
            AVAILABLE_MODES_MONITOR_DATA::ID => Some(Self::AVAILABLE_MODES_MONITOR(
                AVAILABLE_MODES_MONITOR_DATA::default(),
            )),
            BATTERY_STATUS_DATA::ID => Some(Self::BATTERY_STATUS(BATTERY_STATUS_DATA::default())),
            COMMAND_ACK_DATA::ID => Some(Self::COMMAND_ACK(COMMAND_ACK_DATA::default())),
            COMMAND_INT_DATA::ID => Some(Self::COMMAND_INT(COMMAND_INT_DATA::default())),
            COMMAND_LONG_DATA::ID => Some(Self::COMMAND_LONG(COMMAND_LONG_DATA::default())),
            COMPONENT_INFORMATION_BASIC_DATA::ID => Some(Self::COMPONENT_INFORMATION_BASIC(
                COMPONENT_INFORMATION_BASIC_DATA::default(),
            )),
            COMPONENT_METADATA_DATA::ID => Some(Self::COMPONENT_METADATA(COMPONENT_METADATA_DATA::default())),
            CURRENT_MODE_DATA::ID => Some(Self::CURRENT_MODE(CURRENT_MODE_DATA::default())),
            DISTANCE_SENSOR_DATA::ID => Some(Self::DISTANCE_SENSOR(DISTANCE_SENSOR_DATA::default())),
            EXTENDED_SYS_STATE_DATA::ID => Some(Self::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA::default())),
            FILE_TRANSFER_PROTOCOL_DATA::ID => Some(Self::FILE_TRANSFER_PROTOCOL(
                FILE_TRANSFER_PROTOCOL_DATA::default(),
            )),
            HEARTBEAT_DATA::ID => Some(Self::HEARTBEAT(HEARTBEAT_DATA::default())),
            LANDING_TARGET_DATA::ID => Some(Self::LANDING_TARGET(LANDING_TARGET_DATA::default())),
            MESSAGE_INTERVAL_DATA::ID => Some(Self::MESSAGE_INTERVAL(MESSAGE_INTERVAL_DATA::default())),
            NAMED_VALUE_FLOAT_DATA::ID => Some(Self::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA::default())),
            ODOMETRY_DATA::ID => Some(Self::ODOMETRY(ODOMETRY_DATA::default())),
            OPTICAL_FLOW_RAD_DATA::ID => Some(Self::OPTICAL_FLOW_RAD(OPTICAL_FLOW_RAD_DATA::default())),
            PARAM_REQUEST_LIST_DATA::ID => Some(Self::PARAM_REQUEST_LIST(PARAM_REQUEST_LIST_DATA::default())),
            PARAM_REQUEST_READ_DATA::ID => Some(Self::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA::default())),
            PARAM_SET_DATA::ID => Some(Self::PARAM_SET(PARAM_SET_DATA::default())),
            PARAM_VALUE_DATA::ID => Some(Self::PARAM_VALUE(PARAM_VALUE_DATA::default())),
            PING_DATA::ID => Some(Self::PING(PING_DATA::default())),
            RC_CHANNELS_DATA::ID => Some(Self::RC_CHANNELS(RC_CHANNELS_DATA::default())),
            SCALED_IMU_DATA::ID => Some(Self::SCALED_IMU(SCALED_IMU_DATA::default())),
            SCALED_PRESSURE_DATA::ID => Some(Self::SCALED_PRESSURE(SCALED_PRESSURE_DATA::default())),
            SERIAL_CONTROL_DATA::ID => Some(Self::SERIAL_CONTROL(SERIAL_CONTROL_DATA::default())),
            SERVO_OUTPUT_RAW_DATA::ID => Some(Self::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA::default())),
            SETUP_SIGNING_DATA::ID => Some(Self::SETUP_SIGNING(SETUP_SIGNING_DATA::default())),
            SOPHIE_ARMING_DATA::ID => Some(Self::SOPHIE_ARMING(SOPHIE_ARMING_DATA::default())),
            SOPHIE_ARMS_DATA::ID => Some(Self::SOPHIE_ARMS(SOPHIE_ARMS_DATA::default())),
            SOPHIE_CALIBRATION_RESULT_DATA::ID => Some(Self::SOPHIE_CALIBRATION_RESULT(
                SOPHIE_CALIBRATION_RESULT_DATA::default(),
            )),
            SOPHIE_CHECK_DATA::ID => Some(Self::SOPHIE_CHECK(SOPHIE_CHECK_DATA::default())),
            STATUSTEXT_DATA::ID => Some(Self::STATUSTEXT(STATUSTEXT_DATA::default())),
            SYS_STATUS_DATA::ID => Some(Self::SYS_STATUS(SYS_STATUS_DATA::default())),
            TIMESYNC_DATA::ID => Some(Self::TIMESYNC(TIMESYNC_DATA::default())),
            VIBRATION_DATA::ID => Some(Self::VIBRATION(VIBRATION_DATA::default())),
            VISION_POSITION_ESTIMATE_DATA::ID => Some(Self::VISION_POSITION_ESTIMATE(
                VISION_POSITION_ESTIMATE_DATA::default(),
            )),
            _ => None,
        }
    }
    #[cfg(feature = "arbitrary")]
    fn random_message_from_id<R: rand::Rng>(id: u32, rng: &mut R) -> Option<Self> {
        match id {
            ATTITUDE_DATA::ID => Some(Self::ATTITUDE(ATTITUDE_DATA::random(rng))),
            ATTITUDE_QUATERNION_DATA::ID => {
                Some(Self::ATTITUDE_QUATERNION(ATTITUDE_QUATERNION_DATA::random(rng)))
            }
            ATT_POS_MOCAP_DATA::ID => Some(Self::ATT_POS_MOCAP(ATT_POS_MOCAP_DATA::random(rng))),
            AUTOPILOT_VERSION_DATA::ID => Some(Self::AUTOPILOT_VERSION(AUTOPILOT_VERSION_DATA::random(rng))),
            AVAILABLE_MODES_DATA::ID => Some(Self::AVAILABLE_MODES(AVAILABLE_MODES_DATA::random(rng))),
            AVAILABLE_MODES_MONITOR_DATA::ID => Some(Self::AVAILABLE_MODES_MONITOR(
                AVAILABLE_MODES_MONITOR_DATA::random(rng),
            )),
            BATTERY_STATUS_DATA::ID => Some(Self::BATTERY_STATUS(BATTERY_STATUS_DATA::random(rng))),
            COMMAND_ACK_DATA::ID => Some(Self::COMMAND_ACK(COMMAND_ACK_DATA::random(rng))),
            COMMAND_INT_DATA::ID => Some(Self::COMMAND_INT(COMMAND_INT_DATA::random(rng))),
            COMMAND_LONG_DATA::ID => Some(Self::COMMAND_LONG(COMMAND_LONG_DATA::random(rng))),
            COMPONENT_INFORMATION_BASIC_DATA::ID => Some(Self::COMPONENT_INFORMATION_BASIC(
                COMPONENT_INFORMATION_BASIC_DATA::random(rng),
            )),
            COMPONENT_METADATA_DATA::ID => {
                Some(Self::COMPONENT_METADATA(COMPONENT_METADATA_DATA::random(rng)))
            }
            CURRENT_MODE_DATA::ID => Some(Self::CURRENT_MODE(CURRENT_MODE_DATA::random(rng))),
            DISTANCE_SENSOR_DATA::ID => Some(Self::DISTANCE_SENSOR(DISTANCE_SENSOR_DATA::random(rng))),
            EXTENDED_SYS_STATE_DATA::ID => {
                Some(Self::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA::random(rng)))
            }
            FILE_TRANSFER_PROTOCOL_DATA::ID => Some(Self::FILE_TRANSFER_PROTOCOL(
                FILE_TRANSFER_PROTOCOL_DATA::random(rng),
            )),
            HEARTBEAT_DATA::ID => Some(Self::HEARTBEAT(HEARTBEAT_DATA::random(rng))),
            LANDING_TARGET_DATA::ID => Some(Self::LANDING_TARGET(LANDING_TARGET_DATA::random(rng))),
            MESSAGE_INTERVAL_DATA::ID => Some(Self::MESSAGE_INTERVAL(MESSAGE_INTERVAL_DATA::random(rng))),
            NAMED_VALUE_FLOAT_DATA::ID => Some(Self::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA::random(rng))),
            ODOMETRY_DATA::ID => Some(Self::ODOMETRY(ODOMETRY_DATA::random(rng))),
            OPTICAL_FLOW_RAD_DATA::ID => Some(Self::OPTICAL_FLOW_RAD(OPTICAL_FLOW_RAD_DATA::random(rng))),
            PARAM_REQUEST_LIST_DATA::ID => {
                Some(Self::PARAM_REQUEST_LIST(PARAM_REQUEST_LIST_DATA::random(rng)))
            }
            PARAM_REQUEST_READ_DATA::ID => {
                Some(Self::PARAM_REQUEST_READ(PARAM_REQUEST_READ_DATA::random(rng)))
            }
            PARAM_SET_DATA::ID => Some(Self::PARAM_SET(PARAM_SET_DATA::random(rng))),
            PARAM_VALUE_DATA::ID => Some(Self::PARAM_VALUE(PARAM_VALUE_DATA::random(rng))),
            PING_DATA::ID => Some(Self::PING(PING_DATA::random(rng))),
            RC_CHANNELS_DATA::ID => Some(Self::RC_CHANNELS(RC_CHANNELS_DATA::random(rng))),
            SCALED_IMU_DATA::ID => Some(Self::SCALED_IMU(SCALED_IMU_DATA::random(rng))),
            SCALED_PRESSURE_DATA::ID => Some(Self::SCALED_PRESSURE(SCALED_PRESSURE_DATA::random(rng))),
            SERIAL_CONTROL_DATA::ID => Some(Self::SERIAL_CONTROL(SERIAL_CONTROL_DATA::random(rng))),
            SERVO_OUTPUT_RAW_DATA::ID => Some(Self::SERVO_OUTPUT_RAW(SERVO_OUTPUT_RAW_DATA::random(rng))),
            SETUP_SIGNING_DATA::ID => Some(Self::SETUP_SIGNING(SETUP_SIGNING_DATA::random(rng))),
            SOPHIE_ARMING_DATA::ID => Some(Self::SOPHIE_ARMING(SOPHIE_ARMING_DATA::random(rng))),
            SOPHIE_ARMS_DATA::ID => Some(Self::SOPHIE_ARMS(SOPHIE_ARMS_DATA::random(rng))),
            SOPHIE_CALIBRATION_RESULT_DATA::ID => Some(Self::SOPHIE_CALIBRATION_RESULT(
                SOPHIE_CALIBRATION_RESULT_DATA::random(rng),
            )),
            SOPHIE_CHECK_DATA::ID => Some(Self::SOPHIE_CHECK(SOPHIE_CHECK_DATA::random(rng))),
            STATUSTEXT_DATA::ID => Some(Self::STATUSTEXT(STATUSTEXT_DATA::random(rng))),
            SYS_STATUS_DATA::ID => Some(Self::SYS_STATUS(SYS_STATUS_DATA::random(rng))),
            TIMESYNC_DATA::ID => Some(Self::TIMESYNC(TIMESYNC_DATA::random(rng))),
            VIBRATION_DATA::ID => Some(Self::VIBRATION(VIBRATION_DATA::random(rng))),
            VISION_POSITION_ESTIMATE_DATA::ID => Some(Self::VISION_POSITION_ESTIMATE(
                VISION_POSITION_ESTIMATE_DATA::random(rng),
            )),
            _ => None,
        }
    }
    fn ser(&self, version: MavlinkVersion, bytes: &mut [u8]) -> usize {
        match self {
            Self::ATTITUDE(body) => body.ser(version, bytes),
            Self::ATTITUDE_QUATERNION(body) => body.ser(version, bytes),
            Self::ATT_POS_MOCAP(body) => body.ser(version, bytes),
            Self::AUTOPILOT_VERSION(body) => body.ser(version, bytes),
            Self::AVAILABLE_MODES(body) => body.ser(version, bytes),
            Self::AVAILABLE_MODES_MONITOR(body) => body.ser(version, bytes),
            Self::BATTERY_STATUS(body) => body.ser(version, bytes),
            Self::COMMAND_ACK(body) => body.ser(version, bytes),
            Self::COMMAND_INT(body) => body.ser(version, bytes),
            Self::COMMAND_LONG(body) => body.ser(version, bytes),
            Self::COMPONENT_INFORMATION_BASIC(body) => body.ser(version, bytes),
            Self::COMPONENT_METADATA(body) => body.ser(version, bytes),
            Self::CURRENT_MODE(body) => body.ser(version, bytes),
            Self::DISTANCE_SENSOR(body) => body.ser(version, bytes),
            Self::EXTENDED_SYS_STATE(body) => body.ser(version, bytes),
            Self::FILE_TRANSFER_PROTOCOL(body) => body.ser(version, bytes),
            Self::HEARTBEAT(body) => body.ser(version, bytes),
            Self::LANDING_TARGET(body) => body.ser(version, bytes),
            Self::MESSAGE_INTERVAL(body) => body.ser(version, bytes),
            Self::NAMED_VALUE_FLOAT(body) => body.ser(version, bytes),
            Self::ODOMETRY(body) => body.ser(version, bytes),
            Self::OPTICAL_FLOW_RAD(body) => body.ser(version, bytes),
            Self::PARAM_REQUEST_LIST(body) => body.ser(version, bytes),
            Self::PARAM_REQUEST_READ(body) => body.ser(version, bytes),
            Self::PARAM_SET(body) => body.ser(version, bytes),
            Self::PARAM_VALUE(body) => body.ser(version, bytes),
            Self::PING(body) => body.ser(version, bytes),
            Self::RC_CHANNELS(body) => body.ser(version, bytes),
            Self::SCALED_IMU(body) => body.ser(version, bytes),
            Self::SCALED_PRESSURE(body) => body.ser(version, bytes),
            Self::SERIAL_CONTROL(body) => body.ser(version, bytes),
            Self::SERVO_OUTPUT_RAW(body) => body.ser(version, bytes),
            Self::SETUP_SIGNING(body) => body.ser(version, bytes),
            Self::SOPHIE_ARMING(body) => body.ser(version, bytes),
            Self::SOPHIE_ARMS(body) => body.ser(version, bytes),
            Self::SOPHIE_CALIBRATION_RESULT(body) => body.ser(version, bytes),
            Self::SOPHIE_CHECK(body) => body.ser(version, bytes),
            Self::STATUSTEXT(body) => body.ser(version, bytes),
            Self::SYS_STATUS(body) => body.ser(version, bytes),
            Self::TIMESYNC(body) => body.ser(version, bytes),
            Self::VIBRATION(body) => body.ser(version, bytes),
            Self::VISION_POSITION_ESTIMATE(body) => body.ser(version, bytes),
        }
    }
    fn extra_crc(id: u32) -> u8 {
        match id {
            ATTITUDE_DATA::ID => ATTITUDE_DATA::EXTRA_CRC,
            ATTITUDE_QUATERNION_DATA::ID => ATTITUDE_QUATERNION_DATA::EXTRA_CRC,
            ATT_POS_MOCAP_DATA::ID => ATT_POS_MOCAP_DATA::EXTRA_CRC,
            AUTOPILOT_VERSION_DATA::ID => AUTOPILOT_VERSION_DATA::EXTRA_CRC,
            AVAILABLE_MODES_DATA::ID => AVAILABLE_MODES_DATA::EXTRA_CRC,
            AVAILABLE_MODES_MONITOR_DATA::ID => AVAILABLE_MODES_MONITOR_DATA::EXTRA_CRC,
            BATTERY_STATUS_DATA::ID => BATTERY_STATUS_DATA::EXTRA_CRC,
            COMMAND_ACK_DATA::ID => COMMAND_ACK_DATA::EXTRA_CRC,
            COMMAND_INT_DATA::ID => COMMAND_INT_DATA::EXTRA_CRC,
            COMMAND_LONG_DATA::ID => COMMAND_LONG_DATA::EXTRA_CRC,
            COMPONENT_INFORMATION_BASIC_DATA::ID => COMPONENT_INFORMATION_BASIC_DATA::EXTRA_CRC,
            COMPONENT_METADATA_DATA::ID => COMPONENT_METADATA_DATA::EXTRA_CRC,
            CURRENT_MODE_DATA::ID => CURRENT_MODE_DATA::EXTRA_CRC,
            DISTANCE_SENSOR_DATA::ID => DISTANCE_SENSOR_DATA::EXTRA_CRC,
            EXTENDED_SYS_STATE_DATA::ID => EXTENDED_SYS_STATE_DATA::EXTRA_CRC,
            FILE_TRANSFER_PROTOCOL_DATA::ID => FILE_TRANSFER_PROTOCOL_DATA::EXTRA_CRC,
            HEARTBEAT_DATA::ID => HEARTBEAT_DATA::EXTRA_CRC,
            LANDING_TARGET_DATA::ID => LANDING_TARGET_DATA::EXTRA_CRC,
            MESSAGE_INTERVAL_DATA::ID => MESSAGE_INTERVAL_DATA::EXTRA_CRC,
            NAMED_VALUE_FLOAT_DATA::ID => NAMED_VALUE_FLOAT_DATA::EXTRA_CRC,
            ODOMETRY_DATA::ID => ODOMETRY_DATA::EXTRA_CRC,
            OPTICAL_FLOW_RAD_DATA::ID => OPTICAL_FLOW_RAD_DATA::EXTRA_CRC,
            PARAM_REQUEST_LIST_DATA::ID => PARAM_REQUEST_LIST_DATA::EXTRA_CRC,
            PARAM_REQUEST_READ_DATA::ID => PARAM_REQUEST_READ_DATA::EXTRA_CRC,
            PARAM_SET_DATA::ID => PARAM_SET_DATA::EXTRA_CRC,
            PARAM_VALUE_DATA::ID => PARAM_VALUE_DATA::EXTRA_CRC,
            PING_DATA::ID => PING_DATA::EXTRA_CRC,
            RC_CHANNELS_DATA::ID => RC_CHANNELS_DATA::EXTRA_CRC,
            SCALED_IMU_DATA::ID => SCALED_IMU_DATA::EXTRA_CRC,
            SCALED_PRESSURE_DATA::ID => SCALED_PRESSURE_DATA::EXTRA_CRC,
            SERIAL_CONTROL_DATA::ID => SERIAL_CONTROL_DATA::EXTRA_CRC,
            SERVO_OUTPUT_RAW_DATA::ID => SERVO_OUTPUT_RAW_DATA::EXTRA_CRC,
            SETUP_SIGNING_DATA::ID => SETUP_SIGNING_DATA::EXTRA_CRC,
            SOPHIE_ARMING_DATA::ID => SOPHIE_ARMING_DATA::EXTRA_CRC,
            SOPHIE_ARMS_DATA::ID => SOPHIE_ARMS_DATA::EXTRA_CRC,
            SOPHIE_CALIBRATION_RESULT_DATA::ID => SOPHIE_CALIBRATION_RESULT_DATA::EXTRA_CRC,
            SOPHIE_CHECK_DATA::ID => SOPHIE_CHECK_DATA::EXTRA_CRC,
            STATUSTEXT_DATA::ID => STATUSTEXT_DATA::EXTRA_CRC,
            SYS_STATUS_DATA::ID => SYS_STATUS_DATA::EXTRA_CRC,
            TIMESYNC_DATA::ID => TIMESYNC_DATA::EXTRA_CRC,
            VIBRATION_DATA::ID => VIBRATION_DATA::EXTRA_CRC,
            VISION_POSITION_ESTIMATE_DATA::ID => VISION_POSITION_ESTIMATE_DATA::EXTRA_CRC,
            _ => 0,
        }
    }
    fn target_system_id(&self) -> Option<u8> {
        match self {
            Self::COMMAND_ACK(inner) => Some(inner.target_system),
            Self::COMMAND_INT(inner) => Some(inner.target_system),
            Self::COMMAND_LONG(inner) => Some(inner.target_system),
            Self::FILE_TRANSFER_PROTOCOL(inner) => Some(inner.target_system),
            Self::PARAM_REQUEST_LIST(inner) => Some(inner.target_system),
            Self::PARAM_REQUEST_READ(inner) => Some(inner.target_system),
            Self::PARAM_SET(inner) => Some(inner.target_system),
            Self::PING(inner) => Some(inner.target_system),
            Self::SERIAL_CONTROL(inner) => Some(inner.target_system),
            Self::SETUP_SIGNING(inner) => Some(inner.target_system),
            Self::TIMESYNC(inner) => Some(inner.target_system),
            _ => None,
        }
    }
    fn target_system_id_mut(&mut self) -> Option<&mut u8> {
        match self {
            Self::COMMAND_ACK(inner) => Some(&mut inner.target_system),
            Self::COMMAND_INT(inner) => Some(&mut inner.target_system),
            Self::COMMAND_LONG(inner) => Some(&mut inner.target_system),
            Self::FILE_TRANSFER_PROTOCOL(inner) => Some(&mut inner.target_system),
            Self::PARAM_REQUEST_LIST(inner) => Some(&mut inner.target_system),
            Self::PARAM_REQUEST_READ(inner) => Some(&mut inner.target_system),
            Self::PARAM_SET(inner) => Some(&mut inner.target_system),
            Self::PING(inner) => Some(&mut inner.target_system),
            Self::SERIAL_CONTROL(inner) => Some(&mut inner.target_system),
            Self::SETUP_SIGNING(inner) => Some(&mut inner.target_system),
            Self::TIMESYNC(inner) => Some(&mut inner.target_system),
            _ => None,
        }
    }
    fn target_component_id(&self) -> Option<u8> {
        match self {
            Self::COMMAND_ACK(inner) => Some(inner.target_component),
            Self::COMMAND_INT(inner) => Some(inner.target_component),
            Self::COMMAND_LONG(inner) => Some(inner.target_component),
            Self::FILE_TRANSFER_PROTOCOL(inner) => Some(inner.target_component),
            Self::PARAM_REQUEST_LIST(inner) => Some(inner.target_component),
            Self::PARAM_REQUEST_READ(inner) => Some(inner.target_component),
            Self::PARAM_SET(inner) => Some(inner.target_component),
            Self::PING(inner) => Some(inner.target_component),
            Self::SERIAL_CONTROL(inner) => Some(inner.target_component),
            Self::SETUP_SIGNING(inner) => Some(inner.target_component),
            Self::TIMESYNC(inner) => Some(inner.target_component),
            _ => None,
        }
    }
    fn target_component_id_mut(&mut self) -> Option<&mut u8> {
        match self {
            Self::COMMAND_ACK(inner) => Some(&mut inner.target_component),
            Self::COMMAND_INT(inner) => Some(&mut inner.target_component),
            Self::COMMAND_LONG(inner) => Some(&mut inner.target_component),
            Self::FILE_TRANSFER_PROTOCOL(inner) => Some(&mut inner.target_component),
            Self::PARAM_REQUEST_LIST(inner) => Some(&mut inner.target_component),
            Self::PARAM_REQUEST_READ(inner) => Some(&mut inner.target_component),
            Self::PARAM_SET(inner) => Some(&mut inner.target_component),
            Self::PING(inner) => Some(&mut inner.target_component),
            Self::SERIAL_CONTROL(inner) => Some(&mut inner.target_component),
            Self::SETUP_SIGNING(inner) => Some(&mut inner.target_component),
            Self::TIMESYNC(inner) => Some(&mut inner.target_component),
            _ => None,
        }
    }
}
