//! Errors of a scenario: one line with file, line, key, value and the allowed values.

use core::fmt;

/// A line of a scenario file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// As the user named it.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
}

/// Why a scenario is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScenarioError {
    /// Missing, a directory, too large or otherwise unreadable.
    Unreadable {
        /// As the user named it.
        file: String,
        /// The operating system's reason, or the reader's.
        why: String,
    },
    /// Not UTF-8.
    NotText {
        /// First bad byte.
        at: Place,
    },
    /// Not TOML.
    Syntax {
        /// First error.
        at: Place,
        /// The parser's message.
        message: String,
    },
    /// No such key.
    UnknownKey {
        /// Line of the mistake.
        at: Place,
        /// The key with its table.
        key: String,
        /// As given.
        value: String,
        /// Nearest allowed keys.
        nearest: Vec<String>,
    },
    /// A required key is missing.
    MissingKey {
        /// Line where the key belongs.
        at: Place,
        /// The key with its table.
        key: String,
        /// Allowed values.
        allowed: String,
    },
    /// Wrong type, unknown choice or out of range.
    BadValue {
        /// Line of the mistake.
        at: Place,
        /// The key with its table.
        key: String,
        /// As written.
        value: String,
        /// Allowed values.
        allowed: String,
    },
    /// A step that is impossible after the steps before it.
    StepOrder {
        /// Line of the mistake.
        at: Place,
        /// Such as `steps[3]`.
        key: String,
        /// Name.
        step: String,
        /// When it is possible, and the vehicle's state.
        allowed: String,
    },
    /// No steps.
    NoSteps {
        /// The empty list.
        at: Place,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", one_line(&self.file, 200), self.line)
    }
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { file, why } => {
                write!(
                    f,
                    "{}: cannot be read: {}",
                    one_line(file, 200),
                    one_line(why, 120)
                )
            }
            Self::NotText { at } => write!(f, "{at}: not UTF-8 text: allowed is a TOML file"),
            Self::Syntax { at, message } => write!(f, "{at}: not valid TOML: {}", one_line(message, 200)),
            Self::UnknownKey {
                at,
                key,
                value,
                nearest,
            } => write!(
                f,
                "{at}: {} = {}: unknown key: nearest allowed {}",
                one_line(key, 80),
                one_line(value, 40),
                nearest.join(", ")
            ),
            Self::MissingKey { at, key, allowed } => write!(f, "{at}: {key} is missing: allowed {allowed}"),
            Self::BadValue {
                at,
                key,
                value,
                allowed,
            } => {
                write!(f, "{at}: {key} = {}: allowed {allowed}", one_line(value, 40))
            }
            Self::StepOrder {
                at,
                key,
                step,
                allowed,
            } => write!(f, "{at}: {key} = {step}: allowed {allowed}"),
            Self::NoSteps { at } => write!(f, "{at}: steps = []: allowed at least one step, such as arm"),
        }
    }
}

impl std::error::Error for ScenarioError {}

/// Without control characters and runs of blanks, at most `limit` characters.
pub(super) fn one_line(text: &str, limit: usize) -> String {
    let words = text.split(|c: char| c.is_whitespace() || c.is_control());
    let line = words.filter(|w| !w.is_empty()).collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(limit) {
        Some((end, _)) => format!("{}…", line.get(..end).unwrap_or_default()),
        None => line,
    }
}
