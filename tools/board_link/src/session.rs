//! A session at the console: it types commands and reads answers.
//!
//! A command is first typed without its Enter, which follows only if the echo equals the typed text: a line that loses
//! bytes never makes another command of it. The answer ends with the console's prompt.

use std::io::{self, ErrorKind, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use sophie_ports::signing::Key;
use sophie_tasks::console::NOT_TEXT;

use crate::Failure;
use crate::port::{BAUD, PortName};
use crate::wire::Wire;

/// Longest restart of a board: erasing flash, self-tests, and an emulated board at half the speed.
const RESTART: Duration = Duration::from_secs(30);
/// Time between two attempts to reopen a lost port.
const REOPEN: Duration = Duration::from_millis(100);
/// Longest wait for the answer to the first attempt; each further attempt waits twice as long.
const ATTEMPT: Duration = Duration::from_secs(1);
/// Share of the time in which a console must answer that the first probe waits. Each further one waits twice as long:
/// four probes, since one loses its answer to a line that loses frames.
const SHARE: u32 = 8;
/// Number of attempts at typing a line that is damaged on its way.
const TRIES: u32 = 4;
/// Length limit of an answer, in silences: an endless answer, as of a noisy line, counts as none.
const SILENCES: u32 = 6;
/// The console's prompt.
const PROMPT: &str = "\n> ";
/// Ctrl-C: aborts a running command or prompt; ignored inside a line.
const CANCEL: u8 = 0x03;
/// Sent before the first command, whatever state the line is in: it ends a running command, then a cursor key's bytes,
/// makes the console reject the unfinished line, and enters it.
const CLEAN: [u8; 4] = [CANCEL, b'z', 0x80, b'\r'];
/// Largest kept answer, bytes.
const HEARD_MAX: usize = 1 << 20;
/// The console's answer to a line that lost bytes.
const DAMAGED: &str = "the line was damaged on its way";

/// A session at a console that has answered.
pub struct Session {
    wire: Box<dyn Wire>,
    name: PortName,
    /// Key of MAVLink's signatures.
    key: Option<Key>,
    /// Name of the port, for messages.
    port: String,
    /// The answering device, for messages.
    expected: String,
    patience: Duration,
    /// Output since the last Enter: printable characters and line ends only.
    heard: String,
    /// Number of probes so far.
    attempts: u32,
    /// Raised from outside, as by Ctrl-C. It is obeyed once, so that the caller can still tidy up.
    stop: Arc<AtomicBool>,
    heeds: bool,
    /// The port is gone, as on USB while the board restarts.
    lost: bool,
}

impl Session {
    /// Opens `port` and waits for its console; `key` signs MAVLink. `patience` is the longest silence while an answer
    /// is due. When `stop` is raised, the current wait ends once.
    ///
    /// # Errors
    /// One line: the port cannot be opened, or no console answers there.
    pub fn open(
        port: &PortName,
        key: Option<Key>,
        patience: Duration,
        stop: Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        let mut session = Self {
            wire: port.open(key)?,
            name: port.clone(),
            key,
            port: port.to_string(),
            expected: match (port, key) {
                (PortName::Mavlink(_), None) => "over MAVLink, unsigned".to_owned(),
                (PortName::Mavlink(_), Some(_)) => "over MAVLink, signed by the board's key".to_owned(),
                _ => format!("at {BAUD} baud"),
            },
            patience,
            heard: String::new(),
            attempts: 0,
            stop,
            heeds: true,
            lost: false,
        };
        match session.synchronise(patience) {
            Ok(()) => Ok(session),
            Err(Failure::Board(line)) => Err(Failure::Input(line)),
            Err(other) => Err(other),
        }
    }

    /// Name of the port.
    pub fn port(&self) -> &str {
        &self.port
    }

    /// Types `text` and returns the answer.
    ///
    /// # Errors
    /// One line: the line is lost, or the board does not answer.
    pub fn command(&mut self, text: &str) -> Result<Vec<String>, Failure> {
        // The console's own rule, kept here: refused bytes and replaced blanks do not come back as they were typed.
        let text = &text.replace('\t', " ");
        if !text.bytes().all(|byte| matches!(byte, b' '..=b'~')) {
            return Ok(vec![NOT_TEXT.to_owned()]);
        }
        for _ in 0..TRIES {
            self.begin(text)?;
            let lines = self.answer(text)?;
            if !lines.iter().any(|line| line.starts_with(DAMAGED)) {
                return Ok(lines);
            }
        }
        Err(self.failed(&format!("'{text}' is damaged on its way each time")))
    }

    /// As [`Self::command`], for a command that changes nothing: it is repeated if its answer does not end.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn ask(&mut self, text: &str) -> Result<Vec<String>, Failure> {
        for _ in 1..TRIES {
            match self.command(text) {
                Err(lost @ Failure::Board(_)) if self.synchronise(self.patience).is_err() => {
                    return Err(lost);
                }
                Err(Failure::Board(_)) => (),
                other => return other,
            }
        }
        self.command(text)
    }

    /// Types `text` with its Enter.
    fn begin(&mut self, text: &str) -> Result<(), Failure> {
        for _ in 0..TRIES {
            self.heard.clear();
            self.send(text.as_bytes())?;
            if self.wait(ATTEMPT.min(self.patience), |heard| heard.ends_with(text))? {
                self.heard.clear();
                return self.send(b"\r");
            }
            // The console rejects the damaged line.
            self.synchronise(self.patience)?;
        }
        Err(self.failed(&format!("'{text}' does not come back as it was typed")))
    }

    /// Ends the running command after Ctrl-C; further Ctrl-C is ignored.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn calm(&mut self) -> Result<(), Failure> {
        self.see_it_through();
        self.synchronise(self.patience)
    }

    /// From here on Ctrl-C is ignored: a command that has begun must not be left half done.
    pub fn see_it_through(&mut self) {
        self.heeds = false;
    }

    /// The lines of the answer to the typed `text`, up to the prompt.
    fn answer(&mut self, text: &str) -> Result<Vec<String>, Failure> {
        if !self.wait(self.patience, |heard| heard.ends_with(PROMPT))? {
            return Err(self.silent(text));
        }
        let said = self.heard.strip_suffix("> ").unwrap_or(&self.heard);
        Ok(whole_lines(said).collect())
    }

    /// Types `text`, which restarts the board, and waits until it answers again; returns its last output. If the last
    /// line does not announce a restart, there was none.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn restart(&mut self, text: &str) -> Result<Vec<String>, Failure> {
        self.begin(text)?;
        // The board may have stored already: only its answer decides.
        let heeds = std::mem::replace(&mut self.heeds, false);
        let said = self.restarted(text);
        self.heeds = heeds;
        said
    }

    /// Output of `text`; if the board restarts, once it answers again.
    fn restarted(&mut self, text: &str) -> Result<Vec<String>, Failure> {
        let ends = |heard: &str| heard.ends_with("restarting\n") || heard.ends_with(PROMPT);
        if !self.wait(self.patience, ends)? {
            return Err(self.silent(text));
        }
        let lines: Vec<String> = whole_lines(&self.heard).filter(|line| line != ">").collect();
        if restarts(&lines) {
            self.come_back(RESTART.max(self.patience))?;
        }
        Ok(lines)
    }

    /// Waits until the restarted board answers, for at most `time`. A port on USB disappears during the restart.
    fn come_back(&mut self, time: Duration) -> Result<(), Failure> {
        let begun = Instant::now();
        loop {
            let left = time.saturating_sub(begun.elapsed());
            match self.synchronise(left) {
                Err(_) if self.lost && !left.is_zero() => (),
                done => return done,
            }
            // Closed first: the system reuses the port's name only when no process has the old port open.
            self.wire = Box::new(Gone);
            std::thread::sleep(REOPEN);
            if let Ok(wire) = self.name.open(self.key) {
                (self.wire, self.lost) = (wire, false);
            }
        }
    }

    /// Waits until the console answers a probe with a clean prompt, for at most `time`.
    fn synchronise(&mut self, time: Duration) -> Result<(), Failure> {
        let begun = Instant::now();
        let mut attempt = ATTEMPT.min(time / SHARE);
        let mut bytes = 0;
        while begun.elapsed() < time {
            self.attempts += 1;
            // A word that no other text has: its answer is distinguishable from all earlier output.
            let word = format!("sync-{}", self.attempts);
            let answer = format!("no command '{word}'");
            let answered = |heard: &str| {
                heard
                    .split_once(&answer)
                    .is_some_and(|(_, rest)| rest.ends_with(PROMPT))
            };
            self.heard.clear();
            self.send(&CLEAN)?;
            self.send(format!("{word}\r").as_bytes())?;
            if self.wait(attempt.min(time), answered)? {
                return Ok(());
            }
            bytes += self.heard.len();
            attempt *= 2;
        }
        let came = match bytes {
            0 => "nothing came",
            _ => "what came is no answer of the console",
        };
        let (time, expected) = (time.as_secs_f32(), &self.expected);
        Err(self.failed(&format!(
            "no console answers within {time} s, {came}; expected its prompt '> ' {expected}"
        )))
    }

    /// Reads until `done` accepts the output; false after a pause of `silence`.
    fn wait(&mut self, silence: Duration, done: impl Fn(&str) -> bool) -> Result<bool, Failure> {
        let begun = Instant::now();
        let mut last = begun;
        let mut bytes = [0; 256];
        while !done(&self.heard) {
            if self.heeds && self.stop.load(Ordering::Relaxed) {
                self.heeds = false;
                return Err(Failure::Stopped(format!("{}: stopped by Ctrl-C", self.port)));
            }
            match self.wire.read(&mut bytes) {
                Ok(0) => return Err(self.lose("the line was closed")),
                Ok(count) => {
                    last = Instant::now();
                    self.hear(bytes.get(..count).unwrap_or_default());
                }
                Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) => (),
                Err(error) if error.kind() == ErrorKind::Interrupted => (),
                Err(error) => return Err(self.lose(&format!("the line is lost: {error}"))),
            }
            if last.elapsed() >= silence || begun.elapsed() >= silence * SILENCES {
                return Ok(done(&self.heard));
            }
        }
        Ok(true)
    }

    fn hear(&mut self, bytes: &[u8]) {
        if self.heard.len() > HEARD_MAX {
            self.heard.clear();
        }
        for byte in bytes {
            match byte {
                b'\n' | b' '..=b'~' => self.heard.push(char::from(*byte)),
                0x80.. => self.heard.push('?'),
                _ => (),
            }
        }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let sent = self.wire.write_all(bytes).and_then(|()| self.wire.flush());
        sent.map_err(|error| self.lose(&format!("the line is lost: {error}")))
    }

    fn silent(&self, what: &str) -> Failure {
        let last = self.heard.lines().map(str::trim).rfind(|line| !line.is_empty());
        let last = last.map_or("nothing".to_owned(), |line| format!("'{line}'"));
        let patience = self.patience.as_secs_f32();
        self.failed(&format!(
            "the board fell silent for {patience} s after '{what}': expected its prompt '> ', last heard {last}"
        ))
    }

    fn lose(&mut self, why: &str) -> Failure {
        self.lost = true;
        self.failed(why)
    }

    fn failed(&self, why: &str) -> Failure {
        Failure::Board(format!("{}: {why}", self.port))
    }
}

/// Stands for a lost port.
struct Gone;

impl Read for Gone {
    fn read(&mut self, _bytes: &mut [u8]) -> io::Result<usize> {
        Err(ErrorKind::NotConnected.into())
    }
}

impl Write for Gone {
    fn write(&mut self, _bytes: &[u8]) -> io::Result<usize> {
        Err(ErrorKind::NotConnected.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The lines of `text` that are not empty.
fn whole_lines(text: &str) -> impl Iterator<Item = String> {
    let lines = text.lines().map(str::trim_end);
    lines.filter(|line| !line.is_empty()).map(str::to_owned)
}

/// True if the board announces its restart.
pub fn restarts(said: &[String]) -> bool {
    said.last().is_some_and(|line| line.ends_with("restarting"))
}
