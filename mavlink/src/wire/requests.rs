//! Requests: the messages that are taken, and the content of each.

use mavlink_core::{MavlinkVersion, MessageData};

use crate::wire::frame::{COMPONENT, Frame, SYSTEM};
use sophie_dialect::*;

/// The sender of a request.
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
    /// Its parameters; NaN where the sender gives no value. No command uses a place on earth.
    pub params: [f32; 7],
    /// It was sent before, and not acknowledged as far as the sender knows.
    pub repeated: bool,
}

impl Command {
    /// The same command with the same parameters, whether repeated or not.
    pub fn is_alike(&self, other: &Self) -> bool {
        self.number == other.number && self.params.map(f32::to_bits) == other.params.map(f32::to_bits)
    }

    const fn long(m: &COMMAND_LONG_DATA) -> Self {
        Self {
            number: m.command,
            repeated: m.confirmation > 0,
            params: [
                m.param1, m.param2, m.param3, m.param4, m.param5, m.param6, m.param7,
            ],
        }
    }

    const fn int(m: &COMMAND_INT_DATA) -> Self {
        const fn given(whole: i32) -> f32 {
            match whole {
                i32::MAX => f32::NAN,
                whole => whole as f32,
            }
        }
        Self {
            number: m.command,
            repeated: false,
            params: [
                m.param1,
                m.param2,
                m.param3,
                m.param4,
                given(m.x),
                given(m.y),
                m.z,
            ],
        }
    }
}

/// The system and the component that a message is for; 0 stands for all.
type Target = (u8, u8);

/// The target of a message that has no field for it.
const ALL: Target = (0, 0);

const fn is_for_here((system, component): Target) -> bool {
    (system == 0 || system == SYSTEM) && (component == 0 || component == COMPONENT)
}

fn message<M: MessageData>(frame: &Frame<'_>) -> Option<M> {
    M::deser(MavlinkVersion::V2, frame.payload).ok()
}

/// One row for each request: its variant, then each of its messages with target and content. A row makes the variant,
/// the checksum's first byte and the decoder: a message cannot lack one of the three.
macro_rules! messages {
    ($(
        $(#[$doc:meta])*
        $variant:ident $(($content:ty))? { $($message:ident as $read:pat => $target:expr, $request:expr;)+ }
    )*) => {
        /// What a frame asks for.
        #[derive(Clone, Debug, PartialEq)]
        #[allow(
            clippy::large_enum_variant,
            reason = "one at a time, on the stack: nothing can be allocated"
        )]
        pub enum Request {
            $($(#[$doc])* $variant $(($content))?,)*
        }

        /// The byte that the checksum of message `id` starts with; `None` for a message that is not taken.
        pub const fn crc_extra(id: u32) -> Option<u8> {
            Some(match id {
                $($($message::ID => $message::EXTRA_CRC,)+)*
                _ => return None,
            })
        }

        /// The target and the request of a frame; `None` if the message is not taken or cannot be decoded.
        fn read(frame: &Frame<'_>) -> Option<(Target, Request)> {
            Some(match frame.id {
                $($($message::ID => {
                    let $read: $message = message(frame)?;
                    ($target, $request)
                })+)*
                _ => return None,
            })
        }
    };
}

messages! {
    /// Another component is alive.
    Heartbeat {
        HEARTBEAT_DATA as _ => ALL, Request::Heartbeat;
    }
    /// The answer repeats the content.
    Ping(PING_DATA) {
        PING_DATA as m => (m.target_system, m.target_component), Request::Ping(m);
    }
    /// The answer adds the vehicle's time.
    Timesync(TIMESYNC_DATA) {
        TIMESYNC_DATA as m => (m.target_system, m.target_component), Request::Timesync(m);
    }
    /// A command.
    Command(Command) {
        COMMAND_LONG_DATA as m => (m.target_system, m.target_component), Request::Command(Command::long(&m));
        COMMAND_INT_DATA as m => (m.target_system, m.target_component), Request::Command(Command::int(&m));
    }
    /// All parameters.
    ParamList {
        PARAM_REQUEST_LIST_DATA as m => (m.target_system, m.target_component), Request::ParamList;
    }
    /// One parameter.
    ParamRead(PARAM_REQUEST_READ_DATA) {
        PARAM_REQUEST_READ_DATA as m => (m.target_system, m.target_component), Request::ParamRead(m);
    }
    /// A parameter's new value.
    ParamSet(PARAM_SET_DATA) {
        PARAM_SET_DATA as m => (m.target_system, m.target_component), Request::ParamSet(m);
    }
    /// An external pose with covariance and resets.
    Odometry(ODOMETRY_DATA) {
        ODOMETRY_DATA as m => ALL, Request::Odometry(m);
    }
    /// An external pose of a camera aboard.
    Vision(VISION_POSITION_ESTIMATE_DATA) {
        VISION_POSITION_ESTIMATE_DATA as m => ALL, Request::Vision(m);
    }
    /// An external pose of a motion-capture system.
    Mocap(ATT_POS_MOCAP_DATA) {
        ATT_POS_MOCAP_DATA as m => ALL, Request::Mocap(m);
    }
    /// Optical flow.
    Flow(OPTICAL_FLOW_RAD_DATA) {
        OPTICAL_FLOW_RAD_DATA as m => ALL, Request::Flow(m);
    }
    /// A range.
    Range(DISTANCE_SENSOR_DATA) {
        DISTANCE_SENSOR_DATA as m => ALL, Request::Range(m);
    }
    /// The place of the pipe.
    PipeTarget(LANDING_TARGET_DATA) {
        LANDING_TARGET_DATA as m => ALL, Request::PipeTarget(m);
    }
    /// A new signing key. The request does not carry it: a key is set at the console alone.
    SetupSigning {
        SETUP_SIGNING_DATA as m => (m.target_system, m.target_component), Request::SetupSigning;
    }
    /// A request for a file.
    File(FILE_TRANSFER_PROTOCOL_DATA) {
        FILE_TRANSFER_PROTOCOL_DATA as m => (m.target_system, m.target_component), Request::File(m);
    }
    /// Bytes for the console.
    Serial(SERIAL_CONTROL_DATA) {
        SERIAL_CONTROL_DATA as m => (m.target_system, m.target_component), Request::Serial(m);
    }
}

/// The request in `frame`; `None` if it is for another vehicle, is this vehicle's own frame, or cannot be decoded.
pub fn request(frame: &Frame<'_>) -> Option<Request> {
    if frame.system == SYSTEM && frame.component == COMPONENT {
        return None;
    }
    let (target, request) = read(frame)?;
    is_for_here(target).then_some(request)
}
