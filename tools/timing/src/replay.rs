//! Played-back events: polls, preemptions, runs of polls.

use std::collections::{BTreeMap, HashMap};

use sophie_tasks::schedule::Level;

use crate::stats::Sorted;
use crate::trace::{Event, Kind, Trace};

/// Smallest ratio of gaps between runs to those within one.
const APART: f64 = 4.0;

/// A poll of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Poll {
    /// Index of the task.
    pub task: usize,
    /// Wake, µs.
    pub ready: u64,
    /// Exception of the wake; 0: another task of thread mode.
    pub waker: u16,
    /// Start, µs.
    pub begin: u64,
    /// End, µs.
    pub end: u64,
    /// Time of higher levels in between, µs.
    pub preempted: u64,
}

/// Work for one cause: polls with bus waits in between.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Wake, µs.
    pub ready: u64,
    /// Of the first poll, µs.
    pub begin: u64,
    /// Of the last poll, µs.
    pub end: u64,
    /// Processor time, µs.
    pub execution: u64,
    /// Time of higher levels within its polls, µs.
    pub preempted: u64,
    /// From ends of polls to the next wake, µs.
    pub waited: u64,
}

/// A task of the trace.
#[derive(Clone, Debug)]
pub struct Task {
    /// Name, or address.
    pub name: String,
    /// `None` if never named.
    pub level: Option<Level>,
    /// Its runs, in order.
    pub runs: Vec<Run>,
}

/// Preemptions of one task by another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Preemption {
    /// Count.
    pub count: u32,
    /// Total, µs.
    pub total: u64,
    /// Longest, µs.
    pub longest: u64,
}

/// A trace, played back.
#[derive(Clone, Debug, Default)]
pub struct Replay {
    /// The tasks, most urgent level first.
    pub tasks: Vec<Task>,
    /// Every poll, by end.
    pub polls: Vec<Poll>,
    /// By (preempted task, preempting task).
    pub preemptions: BTreeMap<(usize, usize), Preemption>,
    /// Count of wakes by exception.
    pub wakes: BTreeMap<u16, u32>,
    /// By the events, µs.
    pub covered: u64,
    /// Time without any executor, µs.
    pub idle: u64,
}

enum Frame {
    Executor { exception: u16, start: u64 },
    Poll(Poll),
}

struct Player {
    replay: Replay,
    /// By address.
    index: HashMap<u32, usize>,
    /// Outermost first.
    stack: Vec<Frame>,
    /// Time and exception of each wake.
    ready: HashMap<usize, (u64, u16)>,
    quiet_since: Option<u64>,
    last: Option<u64>,
}

impl Player {
    fn new(trace: &Trace) -> Self {
        let mut names: Vec<_> = trace.names.iter().collect();
        names.sort_by_key(|n| n.level);
        let mut replay = Replay::default();
        let mut index = HashMap::new();
        for name in names {
            index.insert(name.address, replay.tasks.len());
            replay.tasks.push(Task {
                name: name.name.clone(),
                level: Some(name.level),
                runs: Vec::new(),
            });
        }
        Self {
            replay,
            index,
            stack: Vec::new(),
            ready: HashMap::new(),
            quiet_since: None,
            last: None,
        }
    }

    /// After lost events active frames may have ended.
    fn cut(&mut self) {
        self.stack.clear();
        self.ready.clear();
        self.quiet_since = None;
        self.last = None;
    }

    fn play(&mut self, event: &Event) {
        self.replay.covered += self.last.map_or(0, |last| event.at - last);
        self.last = Some(event.at);
        match event.kind {
            Kind::Ready => {
                let task = self.task(event.address);
                self.ready.entry(task).or_insert((event.at, event.exception));
                *self.replay.wakes.entry(event.exception).or_default() += 1;
            }
            Kind::Begin => self.begin(event),
            Kind::End => {
                if let Some(Frame::Poll(poll)) = self.stack.pop_if(|f| matches!(f, Frame::Poll(_))) {
                    let poll = Poll {
                        end: event.at,
                        ..poll
                    };
                    self.replay.ended(&self.stack, poll);
                }
            }
            Kind::Idle => self.idle(event),
        }
    }

