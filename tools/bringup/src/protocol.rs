//! The record of a bring-up: a TOML file, readable by people, which the next run continues.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::STEPS;
use super::date::now;
use sophie_board_link::{Failure, file};

/// First lines of the file.
const HEAD: &str = "# Protocol of a bring-up, written after each step by `sophie bringup`. The next run with this file\n\
                    # continues with the first step that has not passed; --again STEP repeats one.\n";
/// Largest file that is read, bytes.
const LARGEST: u64 = sophie_input::MIB;

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Result {
    /// Passed.
    Passed,
    /// Failed.
    Failed,
    /// Skipped by the builder.
    Skipped,
    /// Left out by the builder, who has read what that costs.
    #[serde(rename = "left out")]
    LeftOut,
}

/// A step's entry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Its name.
    pub id: String,
    /// Its title.
    pub title: String,
    /// How it has ended.
    pub result: Result,
    /// Time of its end, UTC.
    pub at: String,
    /// The results, line by line.
    pub figures: Vec<String>,
    /// The firmware of the board; empty if unknown.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub build: String,
    /// Parameters that the step has stored.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, f64>,
    /// Numbers of one part, of several of which a parameter is the mean, by the parameter's name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub measured: BTreeMap<String, f64>,
}

/// Identity of the board and its firmware.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Firmware and board.
    pub firmware: String,
    /// The image and its table of parameters.
    pub build: String,
    /// The chip's revision.
    pub chip: String,
}

/// The content of the file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Content {
    /// The open steps, in words.
    state: String,
    /// Firmware and board.
    firmware: String,
    /// The image and its table of parameters; empty in a file of an earlier program.
    #[serde(default)]
    build: String,
    /// The chip's revision.
    chip: String,
    /// Times of its begin and of its last write, UTC.
    begun: String,
    written: String,
    #[serde(default, rename = "step")]
    steps: Vec<Entry>,
}

/// A protocol with its file.
#[derive(Debug, Default)]
pub struct Protocol {
    path: PathBuf,
    content: Content,
}

impl Protocol {
    /// Reads the file at `path`; begins a new protocol if the file is missing.
    ///
    /// # Errors
    /// One line: the file cannot be read, or is not a protocol.
    pub fn open(path: &Path) -> std::result::Result<Self, Failure> {
        let refused = |why: &str| Failure::Input(format!("{}: {why}", path.display()));
        let fresh = Content {
            begun: now(),
            ..Content::default()
        };
        match fs::metadata(path) {
            Ok(metadata) if !metadata.is_file() => return Err(refused("is no file")),
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Ok(Self {
                    path: path.to_owned(),
                    content: fresh,
                });
            }
            Err(error) => return Err(refused(&format!("cannot be read: {error}"))),
        }
        let text = sophie_input::read_text(path, LARGEST)
            .map_err(|why| refused(&format!("is no protocol of a bring-up: {why}")))?;
        let content: Content = toml::from_str(&text).map_err(|error| {
            let why = error.message().lines().next().unwrap_or_default();
            refused(&format!("is no protocol of a bring-up: {why}; name another file"))
        })?;
        if let Some(entry) = content
            .steps
            .iter()
            .find(|entry| STEPS.iter().all(|step| step.id != entry.id))
        {
            return Err(refused(&format!(
                "has a step '{}' that this program does not know",
                entry.id
            )));
        }
        Ok(Self {
            path: path.to_owned(),
            content,
        })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Notes firmware and chip; returns a warning if earlier steps were done with another image.
    ///
    /// # Errors
    /// One line: the file belongs to another board.
    pub fn identify(&mut self, board: Identity) -> std::result::Result<Option<String>, Failure> {
        let Identity {
            firmware,
            build,
            chip,
        } = board;
        let of = |firmware: &str| {
            firmware
                .rsplit_once(" on ")
                .map_or("", |(_, board)| board)
                .to_owned()
        };
        let old = &self.content;
        let other = of(&old.firmware) != of(&firmware) || old.chip != chip;
        if !old.firmware.is_empty() && other {
            return Err(Failure::Input(format!(
                "{}: is the protocol of {}, {}; this is {firmware}, {chip}: name another file",
                self.path.display(),
                old.firmware,
                old.chip
            )));
        }
        let before = std::mem::replace(&mut self.content.build, build);
        let build = &self.content.build;
        let changed = (!self.content.steps.is_empty() && before != *build).then(|| {
            let before = if before.is_empty() {
                "build unknown"
            } else {
                &before
            };
            format!("Another image than before: the last run was at {before}, this board has {build}")
        });
        (self.content.firmware, self.content.chip) = (firmware, chip);
        Ok(changed)
    }

