//! Vehicle and pipe from behind, along the pipe: east right, up top.

use sophie_sim::plant::contact::{ARM_LENGTH, ARM_X, BELLY_Z, UNDERSIDE_Z};
use sophie_sim::plant::propeller::RADIUS;
use sophie_sim::record::{FlightRecord, Sample};

use super::moments::KeyMoment;
use super::rotation;
use sophie_charts::svg::{Rect, line, path, rect, short, text};

/// Pixels.
const WIDTH: f64 = 320.0;
const HEIGHT: f64 = 300.0;
/// Where the view's centre is drawn, px.
const ANCHOR: (f64, f64) = (160.0, 122.0);
/// Pixels per metre.
const SCALE: f64 = 380.0;
/// Pixels.
const GROUND: f64 = 16.0;

/// Drawn sizes that the plant does not have, m.
const ARM_THICKNESS: f64 = 0.026;
const MOTOR_HEIGHT: f64 = 0.035;
/// Scale of thrust arrows, m/N.
const THRUST_SCALE: f64 = 0.018;

/// Draws one moment.
pub fn draw(record: &FlightRecord, moment: &KeyMoment<'_>) -> String {
    let view = View::new(record, moment);
    let mut svg = format!(
        "<svg class=\"scene\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{}\">",
        sophie_charts::svg::escape(&moment.title)
    );
    svg += &rect(
        Rect {
            x: 0.0,
            y: 0.0,
            width: WIDTH,
            height: HEIGHT,
        },
        "sky",
        "",
    );
    svg += &view.pipe(record);
    for arm in [0, 2] {
        svg += &view.arm(arm, "far");
    }
    svg += &view.body();
    for arm in [1, 3] {
        svg += &view.arm(arm, "near");
    }
    svg += &view.ground();
    svg += &view.push(moment.push);
    svg + "</svg>"
}

struct View<'a> {
    sample: &'a Sample,
    /// East and height at the anchor, m.
    centre: (f64, f64),
    /// Body to world, rows east and down.
    rows: [[f64; 3]; 2],
}

impl<'a> View<'a> {
    fn new(record: &FlightRecord, moment: &KeyMoment<'a>) -> Self {
        let (world, sample) = (&record.scenario.world, moment.sample);
        let centre = if moment.at_pipe {
            (world.pipe_position[1], world.pipe_top + BELLY_Z)
        } else {
            (sample.position[1], -sample.position[2])
        };
        let [_, east, down] = rotation::rows(sample.attitude);
        Self {
            sample,
            centre,
            rows: [east, down],
        }
    }

    fn world(&self, east: f64, height: f64) -> (f64, f64) {
        (
            ANCHOR.0 + (east - self.centre.0) * SCALE,
            ANCHOR.1 - (height - self.centre.1) * SCALE,
        )
    }

    fn body_point(&self, r: [f64; 3]) -> (f64, f64) {
        let along = |row: [f64; 3]| row.iter().zip(r).map(|(a, b)| a * b).sum::<f64>();
        let [east, down] = self.rows.map(along);
        self.world(self.sample.position[1] + east, -self.sample.position[2] - down)
    }

    fn polygon(&self, class: &str, points: &[[f64; 3]]) -> String {
        format!(
            "<path class=\"{class}\" d=\"{}Z\"/>",
            path(points.iter().map(|r| self.body_point(*r)))
        )
    }

    fn pipe(&self, record: &FlightRecord) -> String {
        let world = &record.scenario.world;
        let radius = world.pipe_diameter / 2.0;
        let (x, y) = self.world(world.pipe_position[1], world.pipe_top - radius);
        let r = radius * SCALE;
        if y - r > HEIGHT || y + r < 0.0 || x + r < 0.0 || x - r > WIDTH {
            return String::new();
        }
        let circle = |class: &str, r: f64| {
            format!(
                "<circle class=\"{class}\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>",
                short(x, 1),
                short(y, 1),
                short(r, 1)
            )
        };
        circle("pipe", r) + &circle("bore", r * 0.84)
    }

