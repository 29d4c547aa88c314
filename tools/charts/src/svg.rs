//! Helpers for SVG text.

use std::fmt::Write;

/// `text` escaped for an element or an attribute.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// At most `digits` decimals, no trailing zeros.
pub fn short(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

/// Path through `points` (px), broken at non-finite ones.
pub fn path(points: impl IntoIterator<Item = (f64, f64)>) -> String {
    let mut data = String::new();
    let mut pen_down = false;
    for (x, y) in points {
        if !x.is_finite() || !y.is_finite() {
            pen_down = false;
            continue;
        }
        // Writing to a string cannot fail.
        let _ = write!(
            data,
            "{}{} {}",
            if pen_down { 'L' } else { 'M' },
            short(x, 1),
            short(y, 1)
        );
        pen_down = true;
    }
    data
}

/// A text element.
pub fn text(x: f64, y: f64, class: &str, content: &str) -> String {
    format!(
        "<text x=\"{}\" y=\"{}\" class=\"{class}\">{}</text>",
        short(x, 1),
        short(y, 1),
        escape(content)
    )
}

/// A straight line.
pub fn line(x1: f64, y1: f64, x2: f64, y2: f64, class: &str) -> String {
    format!(
        "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" class=\"{class}\"/>",
        short(x1, 1),
        short(y1, 1),
        short(x2, 1),
        short(y2, 1)
    )
}

/// A rectangle, px.
#[derive(Clone, Copy, Debug)]
pub struct Rect {
    /// Left edge.
    pub x: f64,
    /// Top edge.
    pub y: f64,
    /// Width; a negative one is 0.
    pub width: f64,
    /// Height; a negative one is 0.
    pub height: f64,
}

/// A rectangle with a tooltip (none if empty).
pub fn rect(at: Rect, class: &str, tip: &str) -> String {
    let tip = if tip.is_empty() {
        String::new()
    } else {
        format!("<title>{}</title>", escape(tip))
    };
    format!(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" class=\"{class}\">{tip}</rect>",
        short(at.x, 1),
        short(at.y, 1),
        short(at.width.max(0.0), 1),
        short(at.height.max(0.0), 1)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_break_out() {
        assert_eq!(escape("a<b>&\"c\"\n"), "a&lt;b&gt;&amp;&quot;c&quot; ");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            (short(1.0, 1), short(-0.01, 1), short(12.34, 1), short(100.0, 0)),
            ("1".into(), "0".into(), "12.3".into(), "100".into())
        );
    }

    #[test]
    fn a_path_breaks_at_gaps() {
        let points = [(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN), (3.0, 4.0)];
        assert_eq!(path(points), "M0 1L1 2M3 4");
    }
}
