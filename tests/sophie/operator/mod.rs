//! What a builder does at a board's line: `sophie bringup` and `sophie params`, against the board's own code.

mod board;
mod bringup;
mod interruption;
mod lag;
mod params;
#[cfg(target_os = "linux")]
mod serial;
mod tendon;
mod thrust;
mod tied;
mod wire;

use std::process::{Child, Command};

use sophie_test_support::command::{Temp, sophie, text};

/// Ctrl-C at `child`.
fn interrupt(child: &Child) {
    let status = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(status.success());
}

/// The command in the directory.
fn run(temp: &Temp, args: &[&str]) -> Done {
    let output = sophie(temp, args);
    Done {
        status: output.status.code(),
        said: text(&output.stdout),
        complaint: text(&output.stderr),
    }
}

/// What a command did.
#[derive(Debug)]
struct Done {
    status: Option<i32>,
    said: String,
    complaint: String,
}

impl Done {
    /// One line on stderr that has `part`.
    fn complains(&self, status: i32, part: &str) {
        assert_eq!(self.status, Some(status), "{self:?}");
        assert!(self.complaint.contains(part), "{part}: {self:?}");
        assert_eq!(self.complaint.trim_end().lines().count(), 1, "{self:?}");
    }
}
