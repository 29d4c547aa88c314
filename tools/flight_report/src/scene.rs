//! Vehicle, arms and pipe for Foxglove's 3D panel.

use serde_json::{Value, json};
use sophie_sim::plant::contact::{ARM_LENGTH, ARM_X, HINGE_Z};
use sophie_sim::plant::propeller::RADIUS;
use sophie_sim::record::{FlightRecord, Sample};

use super::time_stamp::stamp;
use sophie_charts::units::tidy;

/// Rotor above the arm, m, drawn.
const ROTOR_LIFT: f64 = 0.05;
/// As in the report.
const COLOURS: [[f64; 3]; 4] = [
    [0.0, 0.45, 0.70],
    [0.84, 0.37, 0.0],
    [0.0, 0.62, 0.45],
    [0.69, 0.33, 0.61],
];

/// Vehicle frame: from NED and FRD, y and z change sign.
pub fn transform(s: &Sample) -> Value {
    let [(sr, cr), (sp, cp), (sy, cy)] = s.attitude.map(|angle| (0.5 * angle).sin_cos());
    let (w, x) = (cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy);
    let (y, z) = (cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy);
    let [north, east, down] = s.position;
    json!({
        "timestamp": stamp(s.t),
        "parent_frame_id": "world",
        "child_frame_id": "vehicle",
        "translation": point(north, -east, -down),
        "rotation": { "x": tidy(x), "y": tidy(-y), "z": tidy(-z), "w": tidy(w) },
    })
}

/// The pipe, and the body in its frame.
pub fn fixed(record: &FlightRecord) -> Value {
    let world = &record.scenario.world;
    let [north, east] = world.pipe_position;
    let d = world.pipe_diameter;
    // A cylinder stands on end: a quarter turn about y lays it north.
    let half = core::f64::consts::FRAC_1_SQRT_2;
    let pipe = json!({
        "pose": {
            "position": point(north, -east, world.pipe_top - d / 2.0),
            "orientation": { "x": 0.0, "y": half, "z": 0.0, "w": half },
        },
        "size": { "x": d, "y": d, "z": world.pipe_length },
        "bottom_scale": 1.0,
        "top_scale": 1.0,
        "color": colour([0.62, 0.66, 0.72], 1.0),
    });
    let body = json!({
        "pose": { "position": point(0.0, 0.0, 0.005), "orientation": level() },
        "size": { "x": 0.42, "y": 0.09, "z": 0.08 },
        "color": colour([0.22, 0.27, 0.35], 1.0),
    });
    let entities = [
        entity(
            0.0,
            "world",
            "pipe",
            Shapes {
                cylinders: vec![pipe],
                ..Shapes::default()
            },
        ),
        entity(
            0.0,
            "vehicle",
            "body",
            Shapes {
                cubes: vec![body],
                ..Shapes::default()
            },
        ),
    ];
    json!({ "deletions": [], "entities": entities })
}

/// The four bent arms and their rotors.
pub fn vehicle(s: &Sample) -> Value {
    let mut lines = vec![];
    let mut rotors = vec![];
    for (i, (tilt, rgb)) in s.tilt.iter().zip(COLOURS).enumerate() {
        let x = if i % 2 == 0 { ARM_X } else { -ARM_X };
        let side = if i < 2 { 1.0 } else { -1.0 };
        let points: Vec<Value> = (0..=8)
            .map(|k| arm_point(x, side, *tilt, f64::from(k) / 8.0, 0.0))
            .collect();
        lines.push(json!({
            "type": 0,
            "pose": { "position": point(0.0, 0.0, 0.0), "orientation": level() },
            "thickness": 0.025,
            "scale_invariant": false,
            "points": points,
            "color": colour(rgb, 1.0),
            "colors": [],
            "indices": [],
        }));
        let (sin, cos) = (0.5 * side * tilt).sin_cos();
        rotors.push(json!({
            "pose": {
                "position": arm_point(x, side, *tilt, 1.0, ROTOR_LIFT),
                "orientation": { "x": tidy(sin), "y": 0.0, "z": 0.0, "w": tidy(cos) },
            },
            "size": { "x": 2.0 * RADIUS, "y": 2.0 * RADIUS, "z": 0.006 },
            "bottom_scale": 1.0,
            "top_scale": 1.0,
            "color": colour(rgb, 0.35),
        }));
    }
    json!({
        "deletions": [],
        "entities": [entity(s.t, "vehicle", "arms", Shapes { cylinders: rotors, lines, ..Shapes::default() })],
    })
}

/// Point (forward, left, up) at share `u` of a bent arm, `lift` m along its normal.
fn arm_point(x: f64, side: f64, tilt: f64, u: f64, lift: f64) -> Value {
    let (sin, cos) = (tilt * u).sin_cos();
    let (out, up) = if tilt.abs() < 1e-4 {
        (ARM_LENGTH * u, 0.5 * ARM_LENGTH * u * u * tilt)
    } else {
        (ARM_LENGTH / tilt * sin, ARM_LENGTH / tilt * (1.0 - cos))
    };
    point(x, side * (out - lift * sin), up + lift * cos - HINGE_Z)
}

#[derive(Default)]
struct Shapes {
    cubes: Vec<Value>,
    cylinders: Vec<Value>,
    lines: Vec<Value>,
}

fn entity(t: f64, frame: &str, id: &str, shapes: Shapes) -> Value {
    json!({
        "timestamp": stamp(t),
        "frame_id": frame,
        "id": id,
        "lifetime": { "sec": 0, "nsec": 0 },
        "frame_locked": true,
        "metadata": [],
        "arrows": [],
        "cubes": shapes.cubes,
        "spheres": [],
        "cylinders": shapes.cylinders,
        "lines": shapes.lines,
        "triangles": [],
        "texts": [],
        "models": [],
    })
}

fn point(x: f64, y: f64, z: f64) -> Value {
    json!({ "x": tidy(x), "y": tidy(y), "z": tidy(z) })
}

fn level() -> Value {
    json!({ "x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0 })
}

fn colour([r, g, b]: [f64; 3], a: f64) -> Value {
    json!({ "r": r, "g": g, "b": b, "a": a })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_right_roll_turns_about_the_forward_axis_and_a_right_yaw_turns_clockwise() {
        let roll = transform(&Sample {
            attitude: [0.4, 0.0, 0.0],
            ..Sample::default()
        });
        assert!((roll["rotation"]["x"].as_f64().unwrap() - 0.2_f64.sin()).abs() < 1e-5);
        // Clockwise from above is negative about an upward axis.
        let yaw = transform(&Sample {
            attitude: [0.0, 0.0, 0.4],
            position: [1.0, 2.0, -3.0],
            ..Sample::default()
        });
        assert!((yaw["rotation"]["z"].as_f64().unwrap() + 0.2_f64.sin()).abs() < 1e-5);
        assert_eq!(yaw["translation"], json!({ "x": 1.0, "y": -2.0, "z": 3.0 }));
    }

    #[test]
    fn a_tip_that_is_up_is_up() {
        let tip = arm_point(0.178, 1.0, 0.3, 1.0, 0.0);
        assert!(tip["z"].as_f64().unwrap() > -HINGE_Z && tip["y"].as_f64().unwrap() > 0.17);
    }
}
