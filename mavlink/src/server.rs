//! The server of one link: what arrives becomes answers and orders, what is due becomes frames.

use heapless::Deque;
use mavlink_core::MessageData;
use sophie_control::mode::Mode;
use sophie_control::params::Params;

use crate::budget::{Budget, RESERVE};
use crate::commands::{Command, Peer, Request, request};
use crate::dialect::*;
use crate::files::{FILES, GENERAL_CRC, GENERAL_URI};
use crate::frame::Encoder;
use crate::ftp::{Ftp, PAYLOAD};
use crate::messages as make;
use crate::parameters::{Parameters, Place, Refused};
use crate::parser::{Frame, Parser};
use crate::streams::{PERIOD_MIN_US, STREAMS, Schedule, frame_bytes};
use crate::texts::Texts;
use crate::vehicle::Vehicle;

/// Answers that wait at most. What does not fit is dropped, and asked for again by who wanted it.
const ANSWERS: usize = 12;
/// Time from the answer to a restart, µs: for the answer to get out.
const LAST_WORDS: u64 = 300_000;
/// Silence of all others after which the next heartbeat is someone new's, µs.
const FORGOTTEN: u64 = 5_000_000;

/// What the server wants done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// To store [`Server::params`]; [`Server::stored`] takes what became of it.
    Store,
    /// To restart the board.
    Restart,
}

/// What is to be said to someone who asked.
#[derive(Clone, Debug, PartialEq)]
enum Answer {
    Ack {
        command: u16,
        result: MavResult,
        to: Peer,
    },
    Ping(PING_DATA),
    Timesync(TIMESYNC_DATA),
    Interval {
        id: u16,
        interval_us: i32,
    },
    Parameter(Place),
    /// A stream's message, once.
    Stream(u32),
    Version,
    /// Where the description of the parameters is.
    Metadata,
    /// This mode, and those behind it where all were asked for.
    Mode {
        index: u8,
        all: bool,
    },
}

impl Answer {
    /// Length of its frame at most, bytes.
    fn bytes(&self) -> u32 {
        match self {
            Self::Ack { .. } => frame_bytes::<COMMAND_ACK_DATA>(),
            Self::Ping(_) => frame_bytes::<PING_DATA>(),
            Self::Timesync(_) => frame_bytes::<TIMESYNC_DATA>(),
            Self::Interval { .. } => frame_bytes::<MESSAGE_INTERVAL_DATA>(),
            Self::Parameter(_) => frame_bytes::<PARAM_VALUE_DATA>(),
            Self::Stream(id) => STREAMS.iter().find(|s| s.id == *id).map_or(0, |s| s.bytes),
            Self::Version => frame_bytes::<AUTOPILOT_VERSION_DATA>(),
            Self::Metadata => frame_bytes::<COMPONENT_METADATA_DATA>(),
            Self::Mode { .. } => frame_bytes::<AVAILABLE_MODES_DATA>(),
        }
    }
}

/// What a command is answered with.
struct Reply {
    result: MavResult,
    /// What was asked for, behind the acknowledgement: clients wait for that first.
    then: Option<Answer>,
}

impl From<MavResult> for Reply {
    fn from(result: MavResult) -> Self {
        Self { result, then: None }
    }
}

impl From<Answer> for Reply {
    fn from(answer: Answer) -> Self {
        Self {
            result: MavResult::MAV_RESULT_ACCEPTED,
            then: Some(answer),
        }
    }
}

/// The files, and who reads them.
struct Files {
    ftp: Ftp,
    /// Who asked last: pieces go there.
    reader: Peer,
    /// The answer that waits. Another request replaces it: who misses it asks again.
    answer: Option<[u8; PAYLOAD]>,
}

/// The server of one link.
pub struct Server {
    parser: Parser,
    encoder: Encoder,
    budget: Budget,
    schedule: Schedule,
    texts: Texts,
    parameters: Parameters,
    answers: Deque<Answer, ANSWERS>,
    files: Files,
    mode: Option<Mode>,
    /// When another's heartbeat came last, µs.
    heard_at: Option<u64>,
    restart_at: Option<u64>,
    /// Storing was asked for by a command.
    store_now: bool,
}

