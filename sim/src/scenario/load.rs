//! Scenarios from files, with overrides of the command line.

use std::path::Path;

use sophie_control::allocation::wrench::Configuration;
use sophie_control::pilot::rc::ArmChoice;
use sophie_mixers::Variant;

use super::error::{Place, ScenarioError, one_line};
use super::read::Source;
use super::{Assist, PositionSensor, Scenario};

/// Refuses devices and wrong files.
const MAX_BYTES: u64 = sophie_input::MIB;

/// Characters of a name that a file gives its scenario.
const NAME_MAX: usize = 80;

/// Command line settings, within the ranges of [`keys`](super::keys), override the file's vehicle; the stack's
/// parameters follow, but for the file's `[params]`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// Infill, %.
    pub infill: Option<f64>,
    /// On Eq. 1's elastic term.
    pub gain_k: Option<f64>,
    /// Sense of rotation.
    pub configuration: Option<Configuration>,
    /// Allocation.
    pub mixer: Option<Variant>,
    /// What measures the position.
    pub sensors: Option<PositionSensor>,
    /// What the pilot leaves to the vehicle.
    pub assist: Option<Assist>,
    /// Arms that close.
    pub arms: Option<ArmChoice>,
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
        set(&mut scenario.vehicle.infill, self.infill);
        set(&mut scenario.vehicle.gain_k, self.gain_k);
        set(&mut scenario.vehicle.configuration, self.configuration);
        set(&mut scenario.mixer, self.mixer);
        set(&mut scenario.arms, self.arms);
        set(&mut scenario.sensors.position, self.sensors);
        set(&mut scenario.pilot.assist, self.assist);
        set(&mut scenario.seed, self.seed);
    }
}

impl Scenario {
    /// Reads a file, whose name is the default `name`.
    ///
    /// # Errors
    /// One line: file, line, key, value, what is allowed.
    pub fn load(path: &Path, overrides: &Overrides) -> Result<Self, ScenarioError> {
        let file = path.display().to_string();
        let text = read_text(path, &file)?;
        let mut scenario = Self::parse(&text, &file, overrides)?;
        if scenario.name.is_empty() {
            let stem = path.file_stem().unwrap_or_default();
            scenario.name = one_line(&stem.to_string_lossy(), NAME_MAX);
        }
        Ok(scenario)
    }

    /// Parses a scenario; messages name `file`.
    ///
    /// # Errors
    /// As [`Scenario::load`].
    pub fn parse(text: &str, file: &str, overrides: &Overrides) -> Result<Self, ScenarioError> {
        Source { file, text }.scenario(overrides)
    }
}

/// The text of the file at `path`, which messages call `file`.
pub(super) fn read_text(path: &Path, file: &str) -> Result<String, ScenarioError> {
    let unreadable = |why: String| ScenarioError::Unreadable {
        file: file.to_owned(),
        why,
    };
    let bytes = sophie_input::read(path, MAX_BYTES)
        .map_err(|why| unreadable(format!("{why}; allowed is a TOML file")))?;
    String::from_utf8(bytes).map_err(|error| {
        let good = error
            .as_bytes()
            .get(..error.utf8_error().valid_up_to())
            .unwrap_or_default();
        let line = 1 + good.iter().filter(|b| **b == b'\n').count();
        ScenarioError::NotText {
            at: Place {
                file: file.to_owned(),
                line,
            },
        }
    })
}
