//! The flow and range module below the vehicle, and its serial line to the board.

use std::cell::Cell;

use glam::DVec3;
use sophie_drivers::ground_module::GroundModule;
use sophie_tasks::links::Links;
use sophie_tasks::navigation::flow_range;

use super::line::{Line, LinePort};
use crate::clock::VirtualTime;
use crate::plant::Plant;
use crate::scenario::{PositionSensor, Scenario, Sensors};
use crate::sensors::flow::{FlowModule, Optics};
use crate::streams::Streams;

/// The module of a scenario: sees the plant each millisecond and sends frames.
pub struct FlowSender {
    streams: Streams,
    sensors: Sensors,
    optics: Optics,
    /// `None` until the first millisecond gives the position of the pipe.
    module: Option<FlowModule>,
}

impl FlowSender {
    /// The module of `scenario`, whose seed sets its errors; `None` if the scenario has another position sensor.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Option<Self> {
        (scenario.sensors.position == PositionSensor::Flow).then(|| Self {
            streams: scenario.streams(),
            sensors: scenario.sensors,
            optics: scenario.world.optics,
            module: None,
        })
    }

    /// Samples the plant. Call it each millisecond.
    pub fn step(&mut self, plant: &Plant) {
        let s = self.sensors;
        let new = || {
            let module = FlowModule::new(self.streams, *plant.pipe(), s.lens());
            let module = module
                .sending(s.flow_rate, s.range_step)
                .looking(self.optics, &s.flow_errors());
            module.failing(s.flow_fault, s.pose_fails_at, s.pose_fails_for)
        };
        self.module.get_or_insert_with(new).step(plant.pose());
    }

    /// The oldest frame that is complete on the line `us` µs after power-up.
    pub fn take(&mut self, us: u64) -> Option<Vec<u8>> {
        self.module.as_mut()?.take(us)
    }
}

/// The module on a line of the simulated board.
pub(crate) struct FlowLine {
    sender: FlowSender,
    line: &'static Line,
    position: DVec3,
    /// World position of the estimate's origin, m, fixed at the estimate's first position.
    origin: Cell<Option<DVec3>>,
}

impl FlowLine {
    /// The line of `sender`.
    pub fn new(sender: FlowSender) -> Self {
        Self {
            sender,
            line: Box::leak(Box::new(Line::new())),
            position: DVec3::ZERO,
            origin: Cell::new(None),
        }
    }

    /// Spawns the task that reads the line.
    pub fn spawn(&self, time: &VirtualTime, links: &'static Links) {
        let decoder = GroundModule::from_params(&links.params);
        time.spawn(flow_range::run(links, LinePort(self.line), decoder));
    }

    /// Samples the plant. Call it each millisecond.
    pub fn step(&mut self, plant: &Plant) {
        self.sender.step(plant);
        self.position = plant.pose().position;
    }

    /// An estimated position in world axes, m. Its error is the drift since the first estimate; a call with `None`
    /// forgets the origin.
    pub fn in_world(&self, position: Option<DVec3>) -> Option<DVec3> {
        let Some(position) = position else {
            self.origin.set(None);
            return None;
        };
        let origin = self.origin.get().unwrap_or(self.position - position);
        self.origin.set(Some(origin));
        Some(origin + position)
    }

    /// Puts the frames due `us` µs after power-up on the line.
    pub fn send(&mut self, us: u64) {
        while let Some(bytes) = self.sender.take(us) {
            self.line.receive(&bytes);
        }
    }

    /// Discards the bytes on the line, as a reset of the board does.
    pub fn reset(&self) {
        self.line.clear();
    }
}
