//! A capture as CSV: a line per run of a trace, else per task and second.

use std::fmt::Write;

use crate::capture::Capture;
use crate::replay::Replay;

/// The capture as CSV; times in µs.
#[must_use]
pub fn csv(capture: &Capture, replay: &Replay) -> String {
    if replay.polls.is_empty() {
        seconds(capture)
    } else {
        runs(replay)
    }
}

fn runs(replay: &Replay) -> String {
    let mut text = String::from("task,level,ready,wake_to_run,execution,response,preempted,waited\n");
    for task in &replay.tasks {
        for run in &task.runs {
            let _ = writeln!(
                text,
                "{},{},{},{},{},{},{},{}",
                task.name,
                task.level.map_or("", |l| l.name()),
                run.ready,
                run.begin - run.ready,
                run.execution,
                run.end - run.ready,
                run.preempted,
                run.waited
            );
        }
    }
    text
}

fn seconds(capture: &Capture) -> String {
    let mut text = String::from("task,second,runs");
    for quantity in ["late", "run", "response"] {
        let _ = write!(text, ",{quantity}_p50,{quantity}_p99,{quantity}_max");
    }
    text += ",deadline,missed\n";
    for task in &capture.tasks {
        for (second, s) in task.seconds.iter().enumerate() {
            let _ = write!(text, "{},{second},{}", task.name, s.runs);
            for q in [s.late, s.run, s.response] {
                let _ = write!(text, ",{},{},{}", q.p50, q.p99, q.max);
            }
            let _ = writeln!(text, ",{},{}", s.deadline, s.missed);
        }
    }
    text
}
