//! A chart as SVG: axes with ticks and units, curves, points, levels, maps.

use super::model::{Axis, Chart, Series, SeriesStyle};
use sophie_charts::svg::{Rect, escape, line, path, rect, short, text};
use sophie_charts::ticks::ticks;

/// Drawing size, px; scales with the page.
const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 330.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
/// Room above the field for labels of uprights.
const TOP: f64 = 20.0;
const BOTTOM: f64 = 44.0;
/// Most points drawn of a curve: about two per pixel.
const POINTS: usize = 900;

struct Frame {
    x: (f64, f64),
    y: (f64, f64),
}

impl Frame {
    fn of(chart: &Chart) -> Self {
        let xs = chart.series.iter().flat_map(|s| s.points.iter().map(|p| p.0));
        let ys = chart.series.iter().flat_map(|s| s.points.iter().map(|p| p.1));
        let tiles = |half: f64| chart.tiles.iter().map(move |t| (t.at, t.size, half));
        let (tx, ty): (Vec<f64>, Vec<f64>) = tiles(-0.5)
            .chain(tiles(0.5))
            .map(|((x, y), (w, h), half)| (x + half * w, y + half * h))
            .unzip();
        let levels = chart.levels.iter().map(|l| l.0);
        let uprights = chart.uprights.iter().map(|u| u.0);
        let margin = if chart.tiles.is_empty() { 0.04 } else { 0.0 };
        Self {
            x: limits(&chart.x, xs.chain(tx).chain(uprights), 0.0),
            y: limits(&chart.y, ys.chain(ty).chain(levels), margin),
        }
    }

    fn px(&self, x: f64) -> f64 {
        LEFT + (x - self.x.0) / (self.x.1 - self.x.0) * (WIDTH - LEFT - RIGHT)
    }

    fn py(&self, y: f64) -> f64 {
        HEIGHT - BOTTOM - (y - self.y.0) / (self.y.1 - self.y.0) * (HEIGHT - TOP - BOTTOM)
    }

    fn holds(&self, (x, y): (f64, f64)) -> bool {
        let within = |v: f64, (low, high): (f64, f64)| {
            let room = 1e-6 * (high - low);
            v >= low - room && v <= high + room
        };
        within(x, self.x) && within(y, self.y)
    }
}

fn limits(axis: &Axis, values: impl Iterator<Item = f64>, margin: f64) -> (f64, f64) {
    if let Some(limits) = axis.limits {
        return limits;
    }
    let all = values
        .chain(axis.include.iter().copied())
        .filter(|v| v.is_finite());
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    if !low.is_finite() {
        return (0.0, 1.0);
    }
    let span = (high - low).max(1e-9 + 1e-6 * high.abs());
    (low - margin * span, high + margin * span)
}

/// Ticks of an axis and their labels.
fn marks(axis: &Axis, (low, high): (f64, f64), count: usize, digits: usize) -> Vec<(f64, String)> {
    if axis.names.is_empty() {
        return ticks(low, high, count)
            .into_iter()
            .map(|v| (v, short(v, digits)))
            .collect();
    }
    axis.names
        .iter()
        .enumerate()
        .map(|(i, name)| (i as f64, name.clone()))
        .collect()
}

/// The chart as SVG, with its legend as a list before it.
pub fn draw(chart: &Chart) -> String {
    let f = Frame::of(chart);
    let mut svg = format!(
        "<svg class=\"chart\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">",
        escape(&format!(
            "{}: {} over {}",
            chart.title, chart.y.title, chart.x.title
        ))
    );
    let (left, right, bottom) = (LEFT, WIDTH - RIGHT, HEIGHT - BOTTOM);
    svg += &rect(
        Rect {
            x: left,
            y: TOP,
            width: right - left,
            height: bottom - TOP,
        },
        "field",
        "",
    );
    for tile in &chart.tiles {
        svg += &tile_svg(&f, tile);
    }
    svg += &grid(&f, chart);
    svg += &guides(&f, chart);
    // The paper's values on top.
    let printed = |s: &&Series| s.look == SeriesStyle::Printed;
    for series in chart
        .series
        .iter()
        .filter(|s| !printed(s))
        .chain(chart.series.iter().filter(printed))
    {
        svg += &curve(&f, series);
    }
    svg += &text((left + right) / 2.0, HEIGHT - 8.0, "title mid", &chart.x.title);
    let middle = (TOP + bottom) / 2.0;
    svg += &format!(
        "<text x=\"14\" y=\"{0}\" class=\"title mid\" transform=\"rotate(-90 14 {0})\">{1}</text></svg>",
        short(middle, 1),
        escape(&chart.y.title)
    );
    format!("<h4>{}</h4>{}{svg}", escape(&chart.title), legend(chart))
}

/// Gridlines, where no tiles cover them, and the axes' values.
fn grid(f: &Frame, chart: &Chart) -> String {
    let (left, right, bottom) = (LEFT, WIDTH - RIGHT, HEIGHT - BOTTOM);
    let mut svg = String::new();
    for (x, name) in marks(&chart.x, f.x, 8, 3) {
        let class = if x == 0.0 { "grid zero" } else { "grid" };
        if chart.tiles.is_empty() {
            svg += &line(f.px(x), TOP, f.px(x), bottom, class);
        }
        svg += &text(f.px(x), bottom + 16.0, "tick mid", &name);
    }
    for (y, name) in marks(&chart.y, f.y, 6, 4) {
        let class = if y == 0.0 { "grid zero" } else { "grid" };
        if chart.tiles.is_empty() {
            svg += &line(left, f.py(y), right, f.py(y), class);
        }
        svg += &text(left - 7.0, f.py(y) + 4.0, "tick end", &name);
    }
    svg
}