impl Server {
    /// Before the first byte of a line that may take `bytes_per_second`, with `params` in force.
    pub const fn new(params: Params, bytes_per_second: u32) -> Self {
        Self {
            parser: Parser::new(),
            encoder: Encoder::new(),
            budget: Budget::new(bytes_per_second),
            schedule: Schedule::new(),
            texts: Texts::new(),
            parameters: Parameters::new(params),
            answers: Deque::new(),
            files: Files {
                ftp: Ftp::new(&FILES),
                reader: Peer {
                    system: 0,
                    component: 0,
                },
                answer: None,
            },
            mode: None,
            heard_at: None,
            restart_at: None,
            store_now: false,
        }
    }

    /// Takes `bytes` that arrived at `now`, µs since the start.
    pub fn receive(&mut self, bytes: &[u8], now: u64, vehicle: &Vehicle) {
        for &byte in bytes {
            let asked =
                (self.parser.push(byte, now)).and_then(|frame| Some((peer(&frame), request(&frame)?)));
            if let Some((peer, asked)) = asked {
                self.obey(&asked, peer, now, vehicle);
            }
        }
    }

    /// What is to be done at `now`, µs since the start.
    pub fn order(&mut self, now: u64, vehicle: &Vehicle) -> Option<Order> {
        if self.restart_at.is_some_and(|at| now >= at) {
            self.restart_at = None;
            return vehicle.at_rest().then_some(Order::Restart);
        }
        let store = core::mem::take(&mut self.store_now) | self.parameters.to_store(vehicle.at_rest(), now);
        store.then_some(Order::Store)
    }

    /// The parameters as they are to be stored.
    pub const fn params(&self) -> &Params {
        self.parameters.copy()
    }

    /// Takes what became of [`Order::Store`].
    pub fn stored(&mut self, result: Result<(), &'static str>) {
        match result {
            Ok(()) => self.texts.say(
                MavSeverity::MAV_SEVERITY_NOTICE,
                format_args!("parameters stored: in force after a restart"),
            ),
            Err(why) => self.texts.say(
                MavSeverity::MAV_SEVERITY_ERROR,
                format_args!("parameters not stored: {why}"),
            ),
        }
    }

    /// The next frame that is due and within the budget at `now`, µs since the start.
    pub fn send(&mut self, now: u64, vehicle: &Vehicle) -> Option<&[u8]> {
        self.budget.refill(now);
        if self.mode != vehicle.mode() {
            self.mode = vehicle.mode();
            self.schedule.hurry(HEARTBEAT_DATA::ID);
            self.schedule.hurry(CURRENT_MODE_DATA::ID);
        }
        let bytes = self
            .send_heartbeat(now, vehicle)
            .or_else(|| self.send_answer(now, vehicle))
            .or_else(|| self.send_text(vehicle))
            .or_else(|| self.send_stream(now, vehicle))
            .or_else(|| self.send_file())
            .or_else(|| self.send_listed())?;
        self.budget.spend(bytes);
        Some(self.encoder.frame())
    }

    /// First of all: no flood of questions makes the vehicle look lost.
    fn send_heartbeat(&mut self, now: u64, vehicle: &Vehicle) -> Option<u32> {
        let room = self.budget.allows(frame_bytes::<HEARTBEAT_DATA>());
        let due = room && self.schedule.take(HEARTBEAT_DATA::ID, now);
        due.then(|| self.encoder.encode(&make::heartbeat(vehicle)))
    }

