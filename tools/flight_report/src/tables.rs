//! The tables of the page.

use sophie_sim::record::FlightRecord;

use sophie_charts::svg::escape;
use sophie_charts::units::{deg, kgcm, tidy};

/// The steps as flown.
pub fn phases(record: &FlightRecord) -> String {
    let head = [
        "#",
        "step",
        "start s",
        "duration s",
        "attitude error °",
        "worst α °",
        "saturated %",
        "battery V",
        "overruns",
        "",
    ];
    let rows = record.phases.iter().enumerate().map(|(i, p)| {
        vec![
            (i + 1).to_string(),
            p.name.clone(),
            format!("{:.1}", p.start),
            format!("{:.1}", p.end - p.start),
            format!("{:.1}", deg(p.worst_attitude_error)),
            signed(deg(p.worst_tilt)),
            format!("{:.1}", 100.0 * p.saturation),
            format!("{:.2}", p.battery_voltage),
            p.overruns.to_string(),
            if p.done {
                "done".to_owned()
            } else {
                "not done".to_owned()
            },
        ]
    });
    table(&head, rows, &[1, 9])
}

/// The proven grips.
pub fn grip(record: &FlightRecord) -> String {
    if record.grip.is_empty() {
        return "<p class=\"note\">No grip was proven.</p>".to_owned();
    }
    let head = ["arm", "pressure N/m²", "true N/m²", "force kgcm", "closure s"];
    let rows = record.grip.iter().map(|g| {
        let name = usize::from(g.arm)
            .checked_sub(1)
            .and_then(|i| super::figure::ARM_NAMES.get(i));
        vec![
            name.map_or_else(|| g.arm.to_string(), |n| (*n).to_owned()),
            format!("{:.0}", g.pressure),
            format!("{:.0}", g.pressure_true),
            format!("{:.2}", kgcm(g.torque)),
            format!("{:.2}", g.closure),
        ]
    });
    table(&head, rows, &[0])
}

/// Strikes of turning propellers; empty without any.
pub fn strikes(record: &FlightRecord) -> String {
    if record.strikes.is_empty() {
        return String::new();
    }
    let rows = record.strikes.iter().map(|s| {
        vec![
            s.arm.to_string(),
            s.against.name().to_owned(),
            format!("{:.2}", s.start),
            format!("{:.2}", s.end - s.start),
            format!("{:.0}", 1e3 * s.depth),
        ]
    });
    table(&["arm", "against", "at s", "for s", "depth mm"], rows, &[1])
}

/// What the stack's parameters have wrong; empty where nothing is.
pub fn differences(record: &FlightRecord) -> String {
    let differences = record.scenario.differences();
    if differences.is_empty() {
        return String::new();
    }
    let rows = differences.iter().map(|d| {
        vec![
            d.key.clone(),
            format!("{:.4}", tidy(d.truth)),
            format!("{:.4}", tidy(d.assumed)),
            d.percent()
                .map_or_else(String::new, |p| format!("{} %", signed(p))),
        ]
    });
    table(&["scenario key", "true", "assumed", "off by"], rows, &[0])
}

/// What happened, in order.
pub fn events(record: &FlightRecord) -> String {
    let rows = record
        .events
        .iter()
        .map(|e| vec![format!("{:.2}", e.t), e.text.clone()]);
    format!(
        "<div class=\"long\">{}</div>",
        table(&["time s", "event"], rows, &[1])
    )
}

/// With a minus sign as wide as the plus.
pub fn signed(value: f64) -> String {
    let text = format!("{value:+.1}");
    if text == "-0.0" {
        "0.0".to_owned()
    } else {
        text.replace('-', "−").replace("+0.0", "0.0")
    }
}

fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>, words: &[usize]) -> String {
    let cell = |tag: &str, i: usize, content: &str| {
        let class = if words.contains(&i) { " class=\"w\"" } else { "" };
        format!("<{tag}{class}>{}</{tag}>", escape(content))
    };
    let mut out = String::from("<div class=\"scroll\"><table><thead><tr>");
    out.extend(head.iter().enumerate().map(|(i, title)| cell("th", i, title)));
    out += "</tr></thead><tbody>";
    for row in rows {
        out += "<tr>";
        out.extend(row.iter().enumerate().map(|(i, content)| cell("td", i, content)));
        out += "</tr>";
    }
    out + "</tbody></table></div>"
}
