//! What others may ask: the messages that are taken, and commands in one shape.

use mavlink_core::{MavlinkVersion, MessageData};

use crate::dialect::*;
use crate::wire::frame::{COMPONENT, Frame, SYSTEM};

/// Who asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Peer {
    /// Its system.
    pub system: u8,
    /// Its component.
    pub component: u8,
}

/// A command, long or int.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Its number.
    pub number: u16,
    /// Its parameters, NaN for one that is not given: none of those that are obeyed uses a place on earth.
    pub params: [f32; 7],
}

/// What a frame asks.
#[derive(Clone, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "one at a time, on the stack, where nothing can be allocated"
)]
pub enum Request {
    /// Someone is there.
    Heartbeat,
    /// To be answered with the same.
    Ping(PING_DATA),
    /// To be answered with the vehicle's time.
    Timesync(TIMESYNC_DATA),
    /// A command.
    Command(Command),
    /// All parameters.
    ParamList,
    /// One parameter.
    ParamRead(PARAM_REQUEST_READ_DATA),
    /// A parameter's new value.
    ParamSet(PARAM_SET_DATA),
    /// A pose from outside.
    Odometry(ODOMETRY_DATA),
    /// The same.
    Vision(VISION_POSITION_ESTIMATE_DATA),
    /// The same.
    Mocap(ATT_POS_MOCAP_DATA),
    /// Optical flow.
    Flow(OPTICAL_FLOW_RAD_DATA),
    /// A range.
    Range(DISTANCE_SENSOR_DATA),
    /// Where the pipe is.
    Target(LANDING_TARGET_DATA),
    /// An attitude that is wished for.
    Attitude(SET_ATTITUDE_TARGET_DATA),
    /// A key for signing, which is left unread.
    SetupSigning,
    /// A request for a file.
    File(FILE_TRANSFER_PROTOCOL_DATA),
    /// What is typed into the console, or said by one.
    Serial(SERIAL_CONTROL_DATA),
}

/// What the checksum of message `id` begins with; `None` for those that are not taken.
pub const fn crc_extra(id: u32) -> Option<u8> {
    Some(match id {
        HEARTBEAT_DATA::ID => HEARTBEAT_DATA::EXTRA_CRC,
        PING_DATA::ID => PING_DATA::EXTRA_CRC,
        TIMESYNC_DATA::ID => TIMESYNC_DATA::EXTRA_CRC,
        COMMAND_LONG_DATA::ID => COMMAND_LONG_DATA::EXTRA_CRC,
        COMMAND_INT_DATA::ID => COMMAND_INT_DATA::EXTRA_CRC,
        PARAM_REQUEST_LIST_DATA::ID => PARAM_REQUEST_LIST_DATA::EXTRA_CRC,
        PARAM_REQUEST_READ_DATA::ID => PARAM_REQUEST_READ_DATA::EXTRA_CRC,
        PARAM_SET_DATA::ID => PARAM_SET_DATA::EXTRA_CRC,
        FILE_TRANSFER_PROTOCOL_DATA::ID => FILE_TRANSFER_PROTOCOL_DATA::EXTRA_CRC,
        SETUP_SIGNING_DATA::ID => SETUP_SIGNING_DATA::EXTRA_CRC,
        SERIAL_CONTROL_DATA::ID => SERIAL_CONTROL_DATA::EXTRA_CRC,
        ODOMETRY_DATA::ID => ODOMETRY_DATA::EXTRA_CRC,
        VISION_POSITION_ESTIMATE_DATA::ID => VISION_POSITION_ESTIMATE_DATA::EXTRA_CRC,
        ATT_POS_MOCAP_DATA::ID => ATT_POS_MOCAP_DATA::EXTRA_CRC,
        OPTICAL_FLOW_RAD_DATA::ID => OPTICAL_FLOW_RAD_DATA::EXTRA_CRC,
        DISTANCE_SENSOR_DATA::ID => DISTANCE_SENSOR_DATA::EXTRA_CRC,
        LANDING_TARGET_DATA::ID => LANDING_TARGET_DATA::EXTRA_CRC,
        SET_ATTITUDE_TARGET_DATA::ID => SET_ATTITUDE_TARGET_DATA::EXTRA_CRC,
        _ => return None,
    })
}