    fn send_answer(&mut self, now: u64, vehicle: &Vehicle) -> Option<u32> {
        if !self.budget.allows(self.answers.front()?.bytes()) {
            return None;
        }
        let answer = self.answers.pop_front()?;
        let encoder = &mut self.encoder;
        match answer {
            Answer::Ack { command, result, to } => Some(encoder.encode(&COMMAND_ACK_DATA {
                command,
                result: result as u8,
                target_system: to.system,
                target_component: to.component,
                ..COMMAND_ACK_DATA::DEFAULT
            })),
            Answer::Ping(ping) => Some(encoder.encode(&ping)),
            Answer::Timesync(sync) => Some(encoder.encode(&sync)),
            Answer::Interval { id, interval_us } => Some(encoder.encode(&MESSAGE_INTERVAL_DATA {
                interval_us,
                message_id: id,
            })),
            Answer::Parameter(place) => Some(encoder.encode(&self.parameters.value(place)?)),
            Answer::Stream(id) => stream(encoder, id, now, vehicle),
            Answer::Version => Some(encoder.encode(&make::autopilot_version())),
            // Wraps after 49 days, as the standard's field does.
            Answer::Metadata => Some(encoder.encode(&COMPONENT_METADATA_DATA {
                time_boot_ms: (now / 1000) as u32,
                file_crc: GENERAL_CRC,
                uri: GENERAL_URI.into(),
            })),
            Answer::Mode { index, all } => {
                if all && usize::from(index) < Mode::ALL.len() {
                    self.answer(Answer::Mode {
                        index: index + 1,
                        all,
                    });
                }
                Some(self.encoder.encode(&make::available_mode(index)?))
            }
        }
    }

    fn send_text(&mut self, vehicle: &Vehicle) -> Option<u32> {
        // Without room it waits, and what happens meanwhile is said by what holds then.
        if !self.budget.allows(frame_bytes::<STATUSTEXT_DATA>()) {
            return None;
        }
        let text = self.texts.next(vehicle)?;
        Some(self.encoder.encode(&text.message()))
    }

    fn send_stream(&mut self, now: u64, vehicle: &Vehicle) -> Option<u32> {
        // Each stream at most once: none that has lost its turn is looked at again at the same time.
        for _ in 0..STREAMS.len() {
            let due = self.schedule.next(now)?;
            if self.budget.allows(due.bytes + RESERVE) {
                let sent = stream(&mut self.encoder, due.id, now, vehicle);
                if sent.is_some() {
                    return sent;
                }
            }
        }
        None
    }

    fn send_file(&mut self) -> Option<u32> {
        if !self
            .budget
            .allows(frame_bytes::<FILE_TRANSFER_PROTOCOL_DATA>() + RESERVE)
        {
            return None;
        }
        let Files { ftp, reader, answer } = &mut self.files;
        let payload = answer.take().or_else(|| ftp.piece())?;
        Some(self.encoder.encode(&FILE_TRANSFER_PROTOCOL_DATA {
            target_network: 0,
            target_system: reader.system,
            target_component: reader.component,
            payload,
        }))
    }

    fn send_listed(&mut self) -> Option<u32> {
        if !self.budget.allows(frame_bytes::<PARAM_VALUE_DATA>() + RESERVE) {
            return None;
        }
        let place = self.parameters.listed()?;
        Some(self.encoder.encode(&self.parameters.value(place)?))
    }

    fn answer(&mut self, answer: Answer) {
        let _ = self.answers.push_back(answer);
    }

    fn obey(&mut self, asked: &Request, from: Peer, now: u64, vehicle: &Vehicle) {
        match asked {
            Request::Heartbeat => {
                let new = self.heard_at.is_none_or(|at| now.saturating_sub(at) > FORGOTTEN);
                self.heard_at = Some(now);
                if new {
                    self.texts.repeat();
                }
            }
            Request::Ping(ping) => {
                // An answer to another's is left alone.
                if ping.target_system == 0 && ping.target_component == 0 {
                    self.answer(Answer::Ping(PING_DATA {
                        target_system: from.system,
                        target_component: from.component,
                        ..ping.clone()
                    }));
                }
            }
            Request::Timesync(sync) => {
                if sync.tc1 == 0 {
                    self.answer(Answer::Timesync(TIMESYNC_DATA {
                        tc1: i64::try_from(now.saturating_mul(1000)).unwrap_or(i64::MAX),
                        ts1: sync.ts1,
                        target_system: from.system,
                        target_component: from.component,
                    }));
                }
            }
            Request::Command(command) => {
                let reply = self.command(command, now, vehicle);
                self.answer(Answer::Ack {
                    command: command.number,
                    result: reply.result,
                    to: from,
                });
                if let Some(answer) = reply.then {
                    self.answer(answer);
                }
            }
            Request::ParamList => self.parameters.list(),
            Request::ParamRead(read) => {
                let found = self.parameters.find(&read.param_id, read.param_index);
                self.parameter(found, Ok(()));
            }
            Request::ParamSet(set) => {
                let found = self.parameters.find(&set.param_id, -1);
                let result = found.and_then(|place| {
                    self.parameters
                        .set(place, set.param_value, set.param_type, vehicle.at_rest(), now)
                });
                self.parameter(found, result);
            }
            Request::File(file) => {
                self.files.answer = self.files.ftp.answer(&file.payload);
                self.files.reader = from;
            }
        }
    }

