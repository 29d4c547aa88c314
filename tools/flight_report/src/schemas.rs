//! JSON schemas of the channels in `flight.mcap`. Own ones are plain numbers and arrays for plotting tools
//! (`/truth.tilt[0]`); `foxglove.` ones are the used parts of Foxglove's, recognised by its panels.

use serde_json::{Value, json};

/// Type of a field in our channels.
#[derive(Clone, Copy)]
pub enum Field {
    /// One number.
    Number,
    /// About the forward and the right axis.
    Two,
    /// North, east, down or roll, pitch, yaw.
    Three,
    /// Per arm: 1 front left, 2 rear left, 3 front right, 4 rear right.
    Arms,
    /// A word.
    Word,
    /// True or false.
    Flag,
}

/// Fields of `/truth`: the simulated vehicle.
pub const TRUTH: &[(&str, Field, &str)] = &[
    (
        "position",
        Field::Three,
        "centre of mass, NED from the take-off point, m",
    ),
    ("velocity", Field::Three, "NED, m/s"),
    ("attitude_deg", Field::Three, "roll, pitch, yaw"),
    ("rate", Field::Three, "body, rad/s"),
    ("tilt_deg", Field::Arms, "arm tilt, tip up positive"),
    ("thrust", Field::Arms, "N"),
    ("tension", Field::Arms, "tendon, N"),
    ("pressure", Field::Arms, "contact pressure at the sensors, Pa"),
    ("battery_voltage", Field::Number, "under load, V"),
];

/// Fields of `/stack`: estimates and demands.
pub const STACK: &[(&str, Field, &str)] = &[
    ("mode", Field::Word, "state of the stack"),
    ("attitude_estimate_deg", Field::Three, "roll, pitch, yaw"),
    (
        "attitude_setpoint_deg",
        Field::Three,
        "roll, pitch, yaw aimed at; null where there is none",
    ),
    (
        "tilt_measured_deg",
        Field::Arms,
        "by the arms' own sensors; null where there is none",
    ),
    ("tilt_model_deg", Field::Arms, "by the model in the mixer"),
    ("thrust_asked", Field::Arms, "N"),
    ("tension_asked", Field::Arms, "N"),
    ("pressure_measured", Field::Arms, "Pa; null where none is fresh"),
    ("throttle", Field::Number, "the pilot's, 0 to 1"),
    (
        "saturated",
        Field::Flag,
        "the rotors could not give all that was asked",
    ),
];

/// Fields of `/position`, which only flights with poses, or with flow and range, have.
pub const POSITION: &[(&str, Field, &str)] = &[
    (
        "estimate",
        Field::Three,
        "by the stack, NED from the take-off point, m; null without one",
    ),
    (
        "pose",
        Field::Three,
        "newest pose, late, NED from the take-off point, m; null without one",
    ),
    (
        "range_true",
        Field::Number,
        "along the body's down axis to pipe or ground, m; null without",
    ),
    ("range", Field::Number, "newest range, late, m; null without one"),
    (
        "flow",
        Field::Two,
        "newest flow, late, rad/s about the forward and the right axis; null without one",
    ),
];

/// Schema of one of our channels.
pub fn own(fields: &[(&str, Field, &str)]) -> Value {
    let number = json!({ "type": ["number", "null"] });
    let list = |n: u32| json!({ "type": "array", "items": number, "minItems": n, "maxItems": n });
    let mut properties = serde_json::Map::new();
    for (name, field, doc) in fields {
        let mut schema = match field {
            Field::Number => number.clone(),
            Field::Two => list(2),
            Field::Three => list(3),
            Field::Arms => list(4),
            Field::Word => json!({ "type": "string" }),
            Field::Flag => json!({ "type": "boolean" }),
        };
        if let Some(map) = schema.as_object_mut() {
            map.insert("description".to_owned(), Value::from(*doc));
        }
        properties.insert((*name).to_owned(), schema);
    }
    json!({ "type": "object", "properties": properties })
}

fn object(fields: &[(&str, Value)]) -> Value {
    let properties: serde_json::Map<String, Value> = fields
        .iter()
        .map(|(name, schema)| ((*name).to_owned(), schema.clone()))
        .collect();
    json!({ "type": "object", "properties": properties })
}

fn time() -> Value {
    object(&[
        ("sec", json!({ "type": "integer", "minimum": 0 })),
        ("nsec", json!({ "type": "integer", "minimum": 0 })),
    ])
}

fn vector() -> Value {
    let number = json!({ "type": "number" });
    object(&[("x", number.clone()), ("y", number.clone()), ("z", number)])
}

fn quaternion() -> Value {
    let number = json!({ "type": "number" });
    object(&[
        ("x", number.clone()),
        ("y", number.clone()),
        ("z", number.clone()),
        ("w", number),
    ])
}

fn pose() -> Value {
    object(&[("position", vector()), ("orientation", quaternion())])
}

fn colour() -> Value {
    let number = json!({ "type": "number" });
    object(&[
        ("r", number.clone()),
        ("g", number.clone()),
        ("b", number.clone()),
        ("a", number),
    ])
}

/// `foxglove.Log`.
pub fn log() -> Value {
    let (text, whole) = (
        json!({ "type": "string" }),
        json!({ "type": "integer", "minimum": 0 }),
    );
    object(&[
        ("timestamp", time()),
        ("level", whole.clone()),
        ("message", text.clone()),
        ("name", text.clone()),
        ("file", text),
        ("line", whole),
    ])
}

/// `foxglove.FrameTransform`.
pub fn frame_transform() -> Value {
    let text = json!({ "type": "string" });
    object(&[
        ("timestamp", time()),
        ("parent_frame_id", text.clone()),
        ("child_frame_id", text),
        ("translation", vector()),
        ("rotation", quaternion()),
    ])
}

/// `foxglove.SceneUpdate`, with the primitives used.
pub fn scene_update() -> Value {
    let text = json!({ "type": "string" });
    let list = |items: Value| json!({ "type": "array", "items": items });
    let solid = || object(&[("pose", pose()), ("size", vector()), ("color", colour())]);
    let number = json!({ "type": "number" });
    let cylinder = object(&[
        ("pose", pose()),
        ("size", vector()),
        ("bottom_scale", number.clone()),
        ("top_scale", number.clone()),
        ("color", colour()),
    ]);
    let line = object(&[
        ("type", json!({ "type": "integer" })),
        ("pose", pose()),
        ("thickness", number),
        ("scale_invariant", json!({ "type": "boolean" })),
        ("points", list(vector())),
        ("color", colour()),
        ("colors", list(colour())),
        ("indices", list(json!({ "type": "integer" }))),
    ]);
    let entity = object(&[
        ("timestamp", time()),
        ("frame_id", text.clone()),
        ("id", text),
        ("lifetime", time()),
        ("frame_locked", json!({ "type": "boolean" })),
        ("cubes", list(solid())),
        ("cylinders", list(cylinder)),
        ("lines", list(line)),
    ]);
    object(&[("deletions", list(object(&[]))), ("entities", list(entity))])
}