/// For this vehicle, or for all; 0 stands for all.
const fn for_here(system: u8, component: u8) -> bool {
    (system == 0 || system == SYSTEM) && (component == 0 || component == COMPONENT)
}

fn message<M: MessageData>(frame: &Frame<'_>) -> Option<M> {
    M::deser(MavlinkVersion::V2, frame.payload).ok()
}

/// What `frame` asks of this vehicle; `None` for what is not for it, or cannot be read.
pub fn request(frame: &Frame<'_>) -> Option<Request> {
    if frame.system == SYSTEM && frame.component == COMPONENT {
        // Its own, come back.
        return None;
    }
    let (system, component, request) = match frame.id {
        HEARTBEAT_DATA::ID => (0, 0, Request::Heartbeat),
        PING_DATA::ID => {
            let m: PING_DATA = message(frame)?;
            (m.target_system, m.target_component, Request::Ping(m))
        }
        TIMESYNC_DATA::ID => {
            let m: TIMESYNC_DATA = message(frame)?;
            (m.target_system, m.target_component, Request::Timesync(m))
        }
        COMMAND_LONG_DATA::ID => {
            let m: COMMAND_LONG_DATA = message(frame)?;
            let params = [
                m.param1, m.param2, m.param3, m.param4, m.param5, m.param6, m.param7,
            ];
            let command = Command {
                number: m.command,
                params,
            };
            (m.target_system, m.target_component, Request::Command(command))
        }
        COMMAND_INT_DATA::ID => {
            let m: COMMAND_INT_DATA = message(frame)?;
            let [x, y] = [m.x, m.y].map(|whole| match whole {
                i32::MAX => f32::NAN,
                whole => whole as f32,
            });
            let params = [m.param1, m.param2, m.param3, m.param4, x, y, m.z];
            let command = Command {
                number: m.command,
                params,
            };
            (m.target_system, m.target_component, Request::Command(command))
        }
        PARAM_REQUEST_LIST_DATA::ID => {
            let m: PARAM_REQUEST_LIST_DATA = message(frame)?;
            (m.target_system, m.target_component, Request::ParamList)
        }
        PARAM_REQUEST_READ_DATA::ID => {
            let m: PARAM_REQUEST_READ_DATA = message(frame)?;
            (m.target_system, m.target_component, Request::ParamRead(m))
        }
        PARAM_SET_DATA::ID => {
            let m: PARAM_SET_DATA = message(frame)?;
            (m.target_system, m.target_component, Request::ParamSet(m))
        }
        ODOMETRY_DATA::ID => (0, 0, Request::Odometry(message(frame)?)),
        VISION_POSITION_ESTIMATE_DATA::ID => (0, 0, Request::Vision(message(frame)?)),
        ATT_POS_MOCAP_DATA::ID => (0, 0, Request::Mocap(message(frame)?)),
        OPTICAL_FLOW_RAD_DATA::ID => (0, 0, Request::Flow(message(frame)?)),
        DISTANCE_SENSOR_DATA::ID => (0, 0, Request::Range(message(frame)?)),
        LANDING_TARGET_DATA::ID => (0, 0, Request::Target(message(frame)?)),
        SET_ATTITUDE_TARGET_DATA::ID => {
            let m: SET_ATTITUDE_TARGET_DATA = message(frame)?;
            (m.target_system, m.target_component, Request::Attitude(m))
        }
        SETUP_SIGNING_DATA::ID => {
            // Zeros at the end are left out, and there may be none but those.
            let at = |place: usize| frame.payload.get(place).copied().unwrap_or_default();
            (at(8), at(9), Request::SetupSigning)
        }
        FILE_TRANSFER_PROTOCOL_DATA::ID => {
            let m: FILE_TRANSFER_PROTOCOL_DATA = message(frame)?;
            (m.target_system, m.target_component, Request::File(m))
        }
        SERIAL_CONTROL_DATA::ID => {
            let m: SERIAL_CONTROL_DATA = message(frame)?;
            (m.target_system, m.target_component, Request::Serial(m))
        }
        _ => return None,
    };
    for_here(system, component).then_some(request)
}
