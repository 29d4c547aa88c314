//! The capture as a self-contained page: tables, zoomable timeline.

use std::fmt::Write;

use crate::capture::Capture;
use crate::replay::Replay;

/// Most that browsers show in a timeline.
const POLLS: usize = 300_000;

const STYLE: &str = include_str!("timeline.css");
const SCRIPT: &str = include_str!("timeline.js");

/// The page, with the terminal's `tables`.
#[must_use]
pub fn html(capture: &Capture, replay: &Replay, tables: &str) -> String {
    let board = escaped(capture.board.as_deref().unwrap_or("board"));
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Timing of {board}</title>\n<style>\n{STYLE}</style>\n<h1>Timing of {board}</h1>\n"
    );
    for line in capture.notes.iter().chain(&capture.incomplete) {
        let _ = writeln!(page, "<p class=\"incomplete\">{}</p>", escaped(line));
    }
    let (rows, bars, what) = if replay.polls.is_empty() {
        seconds(capture)
    } else {
        polls(replay)
    };
    let _ = write!(
        page,
        "<p>{what} Wheel zooms, dragging moves, double click shows all.</p>\n<canvas id=\"timeline\"></canvas>\n<p id=\"told\">&nbsp;</p>\n<pre>{}</pre>\n<script>\nconst rows = [{rows}];\nconst bars = [{bars}];\n{SCRIPT}</script>\n</html>\n",
        escaped(tables)
    );
    page
}

/// Rows, bars `[row, from, begin, end, share of the deadline or -1]`, and a sentence.
fn polls(replay: &Replay) -> (String, String, String) {
    let start = replay.polls.iter().map(|p| p.ready).min().unwrap_or(0);
    let mut bars = String::new();
    for poll in replay.polls.iter().take(POLLS) {
        let [ready, begin, end] = [poll.ready, poll.begin, poll.end].map(|t| t - start);
        let _ = write!(bars, "[{},{ready},{begin},{end},-1],", poll.task);
    }
    let rows = replay.tasks.iter().map(|t| {
        let level = t.level.map_or("", |l| l.name());
        format!("[\"{}\",\"{level}\"],", escaped(&t.name))
    });
    let cut = if replay.polls.len() > POLLS {
        format!(" The first {POLLS} polls of {} are shown.", replay.polls.len())
    } else {
        String::new()
    };
    let what = format!("Every poll: pale from wake to begin, full while it lasts.{cut}");
    (rows.collect(), bars, what)
}

fn seconds(capture: &Capture) -> (String, String, String) {
    let mut bars = String::new();
    for (row, task) in capture.tasks.iter().enumerate() {
        for (second, s) in task.seconds.iter().enumerate() {
            let from = second as u64 * 1_000_000;
            let share = f64::from(s.response.max) / f64::from(s.deadline.max(1));
            let _ = write!(bars, "[{row},{from},{from},{},{share:.3}],", from + 1_000_000);
        }
    }
    let rows = capture
        .tasks
        .iter()
        .map(|t| format!("[\"{}\",\"\"],", escaped(&t.name)));
    let what = "Each second's longest response against its deadline: pale is little, red is missed.";
    (rows.collect(), bars, what.into())
}

fn escaped(text: &str) -> String {
    let text = text
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;");
    text.replace('"', "&quot;")
}
