//! Steps that watch measured values while the builder moves the measured part.

use std::time::{Duration, Instant};

use super::walk::{Stop, Verdict, Walk, understood};
use super::{Judged, Step};
use sophie_board_link::Failure;

/// Rows before a reply counts: one second.
const ROWS: usize = 5;
/// Time for the board to notice that the transmitter was switched off or on.
const NOTICED: Duration = Duration::from_secs(10);

/// A column of `watch`, and the range that the builder must move it through.
struct Moved {
    name: &'static str,
    /// The span or the two ends that it must reach.
    reach: Reach,
}

#[derive(Clone, Copy)]
enum Reach {
    /// Least distance between the extremes.
    Span(f32),
    /// Largest minimum and least maximum.
    Ends(f32, f32),
}

/// The extremes of a column.
#[derive(Clone, Debug)]
struct Seen {
    name: String,
    least: f32,
    most: f32,
    /// The newest row has a number.
    fresh: bool,
}

/// Rolled and pitched by hand, deg.
const IMU: [Moved; 2] = [
    Moved {
        name: "roll",
        reach: Reach::Span(10.0),
    },
    Moved {
        name: "pitch",
        reach: Reach::Span(10.0),
    },
];
/// Tips bent up by hand, deg.
const ARMS: [Moved; 4] = [
    Moved {
        name: "tilt1",
        reach: Reach::Span(3.0),
    },
    Moved {
        name: "tilt2",
        reach: Reach::Span(3.0),
    },
    Moved {
        name: "tilt3",
        reach: Reach::Span(3.0),
    },
    Moved {
        name: "tilt4",
        reach: Reach::Span(3.0),
    },
];
/// Pads pressed by a thumb, Pa.
const GRIP: [Moved; 4] = [
    Moved {
        name: "press1",
        reach: Reach::Span(100.0),
    },
    Moved {
        name: "press2",
        reach: Reach::Span(100.0),
    },
    Moved {
        name: "press3",
        reach: Reach::Span(100.0),
    },
    Moved {
        name: "press4",
        reach: Reach::Span(100.0),
    },
];
/// Sticks to their ends, switches to theirs.
const STICKS: [Moved; 8] = [
    Moved {
        name: "roll",
        reach: Reach::Ends(-0.95, 0.95),
    },
    Moved {
        name: "pitch",
        reach: Reach::Ends(-0.95, 0.95),
    },
    Moved {
        name: "yaw",
        reach: Reach::Ends(-0.95, 0.95),
    },
    Moved {
        name: "thrott",
        reach: Reach::Ends(0.02, 0.95),
    },
    Moved {
        name: "arm",
        reach: Reach::Ends(0.0, 1.0),
    },
    Moved {
        name: "perch",
        reach: Reach::Ends(0.0, 1.0),
    },
    Moved {
        name: "mode",
        reach: Reach::Ends(0.0, 2.0),
    },
    Moved {
        name: "arms",
        reach: Reach::Ends(0.0, 2.0),
    },
];

impl Seen {
    fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            least: f32::INFINITY,
            most: f32::NEG_INFINITY,
            fresh: false,
        }
    }

    fn see(&mut self, text: &str) {
        let number = text.parse::<f32>().ok().filter(|number| number.is_finite());
        self.fresh = number.is_some();
        if let Some(number) = number {
            self.least = self.least.min(number);
            self.most = self.most.max(number);
        }
    }

    /// The figure, with the missing part of `reach`; true if it was reached.
    fn judged(&self, reach: Option<Reach>) -> (bool, String) {
        let Self {
            name,
            least,
            most,
            fresh,
        } = self;
        if !fresh || least > most {
            return (false, format!("{name} silent"));
        }
        let figure = format!("{name} {least} to {most}");
        match reach {
            None => (true, figure),
            Some(Reach::Span(span)) if most - least >= span => (true, figure),
            Some(Reach::Span(span)) => (false, format!("{figure}; to be moved by {span} at least")),
            Some(Reach::Ends(low, high)) if *least <= low && *most >= high => (true, figure),
            Some(Reach::Ends(low, high)) => (false, format!("{figure}; {low} to {high} at least")),
        }
    }
}

pub(super) fn imu(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    watched(walk, "imu", &IMU)
}

pub(super) fn arms(walk: &mut Walk<'_>, _: &Step) -> Judged {
    watched(walk, "arms", &ARMS)
}

pub(super) fn grip(walk: &mut Walk<'_>, _: &Step) -> Judged {
    watched(walk, "grip", &GRIP)
}

