//! `paper.json`: every comparison, table and curve for programs.

use serde_json::{Value, json};

use super::model::{Axis, Block, Cell, Chart, Comparison, Section};
use sophie_charts::units::tidy;

const POINTS: usize = 300;

/// The sections as JSON text, newline-terminated.
pub fn json(sections: &[Section]) -> String {
    let value = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "sections": sections.iter().map(section).collect::<Vec<_>>(),
    });
    // Numbers, text and string keys only: cannot fail.
    serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
}

fn section(s: &Section) -> Value {
    let of = |f: fn(&Block) -> Option<Value>| s.blocks.iter().filter_map(f).collect::<Vec<_>>();
    json!({
        "id": s.id,
        "title": s.title,
        "finding": s.finding,
        "text": of(|b| match b { Block::Text(t) => Some(json!(t)), _ => None }),
        "comparisons": s.blocks.iter().flat_map(|b| match b {
            Block::Comparisons(caption, rows) => rows.iter().map(|r| comparison(caption, r)).collect(),
            _ => vec![],
        }).collect::<Vec<_>>(),
        "tables": of(|b| match b {
            Block::Table(t) => Some(json!({
                "caption": t.caption,
                "columns": t.columns,
                "rows": t.rows.iter().map(|r| r.iter().map(cell).collect::<Vec<_>>()).collect::<Vec<_>>(),
            })),
            _ => None,
        }),
        "figures": of(|b| match b {
            Block::Figure(f) => Some(json!({
                "caption": f.caption,
                "charts": f.charts.iter().map(chart).collect::<Vec<_>>(),
            })),
            _ => None,
        }),
    })
}

fn comparison(caption: &str, r: &Comparison) -> Value {
    json!({
        "table": caption,
        "what": r.what,
        "unit": r.unit,
        "printed": tidy(r.printed),
        "here": tidy(r.here),
        "deviation": tidy(r.deviation()),
        "class": r.class.word(),
        "why": r.why,
    })
}

fn cell(c: &Cell) -> Value {
    match c {
        Cell::Text(t) => json!(t),
        Cell::Number(v, _) => json!(tidy(*v)),
    }
}

fn chart(c: &Chart) -> Value {
    let axis = |a: &Axis| a.title.clone();
    let series: Vec<Value> = c
        .series
        .iter()
        .map(|s| {
            let step = s.points.len().div_ceil(POINTS).max(1);
            let points: Vec<[f64; 2]> = s
                .points
                .iter()
                .step_by(step)
                .map(|p| [tidy(p.0), tidy(p.1)])
                .collect();
            json!({ "name": s.name, "printed": s.look == super::model::SeriesStyle::Printed, "points": points })
        })
        .collect();
    let tiles: Vec<Value> = c
        .tiles
        .iter()
        .map(|t| json!({ "x": tidy(t.at.0), "y": tidy(t.at.1), "text": t.text }))
        .collect();
    json!({ "title": c.title, "x": axis(&c.x), "y": axis(&c.y), "series": series, "tiles": tiles })
}