    fn body(&self) -> String {
        let box_of = |y: f64, top: f64, bottom: f64| {
            [[0.0, -y, top], [0.0, y, top], [0.0, y, bottom], [0.0, -y, bottom]]
        };
        let mut out = self.polygon("hull", &box_of(0.05, -0.045, UNDERSIDE_Z));
        for y in [-0.03, 0.03] {
            let pad = [
                [0.0, y - 0.012, 0.03],
                [0.0, y + 0.012, 0.03],
                [0.0, y + 0.012, BELLY_Z],
                [0.0, y - 0.012, BELLY_Z],
            ];
            out += &self.polygon("pad", &pad);
        }
        let (x, y) = self.body_point([0.0; 3]);
        out + &format!(
            "<circle class=\"cg\" cx=\"{}\" cy=\"{}\" r=\"2.5\"/>",
            short(x, 1),
            short(y, 1)
        )
    }

    fn arm(&self, index: usize, depth: &str) -> String {
        let value = |values: &[f64; 4]| values.get(index).copied().unwrap_or(0.0);
        let arm = Arm::new(index, value(&self.sample.tilt));
        let along = |lift: f64| (0..=16).map(move |i| arm.point(f64::from(i) / 16.0, lift));
        let outline: Vec<[f64; 3]> = along(0.0).chain(along(ARM_THICKNESS).rev()).collect();
        let number = index + 1;
        let mut out = format!("<g class=\"{depth}\">") + &self.polygon(&format!("arm f{number}"), &outline);
        let tension = value(&self.sample.tension);
        if tension > 0.5 {
            let tendon = path(along(-0.006).map(|r| self.body_point(r)));
            out += &format!("<path class=\"tendon\" d=\"{tendon}\"/>");
        }
        let hub = arm.point(1.0, ARM_THICKNESS + MOTOR_HEIGHT);
        out += &self.segment(arm.point(1.0, ARM_THICKNESS), hub, &format!("motor s{number}"));
        let blade = |side: f64| arm.beside(hub, side * RADIUS);
        out += &self.segment(blade(-1.0), blade(1.0), &format!("rotor s{number}"));
        let thrust = value(&self.sample.thrust);
        if thrust > 0.4 {
            let lift = ARM_THICKNESS + MOTOR_HEIGHT + 0.008;
            out += &self.arrow(
                arm.point(1.0, lift),
                arm.point(1.0, lift + thrust * THRUST_SCALE),
                "thrust",
            );
        }
        out + "</g>"
    }

    fn segment(&self, a: [f64; 3], b: [f64; 3], class: &str) -> String {
        let ((x1, y1), (x2, y2)) = (self.body_point(a), self.body_point(b));
        line(x1, y1, x2, y2, class)
    }

    fn arrow(&self, a: [f64; 3], b: [f64; 3], class: &str) -> String {
        arrow(self.body_point(a), self.body_point(b), class)
    }

    /// In place if in view, else below a break with the height beside it.
    fn ground(&self) -> String {
        let (_, level) = self.world(0.0, 0.0);
        let (below, _) = self.world(self.sample.position[1], 0.0);
        let height = -self.sample.position[2] - BELLY_Z;
        if level < HEIGHT - GROUND {
            return rect(
                Rect {
                    x: 0.0,
                    y: level,
                    width: WIDTH,
                    height: HEIGHT - level,
                },
                "ground",
                "",
            ) + &line(0.0, level, WIDTH, level, "ground-line");
        }
        let top = HEIGHT - GROUND;
        let x = if below < WIDTH / 2.0 { WIDTH - 30.0 } else { 30.0 };
        let zigzag = [
            (x, top - 26.0),
            (x - 5.0, top - 22.0),
            (x + 5.0, top - 17.0),
            (x, top - 13.0),
        ];
        let label = format!("belly {height:.2} m over the ground");
        rect(
            Rect {
                x: 0.0,
                y: top,
                width: WIDTH,
                height: GROUND,
            },
            "ground",
            "",
        ) + &line(0.0, top, WIDTH, top, "ground-line")
            + &line(x, top - 38.0, x, top - 26.0, "measure")
            + &format!("<path class=\"measure\" d=\"{}\"/>", path(zigzag))
            + &arrow((x, top - 13.0), (x, top - 1.0), "measure")
            + &text(WIDTH / 2.0, HEIGHT - 4.5, "small mid", &label)
    }