fn watched(walk: &mut Walk<'_>, group: &str, moved: &[Moved]) -> Judged {
    let seen = watch(walk, group)?;
    let judged = seen.iter().map(|seen| {
        let moved = moved.iter().find(|moved| moved.name == seen.name);
        seen.judged(moved.map(|moved| moved.reach))
    });
    let (right, figures): (Vec<bool>, Vec<String>) = judged.unzip();
    let passed = seen.len() >= moved.len() && right.into_iter().all(|right| right);
    Ok(Verdict::of(passed, figures))
}

/// Shows the group until the builder replies.
fn watch(walk: &mut Walk<'_>, group: &str) -> Result<Vec<Seen>, Stop> {
    let command = format!("watch {group}");
    walk.say("  Enter once they have followed, s skips, q stops:");
    walk.session.begin(&command)?;
    let mut seen = Vec::<Seen>::new();
    let mut rows = 0;
    let ended = loop {
        let line = walk.session.line(&command)?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let numbers = words
            .iter()
            .all(|word| *word == "-" || word.parse::<f32>().is_ok());
        if words.len() == seen.len() && numbers && !words.is_empty() {
            rows += 1;
            seen.iter_mut()
                .zip(&words)
                .for_each(|(seen, word)| seen.see(word));
            walk.user.live(&line);
        } else if rows == 0 && !words.is_empty() {
            // First the line of units, then the names.
            walk.say(&line);
            seen = words.iter().map(|word| Seen::new(word)).collect();
        }
        if rows >= ROWS
            && let Some(reply) = walk.user.answered()
        {
            break understood(reply);
        }
    };
    walk.session.cancel()?;
    ended?;
    Ok(seen)
}

pub(super) fn radio(walk: &mut Walk<'_>, _: &Step) -> Judged {
    if let Some(refused) = walk.propellers_off()? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    walk.say(
        "  Each stick to its ends, each switch through its positions. Throttle up before the arm switch",
    );
    walk.say("  goes on, and off before the throttle comes down: so nothing arms.");
    let mut verdict = watched(walk, "sticks", &STICKS)?;
    if !verdict.passed {
        return Ok(verdict);
    }
    walk.ask("Now switch the transmitter off, then Enter:")?;
    let gone = receiver(walk, |line| line.contains("silent"))?;
    walk.ask("And on again, arm switch off, throttle low, then Enter:")?;
    let back = receiver(walk, |line| !line.contains("silent"))?;
    for (what, line) in [("off", &gone), ("on", &back)] {
        verdict.passed &= line.is_ok();
        let line = line.as_ref().unwrap_or_else(|line| line);
        verdict.figures.push(format!("transmitter {what}: {line}"));
    }
    Ok(verdict)
}

/// The receiver's line of `status` once it is `wanted`.
///
/// # Errors
/// The last line, if it never is.
fn receiver(walk: &mut Walk<'_>, wanted: impl Fn(&str) -> bool) -> Result<Result<String, String>, Stop> {
    let begun = Instant::now();
    loop {
        let status = walk.session.command("status")?;
        let line = status.into_iter().find(|line| line.starts_with("receiver "));
        let Some(line) = line else {
            let port = walk.session.port();
            let why = format!("{port}: 'status' has no line of the receiver");
            return Err(Stop::Failed(Failure::Board(why)));
        };
        if wanted(&line) {
            return Ok(Ok(line));
        }
        if begun.elapsed() > NOTICED {
            return Ok(Err(line));
        }
        std::thread::sleep(Duration::from_millis(200));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_judged_by_what_it_has_shown() {
        let seen = |texts: &[&str]| {
            let mut seen = Seen::new("roll");
            texts.iter().for_each(|text| seen.see(text));
            seen
        };
        let ends = Some(Reach::Ends(-0.95, 0.95));
        for (texts, reach, wanted) in [
            (&["-1.00", "1.00"][..], ends, (true, "roll -1 to 1")),
            (
                &["-1.00", "0.90"],
                ends,
                (false, "roll -1 to 0.9; -0.95 to 0.95 at least"),
            ),
            (&["1.0", "-"], ends, (false, "roll silent")),
            (&["-", "1.0"], None, (true, "roll 1 to 1")),
            (&[], None, (false, "roll silent")),
            (
                &["0", "9.9"],
                Some(Reach::Span(10.0)),
                (false, "roll 0 to 9.9; to be moved by 10 at least"),
            ),
            (&["-5", "5"], Some(Reach::Span(10.0)), (true, "roll -5 to 5")),
        ] {
            let (passed, text) = seen(texts).judged(reach);
            assert_eq!((passed, &*text), wanted, "{texts:?}");
        }
    }
}
