//! A ground station beside a server.

use mavlink_core::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, MessageData};
use sophie_control::calibration::procedure::{Procedure, Readings};
use sophie_control::chain::Attitude;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_dialect::{COMMAND_ACK_DATA, COMMAND_LONG_DATA, MavCmd, STATUSTEXT_DATA};
use sophie_mavlink::inputs::Inputs;
use sophie_mavlink::{Condition, Order, Server, Signing, Vehicle};
use sophie_ports::signing::Stored;

/// Plenty for every stream at its own rate.
pub const PLENTY: u32 = 5000;
/// The period of the task that serves a line, µs.
pub const PERIOD: u64 = 20_000;

/// A vehicle at rest that nothing is wrong with.
pub fn vehicle(mode: Mode) -> Vehicle {
    let attitude = Attitude {
        q: Quat::default(),
        accel: Vec3::new(0.0, 0.0, -9.80665),
        calibrated: true,
        ..Attitude::default()
    };
    Vehicle {
        condition: Some(Condition {
            mode,
            ..Condition::default()
        }),
        attitude: Some(attitude),
        readings: Readings {
            attitude: Some((0, attitude)),
            ..Readings::default()
        },
        sticks: Some(sophie_control::pilot::rc::Sticks::default()),
        battery: Some(sophie_control::battery::Battery {
            voltage: 15.2,
            ..Default::default()
        }),
        capacity: 6480.0,
        vibration: Some(sophie_control::vibration::Vibration::default()),
        ..Vehicle::default()
    }
}

/// A frame of `message` from system 255, component 190.
pub fn frame<M: MessageData>(message: &M) -> Vec<u8> {
    frame_from(255, message)
}

/// A frame of `message` from `system`.
pub fn frame_from<M: MessageData>(system: u8, message: &M) -> Vec<u8> {
    frame_by(system, 190, message)
}

/// A frame of `message` from `component` of `system`.
pub fn frame_by<M: MessageData>(system: u8, component: u8, message: &M) -> Vec<u8> {
    let mut raw = MAVLinkV2MessageRaw::new();
    let header = MavHeader {
        system_id: system.into(),
        component_id: component,
        sequence: 0,
    };
    raw.serialize_message_data(header, message);
    raw.raw_bytes().to_vec()
}

/// What the server has sent: the message's number, its payload and its whole length.
#[derive(Clone, Debug, PartialEq)]
pub struct Sent {
    pub at: u64,
    pub id: u32,
    pub payload: Vec<u8>,
    pub bytes: usize,
    pub signed: bool,
}

pub struct Station {
    pub server: Server,
    pub signing: Signing,
    pub inputs: Inputs,
    pub procedure: Procedure,
    pub vehicle: Vehicle,
    pub now: u64,
    pub sent: Vec<Sent>,
    pub orders: Vec<Order>,
}

impl Station {
    pub fn new() -> Self {
        Self::with(PLENTY)
    }

    pub fn with(bytes_per_second: u32) -> Self {
        Self {
            server: Server::new(Params::DEFAULT, bytes_per_second),
            signing: Signing::new(Stored::None),
            inputs: Inputs::new(&Params::DEFAULT),
            procedure: Procedure::new(),
            vehicle: vehicle(Mode::Disarmed),
            now: 0,
            sent: Vec::new(),
            orders: Vec::new(),
        }
    }

    /// The server's periods for `ms`.
    pub fn run(&mut self, ms: u64) {
        for _ in 0..ms * 1000 / PERIOD {
            self.now += PERIOD;
            while let Some(frame) =
                (self.server).send(self.now, &self.vehicle, &mut self.signing, &mut self.inputs)
            {
                let length = usize::from(frame[1]);
                let signed = frame[2] == 1;
                assert_eq!(frame.len(), length + 12 + if signed { 13 } else { 0 });
                self.sent.push(Sent {
                    at: self.now,
                    id: u32::from_le_bytes([frame[7], frame[8], frame[9], 0]),
                    payload: frame[10..10 + length].to_vec(),
                    bytes: frame.len(),
                    signed,
                });
            }
            self.orders.extend(self.server.order(
                self.now,
                &self.vehicle,
                &Params::DEFAULT,
                &mut self.procedure,
            ));
        }
    }

    pub fn say(&mut self, bytes: &[u8]) {
        self.server.receive(
            bytes,
            self.now,
            &self.vehicle,
            &mut self.signing,
            &mut self.inputs,
            &mut self.procedure,
        );
    }

    /// Every message of one kind since the start.
    pub fn got<M: MessageData>(&self) -> Vec<M> {
        self.since(0)
    }

    /// Every message of one kind behind the first `count` of all.
    pub fn since<M: MessageData>(&self, count: usize) -> Vec<M> {
        let of = self.sent.iter().skip(count).filter(|sent| sent.id == M::ID);
        of.map(|sent| M::deser(MavlinkVersion::V2, &sent.payload).unwrap())
            .collect()
    }

    pub fn texts(&self) -> Vec<String> {
        let texts = self.got::<STATUSTEXT_DATA>();
        texts
            .iter()
            .map(|text| text.text.to_str().unwrap().to_string())
            .collect()
    }

    /// Sends a command and gives the result that was acknowledged.
    pub fn command(&mut self, command: MavCmd, params: [f32; 2]) -> Vec<u8> {
        self.command_to(1, 1, command as u16, params)
    }

    pub fn command_to(&mut self, system: u8, component: u8, command: u16, params: [f32; 2]) -> Vec<u8> {
        self.sent.clear();
        self.say(&frame(&COMMAND_LONG_DATA {
            param1: params[0],
            param2: params[1],
            command,
            target_system: system,
            target_component: component,
            ..Default::default()
        }));
        self.run(100);
        let acks = self.got::<COMMAND_ACK_DATA>();
        for ack in &acks {
            assert_eq!(
                (ack.command, ack.target_system, ack.target_component),
                (command, 255, 190)
            );
        }
        acks.iter().map(|ack| ack.result).collect()
    }
}
