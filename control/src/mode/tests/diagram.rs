//! `docs/modes.svg`: the modes and the rows of the table that lead from one to another.

extern crate std;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

use crate::mode::modes::Mode;
use crate::mode::table::transitions::{Origin, TRANSITIONS};

/// Half the size of a mode's box, px.
const HALF: Point = Point { x: 58.0, y: 17.0 };
/// How far the two arrows between a pair of modes keep apart, as a share of their length.
const BEND: f64 = 0.09;
const STYLE: &str = "text{font:13px system-ui,sans-serif;text-anchor:middle;fill:#1b2733}\
    .mode{font-weight:600}rect{fill:#e8f0f7;stroke:#30506b}.paper{fill:#fff;stroke:none}\
    .row{font-size:12px;paint-order:stroke;stroke:#fff;stroke-width:4px}path{fill:none;stroke:#5b7083;stroke-width:1.3}";

#[derive(Clone, Copy)]
struct Point {
    x: f64,
    y: f64,
}

/// Where a mode's box is drawn.
fn place(mode: Mode) -> Point {
    let (x, y) = match mode {
        Mode::Calibrating => (80.0, 230.0),
        Mode::Disarmed => (270.0, 230.0),
        Mode::Armed => (455.0, 165.0),
        Mode::Landed => (455.0, 300.0),
        Mode::Flight => (625.0, 230.0),
        Mode::Hold => (610.0, 70.0),
        Mode::Failsafe => (580.0, 415.0),
        Mode::Approach => (790.0, 40.0),
        Mode::Contact => (850.0, 125.0),
        Mode::Escaping => (830.0, 230.0),
        Mode::Clamping => (1055.0, 130.0),
        Mode::Releasing => (890.0, 365.0),
        Mode::Perched => (1055.0, 440.0),
    };
    Point { x, y }
}

/// How far an arrow bends to its right, as a share of its length: what crosses the whole drawing keeps around it.
fn bend(from: Mode, to: Mode) -> f64 {
    match (from, to) {
        (Mode::Clamping, Mode::Disarmed) => 0.19,
        (Mode::Perched, Mode::Disarmed) => -0.25,
        (Mode::Disarmed, Mode::Perched) => 0.20,
        _ => -BEND,
    }
}

/// Where the line from the middle of the box at `at` towards `target` leaves the box, a little outside.
fn edge(at: Point, target: Point) -> Point {
    let (dx, dy) = (target.x - at.x, target.y - at.y);
    let scale = ((HALF.x + 3.0) / dx.abs().max(1e-9)).min((HALF.y + 3.0) / dy.abs().max(1e-9));
    Point {
        x: at.x + scale * dx,
        y: at.y + scale * dy,
    }
}

fn arrow(from: Mode, to: Mode, rows: &str) -> String {
    let (a, b) = (place(from), place(to));
    let share = bend(from, to);
    let middle = Point {
        x: (a.x + b.x) / 2.0 - 2.0 * share * (b.y - a.y),
        y: (a.y + b.y) / 2.0 + 2.0 * share * (b.x - a.x),
    };
    let (start, end) = (edge(a, middle), edge(b, middle));
    let label = Point {
        x: 0.25 * start.x + 0.5 * middle.x + 0.25 * end.x,
        y: 0.25 * start.y + 0.5 * middle.y + 0.25 * end.y + 4.0,
    };
    format!(
        "<path marker-end=\"url(#head)\" d=\"M{:.1} {:.1}Q{:.1} {:.1} {:.1} {:.1}\"/>\n\
         <text class=\"row\" x=\"{:.1}\" y=\"{:.1}\">{rows}</text>\n",
        start.x, start.y, middle.x, middle.y, end.x, end.y, label.x, label.y
    )
}

/// The rows that lead from one mode to another, in the order of the modes.
fn arrows() -> String {
    let mut rows = BTreeMap::<(usize, usize), Vec<String>>::new();
    let index = |mode| Mode::ALL.into_iter().position(|m| m == mode).unwrap();
    for (i, row) in TRANSITIONS.iter().enumerate() {
        let Origin::In(modes) = row.from else { continue };
        for &from in modes.iter().filter(|from| **from != row.to.mode()) {
            let key = (index(from), index(row.to.mode()));
            rows.entry(key).or_default().push((i + 1).to_string());
        }
    }
    rows.into_iter()
        .map(|((from, to), rows)| arrow(Mode::ALL[from], Mode::ALL[to], &rows.join(" ")))
        .collect()
}

#[test]
fn the_drawing_of_the_modes_is_what_the_code_prints() {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1120 590\" role=\"img\" \
         aria-label=\"modes and the rows that lead from one to another\">\n<style>{STYLE}</style>\n\
         <defs><marker id=\"head\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"8\" markerHeight=\"8\" \
         orient=\"auto\"><path d=\"M0 0L8 4L0 8Z\" style=\"fill:#5b7083;stroke:none\"/></marker></defs>\n\
         <rect class=\"paper\" width=\"1120\" height=\"590\"/>\n"
    );
    svg += &arrows();
    for mode in Mode::ALL {
        let at = place(mode);
        let _ = writeln!(
            svg,
            "<rect x=\"{:.0}\" y=\"{:.0}\" width=\"{:.0}\" height=\"{:.0}\" rx=\"6\"/>\
             <text class=\"mode\" x=\"{:.0}\" y=\"{:.0}\">{}</text>",
            at.x - HALF.x,
            at.y - HALF.y,
            2.0 * HALF.x,
            2.0 * HALF.y,
            at.x,
            at.y + 5.0,
            mode.name()
        );
    }
    svg += "</svg>\n";
    sophie_pages::is("modes.svg", &svg, "--package sophie-control mode::tests::diagram");
}
