//! The companion computer, which sends poses and the position of the pipe over MAVLink, with its line to the board.

use std::cell::Cell;

use glam::{DQuat, DVec3};
use mavlink_core::{MAVLinkV2MessageRaw, MavHeader, MessageData};
use sophie_dialect::{ATT_POS_MOCAP_DATA, LANDING_TARGET_DATA};
use sophie_tasks::links::Links;

use super::chip::ThisChip;
use super::line::Line;
use super::mavlink_server;
use super::storage::Memory;
use crate::clock::VirtualTime;
use crate::plant::Plant;
use crate::scenario::Scenario;
use crate::sensors::pose::{Measured, PoseSource};

/// Output limit of the server, bytes per second: the budget of a line at 57,600 baud.
const BYTES_PER_SECOND: u32 = 4_608;
/// MAVLink address of the computer: the vehicle's system, component MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY.
const SYSTEM: u8 = 1;
const COMPONENT: u8 = 197;
/// MAV_FRAME of its messages.
const LOCAL_NED: u8 = 1;

/// The computer and its line. Its clock is synchronised with the vehicle's, as after TIMESYNC.
pub struct Companion {
    source: PoseSource,
    line: &'static Line,
    /// The line is also that of live clients.
    shared: bool,
    sequence: u8,
}

impl Companion {
    /// The computer of `scenario`, whose seed sets its errors. It sends on `shared`, or on a line of its own.
    pub fn new(scenario: &Scenario, shared: Option<&'static Line>) -> Self {
        let sensors = &scenario.sensors;
        // It assumes the same pipe as the pilot.
        let pipe = scenario.pilot.assumed.pipe(&scenario.world);
        let [north, east] = pipe.position;
        let streams = scenario.streams();
        let world = &scenario.world;
        let spot = DVec3::new(world.pipe_position[0], world.pipe_position[1], -world.pipe_top);
        Self {
            source: PoseSource::new(streams)
                .seeing(DVec3::new(north, east, -pipe.top), streams)
                .tagged(spot, &sensors.tag(), streams)
                .failing(sensors.pose_fault, sensors.pose_fails_at, sensors.pose_fails_for),
            line: shared.unwrap_or_else(|| Box::leak(Box::new(Line::new()))),
            shared: shared.is_some(),
            sequence: 0,
        }
    }

    /// Spawns the board's server on the computer's own line, where no client can order a restart.
    pub fn spawn(&self, time: &VirtualTime, links: &'static Links) {
        let memory: &'static Memory = Box::leak(Box::new(Memory {
            params: Cell::new(links.params),
            signing: Cell::new(None),
        }));
        mavlink_server::spawn(
            time,
            links,
            self.line,
            BYTES_PER_SECOND,
            memory,
            ThisChip(self.line),
        );
    }

    /// Samples the vehicle's pose. Call it each millisecond.
    pub fn step(&mut self, plant: &Plant) {
        self.source.step(plant.pose());
    }

    /// Sends the messages due `us` µs after power-up. Their time stamps count from the board's start, `start` µs after
    /// power-up.
    pub fn send(&mut self, us: u64, start: u64) {
        while let Some(measured) = self.source.take(us) {
            if let Some(at) = measured.at_us.checked_sub(start) {
                let pose = self.pose(&measured, at);
                self.line.receive(&pose);
                if let Some((crown_position, heading)) = measured.target {
                    let target = self.target(crown_position, heading, at);
                    self.line.receive(&target);
                }
            }
        }
        // Discard the board's output on a line without clients.
        while !self.shared && self.line.take_write().is_some() {}
    }

    /// Discards the bytes on the line, as a reset of the board does.
    pub fn reset(&self) {
        self.line.clear();
    }

    /// Converts a position from the computer's present axes to world axes, m.
    pub fn in_world(&self, position: DVec3) -> DVec3 {
        self.source.in_world(position)
    }

    fn pose(&mut self, measured: &Measured, at_us: u64) -> Vec<u8> {
        let [x, y, z] = measured.position.as_vec3().to_array();
        let q = measured.attitude.as_quat();
        // Unknown covariance; MAVLink truncates the trailing zeros.
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

    fn target(&mut self, crown_position: DVec3, heading: f64, at_us: u64) -> Vec<u8> {
        let [x, y, z] = crown_position.as_vec3().to_array();
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
