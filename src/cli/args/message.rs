//! Messages shown instead of a flight: help, version, or a refusal.

use std::process::ExitCode;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use sophie_terminal::console;

use crate::cli::refuse;

/// The subcommands, as listed in messages.
const VERBS: &[&str] = &[
    "fly",
    "check",
    "bringup",
    "params",
    "capture",
    "study",
    "paper",
    "fit-arm",
    "fit-thrust",
    "fit-lag",
    "fit-tendon",
    "timing",
    "recording",
];

/// The studies, as listed in messages.
const STUDIES: &str = "vehicles, unknown";

/// A message shown instead of a flight.
pub struct Message(pub(super) clap::Error);

impl Message {
    /// Shows the message and returns the exit status.
    pub fn show(&self) -> ExitCode {
        match self.0.kind() {
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => match console::written(self.0.print()) {
                Ok(()) => ExitCode::SUCCESS,
                Err(line) => refuse(&line),
            },
            _ => refuse(&self.line()),
        }
    }

    /// clap's message without its usage and hints at help, as one line.
    pub(super) fn line(&self) -> String {
        // Only `study` and `help` forbid a file in a subcommand's place.
        if self.0.kind() == ErrorKind::InvalidSubcommand
            && let Some(ContextValue::String(topic)) = self.0.get(ContextKind::InvalidSubcommand)
        {
            if std::env::args().nth(1).as_deref() == Some("study") {
                return format!("no study '{topic}': allowed are {STUDIES}");
            }
            return format!("no help on '{topic}': allowed are {}", VERBS.join(", "));
        }
        // clap reports a second file as an unknown subcommand if one could stand there.
        let extra = match self.0.kind() {
            ErrorKind::UnknownArgument => self.0.get(ContextKind::InvalidArg),
            ErrorKind::ArgumentConflict => self.0.get(ContextKind::InvalidSubcommand),
            _ => None,
        };
        if let Some(ContextValue::String(extra)) = extra
            && !extra.starts_with('-')
            && !VERBS.contains(&extra.as_str())
        {
            let allowed = match std::env::args().nth(1).as_deref() {
                Some("paper" | "capture") => "no file",
                Some("study") => "one study and no file",
                Some("fit-arm" | "fit-thrust" | "fit-tendon") => "one CSV file",
                Some("fit-lag") => "one WAV file",
                Some("recording") => "one recording",
                Some("timing") => "one log file",
                Some("params") => "one parameter file",
                Some("bringup") => "no file",
                _ => "one scenario file",
            };
            return format!("unexpected argument '{extra}': allowed is {allowed}");
        }
        if self.0.kind() == ErrorKind::MissingSubcommand {
            return format!("<STUDY> is missing: allowed are {STUDIES}");
        }
        let text = self.0.to_string();
        let lines = text.lines().map(str::trim).filter(|l| !l.is_empty());
        let first = lines.take_while(|l| !l.starts_with("Usage:") && !l.starts_with("For more information"));
        let line = first.collect::<Vec<_>>().join("; ").replace(":; ", ": ");
        line.strip_prefix("error: ").unwrap_or(&line).to_owned()
    }
}