    fn task(&mut self, address: u32) -> usize {
        let tasks = &mut self.replay.tasks;
        *self.index.entry(address).or_insert_with(|| {
            tasks.push(Task {
                name: format!("{address:05x}"),
                level: None,
                runs: Vec::new(),
            });
            tasks.len() - 1
        })
    }

    fn begin(&mut self, event: &Event) {
        let task = self.task(event.address);
        let same =
            |f: &Frame| matches!(f, Frame::Executor { exception, .. } if *exception == event.exception);
        if !self.stack.last().is_some_and(same) {
            if self.stack.is_empty() {
                self.replay.idle += self.quiet_since.take().map_or(0, |since| event.at - since);
            }
            self.stack.push(Frame::Executor {
                exception: event.exception,
                start: event.at,
            });
        }
        let at_once = (event.at, event.exception);
        let (ready, waker) = self.ready.remove(&task).unwrap_or(at_once);
        self.stack.push(Frame::Poll(Poll {
            task,
            ready,
            waker,
            begin: event.at,
            end: event.at,
            preempted: 0,
        }));
    }

    fn idle(&mut self, event: &Event) {
        let top = self.stack.pop_if(|f| matches!(f, Frame::Executor { .. }));
        if let Some(Frame::Executor { start, .. }) = top
            && let Some(Frame::Poll(below)) = self.stack.last_mut()
        {
            below.preempted += event.at - start;
        }
        if self.stack.is_empty() {
            self.quiet_since = Some(event.at);
        }
    }
}

impl Replay {
    /// Plays `trace` back.
    #[must_use]
    pub fn of(trace: &Trace) -> Self {
        let mut player = Player::new(trace);
        let mut gaps = trace.gaps.iter().peekable();
        for (number, event) in trace.events.iter().enumerate() {
            let mut cut = false;
            while gaps.next_if(|&&gap| gap <= number).is_some() {
                cut = true;
            }
            if cut {
                player.cut();
            }
            player.play(event);
        }
        player.replay.group();
        player.replay
    }

    fn ended(&mut self, below: &[Frame], poll: Poll) {
        let took = poll.end - poll.begin;
        for frame in below {
            if let Frame::Poll(victim) = frame {
                let entry = self.preemptions.entry((victim.task, poll.task)).or_default();
                entry.count += 1;
                entry.total += took;
                entry.longest = entry.longest.max(took);
            }
        }
        self.polls.push(poll);
    }

    fn group(&mut self) {
        for (number, task) in self.tasks.iter_mut().enumerate() {
            let polls: Vec<&Poll> = self.polls.iter().filter(|p| p.task == number).collect();
            let gap = |pair: &[&Poll]| match pair {
                [before, after] => after.ready.saturating_sub(before.end),
                _ => 0,
            };
            let apart = threshold(polls.windows(2).map(gap).collect());
            let mut previous: Option<&Poll> = None;
            for poll in polls {
                let waited = previous.map(|p| poll.ready.saturating_sub(p.end));
                match (waited, task.runs.last_mut()) {
                    (Some(waited), Some(run)) if (waited as f64) < apart => {
                        run.end = poll.end;
                        run.execution += poll.end - poll.begin - poll.preempted;
                        run.preempted += poll.preempted;
                        run.waited += waited;
                    }
                    _ => task.runs.push(Run {
                        ready: poll.ready,
                        begin: poll.begin,
                        end: poll.end,
                        execution: (poll.end - poll.begin).saturating_sub(poll.preempted),
                        preempted: poll.preempted,
                        waited: 0,
                    }),
                }
                previous = Some(poll);
            }
        }
    }
}

impl Task {
    /// From wake to wake of the runs, µs.
    #[must_use]
    pub fn periods(&self) -> Sorted {
        let pairs = self.runs.iter().zip(self.runs.iter().skip(1));
        Sorted::new(pairs.map(|(a, b)| (b.ready - a.ready) as f64).collect())
    }

