//! Terminal output: survives a closed pipe; colour only where wanted.

use std::cell::{Cell, RefCell};
use std::io::{self, ErrorKind, IsTerminal, Write};

/// Running text: stdout, or stderr when stdout is kept for JSON.
pub struct Console {
    to_stderr: bool,
    terminal: bool,
    closed: Cell<bool>,
    /// Why stdout cannot be written, unless its reader has gone.
    failure: RefCell<Option<String>>,
}

impl Console {
    /// On stdout, or on stderr if `json`.
    pub fn new(json: bool) -> Self {
        let terminal = if json {
            std::io::stderr().is_terminal()
        } else {
            std::io::stdout().is_terminal()
        };
        Self {
            to_stderr: json,
            terminal,
            closed: Cell::new(false),
            failure: RefCell::default(),
        }
    }

    /// Shows one line. Failures do not stop the work; [`Console::end`] reports them.
    pub fn say(&self, line: &str) {
        if self.closed.get() {
            return;
        }
        let result = if self.to_stderr {
            writeln!(std::io::stderr(), "{line}")
        } else {
            let mut out = std::io::stdout().lock();
            writeln!(out, "{line}").and_then(|()| out.flush())
        };
        self.closed.set(result.is_err());
        // A broken stderr cannot be reported.
        if !self.to_stderr {
            *self.failure.borrow_mut() = written(result).err();
        }
    }

    /// Reports a failed output.
    ///
    /// # Errors
    /// One line: why stdout could not be written.
    pub fn end(&self) -> Result<(), String> {
        self.failure.borrow_mut().take().map_or(Ok(()), Err)
    }

    /// True if running text goes to stderr.
    pub fn to_stderr(&self) -> bool {
        self.to_stderr
    }

    /// True if running text goes to a terminal, not to a file or a pipe.
    pub fn is_terminal(&self) -> bool {
        self.terminal
    }

    /// `word` in green if `good`, else in red; plain if colour is not wanted.
    pub fn paint(&self, word: &str, good: bool) -> String {
        if !self.terminal || !colour_wanted() {
            return word.to_owned();
        }
        let code = if good { "1;32" } else { "1;31" };
        format!("\x1b[{code}m{word}\x1b[0m")
    }
}

/// <https://no-color.org>: set and not empty means no colour.
fn colour_wanted() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    !set("NO_COLOR") && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// One line on stdout.
///
/// # Errors
/// As [`written`].
pub fn print(line: &str) -> Result<(), String> {
    let mut out = std::io::stdout().lock();
    written(writeln!(out, "{line}").and_then(|()| out.flush()))
}

/// Result of writing to stdout; a closed pipe is not a failure.
///
/// # Errors
/// One line with any other reason.
pub fn written(result: io::Result<()>) -> Result<(), String> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(format!("stdout: cannot be written: {error}"))
        }
        _ => Ok(()),
    }
}

/// `text` as one line.
pub fn one_line(text: &str) -> String {
    text.split(char::is_control)
        .map(str::trim)
        .filter(|l| !l.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}
