//! The server of one line: it turns received frames into answers and orders, and sends the frames that are due.

mod send;

use mavlink_core::MessageData;
use sophie_control::calibration::procedure::Procedure;
use sophie_control::mode::Mode;
use sophie_control::params::Params;

use crate::inputs::{Inputs, pose};
use crate::services::Services;
use crate::services::answer::Answer;
use crate::services::commands::Received;
use crate::services::commands::orders::CommanderRequests;
use crate::services::commands::report::{Report, Row};
use crate::services::parameters::{Place, SetError};
use crate::services::shell::Shell;
use crate::vehicle::Vehicle;
use crate::wire::budget::Budget;
use crate::wire::frame::{Encoder, Frame};
use crate::wire::parser::Parser;
use crate::wire::requests::{Peer, Request, request};
use crate::wire::signing::Signing;
use sophie_dialect::*;

/// Silence of all stations after which the next heartbeat counts as a new station's, µs.
const FORGOTTEN: u64 = 5_000_000;

/// An order to the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Store [`Server::params`], then report the result to [`Server::stored`].
    Store,
    /// Restart the board.
    Restart,
    /// Make the row of the report with this number, from 0, for [`Server::row`].
    Row(Report, u8),
    /// Set the chip's brown-out level and give the result to [`Server::brown_out_done`].
    SetBrownOut,
}

/// The server of one line.
pub struct Server {
    /// Number of the line in signatures.
    line: u8,
    parser: Parser,
    encoder: Encoder,
    budget: Budget,
    services: Services,
    mode: Option<Mode>,
    /// Time of the newest heartbeat of a station, µs.
    heard_at: Option<u64>,
}

impl Server {
    /// A server before the first byte: the line takes `bytes_per_second`, and `params` are in force.
    pub const fn new(params: Params, bytes_per_second: u32) -> Self {
        Self {
            line: 0,
            parser: Parser::new(),
            encoder: Encoder::new(),
            budget: Budget::new(bytes_per_second),
            services: Services::new(params),
            mode: None,
            heard_at: None,
        }
    }

    /// This server as number `line` of the vehicle's lines; each line signs under its own number.
    #[must_use]
    pub const fn numbered(mut self, line: u8) -> Self {
        self.line = line;
        self
    }

    /// Takes over `params` that another line has set or stored.
    pub const fn follow(&mut self, params: &Params) {
        self.services.parameters.follow(params);
    }

    /// Takes `bytes` that arrived at `now`, µs since the start. `signing` decides which frames are obeyed. Measurements
    /// go into `inputs`, calibrations run in `procedure`; all lines share both.
    pub fn receive(
        &mut self,
        bytes: &[u8],
        now: u64,
        vehicle: &Vehicle,
        signing: &mut Signing,
        inputs: &mut Inputs,
        procedure: &mut Procedure,
    ) {
        for &byte in bytes {
            let Some(frame) = self.parser.push(byte, now) else {
                continue;
            };
            // Frames for other vehicles are not checked: their keys are not known here.
            if let Some(asked) = request(&frame)
                && signing.takes(&frame, now)
            {
                let peer = peer(&frame);
                self.obey(&asked, peer, now, vehicle, inputs, procedure);
            }
        }
    }

    /// The order to the board that is due at `now`, µs since the start; the parameters `in_force` are those of the start.
    pub fn order(
        &mut self,
        now: u64,
        vehicle: &Vehicle,
        in_force: &Params,
        procedure: &mut Procedure,
    ) -> Option<Order> {
        self.services
            .continue_calibration(now, vehicle, in_force, procedure);
        self.services.shell.expire(now);
        if self.services.restart_at.is_some_and(|at| now >= at) {
            self.services.restart_at = None;
            return vehicle.at_rest().then_some(Order::Restart);
        }
        let asked = core::mem::take(&mut self.services.store_now);
        if asked | self.services.parameters.to_store(vehicle.at_rest(), now) {
            return Some(Order::Store);
        }
        if core::mem::take(&mut self.services.set_brown_out) {
            return Some(Order::SetBrownOut);
        }
        let row = self.services.next_row();
        row.map(|(report, number)| Order::Row(report, number))
    }

    /// Takes the row of [`Order::Row`], of so many `rows`; `None` ends the report.
    pub fn row(&mut self, row: Option<Row>, rows: u8) {
        self.services.take_row(row, rows);
    }

    /// Takes the result of [`Order::SetBrownOut`]. After a success the board restarts once the acknowledgement is sent.
    pub fn brown_out_done(&mut self, result: Result<(), &'static str>) {
        self.services.brown_out_done(result);
    }

    /// The requests to the commander at `now`, µs since the start. Each is repeated until the commander answers it in
    /// `vehicle`.
    pub fn requests(&mut self, now: u64, vehicle: &Vehicle) -> CommanderRequests {
        self.services.requests(now, vehicle)
    }

    /// The parameters to store.
    pub const fn params(&self) -> &Params {
        self.services.parameters.copy()
    }

