//! Worst-case bounds of every deadline from the longest measured executions (docs/timing.md).

use std::fmt::Write;

use sophie_tasks::schedule::{Level, TaskId};

use crate::capture::Capture;
use crate::replay::{Replay, Task};
use crate::rta::{Load, rate_monotonic_bound, response, utilisation};

/// Wakes a task; µs on the reference board: 400 instructions.
const INTERRUPT: f64 = 1.0;
/// Longest with interrupts masked, µs on the reference board: encoding of the longest log line.
const BLOCKING: f64 = 5.0;
/// A clock of whole µs shortens an execution by less.
const RESOLUTION: f64 = 1.0;
/// Periods without a wake after which a sample-driven task counts as paused.
const PAUSE: f64 = 10.0;
/// Logs the trace; absent from the image that flies.
const TRACER: &str = "trace";
/// Its bus wait begins every run of the flight level.
const FIRST: &str = "imu";

/// Boards, and their time for 1 µs of the reference board: by clock, and on an M4F by the control path's instructions
/// (docs/cost.md).
const BOARDS: [(&str, f64); 3] = [
    ("matek-h743", 1.0),
    ("cuav-v5", 400.0 / 216.0),
    ("f405", 400.0 / 168.0 * 2166.0 / 1773.0),
];

struct Set {
    loads: Vec<Load>,
    /// Index in `loads`, and deadline, µs.
    deadlines: Vec<(usize, f64)>,
}

/// Bounds of every deadline, for each board.
#[must_use]
pub fn analyse(capture: &Capture, replay: &Replay) -> String {
    let set = if replay.polls.is_empty() {
        of_seconds(capture)
    } else {
        of_trace(capture, &at_work(replay))
    };
    let known = capture.board.as_deref();
    let measured = BOARDS.iter().find(|b| Some(b.0) == known).unwrap_or(&BOARDS[0]);
    let mut text = format!(
        "\nResponse-time bounds, us, from executions measured on {}; margin to the deadline\n\n{:11} {:10} {:>9} {:>9} {:>8}",
        measured.0, "task", "level", "period", "execution", "deadline"
    );
    for (board, _) in BOARDS {
        let scaled = if board == measured.0 { "" } else { ", scaled" };
        let _ = write!(text, " {:>18}", format!("{board}{scaled}"));
    }
    text.push('\n');
    for &(index, deadline) in &set.deadlines {
        let Some(load) = set.loads.get(index) else {
            continue;
        };
        let level = level_name(load.level);
        let _ = write!(
            text,
            "{:11} {level:10} {:>9.0} {:>9.0} {deadline:>8.0}",
            load.name, load.period, load.execution
        );
        for (_, factor) in BOARDS {
            let scale = factor / measured.1;
            let loads = scaled(&set.loads, scale);
            let cell = match response(&loads, index, BLOCKING * scale) {
                Some(bound) => format!("{bound:.0} ({:+.0} %)", 100.0 * (deadline - bound) / deadline),
                None => "none".into(),
            };
            let _ = write!(text, " {cell:>18}");
        }
        text.push('\n');
    }
    text.push('\n');
    for (board, factor) in BOARDS {
        let loads = scaled(&set.loads, factor / measured.1);
        let _ = writeln!(
            text,
            "{board}: {:.1} % of the processor at most",
            100.0 * utilisation(&loads)
        );
    }
    let _ = writeln!(
        text,
        "scaled: by the clock and the control path's instructions, which is coarse: a board's own trace bounds it more closely"
    );
    let bound = rate_monotonic_bound(set.loads.len());
    let _ = writeln!(
        text,
        "any rate-monotonic set of {} keeps up to {:.1} %",
        set.loads.len(),
        100.0 * bound
    );
    text += &inversions(&set.loads);
    text
}

/// Runs since the flight level's last pause: before, the sensor is tested and no task has its period.
fn at_work(replay: &Replay) -> Replay {
    let flight = replay.tasks.iter().filter(|t| t.level == Some(Level::Flight));
    let start = flight.filter_map(after_the_last_pause).max().unwrap_or(0);
    let begun = replay.polls.iter().map(|poll| poll.begin).min().unwrap_or(start);
    let mut replay = replay.clone();
    for task in &mut replay.tasks {
        task.runs.retain(|run| run.begin >= start);
    }
    replay.covered = replay.covered.saturating_sub(start.saturating_sub(begun));
    replay
}

fn after_the_last_pause(task: &Task) -> Option<u64> {
    let usual = task.periods().quantile(0.5).unwrap_or(0.0);
    let pairs = task.runs.windows(2).rev();
    let paused = pairs.map_while(|pair| match pair {
        [before, after] if ((after.ready - before.ready) as f64) < PAUSE * usual => Some(before.begin),
        _ => None,
    });
    paused.last().or(task.runs.last().map(|run| run.begin))
}