    /// Says the value of a parameter, and why it was not set.
    fn parameter(&mut self, found: Result<Place, Refused>, result: Result<(), Refused>) {
        if let Ok(place) = found {
            self.answer(Answer::Parameter(place));
        }
        let severity = MavSeverity::MAV_SEVERITY_WARNING;
        match found.and(result) {
            Ok(()) => (),
            Err(Refused::Unknown) => self.texts.say(severity, format_args!("no such parameter")),
            Err(Refused::Armed) => self.texts.say(severity, format_args!("parameters: disarm first")),
            Err(Refused::Type) => self
                .texts
                .say(severity, format_args!("parameters are of type REAL32")),
            Err(Refused::NotAllowed(name)) => self
                .texts
                .say(severity, format_args!("{name}: not an allowed value")),
        }
    }

    /// Obeys a command.
    fn command(&mut self, command: &Command, now: u64, vehicle: &Vehicle) -> Reply {
        let [first, second, ..] = command.params;
        match u32::from(command.number) {
            n if n == MavCmd::MAV_CMD_REQUEST_MESSAGE as u32 => once(first, second),
            n if n == MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL as u32 => {
                self.set_interval(first, second, now).into()
            }
            n if n == MavCmd::MAV_CMD_GET_MESSAGE_INTERVAL as u32 => self.get_interval(first),
            n if n == MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN as u32 => {
                self.reboot(first, now, vehicle).into()
            }
            n if n == MavCmd::MAV_CMD_PREFLIGHT_STORAGE as u32 => self.storage(first, vehicle).into(),
            _ => MavResult::MAV_RESULT_UNSUPPORTED.into(),
        }
    }

    fn set_interval(&mut self, id: f32, interval: f32, now: u64) -> MavResult {
        let Some(id) = whole(id) else {
            return MavResult::MAV_RESULT_DENIED;
        };
        let Some(stream) = STREAMS.iter().find(|stream| stream.id == id) else {
            return MavResult::MAV_RESULT_UNSUPPORTED;
        };
        let period = match whole(interval) {
            Some(0) => stream.period_ms * 1000,
            Some(period) if period >= PERIOD_MIN_US => period,
            // -1: no longer. A heartbeat is what the others know the vehicle by.
            None if interval < 0.0 && id != HEARTBEAT_DATA::ID => 0,
            _ => return MavResult::MAV_RESULT_DENIED,
        };
        match self.schedule.set_period(id, period, now) {
            Some(()) => MavResult::MAV_RESULT_ACCEPTED,
            None => MavResult::MAV_RESULT_UNSUPPORTED,
        }
    }

    fn get_interval(&mut self, id: f32) -> Reply {
        let Some(id) = whole(id).and_then(|id| u16::try_from(id).ok()) else {
            return MavResult::MAV_RESULT_DENIED.into();
        };
        let interval_us = match self.schedule.period(id.into()) {
            Some(0) => -1,
            Some(period) => i32::try_from(period).unwrap_or(i32::MAX),
            // 0: not available.
            None => 0,
        };
        Answer::Interval { id, interval_us }.into()
    }