    /// Takes the result of [`Order::Store`] and reports it as a text.
    pub fn stored(&mut self, result: Result<(), &'static str>) {
        match result {
            Ok(()) => self.services.texts.say(
                MavSeverity::MAV_SEVERITY_NOTICE,
                format_args!("parameters stored: in force after a restart"),
            ),
            Err(why) => self.services.texts.say(
                MavSeverity::MAV_SEVERITY_ERROR,
                format_args!("parameters not stored: {why}"),
            ),
        }
    }

    /// The station's end of the console.
    pub const fn shell(&mut self) -> &mut Shell {
        &mut self.services.shell
    }

    fn obey(
        &mut self,
        asked: &Request,
        from: Peer,
        now: u64,
        vehicle: &Vehicle,
        inputs: &mut Inputs,
        procedure: &mut Procedure,
    ) {
        if measured(inputs, asked, from, now) {
            self.services.answer(Answer::AskTime(from));
        }
        match asked {
            Request::Heartbeat => {
                let new = self.heard_at.is_none_or(|at| now.saturating_sub(at) > FORGOTTEN);
                self.heard_at = Some(now);
                self.services.shell.hear(from, now);
                if new {
                    self.services.texts.repeat();
                }
            }
            Request::Ping(ping) => {
                // A ping with a target is an answer.
                if ping.target_system == 0 && ping.target_component == 0 {
                    self.services.answer(Answer::Ping(PING_DATA {
                        target_system: from.system,
                        target_component: from.component,
                        ..ping.clone()
                    }));
                }
            }
            Request::Timesync(sync) => {
                if sync.tc1 == 0 {
                    self.services.answer(Answer::Timesync(TIMESYNC_DATA {
                        tc1: i64::try_from(now.saturating_mul(1000)).unwrap_or(i64::MAX),
                        ts1: sync.ts1,
                        target_system: from.system,
                        target_component: from.component,
                    }));
                } else {
                    inputs.clocks.answer(from, sync.tc1, sync.ts1, now);
                }
            }
            Request::Odometry(_)
            | Request::Vision(_)
            | Request::Mocap(_)
            | Request::Flow(_)
            | Request::Range(_)
            | Request::PipeTarget(_) => (),
            Request::Command(command) => {
                let received = Received {
                    command,
                    from,
                    now,
                    vehicle,
                };
                if let Some(reply) = self.services.command(&received, procedure) {
                    self.services.acknowledge(command.number, from, reply.result, 0);
                    if let Some(answer) = reply.then {
                        self.services.answer(answer);
                    }
                }
            }
            Request::ParamList => self.services.parameters.list(),
            Request::ParamRead(read) => {
                let found = self.services.parameters.find(&read.param_id, read.param_index);
                self.parameter(found, Ok(()));
            }
            Request::ParamSet(set) => {
                let found = self.services.parameters.find(&set.param_id, -1);
                let result = found.and_then(|place| {
                    self.services.parameters.set(
                        place,
                        set.param_value,
                        set.param_type,
                        vehicle.at_rest(),
                        now,
                    )
                });
                self.parameter(found, result);
            }
            Request::SetupSigning => self.services.texts.say(
                MavSeverity::MAV_SEVERITY_WARNING,
                format_args!("signing key refused: console only"),
            ),
            Request::File(file) => self.services.ftp.ask(from, &file.payload),
            Request::Serial(serial) => self.services.shell.obey(serial, from, now),
        }
    }

    /// Sends the value of a parameter, and a text if it was not set.
    fn parameter(&mut self, found: Result<Place, SetError>, result: Result<(), SetError>) {
        if let Ok(place) = found {
            self.services.answer(Answer::Parameter(place));
        }
        let severity = MavSeverity::MAV_SEVERITY_WARNING;
        match found.and(result) {
            Ok(()) => (),
            Err(SetError::Unknown) => self
                .services
                .texts
                .say(severity, format_args!("no such parameter")),
            Err(SetError::Armed) => self
                .services
                .texts
                .say(severity, format_args!("parameters: disarm first")),
            Err(SetError::Type) => self
                .services
                .texts
                .say(severity, format_args!("parameters are of type REAL32")),
            Err(SetError::NotAllowed(name)) => self
                .services
                .texts
                .say(severity, format_args!("{name}: not an allowed value")),
        }
    }
}

/// Hands a measurement of `from` to the inputs; true if its sender must be asked for its time.
fn measured(inputs: &mut Inputs, said: &Request, from: Peer, now: u64) -> bool {
    match said {
        Request::Odometry(m) => inputs.pose(pose::odometry(m), ODOMETRY_DATA::ID, m.time_usec, from, now),
        Request::Vision(m) => {
            let id = VISION_POSITION_ESTIMATE_DATA::ID;
            inputs.pose(pose::vision(m), id, m.usec, from, now)
        }
        Request::Mocap(m) => inputs.pose(pose::mocap(m), ATT_POS_MOCAP_DATA::ID, m.time_usec, from, now),
        Request::Flow(m) => inputs.flow(m, from, now),
        Request::Range(m) => inputs.range(m, from, now),
        Request::PipeTarget(m) => inputs.target(m, from, now),
        _ => false,
    }
}

const fn peer(frame: &Frame<'_>) -> Peer {
    Peer {
        system: frame.system,
        component: frame.component,
    }
}
