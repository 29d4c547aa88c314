//! The flow and range module below the vehicle, with the simulated board's errors.

use sophie_sim::plant::Plant;
use sophie_sim::scenario::{PositionSensor, Scenario, Sensors};
use sophie_sim::sensors::flow::FlowModule;
use sophie_sim::streams::Streams;

/// The module, from the first millisecond on, which shows where the pipe is.
pub struct Module {
    streams: Streams,
    sensors: Sensors,
    module: Option<FlowModule>,
}

impl Module {
    /// The module of `scenario`, where it has one.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Option<Self> {
        (scenario.sensors.position == PositionSensor::Flow).then(|| Self {
            streams: scenario.streams(),
            sensors: scenario.sensors,
            module: None,
        })
    }

    /// Looks down, each millisecond.
    pub fn look(&mut self, plant: &Plant) {
        let s = self.sensors;
        let new = || {
            let module = FlowModule::new(self.streams, *plant.pipe(), s.lens());
            let module = module.sending(s.flow_rate, s.range_step);
            module.failing(s.flow_fault, s.pose_fails_at, s.pose_fails_for)
        };
        self.module.get_or_insert_with(new).step(plant.pose());
    }

    /// The bytes that have come `us` µs after power-up.
    pub fn speaks(&mut self, us: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        while let Some(frames) = self.module.as_mut().and_then(|module| module.take(us)) {
            bytes.extend(frames);
        }
        bytes
    }
}
