//! A builder's line to a board: a [`vehicle`] over MAVLink on a serial port, TCP or UDP ([`port`]), and parameter files
//! ([`parameters`]).
//!
//! The line may begin in any state and lose bytes; the board may restart or fall silent. Every failure is one line that
//! names the port and the expected answer.

pub mod description;
pub mod file;
pub mod parameters;
pub mod port;
pub mod station;
pub mod vehicle;

use std::fmt;

/// Reason of a failure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// A file, an option or a port that cannot be used: exit status 2.
    Input(String),
    /// The board refused, fell silent or has other values in force: exit status 1.
    Board(String),
    /// Interrupted by Ctrl-C: exit status 1.
    Stopped(String),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(line) | Self::Board(line) | Self::Stopped(line) => f.write_str(line),
        }
    }
}
