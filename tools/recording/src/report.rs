//! The results in words and as JSON.

use serde_json::{Value, json};

use crate::bytes::Decoded;
use crate::replay::Outcome;

/// A recording of sensors, a line each.
pub fn lines(name: &str, o: &Outcome) -> Vec<String> {
    let [samples, flows, ranges] = o.counts;
    let at = |s: Option<f64>| s.map_or("never".to_owned(), |s| format!("at {s:.2} s"));
    let mut lines = vec![
        format!(
            "{name}: {:.1} s, {samples} inertial samples at {:.0} Hz, {flows} flows, {ranges} ranges",
            o.seconds, o.rate_hz
        ),
        format!(
            "estimate: {:.1} % of {:.1} s; attitude calibrated {}, first estimate {}",
            100.0 * o.estimate_share,
            o.flown_s,
            at(o.calibrated_s),
            at(o.estimate_s)
        ),
    ];
    if let Some(e) = o.last {
        let (p, v) = (e.position, e.velocity);
        lines.push(format!(
            "last: {:.2} m ahead, {:.2} m right, {:.2} m up of where it began; {:.2}, {:.2}, {:.2} m/s",
            p.x, p.y, -p.z, v.x, v.y, -v.z
        ));
    }
    if o.faults.is_empty() {
        lines.push("faults: none".to_owned());
    }
    for fault in &o.faults {
        lines.push(format!(
            "fault: {} from {:.2} to {:.2} s",
            fault.name, fault.from_s, fault.to_s
        ));
    }
    if let Some(errors) = &o.errors {
        let part =
            |what: &str, value: Option<f64>, unit: &str| value.map(|v| format!("{what} {v:.3} {unit}"));
        let attitude = errors.attitude().map(|([roll, pitch], [r, p])| {
            format!("roll {roll:.2} and pitch {pitch:.2} degrees RMS about {r:+.2} and {p:+.2}")
        });
        let parts = [
            part("level velocity", errors.velocity(), "m/s RMS"),
            part("height", errors.height(), "m RMS"),
            part("place at the end", errors.place_end(), "m"),
            attitude,
        ];
        let found: Vec<String> = parts.into_iter().flatten().collect();
        let found = if found.is_empty() {
            "nothing at the same time".to_owned()
        } else {
            found.join(", ")
        };
        lines.push(format!("against the truth: {found}"));
    }
    lines
}

/// A warning about the recording itself, if there is one.
pub fn warning(o: &Outcome) -> Option<String> {
    (o.gaps > 0).then(|| {
        format!(
            "{} gaps of the inertial samples beyond 50 ms, the longest {:.0} ms: the position begins again after each",
            o.gaps,
            1e3 * o.longest_gap_s
        )
    })
}

/// The same as one object.
pub fn object(o: &Outcome) -> Value {
    let faults: Vec<Value> = o
        .faults
        .iter()
        .map(|f| json!({ "name": f.name, "from_s": rounded(f.from_s), "to_s": rounded(f.to_s) }))
        .collect();
    let errors = o.errors.as_ref();
    let worse = |([roll, pitch], _): ([f64; 2], [f64; 2])| rounded(roll.max(pitch));
    json!({
        "seconds": rounded(o.seconds),
        "estimate_share": o.estimate_share,
        "faults": faults,
        "velocity_rms_m_s": errors.and_then(|e| e.velocity()).map(rounded),
        "height_rms_m": errors.and_then(|e| e.height()).map(rounded),
        "place_end_m": errors.and_then(|e| e.place_end()).map(rounded),
        "attitude_rms_deg": errors.and_then(|e| e.attitude()).map(worse),
    })
}

/// A capture of bytes.
pub fn bytes_line(name: &str, d: &Decoded) -> String {
    format!(
        "{name}: {:.3} s, {} bytes, {} frames, {} published, longest pause {:.1} ms",
        d.seconds, d.bytes, d.frames, d.published, d.longest_pause_ms
    )
}

/// The same as one object.
pub fn bytes_object(d: &Decoded) -> Value {
    json!({
        "seconds": rounded(d.seconds),
        "frames": d.frames,
        "published": d.published,
        "longest_pause_ms": rounded(d.longest_pause_ms),
    })
}

/// Rounded to a millionth: finer digits depend on the order of the arithmetic.
fn rounded(x: f64) -> f64 {
    (x * 1e6).round() / 1e6
}
