//! A capture map as a section with its pictures, and as JSON.

use std::collections::BTreeMap;

use serde_json::json;
use sophie_control::mode::Reason;

use super::map::{count, extremes, measure};
use super::{Flown, Outcome, Request};
use crate::results::model::{Axis, Chart, Section, Series, SeriesStyle, Table, num};

/// Width of a bar of the shares, m.
const BIN: f64 = 0.01;
/// Offset within which a touch that ends without a grip is asked for its reason, m.
const CENTRED: f64 = 0.025;
/// Lost touches that are named one by one.
const NAMED: usize = 20;
/// Colours of [`Outcome::ALL`].
const COLOURS: [usize; Outcome::ALL.len()] = [2, 0, 4, 5, 1];

/// The map as JSON text, newline-terminated.
#[must_use]
pub fn json(flown: &[Flown], request: &Request) -> String {
    let of = |outcome| count(flown, outcome);
    let (measured, most) = (measure(flown), extremes(flown));
    let metres = |value: f64| (value * 1e4).round() / 1e4;
    let value = json!({
        "seed": request.seed,
        "uncertain": request.uncertain,
        "touches": flown.len(),
        "held": of(Outcome::Released) + of(Outcome::Held),
        "released": of(Outcome::Released),
        "refused": of(Outcome::Refused),
        "flown_away": of(Outcome::FlownAway),
        "lost": of(Outcome::Lost),
        "half_width_held_m": metres(measured[0].held),
        "half_width_releasable_m": metres(measured[0].releasable),
        "pipes": measured.map(|m| json!({
            "diameter_m": m.gauge.diameter,
            "friction": m.gauge.friction,
            "touches": m.touches,
            "wanted_held_m": m.gauge.wanted,
            "half_width_held_m": metres(m.held),
            "half_width_releasable_m": metres(m.releasable),
        })),
        "deepest_drop_m": metres(most.drop),
        "deepest_seed": most.deepest_seed,
        "propeller_strikes": most.strikes,
        "propeller_clearance_m": metres(most.clearance),
        "closing_pressure_pa": most.closing_pressure.round(),
        "near_closing_pressure_pa": most.near_closing_pressure.round(),
        "near_closing_seed": most.near_closing_seed,
        "open_arm_pressure_pa": most.bump.round(),
        "pressure_pa": most.pressure.round(),
    });
    // Numbers and string keys only: cannot fail.
    serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
}

/// The map with its pictures.
#[must_use]
pub fn section(flown: &[Flown], request: &Request) -> Section {
    let mut s = Section::new("capture", "Touches of the pipe");
    s.table(outcomes(flown));
    s.table(widths(flown));
    s.table(limits(flown));
    s.table(causes(flown));
    for line in lost(flown) {
        s.text(line);
    }
    s.figure(
        &format!(
            "Careful touches on each pipe, in steps of {:.0} mm: share that is held, and share that is also let go.",
            1e3 * BIN
        ),
        (0..super::GAUGES.len()).map(|i| shares(flown, i)).collect(),
    );
    s.figure(
        "Touches from anywhere: lean positive to the right, offset positive where the vehicle is right of the crown.",
        vec![
            anywhere(flown, "lean, °", |f| f.planned.touch.lean.to_degrees()),
            anywhere(flown, "sideways speed, m/s", |f| f.planned.touch.sideways),
        ],
    );
    let paper = measure(flown)[0];
    s.finding = format!(
        "{request}, {} lost; on the paper's pipe 99 % are held within ±{:.0} mm and let go within ±{:.0} mm.",
        count(flown, Outcome::Lost),
        1e3 * paper.held,
        1e3 * paper.releasable
    );
    s
}

fn outcomes(flown: &[Flown]) -> Table {
    let mut t = Table::new("What became of them", &["", "from anywhere", "careful"]);
    for outcome in Outcome::ALL {
        let of = |careful: bool| {
            let these = flown.iter().filter(|f| f.planned.gauge.is_some() == careful);
            these.filter(|f| f.outcome == outcome).count()
        };
        t.row([
            outcome.name().into(),
            num(of(false) as f64, 0),
            num(of(true) as f64, 0),
        ]);
    }
    t
}

fn widths(flown: &[Flown]) -> Table {
    let mut t = Table::new(
        "Half-width within which 99 % of the careful touches succeed",
        &[
            "pipe, m",
            "friction",
            "touches",
            "held, mm",
            "wanted, mm",
            "held and let go, mm",
        ],
    );
    for m in measure(flown) {
        t.row([
            num(m.gauge.diameter, 1),
            num(m.gauge.friction, 1),
            num(m.touches as f64, 0),
            num(1e3 * m.held, 0),
            num(1e3 * m.gauge.wanted, 0),
            num(1e3 * m.releasable, 0),
        ]);
    }
    t
}