    fn push(&self, newtons: f64) -> String {
        if newtons <= 0.0 {
            return String::new();
        }
        let (x, y) = self.body_point([0.0; 3]);
        // The push comes from the left, above the arms.
        let y = y - 6.0;
        arrow((x - 84.0, y), (x - 24.0, y), "push")
            + &text(x - 88.0, y + 4.0, "small end halo", &format!("{newtons} N"))
    }
}

fn arrow((x1, y1): (f64, f64), (x2, y2): (f64, f64), class: &str) -> String {
    let length = (x2 - x1).hypot(y2 - y1).max(1e-6);
    let (ux, uy) = ((x2 - x1) / length, (y2 - y1) / length);
    let barb = |side: f64| (x2 - 7.0 * ux - side * 3.5 * uy, y2 - 7.0 * uy + side * 3.5 * ux);
    format!(
        "<path class=\"{class}\" d=\"{}\"/>",
        path([(x1, y1), (x2, y2), barb(1.0), barb(-1.0), (x2, y2)])
    )
}

/// An arc of constant curvature, level at its root, at its tilt at the tip.
#[derive(Clone, Copy)]
struct Arm {
    x: f64,
    /// -1 left, +1 right.
    side: f64,
    tilt: f64,
}

impl Arm {
    fn new(index: usize, tilt: f64) -> Self {
        let x = if index.is_multiple_of(2) { ARM_X } else { -ARM_X };
        Self {
            x,
            side: if index < 2 { -1.0 } else { 1.0 },
            tilt,
        }
    }

    /// Body point at share `u` of the length, `lift` m above the underside.
    fn point(self, u: f64, lift: f64) -> [f64; 3] {
        let angle = self.tilt * u;
        let (sin, cos) = angle.sin_cos();
        let (out, up) = if self.tilt.abs() < 1e-4 {
            (ARM_LENGTH * u, ARM_LENGTH * u * angle / 2.0)
        } else {
            let radius = ARM_LENGTH / self.tilt;
            (radius * sin, radius * (1.0 - cos))
        };
        [
            self.x,
            self.side * (out - lift * sin),
            UNDERSIDE_Z - up - lift * cos,
        ]
    }

    /// `distance` m outward of `r` along the tip's direction.
    fn beside(self, r: [f64; 3], distance: f64) -> [f64; 3] {
        let (sin, cos) = self.tilt.sin_cos();
        [r[0], r[1] + self.side * distance * cos, r[2] - distance * sin]
    }
}

#[cfg(test)]
mod tests {
    use super::super::moments::key_moments;
    use super::super::synthetic;
    use super::*;

    #[test]
    fn an_arm_bends_up_for_a_positive_tilt_and_keeps_its_length() {
        for tilt in [-1.0, -0.3, 1e-6, 0.4] {
            let arm = Arm::new(3, tilt);
            let points: Vec<[f64; 3]> = (0..=200).map(|i| arm.point(f64::from(i) / 200.0, 0.0)).collect();
            let length: f64 = points
                .windows(2)
                .map(|w| (w[1][1] - w[0][1]).hypot(w[1][2] - w[0][2]))
                .sum();
            assert!((length - ARM_LENGTH).abs() < 1e-5, "{length}");
            assert!(tilt.abs() < 1e-3 || (points[200][2] < UNDERSIDE_Z) == (tilt > 0.0));
            assert!(points[200][1] > 0.0 && Arm::new(1, tilt).point(1.0, 0.0)[1] < 0.0);
        }
    }

    #[test]
    fn every_moment_is_well_formed_and_finite() {
        let record = synthetic::record();
        for moment in key_moments(&record) {
            let svg = draw(&record, &moment);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{}", moment.title);
            super::super::page::tests::well_formed(&svg);
        }
    }
}
