//! Panels of curves over a common time axis, with modes and steps below.

use sophie_sim::record::FlightRecord;

use super::bands::{BAND, bands};
use super::thinning::thin;
use super::time_axis::{LEFT, RIGHT, Span, WIDTH};
use sophie_charts::svg::{Rect, line, path, rect, short, text};
use sophie_charts::ticks::{tick_step, ticks};

/// px.
const GAP: f64 = 22.0;

/// One curve.
pub struct Trace<'a> {
    /// CSS classes of colour and dash.
    pub class: &'a str,
    /// One value per sample.
    pub values: Vec<f64>,
}

/// One panel.
pub struct Panel<'a> {
    /// Vertical axis title with unit.
    pub axis: String,
    /// Height, px.
    pub height: f64,
    /// Curves, the last on top.
    pub traces: Vec<Trace<'a>>,
    /// Shaded range of values.
    pub target: Option<(f64, f64)>,
    /// Dashed levels.
    pub levels: Vec<f64>,
    /// Values to include.
    pub include: Vec<f64>,
    /// Smallest span: noise must not fill a panel.
    pub span: f64,
    /// Times marked at the top of the panel.
    pub marks: Vec<(f64, f64)>,
}

impl Default for Panel<'_> {
    fn default() -> Self {
        Self {
            axis: String::new(),
            height: 150.0,
            traces: vec![],
            target: None,
            levels: vec![],
            include: vec![],
            span: 0.0,
            marks: vec![],
        }
    }
}

/// Panels one below the other.
pub fn figure(record: &FlightRecord, span: Span, title: &str, panels: &[Panel<'_>]) -> String {
    let panels_height: f64 = panels.iter().map(|p| p.height + GAP).sum();
    let height = panels_height + 2.0 * BAND + 36.0;
    let mut svg = format!(
        "<svg class=\"plot\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" data-from=\"{}\" data-to=\"{}\" \
         aria-label=\"{}\">",
        short(span.from, 3),
        short(span.to, 3),
        sophie_charts::svg::escape(title)
    );
    let bottom = panels_height - GAP + 12.0;
    let ticks = ticks(span.from, span.to, 16);
    let mut top = 12.0;
    for panel in panels {
        svg += &draw_panel(record, span, panel, top, &ticks);
        top += panel.height + GAP;
    }
    svg += &bands(record, span, bottom + 8.0);
    let foot = bottom + 8.0 + 2.0 * BAND;
    for t in &ticks {
        svg += &line(span.x(*t), foot, span.x(*t), foot + 4.0, "axis");
        svg += &text(span.x(*t), foot + 17.0, "tick mid", &short(*t, 2));
    }
    svg += &text(
        (LEFT + WIDTH - RIGHT) / 2.0,
        foot + 34.0,
        "title mid",
        "simulated time (s)",
    );
    svg += &format!(
        "<line class=\"cursor\" x1=\"0\" x2=\"0\" y1=\"12\" y2=\"{}\"/>",
        short(foot, 1)
    );
    svg + "</svg>"
}

fn draw_panel(record: &FlightRecord, span: Span, panel: &Panel<'_>, top: f64, times: &[f64]) -> String {
    let (low, high) = limits(record, span, panel);
    let y = |v: f64| top + panel.height - (v - low) / (high - low) * panel.height;
    let (left, right, bottom) = (LEFT, WIDTH - RIGHT, top + panel.height);
    let mut out = rect(
        Rect {
            x: left,
            y: top,
            width: right - left,
            height: panel.height,
        },
        "field",
        "",
    );
    if let Some((a, b)) = panel.target {
        let shaded = Rect {
            x: left,
            y: y(b.min(high)),
            width: right - left,
            height: y(a.max(low)) - y(b.min(high)),
        };
        out += &rect(shaded, "target", "");
    }
    for t in times {
        out += &line(span.x(*t), top, span.x(*t), bottom, "grid");
    }
    out += &scale(panel, low, high, y);
    out += &marks(span, panel, top);
    for trace in &panel.traces {
        let points = thin(record, span, &trace.values)
            .into_iter()
            .map(|(t, v)| (span.x(t), y(v)));
        out += &format!("<path class=\"trace {}\" d=\"{}\"/>", trace.class, path(points));
    }
    let (x, middle) = (17.0, top + panel.height / 2.0);
    let turned = format!("transform=\"rotate(-90 {x} {})\"", short(middle, 1));
    out + &text(x, middle, "title mid", &panel.axis).replacen("<text", &format!("<text {turned}"), 1)
}

/// The vertical axis: gridlines with their values, then the dashed levels.
fn scale(panel: &Panel<'_>, low: f64, high: f64, y: impl Fn(f64) -> f64) -> String {
    let (left, right) = (LEFT, WIDTH - RIGHT);
    let rows = if panel.height < 125.0 { 5 } else { 6 };
    let mut out = String::new();
    for v in ticks(low, high, rows) {
        let class = if v == 0.0 { "grid zero" } else { "grid" };
        out += &line(left, y(v), right, y(v), class);
        out += &text(left - 7.0, y(v) + 4.0, "tick end", &short(v, 3));
    }
    for level in &panel.levels {
        out += &line(left, y(*level), right, y(*level), "level");
    }
    out
}

/// The marked times within `span`, along the top.
fn marks(span: Span, panel: &Panel<'_>, top: f64) -> String {
    let within = |(a, b): &&(f64, f64)| *b >= span.from && *a <= span.to;
    let mark = |(a, b): &(f64, f64)| {
        let (a, b) = (span.x(a.max(span.from)), span.x(b.min(span.to)));
        let place = Rect {
            x: a,
            y: top,
            width: (b - a).max(1.5),
            height: 5.0,
        };
        rect(place, "mark", "")
    };
    panel.marks.iter().filter(within).map(mark).collect()
}

/// Bounds of the vertical axis, rounded out to ticks.
fn limits(record: &FlightRecord, span: Span, panel: &Panel<'_>) -> (f64, f64) {
    let shown = |values: &'_ [f64]| -> Vec<f64> {
        let pairs = record.samples.iter().zip(values);
        pairs
            .filter(|(s, v)| span.contains(s.t) && v.is_finite())
            .map(|(_, v)| *v)
            .collect()
    };
    let values = panel
        .traces
        .iter()
        .flat_map(|t| shown(&t.values))
        .chain(panel.include.iter().copied());
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(v), b.max(v)));
    if low > high {
        return (0.0, 1.0);
    }
    let missing = (panel.span.max(1e-9) - (high - low)).max(0.0) / 2.0;
    let (low, high) = (low - missing, high + missing);
    let step = tick_step(low, high, 6);
    // Margin for curves on the frame, but none below a true zero.
    let room = 0.04 * (high - low);
    let low = if low == 0.0 { 0.0 } else { low - room };
    let round = |v: f64, f: fn(f64) -> f64| f(v / step * 2.0) * step / 2.0;
    (round(low, f64::floor), round(high + room, f64::ceil))
}

#[cfg(test)]
mod tests {
    use super::super::synthetic;
    use super::*;

    #[test]
    fn a_flight_without_samples_still_makes_a_figure() {
        let mut record = synthetic::record();
        record.samples.clear();
        record.phases.clear();
        record.sim_seconds = 0.0;
        let panel = Panel {
            traces: vec![Trace {
                class: "a1",
                values: vec![],
            }],
            ..Panel::default()
        };
        assert!(figure(&record, Span::all(&record), "t", &[panel]).ends_with("</svg>"));
    }
}
