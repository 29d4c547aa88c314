//! The path of an autonomous approach, from above and along the pipe.

use sophie_control::mode::Mode;
use sophie_sim::record::{FlightRecord, Sample};

use super::rotation::rows;
use sophie_charts::svg::{Rect, line, path, rect, short, text};
use sophie_charts::ticks::ticks;

/// Drawing, px: its size, room around both views, and of each view.
const WIDTH: f64 = 1000.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 46.0;
const LEFT: f64 = 62.0;
const GAP: f64 = 76.0;
const VIEW: (f64, f64) = (424.0, 340.0);
/// Margin around the path, and least width to both sides of the crown, m.
const MARGIN: f64 = 0.08;
const BESIDE: f64 = 0.3;
/// Samples between two points of a line, and between two ranges.
const THIN: usize = 5;

/// A touch of the pipe.
struct Touch {
    t: f64,
    /// Offset from the crown, positive right when looking along the pipe to the north, m.
    off: f64,
    at: [f64; 3],
}

/// The drawn part: the samples from the beginning to the grip or the end, and the touches.
struct Way<'a> {
    /// Assumed place of the range sensor, m, body.
    lens: [f64; 3],
    samples: &'a [Sample],
    touches: Vec<Touch>,
}

impl<'a> Way<'a> {
    fn of(record: &'a FlightRecord) -> Option<Self> {
        let begins = record.samples.iter().position(|s| s.mode == Mode::Approach)?;
        let after = record.samples.get(begins..)?;
        let part = |s: &Sample| {
            matches!(
                s.mode,
                Mode::Approach | Mode::Contact | Mode::Clamping | Mode::Escaping
            )
        };
        let length = after.iter().position(|s| !part(s)).unwrap_or(after.len());
        let samples = after.get(..length)?;
        let crown_east = record.scenario.world.pipe_position[1];
        let touches = samples
            .windows(2)
            .filter_map(|pair| match pair {
                [a, b] if a.mode == Mode::Approach && b.mode == Mode::Contact => Some(Touch {
                    t: b.t,
                    off: b.position[1] - crown_east,
                    at: b.position,
                }),
                _ => None,
            })
            .collect();
        let lens = record.scenario.params.flow_lens();
        Some(Self {
            lens: lens.to_array().map(f64::from),
            samples,
            touches,
        })
    }
}

/// Drawing and caption; `None` for a flight without an approach.
pub fn draw(record: &FlightRecord) -> Option<(String, String)> {
    let way = Way::of(record)?;
    let [above, behind] = views(record, &way);
    let height = TOP + VIEW.1 + BOTTOM;
    let mut svg = format!(
        "<svg class=\"plot\" viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"approach over the pipe\">"
    );
    svg += &above.frame("From above", "along the pipe, north (m)");
    svg += &above.pipe_from_above(record);
    svg += &above.tracks(&way, |p| (p[1], p[0]));
    svg += &behind.frame("Along the pipe, to the north", "height (m)");
    svg += &behind.pipe_from_behind(record);
    svg += &behind.feet(&way);
    svg += &behind.tracks(&way, |p| (p[1], -p[2]));
    Some((svg + "</svg>", caption(&way)))
}

fn caption(way: &Way<'_>) -> String {
    let touch = |(i, touch): (usize, &Touch)| {
        let side = if touch.off < 0.0 { "left" } else { "right" };
        let off = 100.0 * touch.off.abs();
        format!(
            "Touch {} at {:.1} s, {off:.1} cm {side} of the crown.",
            i + 1,
            touch.t
        )
    };
    let touches: Vec<String> = way.touches.iter().enumerate().map(touch).collect();
    if touches.is_empty() {
        "It did not come to a touch.".to_owned()
    } else {
        touches.join(" ")
    }
}

