//! Panels of curves over a common time axis, with a band of modes and steps below.

use sophie_hil::record::FlightRecord;

use super::svg::{line, path, rect, short, text};

/// Size of the drawing, px; it scales with the page.
const WIDTH: f64 = 1000.0;
const LEFT: f64 = 74.0;
const RIGHT: f64 = 14.0;
const GAP: f64 = 22.0;
const BAND: f64 = 17.0;
/// Columns into which a curve is thinned: about two to a pixel of the drawing.
const COLUMNS: usize = 460;

/// One curve.
pub struct Trace<'a> {
    /// CSS classes that give colour and dash.
    pub class: &'a str,
    /// One value for each sample.
    pub values: Vec<f64>,
}

/// One panel.
pub struct Panel<'a> {
    /// Title of the vertical axis, with its unit.
    pub axis: String,
    /// Height, px.
    pub height: f64,
    /// Curves, the last on top.
    pub traces: Vec<Trace<'a>>,
    /// Shaded range of values.
    pub target: Option<(f64, f64)>,
    /// Dashed levels.
    pub levels: Vec<f64>,
    /// Values that the axis must show at least.
    pub include: Vec<f64>,
    /// Smallest span of the axis, so that noise does not fill a panel.
    pub span: f64,
    /// Times that are marked at the top of the panel.
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

/// The part of the flight that is shown.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// First time, s.
    pub from: f64,
    /// Last time, s.
    pub to: f64,
}

impl Span {
    /// The whole flight.
    pub fn all(record: &FlightRecord) -> Self {
        Self {
            from: 0.0,
            to: record.sim_seconds.max(1.0),
        }
    }

    fn x(self, t: f64) -> f64 {
        LEFT + (t - self.from) / (self.to - self.from) * (WIDTH - LEFT - RIGHT)
    }

    fn contains(self, t: f64) -> bool {
        (self.from..=self.to).contains(&t)
    }
}

