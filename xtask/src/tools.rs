//! Programs that the user installs, with one line per error.

use std::io::ErrorKind;
use std::process::{Command, Output, Stdio};

use crate::boards::Board;
use crate::{Error, build};

pub struct Tool {
    program: &'static str,
    /// Installation source.
    install: &'static str,
}

/// Reads and writes a chip through a probe.
pub const PROBE_RS: Tool = Tool {
    program: "probe-rs",
    install: "see https://probe.rs/docs/getting-started/installation",
};

/// Writes a chip through its USB loader. A program instead of a crate (`dfu-libusb`, `dfu-nusb`), which would add a USB
/// library to xtask: users have it from other autopilots, and it handles the quirks of ST's loaders.
pub const DFU_UTIL: Tool = Tool {
    program: "dfu-util",
    install: "Debian, Ubuntu: apt-get install dfu-util; macOS: brew install dfu-util; else https://dfu-util.sourceforge.net",
};

impl Tool {
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(self.program);
        command.args(arguments);
        command
    }

    /// Prints `command` and runs it.
    ///
    /// # Errors
    /// The program is not installed, or fails.
    pub fn run(&self, command: &mut Command) -> Result<(), Error> {
        eprintln!("{}", build::shown(command));
        let status = command.status().map_err(|e| self.missing(&e))?;
        if status.success() {
            Ok(())
        } else {
            Err(format!("{} failed ({status})", self.program).into())
        }
    }

    /// Runs `command`; returns its output.
    ///
    /// # Errors
    /// The program is not installed.
    pub fn ask(&self, command: &mut Command) -> Result<Output, Error> {
        let output = command.stdin(Stdio::null()).output();
        output.map_err(|e| self.missing(&e).into())
    }

    fn missing(&self, error: &std::io::Error) -> String {
        match error.kind() {
            ErrorKind::NotFound => format!("{} is not installed; {}", self.program, self.install),
            _ => format!("{}: {error}", self.program),
        }
    }
}

/// Checks for a connected probe.
///
/// # Errors
/// probe-rs is not installed, or lists none.
pub fn probe(board: &Board) -> Result<(), Error> {
    let listed = PROBE_RS.ask(&mut PROBE_RS.command(&["list"]))?;
    if names_a_probe(&String::from_utf8_lossy(&listed.stdout)) {
        return Ok(());
    }
    Err(format!(
        "`probe-rs list` shows no probe. Connect an ST-Link or a CMSIS-DAP probe to SWDIO, SWCLK, ground and a 3.3 V \
         reference of the {} (docs/first-hour.md), and power the board; on Linux install probe-rs's udev rules",
        board.name
    )
    .into())
}

/// Probes are numbered: `[0]: STLink V3 -- …`.
fn names_a_probe(listed: &str) -> bool {
    listed.lines().any(|line| line.trim_start().starts_with('['))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_probe_is_told_from_none() {
        assert!(names_a_probe(
            "The following debug probes were found:\n[0]: STLink V3 -- 0483:374e:0030 (ST-LINK)\n"
        ));
        assert!(!names_a_probe("No debug probes were found.\n"));
    }
}
