//! The builder at the terminal, or a pipe that replaces him.

use std::io::{BufRead, IsTerminal, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::time::Duration;

use sophie_bringup::{Reply, User};

/// Width of a row that replaces the last one.
const WIDTH: usize = 79;
/// Longest delay until Ctrl-C is noticed while a reply is awaited.
const NOTICED: Duration = Duration::from_millis(50);

/// Standard input and output.
pub struct Terminal {
    /// Typed lines; a thread reads them, so that measurements can be shown meanwhile.
    lines: Receiver<String>,
    /// Input and output are both a terminal: replies are echoed as they are typed, and a row may be overwritten.
    terminal: bool,
    /// The row on the screen that the next one overwrites.
    row: Option<String>,
    /// Raised by Ctrl-C: no replies follow.
    stop: Arc<AtomicBool>,
}

impl Terminal {
    pub fn new(stop: Arc<AtomicBool>) -> Self {
        let (sender, lines) = channel();
        std::thread::spawn(move || {
            for line in std::io::stdin().lock().lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    break;
                }
            }
        });
        Self {
            lines,
            terminal: std::io::stdin().is_terminal() && std::io::stdout().is_terminal(),
            row: None,
            stop,
        }
    }

    /// The next line; `None` at the end of input and after Ctrl-C.
    fn next(&self) -> Option<String> {
        loop {
            match self.lines.recv_timeout(NOTICED) {
                _ if self.stop.load(Ordering::Relaxed) => return None,
                Ok(line) => return Some(line),
                Err(RecvTimeoutError::Timeout) => (),
                Err(RecvTimeoutError::Disconnected) => return None,
            }
        }
    }

    /// Writes without a line end; ignores a closed pipe.
    fn write(&mut self, text: &str) {
        let mut out = std::io::stdout().lock();
        let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    }

    /// Ends the row that was shown last.
    fn end_row(&mut self) {
        if let Some(row) = self.row.take() {
            // Without a terminal, only the last row is printed.
            let end = if self.terminal {
                "\n".to_owned()
            } else {
                format!("{row}\n")
            };
            self.write(&end);
        }
    }

    /// The reply; from a pipe it has not been echoed yet, so it is printed.
    fn replied(&mut self, line: String) -> Reply {
        if !self.terminal {
            self.write(&format!("{line}\n"));
        }
        Reply::Line(line)
    }
}

impl User for Terminal {
    fn say(&mut self, line: &str) {
        self.end_row();
        self.write(&format!("{}\n", wrapped(line)));
    }

    fn live(&mut self, line: &str) {
        if self.terminal {
            self.write(&format!("\r{line:WIDTH$.WIDTH$}"));
        }
        self.row = Some(line.to_owned());
    }

    fn ask(&mut self, question: &str) -> Reply {
        self.end_row();
        self.write(question);
        match self.next() {
            Some(line) => self.replied(line),
            None => {
                self.write("\n");
                Reply::End
            }
        }
    }

    fn answered(&mut self) -> Option<Reply> {
        match self.lines.try_recv() {
            Ok(line) => {
                if self.terminal {
                    // The reply's Enter has ended the row.
                    self.row = None;
                }
                self.end_row();
                Some(self.replied(line))
            }
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Reply::End),
        }
    }
}

/// The line wrapped to [`WIDTH`] between words, with continuation lines indented by two more.
fn wrapped(line: &str) -> String {
    if line.len() <= WIDTH {
        return line.to_owned();
    }
    let indent = " ".repeat(line.len() - line.trim_start().len());
    let mut text = String::new();
    let mut column = 0;
    for word in line.split_whitespace() {
        if column == 0 {
            text += &indent;
            column = indent.len();
        } else if column + 1 + word.len() > WIDTH {
            text += &format!("\n{indent}  ");
            column = indent.len() + 2;
        } else {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += word.len();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_broken_between_words() {
        assert_eq!(wrapped("  short  as it is"), "  short  as it is");
        let long = format!("  {}", "word ".repeat(30));
        let text = wrapped(long.trim_end());
        assert!(
            text.lines()
                .all(|line| line.len() <= WIDTH && line.starts_with("  ")),
            "{text}"
        );
        assert_eq!(text.split_whitespace().count(), 30);
    }
}
