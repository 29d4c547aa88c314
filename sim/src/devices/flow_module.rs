//! The module below the vehicle on the board's serial line, and the task that reads it.

use std::cell::Cell;

use glam::DVec3;
use sophie_drivers::ground_module::GroundModule;
use sophie_tasks::ground;
use sophie_tasks::links::Links;

use crate::clock::VirtualTime;
use crate::devices::line::{Line, LinePort};
use crate::plant::Plant;
use crate::scenario::Scenario;
use crate::sensors::flow::FlowModule;
use crate::streams::Streams;

/// The module and its line.
pub struct Below {
    streams: Streams,
    lens: DVec3,
    failure: (crate::scenario::FlowFault, f64, f64),
    /// Frames a second, and the step of its ranges, m.
    sending: (Option<f64>, Option<f64>),
    /// `None` before the first millisecond, which shows where the pipe is.
    module: Option<FlowModule>,
    line: &'static Line,
    place: DVec3,
    /// From the origin of the estimate to that of the world, m, as it was with the estimate's first position.
    origin: Cell<Option<DVec3>>,
}

impl Below {
    /// The module of `scenario`, whose seed gives its errors.
    pub fn new(scenario: &Scenario) -> Self {
        let s = &scenario.sensors;
        Self {
            streams: scenario.streams(),
            lens: s.lens(),
            failure: (s.flow_fault, s.pose_fails_at, s.pose_fails_for),
            sending: (s.flow_rate, s.range_step),
            module: None,
            line: Box::leak(Box::new(Line::new())),
            place: DVec3::ZERO,
            origin: Cell::new(None),
        }
    }

    /// Spawns the board's task.
    pub fn spawn(&self, time: &VirtualTime, links: &'static Links) {
        let decoder = GroundModule::from_params(&links.params);
        time.spawn(ground::run(links, LinePort(self.line), decoder));
    }

    /// Looks down, each millisecond.
    pub fn look(&mut self, plant: &Plant) {
        let (fault, at, seconds) = self.failure;
        let (rate, step) = self.sending;
        let new = || {
            let module = FlowModule::new(self.streams, *plant.pipe(), self.lens);
            module.sending(rate, step).failing(fault, at, seconds)
        };
        self.module.get_or_insert_with(new).step(plant.pose());
        self.place = plant.pose().position;
    }

    /// An estimated position as one in the world: what it is off there is what it has drifted by since its first.
    pub fn in_world(&self, position: Option<DVec3>) -> Option<DVec3> {
        let Some(position) = position else {
            self.origin.set(None);
            return None;
        };
        let origin = self.origin.get().unwrap_or(self.place - position);
        self.origin.set(Some(origin));
        Some(origin + position)
    }

    /// Sends what is due `us` µs after power-up.
    pub fn speak(&mut self, us: u64) {
        while let Some(bytes) = self.module.as_mut().and_then(|module| module.take(us)) {
            self.line.receive(&bytes);
        }
    }

    /// Loses what is on the line, as at a reset of the board.
    pub fn reset(&self) {
        self.line.clear();
    }
}
