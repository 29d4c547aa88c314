//! The builder's side of the console: a [`session`] over a serial port, TCP or [`mavlink`], parameter files
//! ([`parameters`]) and the guided [bring-up](bringup) of a vehicle.
//!
//! Whatever is typed is a command of docs/console.md. The line may be in any state and lose bytes; the board may restart
//! or fall silent. Every failure is one line that names the port and what was expected.

pub mod file;
pub mod mavlink;
pub mod parameters;
pub mod port;
pub mod session;
pub mod wire;

use std::fmt;

/// Why something was not done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// A file, an option or a port that cannot be used: exit status 2.
    Input(String),
    /// The board refused, fell silent or has something else in force: exit status 1.
    Board(String),
    /// Ctrl-C, before it was done: exit status 1.
    Stopped(String),
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(line) | Self::Board(line) | Self::Stopped(line) => f.write_str(line),
        }
    }
}
