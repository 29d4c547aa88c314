//! Executor events of a firmware with the feature `trace`.
//!
//! `trace task ADDRESS LEVEL NAME` names a task; `trace NUMBER: [bytes]` holds events from the NUMBERth since the
//! start, eight bytes each (format: `boards/src/cortex_m/trace.rs`); `trace lost COUNT` counts lost ones.

use sophie_tasks::schedule::Level;

use crate::live::Garbled;

/// Address bits in an event.
const ADDRESS: u32 = 0x000F_FFFC;

/// Kind of event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A task was woken.
    Ready,
    /// A task is polled.
    Begin,
    /// The poll has ended.
    End,
    /// The executor is idle.
    Idle,
}

/// An event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    /// Time, µs since start.
    pub at: u64,
    /// Kind of event.
    pub kind: Kind,
    /// Target: lower bits of an address.
    pub address: u32,
    /// Active exception; 0 in thread mode.
    pub exception: u16,
}

/// A task's name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// Lower bits of its address.
    pub address: u32,
    /// Its executor.
    pub level: Level,
    /// Its name.
    pub name: String,
}

/// The events of a capture.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// In order of time.
    pub events: Vec<Event>,
    /// Indices of events behind gaps.
    pub gaps: Vec<usize>,
    /// The tasks.
    pub names: Vec<Name>,
    /// Count of missing events.
    pub lost: u64,
    /// Starts of the board in it, from the first event on.
    pub starts: usize,
    pub(crate) next: Option<u32>,
    pub(crate) board_lost: u32,
    /// Of the present start: its first event, and the time of its clock's zero, µs.
    pub(crate) first: usize,
    pub(crate) origin: u64,
}

/// True if a count that only grows, and wraps, has gone from `before` back to `now`: the board has restarted.
fn went_back(before: u32, now: u32) -> bool {
    now.wrapping_sub(before) > u32::MAX / 2
}

impl Trace {
    /// The board starts: its counts and clock begin again. Its events follow the last start's from the next second on.
    pub fn start(&mut self) {
        self.next = None;
        self.board_lost = 0;
        if self.events.len() > self.first {
            self.gaps.push(self.events.len());
            self.first = self.events.len();
            let last = self.events.last().map_or(0, |e| e.at);
            self.origin = (last / 1_000_000 + 1) * 1_000_000;
        }
    }

    /// Takes a line; true if it was of the trace.
    ///
    /// # Errors
    /// A garbled trace line.
    pub fn take(&mut self, line: &str) -> Result<bool, Garbled> {
        let Some((_, rest)) = line.split_once("trace ") else {
            return Ok(false);
        };
        if let Some(name) = rest.strip_prefix("task ") {
            return self.name(name).ok_or(Garbled).map(|()| true);
        }
        if let Some(count) = rest.strip_prefix("lost ") {
            let count: u32 = count.trim().parse().map_err(|_| Garbled)?;
            if went_back(self.board_lost, count) {
                self.start();
            }
            self.lost += u64::from(count.wrapping_sub(self.board_lost));
            self.board_lost = count;
            self.gaps.push(self.events.len());
            return Ok(true);
        }
        match rest.split_once(": [") {
            Some((number, bytes)) if number.bytes().all(|b| b.is_ascii_digit()) => {
                self.events(number, bytes).ok_or(Garbled).map(|()| true)
            }
            // Prose may begin with the same word.
            _ => Ok(false),
        }
    }

    fn name(&mut self, text: &str) -> Option<()> {
        let mut words = text.split_whitespace();
        let address = u32::from_str_radix(words.next()?, 16).ok()? & ADDRESS;
        let level = words.next()?;
        let level = [Level::Flight, Level::Steady, Level::Background]
            .into_iter()
            .find(|l| l.name() == level)?;
        let name = words.next()?.to_owned();
        if !self.names.iter().any(|n| n.address == address) {
            self.names.push(Name { address, level, name });
        }
        Some(())
    }

    fn events(&mut self, number: &str, bytes: &str) -> Option<()> {
        let number: u32 = number.parse().ok()?;
        let bytes: Option<Vec<u8>> = bytes
            .trim_end()
            .strip_suffix(']')?
            .split(", ")
            .map(|b| u8::from_str_radix(b.trim_start_matches("0x"), 16).ok())
            .collect();
        let bytes = bytes?;
        let (events, rest) = bytes.as_chunks::<8>();
        if !rest.is_empty() || events.is_empty() {
            return None;
        }
        // The greeting of a start may be lost as any other line.
        if self.next.is_some_and(|next| went_back(next, number)) {
            self.start();
        }
        if let Some(next) = self.next
            && number != next
        {
            self.lost += u64::from(number.wrapping_sub(next));
            self.gaps.push(self.events.len());
        }
        self.next = Some(number.wrapping_add(events.len() as u32));
        for event in events {
            let word = |at: usize| {
                let bytes = event.get(at..at + 4).and_then(|b| b.try_into().ok());
                u32::from_le_bytes(bytes.unwrap_or_default())
            };
            let event = self.event(word(0), word(4))?;
            self.starts += usize::from(self.events.len() == self.first);
            self.events.push(event);
        }
        Some(())
    }

