//! What a builder does at a board's console: `sophie params`, against the console's own code.

mod board;
#[path = "../common/command.rs"]
mod command;
mod params;

use self::command::{Temp, sophie, text};

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
