//! Times as Foxglove writes them.

use serde_json::{Value, json};

/// A time as Foxglove's schemas have it.
pub fn stamp(t: f64) -> Value {
    let ns = nanoseconds(t);
    json!({ "sec": ns / 1_000_000_000, "nsec": ns % 1_000_000_000 })
}

/// `t`, s, in nanoseconds; 0 for a time before the start.
pub fn nanoseconds(t: f64) -> u64 {
    (t.max(0.0) * 1e9).round() as u64
}
