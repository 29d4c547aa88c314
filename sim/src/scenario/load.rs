//! Scenarios from files.

use std::path::Path;

use super::Scenario;
use super::error::{ScenarioError, one_line};
use super::overrides::Overrides;
use super::source::{Source, read_text};

/// Characters of a name that a file gives its scenario.
const NAME_MAX: usize = 80;

impl Scenario {
    /// Reads a file, whose name is the default `name`.
    ///
    /// # Errors
    /// One line: file, line, key, value, allowed values.
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
