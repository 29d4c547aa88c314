//! The sections as text for a terminal.

use super::model::{self, Block, Cell, Class, Comparison, Section};
use super::page::{deviation, value};
use sophie_terminal::table::{Align, Table};

const WIDTH: usize = 110;

/// Finding, comparisons and tables of a section; figures are on the page.
pub fn lines(number: usize, s: &Section) -> Vec<String> {
    let mut out = vec![String::new(), format!("{number}. {}", s.title)];
    out.extend(wrapped(&s.finding));
    for block in &s.blocks {
        match block {
            Block::Text(_) | Block::Figure(_) => {}
            Block::Comparisons(caption, rows) => out.extend(comparisons(caption, rows)),
            Block::Table(table) => out.extend(table_lines(table)),
        }
    }
    out
}

/// Printed numbers beside computed ones, then the reasons of contradictions, each once.
fn comparisons(caption: &str, rows: &[Comparison]) -> Vec<String> {
    let mut t = Table::new(&[
        (caption, Align::Left),
        ("printed", Align::Right),
        ("here", Align::Right),
        ("unit", Align::Left),
        ("deviation", Align::Right),
        ("class", Align::Left),
    ]);
    let inconsistent = |r: &Comparison| r.class == Class::Inconsistent;
    for r in rows {
        let mark = if inconsistent(r) { " *" } else { "" };
        t.row([
            r.what.clone(),
            value(r.printed),
            value(r.here),
            r.unit.to_owned(),
            deviation(r),
            format!("{}{mark}", r.class.word()),
        ]);
    }
    let mut out = vec![String::new()];
    out.extend(t.lines());
    let mut reasons: Vec<&str> = vec![];
    for r in rows.iter().filter(|r| inconsistent(r)) {
        if !reasons.contains(&r.why.as_str()) {
            reasons.push(&r.why);
            out.extend(wrapped(&format!("* {}", r.why)));
        }
    }
    out
}

/// Columns of numbers are right-aligned.
fn table_lines(table: &model::Table) -> Vec<String> {
    let align = |i: usize| {
        let words = table.rows.iter().any(|r| matches!(r.get(i), Some(Cell::Text(_))));
        if words { Align::Left } else { Align::Right }
    };
    let columns = table.columns.iter().enumerate();
    let columns: Vec<(&str, Align)> = columns.map(|(i, c)| (c.as_str(), align(i))).collect();
    let mut t = Table::new(&columns);
    for row in &table.rows {
        t.row(row.iter().map(Cell::shown));
    }
    let mut out = vec![String::new(), table.caption.clone()];
    out.extend(t.lines());
    out
}

fn wrapped(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = vec![];
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(last) if last.chars().count() + word.chars().count() < WIDTH => {
                last.push(' ');
                last.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
