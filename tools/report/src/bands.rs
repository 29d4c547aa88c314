//! The bands below a plot: what the stack was doing, and in which step.

use sophie_sim::record::FlightRecord;

use super::plot::{LEFT, Span};
use super::svg::{rect, text};

/// Height of one band, px.
pub const BAND: f64 = 17.0;

/// Two bands below the panels: the state of the stack, and the number of the step.
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
