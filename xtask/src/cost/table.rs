//! The counts as a table.

use std::fmt::Write;
use std::fs;

use serde::Serialize;

use super::stages::{M4F_ALLOWANCE, SPREAD, STAGES, Stage};
use super::{CORES, Count};
use crate::{Error, build};

/// Marks in docs/cost.md.
const BEGIN: &str = "<!-- cargo xtask cost --tighten writes from here -->\n";
const END: &str = "<!-- to here -->\n";

#[derive(Serialize)]
pub struct Row {
    stage: &'static str,
    core: &'static str,
    calls: u64,
    mean: f64,
    min: f64,
    max: f64,
    max_over_mean: f64,
    /// Most instructions on this core; `None`: no target.
    target: Option<f64>,
    best_peer: &'static str,
    met: bool,
    /// Costliest call close enough to the mean.
    constant: bool,
}

fn row(stage: &Stage, count: &Count) -> Row {
    let per = |x: f64| x / stage.parts;
    let allowance = if count.core == "M7" { 1.0 } else { M4F_ALLOWANCE };
    let target = stage.target.map(|t| t * allowance);
    Row {
        stage: stage.name,
        core: count.core,
        calls: count.calls,
        mean: per(count.mean),
        min: per(count.min),
        max: per(count.max),
        max_over_mean: count.max / count.mean,
        target,
        best_peer: stage.peer,
        met: target.is_none_or(|t| per(count.mean) <= t),
        constant: count.max <= SPREAD * count.mean,
    }
}

pub fn rows(counts: &[Count]) -> Vec<Row> {
    let rows = STAGES.iter().flat_map(|stage| {
        let mine = counts.iter().filter(|c| c.stage == stage.name);
        mine.map(|count| row(stage, count)).collect::<Vec<_>>()
    });
    rows.collect()
}

/// Markdown: a line per stage, cores side by side.
pub fn markdown(counts: &[Count]) -> String {
    let mut text = String::from("| stage |");
    for core in &CORES {
        let _ = write!(text, " {0} mean | {0} max | max/mean |", core.name);
    }
    text += " target M7 (M4F) | best peer | |\n|---|";
    text += &"---:|".repeat(3 * CORES.len());
    text += "---:|---|---|\n";
    for stage in &STAGES {
        let _ = write!(text, "| {} |", stage.what);
        let mut misses = Vec::new();
        for core in &CORES {
            let mine = |c: &&Count| c.stage == stage.name && c.core == core.name;
            let Some(r) = counts.iter().find(mine).map(|c| row(stage, c)) else {
                text += " | | |";
                continue;
            };
            let _ = write!(text, " {:.1} | {:.0} | {:.3} |", r.mean, r.max, r.max_over_mean);
            if !r.met {
                misses.push(format!("{} misses", core.name));
            }
            if !r.constant {
                misses.push(format!("{} varies", core.name));
            }
        }
        let target = stage
            .target
            .map_or_else(String::new, |t| format!("{t:.0} ({:.0})", t * M4F_ALLOWANCE));
        let verdict = match (misses.is_empty(), stage.target) {
            (false, _) => misses.join(", "),
            (true, Some(_)) => "met".into(),
            (true, None) => String::new(),
        };
        let _ = writeln!(text, " {target} | {} | {verdict} |", stage.peer);
    }
    text
}

/// Writes the table into docs/cost.md.
///
/// # Errors
/// The document or its marks are missing.
pub fn write(counts: &[Count]) -> Result<(), Error> {
    let path = build::root().join("docs/cost.md");
    let text = fs::read_to_string(&path)?;
    let marks = text
        .split_once(BEGIN)
        .and_then(|(head, rest)| Some((head, rest.split_once(END)?.1)));
    let (head, tail) = marks.ok_or("docs/cost.md has no place for the table")?;
    fs::write(&path, format!("{head}{BEGIN}{}{END}{tail}", markdown(counts)))?;
    Ok(())
}
