//! A computer beside the flight stack that sends poses and the place of the pipe over MAVLink, and the line between them.

use std::cell::Cell;

use glam::{DQuat, DVec3};
use mavlink_core::{MAVLinkV2MessageRaw, MavHeader, MessageData};
use sophie_mavlink::dialect::{ATT_POS_MOCAP_DATA, LANDING_TARGET_DATA};
use sophie_ports::signing::Stored;
use sophie_tasks::ground_station::console_pipe::Shell;
use sophie_tasks::ground_station::mavlink;
use sophie_tasks::links::Links;

use crate::clock::VirtualTime;
use crate::live::Live;
use crate::live::line::{Line, LinePort};
use crate::live::stored::{Memory, Port};
use crate::plant::Plant;
use crate::scenario::Scenario;
use crate::sensors::pose::{Measured, PoseSource};

/// What the server may send, bytes each second: the budget of a line at 57,600 baud.
const BYTES_PER_SECOND: u32 = 4_608;
/// MAVLink's number of the computer: the vehicle's system, MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY.
const SYSTEM: u8 = 1;
const COMPONENT: u8 = 197;
/// MAV_FRAME of what it sends.
const LOCAL_NED: u8 = 1;

/// The computer and its line. It knows the vehicle's clock, as after TIMESYNC.
pub struct Companion {
    source: PoseSource,
    line: &'static Line,
    /// The line is also that of live clients.
    shared: bool,
    sequence: u8,
}

impl Companion {
    /// The computer of `scenario`, whose seed gives its errors. With `live` it shares the line of the clients.
    pub fn new(scenario: &Scenario, live: Option<&Live>) -> Self {
        let sensors = &scenario.sensors;
        // It knows of the pipe what the pilot does.
        let pipe = scenario.pilot.believes.pipe(&scenario.world);
        let [north, east] = pipe.position;
        let streams = scenario.streams();
        Self {
            source: PoseSource::new(streams)
                .seeing(DVec3::new(north, east, -pipe.top), streams)
                .failing(sensors.pose_fault, sensors.pose_fails_at, sensors.pose_fails_for),
            line: live.map_or_else(|| &*Box::leak(Box::new(Line::new())), Live::line),
            shared: live.is_some(),
            sequence: 0,
        }
    }

    /// Spawns the board's server on a line of its own.
    pub fn spawn(&self, time: &VirtualTime, links: &'static Links) {
        let memory: &'static Memory = Box::leak(Box::new(Memory {
            params: Cell::new(links.params),
            signing: Cell::new(None),
        }));
        let port = LinePort(self.line);
        let lines = mavlink::Lines {
            inputs: [port],
            outputs: [port],
            bytes_per_second: [BYTES_PER_SECOND],
        };
        // The computer types nothing, and orders no restart.
        let shell: &'static Shell = Box::leak(Box::default());
        time.spawn(mavlink::run(
            links,
            lines,
            shell,
            Port(memory),
            || (),
            Stored::None,
        ));
    }

    /// Takes in where the vehicle is, each millisecond.
    pub fn look(&mut self, plant: &Plant) {
        self.source.step(plant.pose());
    }

    /// Sends what is due `us` µs after power-up to a board that started `start` µs after it.
    pub fn speak(&mut self, us: u64, start: u64) {
        while let Some(measured) = self.source.take(us) {
            if let Some(at) = measured.at_us.checked_sub(start) {
                let pose = self.pose(&measured, at);
                self.line.receive(&pose);
                if let Some((crown, heading)) = measured.target {
                    let target = self.target(crown, heading, at);
                    self.line.receive(&target);
                }
            }
        }
        // No one reads what the board says on a line of its own.
        while !self.shared && self.line.said().is_some() {}
    }

    /// Loses what is on the line, as at a reset of the board.
    pub fn reset(&self) {
        self.line.clear();
    }

    /// A position in the computer's axes as one in the true axes, by what these are now.
    pub fn in_world(&self, position: DVec3) -> DVec3 {
        self.source.in_world(position)
    }

    fn pose(&mut self, measured: &Measured, at_us: u64) -> Vec<u8> {
        let [x, y, z] = measured.position.as_vec3().to_array();
        let q = measured.attitude.as_quat();
        // Not known; the zeros behind the first are not sent.
        let mut covariance = [0.0; 21];
        covariance[0] = f32::NAN;
        self.frame(&ATT_POS_MOCAP_DATA {
            time_usec: at_us,
            q: [q.w, q.x, q.y, q.z],
            x,
            y,
            z,
            covariance,
        })
    }

    fn target(&mut self, crown: DVec3, heading: f64, at_us: u64) -> Vec<u8> {
        let [x, y, z] = crown.as_vec3().to_array();
        let q = DQuat::from_rotation_z(heading).as_quat();
        self.frame(&LANDING_TARGET_DATA {
            time_usec: at_us,
            frame: LOCAL_NED,
            x,
            y,
            z,
            q: [q.w, q.x, q.y, q.z],
            position_valid: 1,
            ..LANDING_TARGET_DATA::DEFAULT
        })
    }

    fn frame(&mut self, message: &impl MessageData) -> Vec<u8> {
        self.sequence = self.sequence.wrapping_add(1);
        let mut raw = MAVLinkV2MessageRaw::new();
        let header = MavHeader {
            system_id: SYSTEM.into(),
            component_id: COMPONENT,
            sequence: self.sequence,
        };
        raw.serialize_message_data(header, message);
        raw.raw_bytes().to_vec()
    }
}
