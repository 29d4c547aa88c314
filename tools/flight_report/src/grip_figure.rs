//! Tendon force and contact pressure, over the flight and during closing.

use sophie_control::gripper::tendon::ForceLimit;
use sophie_sim::record::FlightRecord;

use super::figure::{ARM, Figure, arm_legend, arm_series};
use super::plot::{Panel, Trace, figure};
use super::time_axis::Span;
use sophie_charts::units::kgcm;

/// Tendon force and pressure of the arms.
pub fn grip(record: &FlightRecord, span: Span, title: &'static str, note: String) -> Figure {
    let p = &record.scenario.params;
    let (aim, tolerance) = (f64::from(p.grip_pressure), f64::from(p.grip_tolerance));
    let arms = |values: Vec<Vec<f64>>| {
        ARM.into_iter()
            .zip(values)
            .map(|(class, values)| Trace { class, values })
    };
    let force = |v: f64| tension_kgcm(record, v);
    let limit = tension_kgcm(record, f64::from(ForceLimit::from_params(p).force));
    let largest = record
        .samples
        .iter()
        .flat_map(|s| s.tension)
        .fold(0.0, |a: f64, v| a.max(force(v)));
    // Shown only near the curves, which it would flatten.
    let near = largest > 0.5 * limit;
    let tension = Panel {
        axis: "tendon force (kgcm)".into(),
        height: 170.0,
        traces: arms(arm_series(record, |s| &s.tension, force)).collect(),
        levels: near.then_some(limit).into_iter().collect(),
        include: if near { vec![0.0, limit] } else { vec![0.0] },
        span: 1.0,
        ..Panel::default()
    };
    let pressure = Panel {
        axis: "pressure (N/m²)".into(),
        height: 190.0,
        traces: arms(arm_series(record, |s| &s.pressure_measured, |v| v)).collect(),
        target: Some((aim - tolerance, aim + tolerance)),
        include: vec![0.0, aim + 2.0 * tolerance],
        ..Panel::default()
    };
    let band = format!(
        "Measured contact pressure; shaded: {aim:.0} ± {tolerance:.0} N/m², the proof of grip. {note}"
    );
    let mut legend = arm_legend();
    legend.push(("target", "target pressure".into()));
    if near {
        legend.push(("level", format!("limit {limit:.1} kgcm")));
    }
    Figure {
        title,
        note: band.trim_end().to_owned(),
        legend,
        svg: figure(
            record,
            span,
            "tendon force and contact pressure over time",
            &[tension, pressure],
        ),
    }
}

/// First closing, with margins.
pub fn closing(record: &FlightRecord) -> Option<(Span, String)> {
    let phase = record.phases.iter().find(|p| p.name == "perch")?;
    let times: Vec<String> = record
        .grip
        .iter()
        .take(4)
        .map(|g| format!("arm {} {:.2} s", g.arm, g.closure))
        .collect();
    let note = if times.is_empty() {
        String::new()
    } else {
        format!("Closed after: {}.", times.join(", "))
    };
    Some((
        Span {
            from: (phase.start - 0.5).max(0.0),
            to: phase.end + 1.5,
        },
        note,
    ))
}

/// Tendon tension (N) to servo torque in kgcm.
fn tension_kgcm(record: &FlightRecord, tension: f64) -> f64 {
    kgcm(tension * f64::from(record.scenario.params.reel_radius))
}