fn limits(flown: &[Flown]) -> Table {
    let most = extremes(flown);
    let mut t = Table::new("Extremes", &["", "value", "unit"]);
    for (what, value, digits, unit) in [
        (
            "touches in which a turning propeller reached the pipe",
            most.strikes as f64,
            0,
            "",
        ),
        ("deepest below the height of the touch", most.drop, 2, "m"),
        (
            "nearest turning propeller to the pipe",
            1e3 * most.clearance,
            0,
            "mm",
        ),
        (
            "pressure in closings that ended in proof",
            most.closing_pressure,
            0,
            "N/m²",
        ),
        (
            "the same, within 45 mm of the crown",
            most.near_closing_pressure,
            0,
            "N/m²",
        ),
        ("pressure on open arms", most.bump, 0, "N/m²"),
        ("pressure in any touch", most.pressure, 0, "N/m²"),
    ] {
        t.row([what.into(), num(value, digits), unit.into()]);
    }
    t
}

fn causes(flown: &[Flown]) -> Table {
    let mut t = Table::new(
        &format!(
            "Why careful touches within {:.0} mm of the crown ended without a grip",
            1e3 * CENTRED
        ),
        &["", "touches"],
    );
    let centred = || {
        let careful = flown.iter().filter(|f| f.planned.gauge.is_some());
        careful.filter(|f| f.planned.touch.offset.abs() <= CENTRED)
    };
    let mut causes = BTreeMap::new();
    for f in centred().filter(|f| !f.outcome.is_held()) {
        let why = f.touched.why.map_or("no reason shown", Reason::text);
        *causes.entry(why).or_insert(0_u32) += 1;
    }
    for (why, touches) in causes {
        t.row([why.into(), num(f64::from(touches), 0)]);
    }
    t.row([
        "of careful touches there".into(),
        num(centred().count() as f64, 0),
    ]);
    t
}

/// The lost ones, a line each.
pub fn lost(flown: &[Flown]) -> Vec<String> {
    let all: Vec<_> = flown.iter().filter(|f| f.outcome == Outcome::Lost).collect();
    let mut lines: Vec<String> = all
        .iter()
        .take(NAMED)
        .map(|f| {
            let (t, seen) = (f.planned.touch, f.touched);
            format!(
                "lost: seed {}: {:.0} mm beside the crown, lean {:.0}°, sink {:.2} m/s, sideways {:.2} m/s, heading {:.0}°, \
                 pipe {:.2} m, friction {:.2}: {:.2} m deep, propeller {:.0} mm from the pipe, at the end {}",
                t.seed,
                1e3 * t.offset,
                t.lean.to_degrees(),
                t.sink,
                t.sideways,
                t.yaw.to_degrees(),
                t.diameter,
                t.friction,
                seen.drop,
                1e3 * seen.clearance,
                seen.mode.name()
            )
        })
        .collect();
    if let Some(more) = all.len().checked_sub(NAMED).filter(|more| *more > 0) {
        lines.push(format!("and {more} more"));
    }
    lines
}

fn shares(flown: &[Flown], gauge: usize) -> Chart {
    let of = || flown.iter().filter(move |f| f.planned.gauge == Some(gauge));
    let share = |good: fn(Outcome) -> bool| -> Vec<(f64, f64)> {
        let bins = (super::sampling::GAUGE_OFFSET_MAX / BIN).ceil() as i32;
        (-bins..bins)
            .map(|bin| {
                let (from, to) = (BIN * f64::from(bin), BIN * f64::from(bin + 1));
                let these: Vec<_> = of()
                    .filter(|f| (from..to).contains(&f.planned.touch.offset))
                    .collect();
                let good = these.iter().filter(|f| good(f.outcome)).count();
                // No touch in it: no point.
                (500.0 * (from + to), 100.0 * good as f64 / these.len() as f64)
            })
            .collect()
    };
    let at = super::GAUGES[gauge];
    let wanted = 1e3 * at.wanted;
    Chart {
        title: format!("pipe {:.1} m, friction {:.1}", at.diameter, at.friction),
        x: Axis::new("beside the crown, mm"),
        y: Axis::between("share, %", 0.0, 105.0),
        series: vec![
            Series::new("held", 0, SeriesStyle::Line, share(Outcome::is_held)),
            Series::new(
                "held and let go",
                2,
                SeriesStyle::Dashed,
                share(|o| o == Outcome::Released),
            ),
        ],
        uprights: vec![(-wanted, "wanted".to_owned()), (wanted, "wanted".to_owned())],
        ..Chart::default()
    }
}

fn anywhere(flown: &[Flown], title: &str, value: impl Fn(&Flown) -> f64) -> Chart {
    let series = Outcome::ALL.into_iter().zip(COLOURS).map(|(outcome, colour)| {
        let points = flown
            .iter()
            .filter(|f| f.planned.gauge.is_none() && f.outcome == outcome)
            .map(|f| (1e3 * f.planned.touch.offset, value(f)))
            .collect();
        Series::new(outcome.name(), colour, SeriesStyle::Dots, points)
    });
    Chart {
        title: title.to_owned(),
        x: Axis::new("beside the crown, mm"),
        y: Axis::new(title),
        series: series.filter(|s| !s.points.is_empty()).collect(),
        ..Chart::default()
    }
}
