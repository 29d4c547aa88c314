//! The server of one link: what arrives becomes answers and orders, what is due becomes frames.

mod send;

use mavlink_core::MessageData;
use sophie_control::mode::Mode;
use sophie_control::params::Params;

use crate::inputs::{Inputs, pose};
use crate::services::Services;
use crate::services::answer::Answer;
use crate::services::commands::orders::Requests;
use crate::services::parameters::{Place, Refused};
use crate::services::shell::Shell;
use crate::vehicle::Vehicle;
use crate::wire::budget::Budget;
use crate::wire::frame::{Encoder, Frame};
use crate::wire::parser::Parser;
use crate::wire::requests::{Peer, Request, request};
use crate::wire::signing::Signing;
use sophie_dialect::*;

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

/// The server of one link.
pub struct Server {
    /// Number of the line in signatures.
    line: u8,
    parser: Parser,
    encoder: Encoder,
    budget: Budget,
    services: Services,
    mode: Option<Mode>,
    /// When another's heartbeat came last, µs.
    heard_at: Option<u64>,
}

impl Server {
    /// Before the first byte of a line that may take `bytes_per_second`, with `params` in force.
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

    /// The same as number `line` of the vehicle's lines, each of which signs under its own.
    #[must_use]
    pub const fn numbered(mut self, line: u8) -> Self {
        self.line = line;
        self
    }

    /// Takes over `params`, which were set or stored on another line.
    pub const fn follow(&mut self, params: &Params) {
        self.services.parameters.follow(params);
    }

    /// Takes `bytes` that arrived at `now`, µs since the start, as far as `signing` lets it. What others measured goes into the
    /// `inputs` of all lines.
    pub fn receive(
        &mut self,
        bytes: &[u8],
        now: u64,
        vehicle: &Vehicle,
        signing: &mut Signing,
        inputs: &mut Inputs,
    ) {
        for &byte in bytes {
            let Some(frame) = self.parser.push(byte, now) else {
                continue;
            };
            // What is for others is not judged: their keys are theirs.
            if let Some(asked) = request(&frame)
                && signing.takes(&frame, now)
            {
                let peer = peer(&frame);
                self.obey(&asked, peer, now, vehicle, inputs);
            }
        }
    }

    /// What is to be done at `now`, µs since the start.
    pub fn order(&mut self, now: u64, vehicle: &Vehicle) -> Option<Order> {
        self.services.continue_calibration(now, vehicle);
        self.services.shell.expire(now);
        if self.services.restart_at.is_some_and(|at| now >= at) {
            self.services.restart_at = None;
            return vehicle.at_rest().then_some(Order::Restart);
        }
        let asked = core::mem::take(&mut self.services.store_now);
        let store = asked | self.services.parameters.to_store(vehicle.at_rest(), now);
        store.then_some(Order::Store)
    }

    /// What is to be sent to the commander at `now`, µs since the start, given what it has answered.
    pub fn requests(&mut self, now: u64, vehicle: &Vehicle) -> Requests {
        self.services.requests(now, vehicle)
    }

    /// The parameters as they are to be stored.
    pub const fn params(&self) -> &Params {
        self.services.parameters.copy()
    }

    /// Takes what became of [`Order::Store`].
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

    /// The console's far end.
    pub const fn shell(&mut self) -> &mut Shell {
        &mut self.services.shell
    }

    fn obey(&mut self, asked: &Request, from: Peer, now: u64, vehicle: &Vehicle, inputs: &mut Inputs) {
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
                // An answer to another's is left alone.
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
                if let Some(reply) = self.services.command(command, from, now, vehicle) {
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

    /// Says the value of a parameter, and why it was not set.
    fn parameter(&mut self, found: Result<Place, Refused>, result: Result<(), Refused>) {
        if let Ok(place) = found {
            self.services.answer(Answer::Parameter(place));
        }
        let severity = MavSeverity::MAV_SEVERITY_WARNING;
        match found.and(result) {
            Ok(()) => (),
            Err(Refused::Unknown) => self
                .services
                .texts
                .say(severity, format_args!("no such parameter")),
            Err(Refused::Armed) => self
                .services
                .texts
                .say(severity, format_args!("parameters: disarm first")),
            Err(Refused::Type) => self
                .services
                .texts
                .say(severity, format_args!("parameters are of type REAL32")),
            Err(Refused::NotAllowed(name)) => self
                .services
                .texts
                .say(severity, format_args!("{name}: not an allowed value")),
        }
    }
}

/// Takes what `from` has measured or wished; true where it is to be asked for its time.
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