/// A figure of panels, one below the other.
pub fn figure(record: &FlightRecord, span: Span, title: &str, panels: &[Panel<'_>]) -> String {
    let panels_height: f64 = panels.iter().map(|p| p.height + GAP).sum();
    let height = panels_height + 2.0 * BAND + 46.0;
    let mut svg = format!(
        "<svg class=\"plot\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" data-from=\"{}\" data-to=\"{}\" \
         aria-label=\"{}\">",
        short(span.from, 3),
        short(span.to, 3),
        super::svg::escape(title)
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
    let mut out = rect(left, top, right - left, panel.height, "field", "");
    if let Some((a, b)) = panel.target {
        out += &rect(
            left,
            y(b.min(high)),
            right - left,
            y(a.max(low)) - y(b.min(high)),
            "target",
            "",
        );
    }
    for t in times {
        out += &line(span.x(*t), top, span.x(*t), bottom, "grid");
    }
    let rows = if panel.height < 110.0 { 4 } else { 6 };
    for v in ticks(low, high, rows) {
        out += &line(
            left,
            y(v),
            right,
            y(v),
            if v == 0.0 { "grid zero" } else { "grid" },
        );
        out += &text(left - 7.0, y(v) + 4.0, "tick end", &short(v, 3));
    }
    for level in &panel.levels {
        out += &line(left, y(*level), right, y(*level), "level");
    }
    for (a, b) in panel
        .marks
        .iter()
        .filter(|(a, b)| *b >= span.from && *a <= span.to)
    {
        let (a, b) = (span.x(a.max(span.from)), span.x(b.min(span.to)));
        out += &rect(a, top, (b - a).max(1.5), 5.0, "mark", "");
    }
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

/// Bounds of the vertical axis, rounded out to whole ticks.
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
    // A curve that lies on the frame is hard to see: leave a little room, but not below a true zero.
    let room = 0.04 * (high - low);
    let low = if low == 0.0 { 0.0 } else { low - room };
    let round = |v: f64, f: fn(f64) -> f64| f(v / step * 2.0) * step / 2.0;
    (round(low, f64::floor), round(high + room, f64::ceil))
}

/// The curve as its smallest and largest value in each column, in the order in which they come.
fn thin(record: &FlightRecord, span: Span, values: &[f64]) -> Vec<(f64, f64)> {
    let shown: Vec<(f64, f64)> = record
        .samples
        .iter()
        .zip(values)
        .map(|(s, v)| (s.t, *v))
        .filter(|(t, _)| span.contains(*t))
        .collect();
    if shown.len() <= 2 * COLUMNS {
        return shown;
    }
    let size = shown.len().div_ceil(COLUMNS);
    let mut out = Vec::with_capacity(2 * COLUMNS);
    for column in shown.chunks(size) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let finite = || column.iter().filter(|(_, v)| v.is_finite());
        match (finite().min_by(by_value), finite().max_by(by_value)) {
            (Some(a), Some(b)) if a.0 < b.0 => out.extend([*a, *b]),
            (Some(a), Some(b)) if a.0 > b.0 => out.extend([*b, *a]),
            (Some(a), _) => out.push(*a),
            _ => out.extend(column.first()),
        }
    }
    out
}

/// Two bands below the panels: the state of the stack, and the number of the step.
fn bands(record: &FlightRecord, span: Span, top: f64) -> String {
    let mut out = String::new();
    let mut start = 0;
    for end in 1..=record.samples.len() {
        let (Some(first), Some(last)) = (record.samples.get(start), record.samples.get(end - 1)) else {
            break;
        };
        if record.samples.get(end).is_some_and(|s| s.mode == first.mode) {
            continue;
        }
        start = end;
        let until = record.samples.get(end).map_or(last.t, |s| s.t);
        let name = first.mode.name();
        out += &block(
            span,
            first.t,
            until,
            top,
            &format!("mode m-{}", name.to_lowercase()),
            name,
            name,
        );
    }
    for (i, phase) in record.phases.iter().enumerate() {
        let number = (i + 1).to_string();
        let tip = format!("{number} {}", phase.name);
        let named = if wide(span, phase.start, phase.end, &tip) {
            &tip
        } else {
            &number
        };
        out += &block(span, phase.start, phase.end, top + BAND, "step", named, &tip);
    }
    out += &text(LEFT - 7.0, top + 12.5, "tick end", "mode");
    out + &text(LEFT - 7.0, top + BAND + 12.5, "tick end", "step")
}

fn block(span: Span, from: f64, to: f64, top: f64, class: &str, label: &str, tip: &str) -> String {
    if to < span.from || from > span.to {
        return String::new();
    }
    let (from, to) = (from.max(span.from), to.min(span.to));
    let mut out = rect(span.x(from), top, span.x(to) - span.x(from), BAND, class, tip);
    if wide(span, from, to, label) {
        out += &text(
            (span.x(from) + span.x(to)) / 2.0,
            top + 12.5,
            "band-label mid",
            label,
        );
    }
    out
}

/// Whether a label fits between two times.
fn wide(span: Span, from: f64, to: f64, label: &str) -> bool {
    let (from, to) = (from.max(span.from), to.min(span.to));
    span.x(to) - span.x(from) > 5.0 + 6.9 * label.chars().count() as f64
}

/// Round values between `low` and `high`, about `count` of them.
fn ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    let step = tick_step(low, high, count);
    let (first, last) = (
        (low / step - 1e-9).ceil() as i64,
        (high / step + 1e-9).floor() as i64,
    );
    (first..=last).map(|i| i as f64 * step).collect()
}

/// 1, 2 or 5 times a power of ten.
fn tick_step(low: f64, high: f64, count: usize) -> f64 {
    let raw = ((high - low) / count.max(1) as f64).max(1e-9);
    let power = 10_f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|m| m * power >= raw * 0.999);
    step.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::super::synthetic;
    use super::*;

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks(0.0, 10.0, 5), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(ticks(-0.5, 0.5, 4), [-0.5, 0.0, 0.5]);
        assert!(ticks(0.0, 72.0, 12).contains(&70.0));
    }

    #[test]
    fn thinning_keeps_peaks_and_order() {
        let record = synthetic::record();
        let mut values = vec![0.0; record.samples.len()];
        values[3210] = 7.0;
        values[3211] = -5.0;
        let thinned = thin(&record, Span::all(&record), &values);
        assert!(thinned.len() <= 2 * COLUMNS);
        assert!(thinned.iter().any(|(_, v)| *v == 7.0) && thinned.iter().any(|(_, v)| *v == -5.0));
        assert!(thinned.windows(2).all(|w| w[0].0 < w[1].0));
        // Where there is no value, the gap stays.
        let gap = thin(&record, Span::all(&record), &vec![f64::NAN; record.samples.len()]);
        assert!(!gap.is_empty() && gap.iter().all(|(_, v)| v.is_nan()));
    }

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