    fn reboot(&mut self, autopilot: f32, now: u64, vehicle: &Vehicle) -> MavResult {
        match whole(autopilot) {
            Some(1) if vehicle.at_rest() => {
                self.restart_at = Some(now.saturating_add(LAST_WORDS));
                MavResult::MAV_RESULT_ACCEPTED
            }
            Some(1) => self.refuse_armed(),
            _ => MavResult::MAV_RESULT_UNSUPPORTED,
        }
    }

    fn storage(&mut self, parameters: f32, vehicle: &Vehicle) -> MavResult {
        match whole(parameters) {
            Some(1) if vehicle.at_rest() => {
                self.store_now = true;
                MavResult::MAV_RESULT_ACCEPTED
            }
            Some(1) => self.refuse_armed(),
            _ => MavResult::MAV_RESULT_UNSUPPORTED,
        }
    }

    fn refuse_armed(&mut self) -> MavResult {
        self.texts.say(
            MavSeverity::MAV_SEVERITY_WARNING,
            format_args!("refused: disarm first"),
        );
        MavResult::MAV_RESULT_TEMPORARILY_REJECTED
    }
}

/// A message that is asked for once; `index` says which of several.
fn once(id: f32, index: f32) -> Reply {
    let Some(id) = whole(id) else {
        return MavResult::MAV_RESULT_DENIED.into();
    };
    match id {
        AUTOPILOT_VERSION_DATA::ID => Answer::Version.into(),
        COMPONENT_METADATA_DATA::ID => Answer::Metadata.into(),
        AVAILABLE_MODES_DATA::ID => match whole(index) {
            Some(0) => Answer::Mode { index: 1, all: true }.into(),
            Some(index) if index as usize <= Mode::ALL.len() => Answer::Mode {
                index: index as u8,
                all: false,
            }
            .into(),
            _ => MavResult::MAV_RESULT_DENIED.into(),
        },
        id if STREAMS.iter().any(|stream| stream.id == id) => Answer::Stream(id).into(),
        _ => MavResult::MAV_RESULT_UNSUPPORTED.into(),
    }
}

/// A number of a command's field that is whole and not negative.
fn whole(value: f32) -> Option<u32> {
    let number = value as u32;
    // Beyond 2^24 a float has no room for every whole number: message numbers and µs of minutes stay below.
    ((number as f32 - value).abs() <= 0.0 && value >= 0.0).then_some(number)
}

const fn peer(frame: &Frame<'_>) -> Peer {
    Peer {
        system: frame.system,
        component: frame.component,
    }
}

/// Makes the frame of a stream; `None` where nothing fresh is known.
fn stream(encoder: &mut Encoder, id: u32, now: u64, vehicle: &Vehicle) -> Option<u32> {
    // Wraps after 49 days, as the standard's field does.
    let ms = (now / 1000) as u32;
    Some(match id {
        HEARTBEAT_DATA::ID => encoder.encode(&make::heartbeat(vehicle)),
        SYS_STATUS_DATA::ID => encoder.encode(&make::sys_status(vehicle)),
        EXTENDED_SYS_STATE_DATA::ID => encoder.encode(&make::extended_sys_state(vehicle)),
        CURRENT_MODE_DATA::ID => encoder.encode(&make::current_mode(vehicle)),
        ATTITUDE_DATA::ID => encoder.encode(&make::attitude(vehicle, ms)?),
        ATTITUDE_QUATERNION_DATA::ID => encoder.encode(&make::attitude_quaternion(vehicle, ms)?),
        SOPHIE_ARMS_DATA::ID => encoder.encode(&make::arms(vehicle, ms)),
        RC_CHANNELS_DATA::ID => encoder.encode(&make::rc_channels(vehicle, ms)),
        SERVO_OUTPUT_RAW_DATA::ID => encoder.encode(&make::servo_output_raw(vehicle, ms)),
        BATTERY_STATUS_DATA::ID => encoder.encode(&make::battery_status(vehicle)),
        SCALED_IMU_DATA::ID => encoder.encode(&make::scaled_imu(vehicle, ms)?),
        _ => return None,
    })
}
