//! Bands below a plot: state of the stack, and step.

use sophie_sim::record::FlightRecord;

use super::time_axis::{LEFT, Span};
use sophie_charts::svg::{Rect, rect, text};

/// Height of one band, px.
pub const BAND: f64 = 17.0;

/// State of the stack and number of the step, below the panels.
pub fn bands(record: &FlightRecord, span: Span, top: f64) -> String {
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
        let block = Block {
            from: first.t,
            to: until,
            class: &format!("mode m-{}", name.to_lowercase()),
            label: name,
            tip: name,
        };
        out += &block.draw(span, top);
    }
    for (i, phase) in record.phases.iter().enumerate() {
        let number = (i + 1).to_string();
        let tip = format!("{number} {}", phase.name);
        let named = if wide(span, phase.start, phase.end, &tip) {
            &tip
        } else {
            &number
        };
        let block = Block {
            from: phase.start,
            to: phase.end,
            class: "step",
            label: named,
            tip: &tip,
        };
        out += &block.draw(span, top + BAND);
    }
    out += &text(LEFT - 7.0, top + 12.5, "tick end", "mode");
    out + &text(LEFT - 7.0, top + BAND + 12.5, "tick end", "step")
}

struct Block<'a> {
    from: f64,
    to: f64,
    class: &'a str,
    /// Shown if it fits.
    label: &'a str,
    tip: &'a str,
}

impl Block<'_> {
    fn draw(&self, span: Span, top: f64) -> String {
        if self.to < span.from || self.from > span.to {
            return String::new();
        }
        let (left, right) = (span.x(self.from.max(span.from)), span.x(self.to.min(span.to)));
        let area = Rect {
            x: left,
            y: top,
            width: right - left,
            height: BAND,
        };
        let mut out = rect(area, self.class, self.tip);
        if wide(span, self.from, self.to, self.label) {
            out += &text((left + right) / 2.0, top + 12.5, "band-label mid", self.label);
        }
        out
    }
}

fn wide(span: Span, from: f64, to: f64, label: &str) -> bool {
    let (from, to) = (from.max(span.from), to.min(span.to));
    span.x(to) - span.x(from) > 5.0 + 6.9 * label.chars().count() as f64
}