    /// Firmware of the board.
    pub fn build(&self) -> &str {
        &self.content.build
    }

    /// Entry of the step `id`.
    pub fn entry(&self, id: &str) -> Option<&Entry> {
        self.content.steps.iter().find(|entry| entry.id == id)
    }

    /// What the passed steps have measured of parts, by step.
    pub fn measured(&self) -> BTreeMap<String, BTreeMap<String, f64>> {
        let passed = self
            .content
            .steps
            .iter()
            .filter(|entry| entry.result == Result::Passed);
        passed
            .map(|entry| (entry.id.clone(), entry.measured.clone()))
            .collect()
    }

    /// The step `id` has passed.
    pub fn passed(&self, id: &str) -> bool {
        self.entry(id).is_some_and(|entry| entry.result == Result::Passed)
    }

    /// The step `id` is optional, and left out.
    pub fn left_out(&self, id: &str) -> bool {
        self.entry(id)
            .is_some_and(|entry| entry.result == Result::LeftOut)
    }

    /// Names of the steps that have neither passed nor are left out.
    pub fn open_steps(&self) -> Vec<&'static str> {
        let done = |id| self.passed(id) || self.left_out(id);
        let open = STEPS.iter().filter(|step| !done(step.id));
        open.map(|step| step.id).collect()
    }

    /// Inserts an entry and writes the file.
    ///
    /// # Errors
    /// One line: the file cannot be written.
    pub fn put(&mut self, entry: Entry) -> std::result::Result<(), Failure> {
        self.note(entry);
        self.write()
    }

    /// Inserts an entry, in memory only.
    pub(super) fn note(&mut self, entry: Entry) {
        self.drop_entry(&entry.id);
        self.content.steps.push(entry);
        let place = |entry: &Entry| STEPS.iter().position(|step| step.id == entry.id);
        self.content.steps.sort_by_key(place);
    }

    /// Removes the entry of the step `id`, in memory only.
    pub fn drop_entry(&mut self, id: &str) {
        self.content.steps.retain(|entry| entry.id != id);
    }

    /// The open steps, as the file lists them.
    pub fn state(&self) -> String {
        let named = |result: Option<Result>| {
            let ids = STEPS.iter().map(|step| step.id);
            let such = ids.filter(|id| self.entry(id).map(|entry| entry.result) == result);
            such.collect::<Vec<_>>().join(", ")
        };
        let open = [
            ("failed", named(Some(Result::Failed))),
            ("skipped", named(Some(Result::Skipped))),
            ("not done", named(None)),
        ];
        let open = open.into_iter().filter(|(_, names)| !names.is_empty());
        let parts: Vec<String> = open.map(|(word, names)| format!("{word}: {names}")).collect();
        let left_out = named(Some(Result::LeftOut));
        match parts.as_slice() {
            [] if left_out.is_empty() => format!("all {} steps passed", STEPS.len()),
            [] => format!("all steps passed, left out: {left_out}"),
            parts => parts.join("; "),
        }
    }

    /// Writes the file, whole or not at all.
    ///
    /// # Errors
    /// One line: the file cannot be written.
    pub fn write(&mut self) -> std::result::Result<(), Failure> {
        self.content.state = self.state();
        self.content.written = now();
        let text = toml::to_string_pretty(&self.content).map_err(|error| {
            Failure::Input(format!("{}: cannot be written: {error}", self.path.display()))
        })?;
        file::replace(&self.path, &format!("{HEAD}{text}"))
    }
}
