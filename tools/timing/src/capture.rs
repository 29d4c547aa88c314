//! All timing data of a file.

use std::path::Path;

use crate::live::{self, Chain, Contact, Garbled, Line, Quantiles, Record};
use crate::source;
use crate::trace::Trace;

/// A capture, read.
#[derive(Debug, Default)]
pub struct Capture {
    /// The board, if the log has its greeting.
    pub board: Option<String>,
    /// Each task's seconds, in order of appearance.
    pub tasks: Vec<Task>,
    /// The chain's seconds.
    pub chain: Vec<Chain>,
    /// Seconds with pulses that answer a pressure.
    pub contact: Vec<Contact>,
    /// The executors' events, if logged.
    pub trace: Trace,
    /// Starts of the board whose greeting the log has.
    pub greetings: usize,
    /// Remarks on the file, though no part of it is lost; a line each.
    pub notes: Vec<String>,
    /// Unreadable and remaining parts, in a sentence.
    pub incomplete: Option<String>,
}

/// The seconds of one task.
#[derive(Debug)]
pub struct Task {
    /// Its name.
    pub name: String,
    /// Its seconds, in order.
    pub seconds: Vec<Record>,
}

impl Capture {
    /// Reads a file; `elf` is its image, needed only for raw logs.
    ///
    /// # Errors
    /// One line: the defect of the file, and the required format.
    pub fn read(path: &Path, elf: Option<&Path>) -> Result<Self, String> {
        let messages = source::read(path, elf)?;
        let mut capture = Self::default();
        let mut garbled = 0;
        for line in &messages.lines {
            garbled += usize::from(capture.take(line).is_err());
        }
        let note = |what: &str| format!("{}: {what}", path.display());
        capture.notes.extend(messages.encoding.map(note));
        let starts = capture.greetings.max(capture.trace.starts);
        if starts > 1 {
            capture.notes.push(note(&format!(
                "{starts} starts of the board; the trace of each begins on the second after the one before"
            )));
        }
        let lines = messages.lines.len();
        if capture.tasks.is_empty() && capture.trace.events.is_empty() {
            let why = messages.broken.map_or(String::new(), |b| format!(" ({b})"));
            return Err(format!(
                "{}: {lines} lines and none of a task's timing{why}; wanted is the log of a board that has run for a second",
                path.display()
            ));
        }
        let garbled = (garbled > 0).then(|| format!("{garbled} lines about timing are garbled"));
        let lost =
            (capture.trace.lost > 0).then(|| format!("{} events of the trace are lost", capture.trace.lost));
        let faults: Vec<String> = messages.broken.into_iter().chain(garbled).chain(lost).collect();
        if !faults.is_empty() {
            capture.incomplete = Some(format!(
                "{}: {}; what is told here is of the rest: {}",
                path.display(),
                faults.join(", "),
                capture.extent()
            ));
        }
        Ok(capture)
    }

    /// Extent, for a sentence.
    #[must_use]
    pub fn extent(&self) -> String {
        let seconds = self.tasks.iter().map(|t| t.seconds.len()).max().unwrap_or(0);
        let records = format!("{seconds} s of {} tasks", self.tasks.len());
        match self.trace.events.len() {
            0 => records,
            events => format!("{records}, {events} events"),
        }
    }

    fn take(&mut self, line: &str) -> Result<(), Garbled> {
        if let Some((_, rest)) = line.split_once("SOPHIE ")
            && let Some((_, rest)) = rest.split_once(" on ")
            && let Some((board, _)) = rest.split_once(", start after")
        {
            self.board = Some(board.to_owned());
            self.greetings += 1;
            self.trace.start();
            return Ok(());
        }
        if self.trace.take(line)? {
            return Ok(());
        }
        match live::parse(line).transpose()? {
            Some(Line::Record(record)) => match self.tasks.iter_mut().find(|t| t.name == record.task) {
                Some(task) => task.seconds.push(record),
                None => self.tasks.push(Task {
                    name: record.task.clone(),
                    seconds: vec![record],
                }),
            },
            Some(Line::Chain(chain)) => self.chain.push(chain),
            Some(Line::Contact(contact)) => self.contact.push(contact),
            None => {}
        }
        Ok(())
    }
}

impl Task {
    /// Runs of all seconds.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.seconds.iter().map(|s| u64::from(s.runs)).sum()
    }

    /// Missed deadlines of all seconds.
    #[must_use]
    pub fn missed(&self) -> u64 {
        self.seconds.iter().map(|s| u64::from(s.missed)).sum()
    }

    /// Runs per second, without the incomplete first second.
    #[must_use]
    pub fn rate(&self) -> f64 {
        let whole = self
            .seconds
            .get(1..)
            .filter(|s| !s.is_empty())
            .unwrap_or(&self.seconds);
        whole.iter().map(|s| f64::from(s.runs)).sum::<f64>() / whole.len().max(1) as f64
    }

    /// Deadline, µs after release.
    #[must_use]
    pub fn deadline(&self) -> u32 {
        self.seconds.last().map_or(0, |s| s.deadline)
    }

    /// The seconds' quantiles as one, see [`worst`].
    #[must_use]
    pub fn over(&self, of: impl Fn(&Record) -> Quantiles) -> Quantiles {
        let all: Vec<Quantiles> = self.seconds.iter().map(of).collect();
        worst(&all)
    }
}

/// Over several seconds: median of medians, worst of the others.
#[must_use]
pub fn worst(seconds: &[Quantiles]) -> Quantiles {
    let mut halves: Vec<u32> = seconds.iter().map(|q| q.p50).collect();
    halves.sort_unstable();
    Quantiles {
        p50: halves.get(halves.len() / 2).copied().unwrap_or(0),
        p99: seconds.iter().map(|q| q.p99).max().unwrap_or(0),
        max: seconds.iter().map(|q| q.max).max().unwrap_or(0),
    }
}
