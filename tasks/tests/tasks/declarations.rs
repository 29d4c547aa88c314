//! What is declared of tasks and links, and the tables of the docs that follow from it.

use std::fmt::Write;

use embassy_time::Duration;
use sophie_tasks::links::Links;
use sophie_tasks::schedule::{TaskId, Watch};
use sophie_tasks::supervision::supervisor::least_runs;

const TEST: &str = "--package sophie-tasks --test tasks declarations";

/// In the unit in which it is a whole number: `2 ms`, `600 us`.
fn shown(time: Duration) -> String {
    match time.as_micros() {
        us if us % 1000 == 0 => format!("{} ms", us / 1000),
        us => format!("{us} us"),
    }
}

#[test]
fn the_table_of_the_tasks_is_their_declaration() {
    let mut table = String::from(
        "| task | level | period | begins at | deadline | watched | what it does |\n|---|---|---:|---:|---:|---|---|\n",
    );
    for id in TaskId::ALL {
        let task = id.task();
        let [period, deadline] = [task.period, task.deadline].map(shown);
        let phase = task.phase.map(shown).unwrap_or_default();
        let watched = match task.watch {
            Watch::Watched => "yes",
            Watch::Unwatched => "no",
        };
        let (name, level, what) = (task.name, task.level.name(), task.what.trim());
        let _ = writeln!(
            table,
            "| `{name}` | {level} | {period} | {phase} | {deadline} | {watched} | {what} |"
        );
    }
    sophie_pages::hold("timing", &[("tasks", table)], TEST);
}

#[test]
fn the_table_of_the_links_is_their_declaration() {
    let mut table = String::from(
        "| link | message | from | to | period | stale after | what it is |\n|---|---|---|---|---:|---:|---|\n",
    );
    for link in Links::DECLARED {
        let [period, stale] = [link.from.period(), link.stale_after].map(shown);
        let (name, message, from, to) = (link.name, link.message, link.from.name(), link.to);
        let meaning = link.meaning.trim();
        let _ = writeln!(
            table,
            "| `{name}` | `{message}` | {from} | {to} | {period} | {stale} | {meaning} |"
        );
    }
    sophie_pages::hold("architecture", &[("links", table)], TEST);
}

#[test]
fn every_reader_is_a_task_the_console_or_the_log() {
    for link in Links::DECLARED {
        for reader in link.to.split(", ") {
            let known =
                ["console", "log"].contains(&reader) || TaskId::ALL.iter().any(|task| task.name() == reader);
            assert!(known, "{}: {reader}", link.name);
        }
    }
}

#[test]
fn a_link_outlives_two_periods_of_its_sender() {
    // One message that is missing must not make its readers stop.
    for link in Links::DECLARED {
        assert!(link.stale_after >= link.from.period() * 2, "{}", link.name);
    }
}

#[test]
fn a_task_is_declared_once_in_its_place() {
    for (place, task) in TaskId::ALL.into_iter().enumerate() {
        assert_eq!(task as usize, place);
        let same = TaskId::ALL.into_iter().filter(|t| t.name() == task.name());
        assert_eq!(same.count(), 1, "{}", task.name());
        assert!(task.deadline() <= task.period());
        // What is watched must run often enough to be missed within a window.
        assert!(least_runs(task).is_none_or(|least| least >= 2), "{}", task.name());
    }
}