/// The views from above and from behind, to one scale.
fn views(record: &FlightRecord, way: &Way<'_>) -> [View; 2] {
    let world = &record.scenario.world;
    let crown_east = world.pipe_position[1];
    let bounds = |values: &dyn Fn(&Sample) -> f64, low: f64, high: f64| {
        let (low, high) = way.samples.iter().fold((low, high), |(low, high), s| {
            (low.min(values(s)), high.max(values(s)))
        });
        (low - MARGIN, high + MARGIN)
    };
    let east = bounds(&|s| s.position[1], crown_east - BESIDE, crown_east + BESIDE);
    let north = bounds(&|s| s.position[0], f64::MAX, f64::MIN);
    let height = bounds(
        &|s| -s.position[2],
        world.pipe_top - world.pipe_diameter,
        world.pipe_top,
    );
    let size = |(low, high): (f64, f64)| high - low;
    let fits = (VIEW.1 / size(north)).min(VIEW.1 / size(height));
    let scale = fits.min(VIEW.0 / size(east));
    let middle = |(low, high): (f64, f64)| 0.5 * (low + high);
    [(LEFT, north), (LEFT + VIEW.0 + GAP, height)].map(|(left, up)| View {
        left,
        scale,
        centre: (middle(east), middle(up)),
    })
}

/// One view: east to the right.
struct View {
    /// px.
    left: f64,
    /// px/m.
    scale: f64,
    /// East, and north or height, in the middle, m.
    centre: (f64, f64),
}

impl View {
    fn at(&self, east: f64, up: f64) -> (f64, f64) {
        (
            self.left + 0.5 * VIEW.0 + (east - self.centre.0) * self.scale,
            TOP + 0.5 * VIEW.1 - (up - self.centre.1) * self.scale,
        )
    }

    /// Limits of the view, east and up, m.
    fn shown(&self) -> [(f64, f64); 2] {
        let (east, up) = (0.5 * VIEW.0 / self.scale, 0.5 * VIEW.1 / self.scale);
        [
            (self.centre.0 - east, self.centre.0 + east),
            (self.centre.1 - up, self.centre.1 + up),
        ]
    }

    fn area(&self) -> Rect {
        Rect {
            x: self.left,
            y: TOP,
            width: VIEW.0,
            height: VIEW.1,
        }
    }

    fn frame(&self, title: &str, up: &str) -> String {
        let mut out = rect(self.area(), "field", "");
        let (right, bottom) = (self.left + VIEW.0, TOP + VIEW.1);
        let [east, rows] = self.shown();
        for value in ticks(east.0, east.1, 8) {
            let (x, _) = self.at(value, 0.0);
            out += &line(x, TOP, x, bottom, "grid");
            out += &text(x, bottom + 16.0, "tick mid", &short(value, 2));
        }
        for value in ticks(rows.0, rows.1, 7) {
            let (_, y) = self.at(0.0, value);
            out += &line(self.left, y, right, y, "grid");
            out += &text(self.left - 7.0, y + 4.0, "tick end", &short(value, 2));
        }
        let middle = self.left + 0.5 * VIEW.0;
        out += &text(middle, TOP - 10.0, "title mid", title);
        out += &text(middle, bottom + 36.0, "title mid", "east (m)");
        let (x, y) = (self.left - 45.0, TOP + 0.5 * VIEW.1);
        let turned = format!("transform=\"rotate(-90 {} {})\"", short(x, 1), short(y, 1));
        out + &text(x, y, "title mid", up).replacen("<text", &format!("<text {turned}"), 1)
    }

    fn pipe_from_above(&self, record: &FlightRecord) -> String {
        let world = &record.scenario.world;
        let [north, east] = world.pipe_position;
        let (half, radius) = (0.5 * world.pipe_length, 0.5 * world.pipe_diameter);
        let [_, (low, high)] = self.shown();
        let (from, to) = ((north - half).max(low), (north + half).min(high));
        if from >= to {
            return String::new();
        }
        let (left, top) = self.at(east - radius, to);
        let (right, bottom) = self.at(east + radius, from);
        let (middle, _) = self.at(east, 0.0);
        let area = Rect {
            x: left,
            y: top,
            width: right - left,
            height: bottom - top,
        };
        rect(area, "pipe faint", "") + &line(middle, top, middle, bottom, "level")
    }

    fn pipe_from_behind(&self, record: &FlightRecord) -> String {
        let world = &record.scenario.world;
        let radius = 0.5 * world.pipe_diameter;
        let (x, y) = self.at(world.pipe_position[1], world.pipe_top - radius);
        format!(
            "<circle class=\"pipe faint\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
            short(x, 1),
            short(y, 1),
            short(radius * self.scale, 1)
        )
    }