    /// `of` each run, µs.
    #[must_use]
    pub fn times(&self, of: impl Fn(&Run) -> u64) -> Sorted {
        Sorted::new(self.runs.iter().map(|run| of(run) as f64).collect())
    }
}

/// Smallest gap before a new run, µs: the middle of the widest logarithmic step with a twentieth of the gaps on either
/// side; without one every poll is a run.
fn threshold(gaps: Vec<u64>) -> f64 {
    let mut gaps: Vec<f64> = gaps.into_iter().map(|g| (g as f64).max(1.0)).collect();
    gaps.sort_by(f64::total_cmp);
    let edge = gaps.len() / 20;
    let pairs = gaps.windows(2).enumerate();
    let steps = pairs.filter_map(|(below, pair)| match pair {
        [a, b] if below >= edge && gaps.len() - below > edge + 1 => Some((b / a, (a * b).sqrt())),
        _ => None,
    });
    match steps.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((step, middle)) if step >= APART => middle,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::{Event, Name};

    const LOW: u32 = 0x100;
    const HIGH: u32 = 0x200;

    fn trace(events: &[(u64, Kind, u32)]) -> Trace {
        let name = |address, level, name: &str| Name {
            address,
            level,
            name: name.into(),
        };
        Trace {
            events: events
                .iter()
                .map(|&(at, kind, address)| Event {
                    at,
                    kind,
                    address,
                    exception: if address == HIGH { 54 } else { 0 },
                })
                .collect(),
            names: vec![
                name(LOW, Level::Background, "low"),
                name(HIGH, Level::Flight, "high"),
            ],
            ..Trace::default()
        }
    }

    #[test]
    fn a_preempted_poll_is_told_from_the_time_that_it_ran() {
        use Kind::{Begin, End, Idle, Ready};
        let replay = Replay::of(&trace(&[
            (0, Ready, LOW),
            (3, Begin, LOW),
            (10, Ready, HIGH),
            (12, Begin, HIGH),
            (20, End, HIGH),
            (21, Idle, HIGH),
            (30, End, LOW),
            (31, Idle, LOW),
            (131, Begin, LOW),
        ]));
        assert_eq!(replay.tasks[0].name, "high");
        let low = replay.tasks[1].runs[0];
        assert_eq!((low.execution, low.preempted, low.begin - low.ready), (18, 9, 3));
        let once = Preemption {
            count: 1,
            total: 8,
            longest: 8,
        };
        assert_eq!(replay.preemptions, BTreeMap::from([((1, 0), once)]));
        assert_eq!((replay.covered, replay.idle), (131, 100));
    }

    #[test]
    fn polls_with_a_short_wait_between_them_are_one_run() {
        use Kind::{Begin, End, Ready};
        let mut events = Vec::new();
        for n in 0..40u64 {
            let at = n * 250;
            events.extend([(at, Ready, HIGH), (at + 1, Begin, HIGH), (at + 2, End, HIGH)]);
            events.extend([
                (at + 14, Ready, HIGH),
                (at + 15, Begin, HIGH),
                (at + 18, End, HIGH),
            ]);
        }
        let replay = Replay::of(&trace(&events));
        let task = &replay.tasks[0];
        assert_eq!(task.runs.len(), 40);
        let run = task.runs[7];
        assert_eq!((run.execution, run.waited, run.end - run.ready), (4, 12, 18));
        assert_eq!(task.periods().deviation(), Some(0.0));
    }

    #[test]
    fn nothing_is_told_across_a_gap() {
        use Kind::{Begin, End, Ready};
        let events = [
            (0, Ready, LOW),
            (1, Begin, LOW),
            (900, End, LOW),
            (901, Ready, LOW),
            (902, Begin, LOW),
            (904, End, LOW),
        ];
        let mut broken = trace(&events);
        broken.gaps = vec![2];
        let replay = Replay::of(&broken);
        assert_eq!(replay.polls.len(), 1);
        assert_eq!(replay.tasks[1].runs[0].execution, 2);
    }
}
