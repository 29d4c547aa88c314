//! Timing records of every firmware: tasks and chains each second, and missed deadlines.

/// A timing line that cannot be parsed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Garbled;

/// Of a second's runs, µs: median, 99 %, maximum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quantiles {
    /// Half of them.
    pub p50: u32,
    /// 99 % of them.
    pub p99: u32,
    /// All.
    pub max: u32,
}

/// One task's second.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Record {
    /// Its name.
    pub task: String,
    /// Runs.
    pub runs: u32,
    /// From release to start.
    pub late: Quantiles,
    /// From start to end, preemption and waits included.
    pub run: Quantiles,
    /// From release to end.
    pub response: Quantiles,
    /// Deadline, µs after release.
    pub deadline: u32,
    /// Deadlines missed.
    pub missed: u32,
}

/// A second of the chain from data-ready to motor frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chain {
    /// Frames.
    pub frames: u32,
    /// The quickest, µs.
    pub min: u32,
    /// The others.
    pub times: Quantiles,
}

/// A second of the chain from pressure conversion to servo pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    /// Conversions answered by a pulse.
    pub pulses: u32,
    /// From conversion to written pulse widths.
    pub command: Quantiles,
    /// Shortest time to the pulse, µs.
    pub min: u32,
    /// From conversion to pulse, with the wait for the servo frame.
    pub pulse: Quantiles,
    /// Deadline of the pulse, µs after the conversion.
    pub deadline: u32,
    /// Deadlines missed.
    pub missed: u32,
}

/// Content of a log line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Line {
    /// Of a task.
    Record(Record),
    /// Of the chain.
    Chain(Chain),
    /// Of the contact chain.
    Contact(Contact),
}

/// Parses a timing line, if it is one.
///
/// # Errors
/// A garbled timing line.
pub fn parse(line: &str) -> Option<Result<Line, Garbled>> {
    let (_, rest) = line.split_once("timing ")?;
    let (task, rest) = rest.split_once(": ")?;
    // Prose may begin with the same word.
    if task.contains(' ') {
        return None;
    }
    let parsed = match task {
        "chain" => chain(rest).map(Line::Chain),
        "contact" => contact(rest).map(Line::Contact),
        _ => record(task, rest).map(Line::Record),
    };
    Some(parsed.ok_or(Garbled))
}

fn record(task: &str, rest: &str) -> Option<Record> {
    let (runs, rest) = rest.split_once("/s, late ")?;
    let (late, rest) = rest.split_once(", run ")?;
    let (run, rest) = rest.split_once(", response ")?;
    let (response, rest) = rest.split_once(" of ")?;
    let (deadline, rest) = rest.split_once(" us, ")?;
    let (missed, _) = rest.split_once(" missed")?;
    let [late, run, response] = [late, run, response].map(quantiles);
    Some(Record {
        task: task.to_owned(),
        runs: runs.parse().ok()?,
        late: late?,
        run: run?,
        response: response?,
        deadline: deadline.parse().ok()?,
        missed: missed.parse().ok()?,
    })
}

fn chain(rest: &str) -> Option<Chain> {
    let (frames, rest) = rest.split_once("/s, ")?;
    let (times, _) = rest.split_once(" us from data-ready to motor frame")?;
    let (min, times) = times.split_once('/')?;
    Some(Chain {
        frames: frames.parse().ok()?,
        min: min.parse().ok()?,
        times: quantiles(times)?,
    })
}

fn contact(rest: &str) -> Option<Contact> {
    let (pulses, rest) = rest.split_once("/s, ")?;
    let (command, rest) = rest.split_once(" us from pressure to servo command, ")?;
    let (times, rest) = rest.split_once(" us to its pulse of ")?;
    let (deadline, rest) = rest.split_once(" us, ")?;
    let (missed, _) = rest.split_once(" missed")?;
    let (min, times) = times.split_once('/')?;
    Some(Contact {
        pulses: pulses.parse().ok()?,
        command: quantiles(command)?,
        min: min.parse().ok()?,
        pulse: quantiles(times)?,
        deadline: deadline.parse().ok()?,
        missed: missed.parse().ok()?,
    })
}

fn quantiles(text: &str) -> Option<Quantiles> {
    let mut numbers = text.split('/').map(|n| n.parse().ok());
    let quantiles = Quantiles {
        p50: numbers.next()??,
        p99: numbers.next()??,
        max: numbers.next()??,
    };
    numbers.next().is_none().then_some(quantiles)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: &str = "   6.400122 INFO  timing imu: 1000/s, late 21/22/24, run 3/3/4, response 24/27/28 of 200 us, 2 missed";

    #[test]
    fn a_record_is_read_behind_whatever_the_tool_writes_before_it() {
        let Some(Ok(Line::Record(r))) = parse(LINE) else {
            unreachable!()
        };
        assert_eq!(
            (r.task.as_str(), r.runs, r.deadline, r.missed),
            ("imu", 1000, 200, 2)
        );
        assert_eq!(
            r.response,
            Quantiles {
                p50: 24,
                p99: 27,
                max: 28
            }
        );
        let chain = parse("timing chain: 999/s, 42/43/43/44 us from data-ready to motor frame");
        let times = Quantiles {
            p50: 43,
            p99: 43,
            max: 44,
        };
        let expected = Chain {
            frames: 999,
            min: 42,
            times,
        };
        assert_eq!(chain, Some(Ok(Line::Chain(expected))));
    }

    #[test]
    fn the_contact_chain_is_read_to_its_last_number_or_not_at_all() {
        const LINE: &str = "timing contact: 50/s, 6143/9215/9100 us from pressure to servo command, 9514/16383/17000/16990 us to its pulse of 35000 us, 3 missed";
        let [p50, p99, max] = [6143, 9215, 9100];
        let expected = Contact {
            pulses: 50,
            command: Quantiles { p50, p99, max },
            min: 9514,
            pulse: Quantiles {
                p50: 16_383,
                p99: 17_000,
                max: 16_990,
            },
            deadline: 35_000,
            missed: 3,
        };
        assert_eq!(parse(LINE), Some(Ok(Line::Contact(expected))));
        for end in LINE.find("50/s").unwrap_or(0)..LINE.len() - "missed".len() {
            assert_eq!(parse(&LINE[..end]), Some(Err(Garbled)), "{}", &LINE[..end]);
        }
    }

    #[test]
    fn other_lines_are_none_and_broken_ones_errors() {
        assert_eq!(parse("0.1 INFO DISARMED"), None);
        assert_eq!(parse("0.1 INFO the timing is good: indeed"), None);
        for end in LINE.find("late").unwrap_or(0)..LINE.len() - "missed".len() {
            assert_eq!(parse(&LINE[..end]), Some(Err(Garbled)), "{}", &LINE[..end]);
        }
    }
}
