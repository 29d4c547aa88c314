//! Tables for the terminal.

use std::fmt::Write;

use crate::capture::{Capture, worst};
use crate::live::{Contact, Quantiles};
use crate::replay::{Replay, Task};
use crate::stats::Sorted;

const BAR: usize = 40;

/// The tables of a capture.
#[must_use]
pub fn tables(capture: &Capture, replay: &Replay) -> String {
    let board = capture.board.as_deref().unwrap_or("board not named");
    let mut text = format!("{board}: {}\n", capture.extent());
    if !capture.tasks.is_empty() {
        text += &seconds(capture);
    }
    if !replay.polls.is_empty() {
        text += &runs(capture, replay);
        text += &preemptions(replay);
        text += &histograms(replay);
    }
    text
}

fn seconds(capture: &Capture) -> String {
    let mut text =
        String::from("\nEach second's records: half / 99 % / all runs, us from release (docs/timing.md)\n\n");
    let _ = writeln!(
        text,
        "{:11} {:>8} {:>7} {:>20} {:>20} {:>20} {:>8} {:>7}",
        "task", "runs", "1/s", "late", "run", "response", "deadline", "missed"
    );
    for task in &capture.tasks {
        let [late, run, response] = [
            task.over(|s| s.late),
            task.over(|s| s.run),
            task.over(|s| s.response),
        ]
        .map(quantiles);
        let _ = writeln!(
            text,
            "{:11} {:>8} {:>7.1} {late:>20} {run:>20} {response:>20} {:>8} {:>7}",
            task.name,
            task.runs(),
            task.rate(),
            task.deadline(),
            task.missed()
        );
    }
    let times: Vec<Quantiles> = capture.chain.iter().map(|c| c.times).collect();
    if let Some(min) = capture.chain.iter().map(|c| c.min).min() {
        let all = worst(&times);
        let _ = writeln!(
            text,
            "\ndata-ready to motor frame: {min} to {} us, half within {}, 99 % within {}",
            all.max, all.p50, all.p99
        );
    }
    text + &contact(&capture.contact)
}

/// From contact pressure to servo pulse; empty without records.
fn contact(seconds: &[Contact]) -> String {
    let (Some(min), Some(last)) = (seconds.iter().map(|c| c.min).min(), seconds.last()) else {
        return String::new();
    };
    let [command, pulse] = [|c: &Contact| c.command, |c: &Contact| c.pulse]
        .map(|of| worst(&seconds.iter().map(of).collect::<Vec<_>>()));
    let missed: u64 = seconds.iter().map(|c| u64::from(c.missed)).sum();
    format!(
        "pressure to servo pulse: {min} to {} us of {}, half within {}, 99 % within {}, {missed} missed; to its command half within {}, all within {}\n",
        pulse.max, last.deadline, pulse.p50, pulse.p99, command.p50, command.max
    )
}

fn quantiles(q: Quantiles) -> String {
    format!("{} / {} / {}", q.p50, q.p99, q.max)
}

fn runs(capture: &Capture, replay: &Replay) -> String {
    let idle = 100.0 * replay.idle as f64 / replay.covered.max(1) as f64;
    let mut text = format!(
        "\nTrace of {:.3} s, executors idle for {idle:.1} % of it: half / 99 % / all runs, us from the wake\n\n",
        replay.covered as f64 * 1e-6
    );
    let _ = writeln!(
        text,
        "{:11} {:10} {:>6} {:>30} {:>16} {:>18} {:>20} {:>8}",
        "task",
        "level",
        "runs",
        "period: mean min max sd",
        "wake to run",
        "execution",
        "response",
        "deadline"
    );
    for task in replay.tasks.iter().filter(|t| !t.runs.is_empty()) {
        let periods = task.periods();
        let period = match (periods.mean(), periods.min(), periods.max(), periods.deviation()) {
            (Some(mean), Some(min), Some(max), Some(sd)) => format!("{mean:.1} {min:.0} {max:.0} {sd:.1}"),
            _ => "-".into(),
        };
        let deadline = capture.tasks.iter().find(|t| t.name == task.name);
        let _ = writeln!(
            text,
            "{:11} {:10} {:>6} {period:>30} {:>16} {:>18} {:>20} {:>8}",
            task.name,
            task.level.map_or("", |l| l.name()),
            task.runs.len(),
            exact(&task.times(|r| r.begin - r.ready)),
            exact(&task.times(|r| r.execution)),
            exact(&task.times(|r| r.end - r.ready)),
            deadline.map_or("-".into(), |t| t.deadline().to_string())
        );
    }
    text
}

fn exact(times: &Sorted) -> String {
    let at = |share| times.quantile(share).unwrap_or(0.0);
    format!("{:.0} / {:.0} / {:.0}", at(0.5), at(0.99), at(1.0))
}

fn preemptions(replay: &Replay) -> String {
    let mut text = String::from("\nPreemptions: who, by whom, how often, longest and in all (us)\n\n");
    let name = |n: usize| replay.tasks.get(n).map_or("?", |t| t.name.as_str());
    for (&(victim, by), p) in &replay.preemptions {
        let _ = writeln!(
            text,
            "{:11} by {:11} {:>7} {:>7} {:>9}",
            name(victim),
            name(by),
            p.count,
            p.longest,
            p.total
        );
    }
    if replay.preemptions.is_empty() {
        text += "none\n";
    }
    text
}

fn histograms(replay: &Replay) -> String {
    let mut text = String::from("\nResponses, us from the wake\n");
    for task in replay.tasks.iter().filter(|t| !t.runs.is_empty()) {
        let _ = write!(text, "\n{}\n{}", task.name, histogram(task));
    }
    text
}

fn histogram(task: &Task) -> String {
    let octaves = task.times(|r| r.end - r.ready).octaves();
    let most = octaves.iter().map(|o| o.2).max().unwrap_or(1);
    let mut text = String::new();
    for (from, to, count) in octaves {
        let bar = "#".repeat((count * BAR).div_ceil(most));
        let _ = writeln!(text, "{from:>8.0} to {to:<8.0} {count:>7} {bar}");
    }
    text
}