fn of_trace(capture: &Capture, replay: &Replay) -> Set {
    let mut set = interrupts(replay);
    let bus = replay
        .tasks
        .iter()
        .find(|t| t.name == FIRST)
        .and_then(|t| t.times(|r| r.waited).max())
        .unwrap_or(0.0);
    for task in &replay.tasks {
        let (Some(level), Some(execution)) = (task.level, task.times(|r| r.execution).max()) else {
            continue;
        };
        if task.name == TRACER {
            continue;
        }
        let whole = replay.covered as f64 / task.runs.len().max(1) as f64;
        let periods = task.periods();
        let seen = periods.mean().unwrap_or(whole);
        let seconds = capture.tasks.iter().find(|t| t.name == task.name);
        if let Some(seconds) = seconds {
            set.deadlines
                .push((set.loads.len(), f64::from(seconds.deadline())));
        }
        // A release may take several runs, with waits that its record includes. For the first task each sample is a
        // release.
        let released = seconds
            .map(|s| 1e6 / s.rate().max(1e-3))
            .filter(|_| task.name != FIRST);
        let period = released.unwrap_or(seen);
        let execution = (execution + RESOLUTION) * (period / seen).round().max(1.0);
        let recorded = seconds.map_or(0.0, |s| f64::from(s.over(|second| second.run).max));
        set.loads.push(Load {
            name: task.name.clone(),
            level: number(level),
            execution,
            period,
            jitter: periods.min().map_or(0.0, |min| seen - min),
            waited: match level {
                Level::Flight => bus,
                _ => (recorded - execution).max(0.0),
            },
        });
    }
    set
}

/// With their rates.
fn interrupts(replay: &Replay) -> Set {
    let vectors = replay.wakes.iter().filter(|(exception, _)| **exception >= 16);
    let loads = vectors.map(|(exception, &count)| Load {
        name: format!("interrupt {}", exception - 16),
        level: 0,
        execution: INTERRUPT,
        period: replay.covered as f64 / f64::from(count.max(1)),
        jitter: 0.0,
        waited: 0.0,
    });
    Set {
        loads: loads.collect(),
        deadlines: Vec::new(),
    }
}

/// Without trace: whole runs, with preemption and waits, count as executions.
fn of_seconds(capture: &Capture) -> Set {
    let mut set = Set {
        loads: Vec::new(),
        deadlines: Vec::new(),
    };
    for task in &capture.tasks {
        let Some(id) = TaskId::ALL.into_iter().find(|id| id.name() == task.name) else {
            continue;
        };
        set.deadlines.push((set.loads.len(), f64::from(task.deadline())));
        set.loads.push(Load {
            name: task.name.clone(),
            level: number(id.level()),
            execution: f64::from(task.over(|s| s.run).max) + RESOLUTION,
            period: 1e6 / task.rate().max(1e-3),
            jitter: 0.0,
            waited: match id.level() {
                Level::Flight => first_wait(capture),
                _ => 0.0,
            },
        });
    }
    set
}

fn first_wait(capture: &Capture) -> f64 {
    let first = capture.tasks.iter().find(|t| t.name == FIRST);
    first.map_or(0.0, |t| f64::from(t.over(|s| s.late).max))
}

fn scaled(loads: &[Load], factor: f64) -> Vec<Load> {
    let scale = |l: &Load| Load {
        execution: l.execution * factor,
        ..l.clone()
    };
    loads.iter().map(scale).collect()
}

/// Pairs against the rate-monotonic order.
fn inversions(loads: &[Load]) -> String {
    let mut text = String::new();
    for above in loads.iter().filter(|l| l.level > 0) {
        let below = loads
            .iter()
            .filter(|l| l.level > above.level && l.period < 0.9 * above.period);
        for below in below {
            let _ = writeln!(
                text,
                "not rate-monotonic: {} (each {:.0} us) is above {} (each {:.0} us)",
                above.name, above.period, below.name, below.period
            );
        }
    }
    text
}

fn number(level: Level) -> u8 {
    match level {
        Level::Flight => 1,
        Level::Steady => 2,
        Level::Background => 3,
    }
}

fn level_name(number: u8) -> &'static str {
    match number {
        1 => Level::Flight.name(),
        2 => Level::Steady.name(),
        _ => Level::Background.name(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::{Poll, Run};

    fn run(begin: u64, execution: u64) -> Run {
        Run {
            ready: begin,
            begin,
            end: begin + execution,
            execution,
            preempted: 0,
            waited: 0,
        }
    }

    #[test]
    fn the_test_of_the_sensor_at_the_start_is_no_part_of_the_work() {
        // All are polled at the start; then the sensor is tested; samples come after 1 s.
        let samples = (0..100).map(|n| 1_000_000 + 1000 * n);
        let imu = [run(10, 5), run(20_000, 460), run(220_000, 400)];
        let task = |name: &str, runs: Vec<Run>| Task {
            name: name.into(),
            level: Some(Level::Flight),
            runs,
        };
        let imu = imu.into_iter().chain(samples.clone().map(|t| run(t, 15)));
        let estimator = [run(12, 1)].into_iter().chain(samples.map(|t| run(t + 16, 3)));
        let replay = Replay {
            tasks: vec![task("imu", imu.collect()), task("estimator", estimator.collect())],
            polls: vec![Poll {
                task: 0,
                ready: 10,
                waker: 0,
                begin: 10,
                end: 15,
                preempted: 0,
            }],
            covered: 1_100_000,
            ..Replay::default()
        };
        let work = at_work(&replay);
        assert_eq!(
            work.tasks.iter().map(|t| t.runs.len()).collect::<Vec<_>>(),
            [99, 100]
        );
        assert_eq!(
            work.tasks.first().unwrap().times(|r| r.execution).max(),
            Some(15.0)
        );
        assert!((99_000..101_000).contains(&work.covered));
        assert_eq!(at_work(&work).tasks.first().unwrap().runs.len(), 99);
    }
}
