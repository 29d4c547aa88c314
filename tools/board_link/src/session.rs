//! A session at the console: commands typed, answers heard.
//!
//! A command is typed without its Enter first and sent off only when its echo is what was typed: a line that loses bytes
//! never makes another command of it. Its answer ends with the console's prompt.

use std::io::{self, ErrorKind, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use sophie_mavlink::wire::signing::Key;
use sophie_tasks::console::NOT_TEXT;

use crate::Failure;
use crate::port::{BAUD, PortName};
use crate::wire::Wire;

/// Longest silence while an answer is due, where nothing else is said.
pub const PATIENCE: Duration = Duration::from_secs(10);
/// Time that a restarted board has to answer: erasing flash, self-tests, and an emulated one at half its speed.
const RESTART: Duration = Duration::from_secs(30);
/// Time between two attempts to open a port that is gone.
const REOPEN: Duration = Duration::from_millis(100);
/// Time that the first attempt has to be answered; each further one has twice that of the last.
const ATTEMPT: Duration = Duration::from_secs(1);
/// Times that a line which was damaged on its way is typed.
const TRIES: u32 = 4;
/// Silences after which an answer that never ends, as of a line full of noise, counts as none.
const SILENCES: u32 = 6;
/// What asks for a command, at the start of a line.
const PROMPT: &str = "\n> ";
/// Ends a command that lasts or asks; typed into a line it is nothing.
const CANCEL: u8 = 0x03;
/// What is sent before the first command, whatever the line is at: an end to what runs, one to a cursor key's bytes, a
/// byte for which the console rejects what is typed so far, and Enter.
const CLEAN: [u8; 4] = [CANCEL, b'z', 0x80, b'\r'];
/// Most bytes that are kept of an answer.
const HEARD_MAX: usize = 1 << 20;
/// What the console says of a line that lost bytes.
const DAMAGED: &str = "the line was damaged on its way";

/// A line to a console that has answered.
pub struct Session {
    wire: Box<dyn Wire>,
    name: PortName,
    /// What MAVLink is signed with.
    key: Option<Key>,
    /// Its text, for messages.
    port: String,
    /// What answers there, for messages.
    expected: String,
    patience: Duration,
    /// What was said since the last Enter or key, printable characters and line ends alone.
    heard: String,
    /// Key whose echo comes first.
    pressed: Option<u8>,
    /// Attempts to be answered so far.
    attempts: u32,
    /// Restarts since the session began.
    restarts: u32,
    /// Raised from outside, as by Ctrl-C; heeded once, so that what is left can be put in order.
    stop: Arc<AtomicBool>,
    heeds: bool,
    /// The port is gone, as one on USB is while its board restarts.
    lost: bool,
}

/// What the console said up to where it waits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Whole lines, without the echo of what was typed.
    pub lines: Vec<String>,
    /// The question that it waits at; `None` at the prompt.
    pub question: Option<&'static str>,
}

impl Session {
    /// Opens `port` and waits for its console, over MAVLink signed by `key` where there is one. `patience` is the longest
    /// silence while an answer is due; what waits ends once when `stop` is raised.
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
            pressed: None,
            attempts: 0,
            restarts: 0,
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

    /// Restarts of the board since the session began.
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    /// Types `text` and gives the answer.
    ///
    /// # Errors
    /// One line: the line is lost, or the board does not answer.
    pub fn command(&mut self, text: &str) -> Result<Vec<String>, Failure> {
        // The console's own rule, kept here: what it refuses or takes for a blank does not come back as it was typed.
        let text = &text.replace('\t', " ");
        if !text.bytes().all(|byte| matches!(byte, b' '..=b'~')) {
            return Ok(vec![NOT_TEXT.to_owned()]);
        }
        for _ in 0..TRIES {
            self.begin(text)?;
            let turn = self.turn(text, &[])?;
            if !turn.lines.iter().any(|line| line.starts_with(DAMAGED)) {
                return Ok(turn.lines);
            }
        }
        Err(self.failed(&format!("'{text}' is damaged on its way each time")))
    }

    /// The same for a command that changes nothing: where its answer ends nowhere, it is typed again.
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

