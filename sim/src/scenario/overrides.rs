//! Settings of the command line that override a scenario file.

use sophie_control::allocation::wrench::Configuration;
use sophie_control::pilot::rc::ArmChoice;
use sophie_mixers::Variant;

use super::{Assist, Known, PositionSensor, Rule, Scenario};

/// Command line settings, within the ranges of [`keys`](super::keys), override the file's vehicle; the stack's
/// parameters follow, but for the file's `[params]`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// How far the parameters follow the vehicle.
    pub known: Option<Known>,
    /// Infill, %.
    pub infill: Option<f64>,
    /// Gain K on Eq. 1's elastic term.
    pub gain_k: Option<f64>,
    /// Sense of rotation.
    pub configuration: Option<Configuration>,
    /// Allocation.
    pub mixer: Option<Variant>,
    /// Sensor of the position.
    pub sensors: Option<PositionSensor>,
    /// Assistance by the vehicle's modes.
    pub assist: Option<Assist>,
    /// Arms that close.
    pub arms: Option<ArmChoice>,
    /// Rule of the judge.
    pub judge: Option<Rule>,
    /// Seed.
    pub seed: Option<u64>,
}

impl Overrides {
    pub(super) fn apply(&self, scenario: &mut Scenario) {
        fn set<T: Copy>(to: &mut T, from: Option<T>) {
            if let Some(value) = from {
                *to = value;
            }
        }
        set(&mut scenario.known, self.known);
        set(&mut scenario.vehicle.infill, self.infill);
        set(&mut scenario.vehicle.gain_k, self.gain_k);
        set(&mut scenario.vehicle.configuration, self.configuration);
        set(&mut scenario.mixer, self.mixer);
        set(&mut scenario.arms, self.arms);
        set(&mut scenario.sensors.position, self.sensors);
        set(&mut scenario.pilot.assist, self.assist);
        set(&mut scenario.judge, self.judge);
        set(&mut scenario.seed, self.seed);
    }
}