    fn tracks(&self, way: &Way<'_>, pick: impl Fn([f64; 3]) -> (f64, f64)) -> String {
        let through = |class: &str, place: &dyn Fn(&Sample) -> Option<[f64; 3]>| {
            let points = way.samples.iter().step_by(THIN).map(|s| {
                place(s).map_or((f64::NAN, f64::NAN), |p| {
                    let (east, up) = pick(p);
                    self.at(east, up)
                })
            });
            format!("<path class=\"trace {class}\" d=\"{}\"/>", path(points))
        };
        let mut out = through("estimate", &|s| s.position_estimate) + &through("true", &|s| Some(s.position));
        if let Some(first) = way.samples.first() {
            let (east, up) = pick(first.position);
            let (x, y) = self.at(east, up);
            out += &format!(
                "<circle class=\"begin\" cx=\"{}\" cy=\"{}\" r=\"4\"/>",
                short(x, 1),
                short(y, 1)
            );
        }
        for (i, touch) in way.touches.iter().enumerate() {
            let (east, up) = pick(touch.at);
            let (x, y) = self.at(east, up);
            out += &line(x - 5.0, y - 5.0, x + 5.0, y + 5.0, "touch");
            out += &line(x - 5.0, y + 5.0, x + 5.0, y - 5.0, "touch");
            out += &text(x + 9.0, y - 7.0, "small halo", &(i + 1).to_string());
        }
        out
    }

    /// Points that the range beam hit, by the estimate, within the view.
    fn feet(&self, way: &Way<'_>) -> String {
        let [east, up] = self.shown();
        let mut out = String::new();
        for s in way.samples.iter().step_by(THIN) {
            let (Some(place), Some(range)) = (s.position_estimate, s.range_measured) else {
                continue;
            };
            let [x, y, z] = way.lens;
            let beam = rows(s.attitude_estimate).map(|row| row[0] * x + row[1] * y + row[2] * (z + range));
            let foot = (place[1] + beam[1], -place[2] - beam[2]);
            if (east.0..=east.1).contains(&foot.0) && (up.0..=up.1).contains(&foot.1) {
                let (x, y) = self.at(foot.0, foot.1);
                out += &format!(
                    "<circle class=\"foot\" cx=\"{}\" cy=\"{}\" r=\"1.6\"/>",
                    short(x, 1),
                    short(y, 1)
                );
            }
        }
        out
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::synthetic;
    use super::*;

    /// The synthetic flight as an autonomous approach, from 5 to 3 cm over its pipe in two tries.
    pub fn flown() -> FlightRecord {
        let mut record = synthetic::record();
        let crown_east = record.scenario.world.pipe_position[1];
        for s in &mut record.samples {
            s.mode = match s.t {
                t if (20.0..24.0).contains(&t) || (25.0..28.0).contains(&t) => Mode::Approach,
                t if (24.0..24.5).contains(&t) || (28.0..30.0).contains(&t) => Mode::Contact,
                t if (24.5..25.0).contains(&t) => Mode::Escaping,
                _ => s.mode,
            };
            s.position[1] = crown_east + if s.t < 25.0 { -0.05 } else { 0.03 };
            s.position_estimate = Some(s.position);
            s.range_measured = Some(0.2);
        }
        record
    }

    #[test]
    fn both_touches_are_drawn_and_named_with_their_side() {
        let (svg, caption) = draw(&flown()).unwrap();
        super::super::page::tests::well_formed(&svg);
        assert!(!svg.contains("NaN"));
        assert_eq!(svg.matches("class=\"touch\"").count(), 8);
        assert!(caption.contains("Touch 1 at 24.0 s, 5.0 cm left"), "{caption}");
        assert!(caption.contains("Touch 2 at 28.0 s, 3.0 cm right"), "{caption}");
    }

    #[test]
    fn a_flight_by_hand_has_none_and_one_without_a_touch_says_so() {
        assert!(draw(&synthetic::record()).is_none());
        let mut record = flown();
        record.samples.retain(|s| s.t < 23.0);
        let (_, caption) = draw(&record).unwrap();
        assert_eq!(caption, "It did not come to a touch.");
    }
}