    /// Types `text` with its Enter; [`Self::turn`] gives what follows.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn begin(&mut self, text: &str) -> Result<(), Failure> {
        for _ in 0..TRIES {
            self.heard.clear();
            self.send(text.as_bytes())?;
            if self.wait(ATTEMPT.min(self.patience), |heard| heard.ends_with(text))? {
                self.heard.clear();
                return self.send(b"\r");
            }
            // What came of it is rejected, not obeyed.
            self.synchronise(self.patience)?;
        }
        Err(self.failed(&format!("'{text}' does not come back as it was typed")))
    }

    /// Presses `key`.
    ///
    /// # Errors
    /// The line is lost.
    fn key(&mut self, key: u8) -> Result<(), Failure> {
        self.heard.clear();
        self.pressed = Some(key);
        self.send(&[key])
    }

    /// Ends the command that runs, and waits for the prompt.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn cancel(&mut self) -> Result<Vec<String>, Failure> {
        self.key(CANCEL)?;
        // The end of the line before may have been heard already.
        self.heard.push('\n');
        Ok(self.turn("what runs was ended", &[])?.lines)
    }

    /// Ends whatever runs at the console after Ctrl-C, which is heeded no more.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn calm(&mut self) -> Result<(), Failure> {
        self.see_it_through();
        self.pressed = None;
        self.synchronise(self.patience)
    }

    /// From here on Ctrl-C is not heeded: what is begun must not be left half done.
    pub fn see_it_through(&mut self) {
        self.heeds = false;
    }

    /// What is said until the console asks one of `questions` or waits at its prompt; `what` was typed or pressed.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn turn(&mut self, what: &str, questions: &[&'static str]) -> Result<Turn, Failure> {
        let asked = |heard: &str| {
            questions
                .iter()
                .copied()
                .find(|question| heard.ends_with(question))
        };
        if !self.wait(self.patience, |heard| {
            heard.ends_with(PROMPT) || asked(heard).is_some()
        })? {
            return Err(self.silent(what));
        }
        let question = asked(&self.heard);
        let end = match question {
            None => "> ",
            // A line of the answer.
            Some(question) if question.ends_with('\n') => "",
            Some(question) => question,
        };
        let text = self.heard.strip_suffix(end).unwrap_or(&self.heard);
        let mut lines: Vec<String> = whole_lines(text).collect();
        if let Some(key) = self.pressed.take()
            && lines.first().is_some_and(|line| line.as_bytes() == [key])
        {
            lines.remove(0);
        }
        Ok(Turn { lines, question })
    }

    /// The next whole line of `command`, which lasts.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn line(&mut self, command: &str) -> Result<String, Failure> {
        if !self.wait(self.patience, |heard| heard.contains('\n'))? {
            return Err(self.silent(command));
        }
        let rest = self
            .heard
            .split_once('\n')
            .map(|(line, rest)| (line.trim_end().to_owned(), rest.to_owned()));
        let (line, rest) = rest.unwrap_or_default();
        self.heard = rest;
        Ok(line)
    }

    /// Presses `key` where the console waits for one; false where it has ended by itself meanwhile.
    ///
    /// # Errors
    /// The line is lost.
    pub fn press(&mut self, key: u8) -> Result<bool, Failure> {
        self.heard.clear();
        if self.wait(Duration::ZERO, |heard| !heard.is_empty())? {
            return Ok(false);
        }
        self.key(key)?;
        Ok(true)
    }

    /// Time that a start may take from the restart to `DISARMED`.
    pub fn longest_start(&self) -> Duration {
        RESTART.max(self.patience)
    }

    /// Types `text`, after which the board restarts, and waits until it answers again; what it said before. It has not
    /// restarted where the last line does not say so.
    ///
    /// # Errors
    /// As [`Self::command`].
    pub fn restart(&mut self, text: &str) -> Result<Vec<String>, Failure> {
        self.begin(text)?;
        // Now it is stored or not, whatever happens here: only the answer says which.
        let heeds = std::mem::replace(&mut self.heeds, false);
        let said = self.restarted(text);
        self.heeds = heeds;
        said
    }

    /// What was said to `text`; where the board restarts, once it answers again.
    fn restarted(&mut self, text: &str) -> Result<Vec<String>, Failure> {
        let ends = |heard: &str| heard.ends_with("restarting\n") || heard.ends_with(PROMPT);
        if !self.wait(self.patience, ends)? {
            return Err(self.silent(text));
        }
        let lines: Vec<String> = whole_lines(&self.heard).filter(|line| line != ">").collect();
        if restarts(&lines) {
            self.come_back(RESTART.max(self.patience))?;
            self.restarts += 1;
        }
        Ok(lines)
    }

    /// Waits until the restarted board answers, for at most `time`. A port on USB goes with its board and comes back.
    fn come_back(&mut self, time: Duration) -> Result<(), Failure> {
        let begun = Instant::now();
        loop {
            let left = time.saturating_sub(begun.elapsed());
            match self.synchronise(left) {
                Err(_) if self.lost && !left.is_zero() => (),
                done => return done,
            }
            // Given up first: the system gives the port its name again only when no one has the old one.
            self.wire = Box::new(Gone);
            std::thread::sleep(REOPEN);
            if let Ok(wire) = self.name.open(self.key) {
                (self.wire, self.lost) = (wire, false);
            }
        }
    }

    /// Waits until the console answers a line of its own with a clean prompt, for at most `time`.
    fn synchronise(&mut self, time: Duration) -> Result<(), Failure> {
        let begun = Instant::now();
        let mut attempt = ATTEMPT;
        let mut bytes = 0;
        while begun.elapsed() < time {
            self.attempts += 1;
            // A word that no other text has: what is said to it can be told from all that was said before.
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

    /// Reads until `done` of what was heard; false where nothing has come for `silence`.
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

/// In place of a port that is gone.
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

/// The board says that it restarts.
pub fn restarts(said: &[String]) -> bool {
    said.last().is_some_and(|line| line.ends_with("restarting"))
}