/// Levels and uprights with their words.
fn guides(f: &Frame, chart: &Chart) -> String {
    let (left, right, bottom) = (LEFT, WIDTH - RIGHT, HEIGHT - BOTTOM);
    let mut svg = String::new();
    for (level, word) in &chart.levels {
        svg += &line(left, f.py(*level), right, f.py(*level), "level");
        svg += &text(right - 5.0, f.py(*level) - 4.0, "small end halo", word);
    }
    for (at, word) in &chart.uprights {
        let x = f.px(*at);
        svg += &line(x, TOP, x, bottom, "level");
        // Centred on the line, but within the drawing.
        let half = 3.2 * word.chars().count() as f64;
        let middle = x.clamp(half.min(WIDTH / 2.0), WIDTH - half.min(WIDTH / 2.0));
        svg += &text(middle, TOP - 5.0, "small mid", word);
    }
    svg
}

fn tile_svg(f: &Frame, tile: &super::model::Tile) -> String {
    let (x, y) = (
        f.px(tile.at.0 - 0.5 * tile.size.0),
        f.py(tile.at.1 + 0.5 * tile.size.1),
    );
    let (w, h) = (
        f.px(tile.at.0 + 0.5 * tile.size.0) - x,
        f.py(tile.at.1 - 0.5 * tile.size.1) - y,
    );
    let class = if tile.shade < 0.0 {
        "t-lost".to_owned()
    } else {
        format!("t{}", (tile.shade * 5.0).round().clamp(0.0, 5.0))
    };
    let area = Rect {
        x,
        y,
        width: w,
        height: h,
    };
    let mut out = rect(area, &format!("tile {class}"), &tile.text);
    if !tile.text.is_empty() {
        out += &text(x + 0.5 * w, y + 0.5 * h + 4.0, "in-tile mid", &tile.text);
    }
    out
}

fn curve(f: &Frame, series: &Series) -> String {
    let colour = series.colour % 8;
    if matches!(series.look, SeriesStyle::Dots | SeriesStyle::Printed) {
        let shown = series.points.iter().filter(|p| f.holds(**p));
        return shown
            .map(|(x, y)| mark(series.look, colour, f.px(*x), f.py(*y)))
            .collect();
    }
    let step = series.points.len().div_ceil(POINTS).max(1);
    let thinned = series.points.iter().step_by(step).map(|p| {
        if f.holds(*p) {
            (f.px(p.0), f.py(p.1))
        } else {
            (f64::NAN, f64::NAN)
        }
    });
    let dash = if series.look == SeriesStyle::Dashed {
        " dash"
    } else {
        ""
    };
    format!("<path class=\"curve c{colour}{dash}\" d=\"{}\"/>", path(thinned))
}

fn mark(look: SeriesStyle, colour: usize, x: f64, y: f64) -> String {
    if look == SeriesStyle::Printed {
        let (x, y) = (short(x, 1), short(y, 1));
        return format!("<path class=\"printed\" d=\"M{x} {y}m-6 0l6 -6l6 6l-6 6z\"/>");
    }
    format!(
        "<circle class=\"dot f{colour}\" cx=\"{}\" cy=\"{}\" r=\"3.2\"/>",
        short(x, 1),
        short(y, 1)
    )
}

fn legend(chart: &Chart) -> String {
    let mut out = String::from("<ul class=\"legend\">");
    for s in chart.series.iter().filter(|s| !s.name.is_empty()) {
        let colour = s.colour % 8;
        let sample = match s.look {
            SeriesStyle::Dots | SeriesStyle::Printed => mark(s.look, colour, 15.0, 7.0),
            SeriesStyle::Line => format!("<path class=\"curve c{colour}\" d=\"M0 7L30 7\"/>"),
            SeriesStyle::Dashed => format!("<path class=\"curve c{colour} dash\" d=\"M0 7L30 7\"/>"),
        };
        out += &format!(
            "<li><svg viewBox=\"0 0 30 14\">{sample}</svg>{}</li>",
            escape(&s.name)
        );
    }
    out + "</ul>"
}

#[cfg(test)]
mod tests {
    use crate::results::chart::*;

    #[test]
    fn a_chart_has_its_axes_and_the_printed_value_and_no_gap_is_bridged() {
        let chart = Chart {
            title: "t".to_owned(),
            x: Axis::new("thrust (N)"),
            y: Axis::new("α (°)"),
            series: vec![
                Series::new(
                    "a",
                    0,
                    SeriesStyle::Line,
                    vec![(0.0, 0.0), (1.0, f64::NAN), (2.0, 1.0)],
                ),
                Series::new("printed", 0, SeriesStyle::Printed, vec![(1.0, 0.5)]),
            ],
            ..Chart::default()
        };
        let svg = draw(&chart);
        assert!(svg.contains("thrust (N)") && svg.contains("α (°)") && svg.contains("class=\"printed\""));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}