    fn event(&self, time: u32, what: u32) -> Option<Event> {
        let kind = match what & 7 {
            0 => Kind::Ready,
            1 => Kind::Begin,
            2 => Kind::End,
            3 => Kind::Idle,
            _ => return None,
        };
        // The clock's lower half wraps every 71 minutes.
        let at = match self.events.last() {
            Some(last) if self.events.len() > self.first => {
                last.at + u64::from(time.wrapping_sub((last.at - self.origin) as u32))
            }
            _ => self.origin + u64::from(time),
        };
        Some(Event {
            at,
            kind,
            address: (what >> 1) & ADDRESS,
            exception: (what >> 21) as u16,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(number: u32, events: &[(u32, u32)]) -> String {
        let words = events.iter().flat_map(|&(time, what)| [time, what]);
        let bytes: Vec<String> = words
            .flat_map(u32::to_le_bytes)
            .map(|b| format!("{b:02x}"))
            .collect();
        format!("1.0 INFO trace {number}: [{}]", bytes.join(", "))
    }

    #[test]
    fn an_event_is_unpacked() {
        let mut trace = Trace::default();
        let what = 1 | (0x240A_51C0 & ADDRESS) << 1 | 54 << 21;
        assert_eq!(trace.take(&line(0, &[(u32::MAX, what), (2, what)])), Ok(true));
        let expected = Event {
            at: u64::from(u32::MAX),
            kind: Kind::Begin,
            address: 0x000A_51C0,
            exception: 54,
        };
        assert_eq!(trace.events[0], expected);
        assert_eq!(trace.events[1].at, expected.at + 3);
    }

    #[test]
    fn what_the_probe_dropped_is_counted() {
        let mut trace = Trace::default();
        for number in [0, 1, 5] {
            assert_eq!(trace.take(&line(number, &[(number, 0)])), Ok(true));
        }
        assert_eq!((trace.lost, trace.gaps.as_slice()), (3, &[2][..]));
        assert_eq!(trace.take("trace lost 7"), Ok(true));
        assert_eq!(trace.lost, 10);
    }

    #[test]
    fn a_start_of_the_board_is_no_loss() {
        // With its greeting, and with that lost.
        for greeted in [true, false] {
            let mut trace = Trace::default();
            for start in 0..2 {
                if greeted {
                    trace.start();
                }
                for number in [9, 10, 11] {
                    assert_eq!(trace.take(&line(number, &[(1_500_000 + number, 0)])), Ok(true));
                }
                assert_eq!(trace.take(&format!("trace lost {}", 5 - start)), Ok(true));
            }
            assert_eq!((trace.lost, trace.starts), (5 + 4, 2), "greeted: {greeted}");
            let times: Vec<u64> = trace.events.iter().map(|e| e.at).collect();
            assert_eq!(times[..3], [1_500_009, 1_500_010, 1_500_011]);
            assert_eq!(times[3..], [3_500_009, 3_500_010, 3_500_011]);
            assert!(trace.gaps.contains(&3));
        }
    }

    #[test]
    fn counts_that_wrap_are_no_start() {
        let mut trace = Trace::default();
        for number in [u32::MAX, 0, 1] {
            assert_eq!(trace.take(&line(number, &[(number, 0)])), Ok(true));
        }
        assert_eq!((trace.lost, trace.starts), (0, 1));
    }

    #[test]
    fn names_are_kept_once_and_garbled_lines_refused() {
        let mut trace = Trace::default();
        for _ in 0..2 {
            assert_eq!(trace.take("trace task 240a51c0 flight imu"), Ok(true));
        }
        assert_eq!(trace.names.len(), 1);
        let whole = line(0, &[(1, 1)]);
        for end in [whole.len() - 1, whole.len() - 3, whole.len() - 5] {
            assert_eq!(trace.take(&whole[..end]), Err(Garbled));
        }
        assert_eq!(trace.take("trace task 240a51c0 flig"), Err(Garbled));
        assert_eq!(trace.take("no trace of it"), Ok(false));
    }
}
