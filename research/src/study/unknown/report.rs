//! A campaign as a section, and as JSON.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::Request;
use super::class::Class;
use super::explain::{self, Finding};
use super::row::Row;
use crate::results::model::{Axis, Cell, Chart, Section, Series, SeriesStyle, Table, num};
use crate::study::cause::cause;

/// Quantities that are shown.
const SHOWN: usize = 5;
/// Of these, with a picture.
const PICTURED: usize = 3;
/// Parts of equal size into which a picture sorts the vehicles.
const FIFTHS: usize = 5;
/// Chance below which a correlation counts.
const SIGNIFICANT: f64 = 0.05;

/// How many of `rows` are of `class`.
#[must_use]
pub fn count(rows: &[Row], class: Class) -> usize {
    rows.iter().filter(|row| row.class == class).count()
}

/// Classes and causes, and how many flights ended so, by class, then most frequent first.
#[must_use]
pub fn endings(rows: &[Row]) -> Vec<(Class, String, usize)> {
    let mut endings = Vec::new();
    for class in Class::ALL {
        let mut counted = BTreeMap::<String, usize>::new();
        for row in rows.iter().filter(|row| row.class == class) {
            *counted.entry(cause(&row.reason)).or_default() += 1;
        }
        let mut of_class: Vec<_> = counted.into_iter().collect();
        of_class.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        endings.extend(of_class.into_iter().map(|(cause, count)| (class, cause, count)));
    }
    endings
}

/// The campaign as JSON text, newline-terminated: one object, whose five classes sum to `vehicles`.
#[must_use]
pub fn json(rows: &[Row], request: &Request) -> String {
    let mut object = serde_json::Map::new();
    object.insert("vehicles".to_owned(), json!(rows.len()));
    for class in Class::ALL {
        object.insert(class.word().to_owned(), json!(count(rows, class)));
    }
    let command = request.words().into_iter();
    object.insert(
        "command".to_owned(),
        command
            .map(|(name, word)| (name.to_owned(), json!(word)))
            .collect(),
    );
    let explained = explain::explain(rows).into_iter().take(SHOWN).map(|found| {
        json!({
            "quantity": found.quantity,
            "rank_correlation": found.correlation,
            "chance": found.chance,
        })
    });
    object.insert("explained_by".to_owned(), explained.collect());
    let endings = endings(rows).into_iter();
    object.insert(
        "endings".to_owned(),
        endings
            .map(|(class, cause, count)| json!({ "class": class.word(), "cause": cause, "vehicles": count }))
            .collect(),
    );
    // Numbers, text and string keys only: cannot fail.
    serde_json::to_string_pretty(&Value::Object(object)).unwrap_or_default() + "\n"
}

/// The campaign with its tables and pictures.
#[must_use]
pub fn section(rows: &[Row], request: &Request) -> Section {
    let mut s = Section::new("unknown", "Unknown vehicles");
    let found = explain::explain(rows);
    let perched = count(rows, Class::Perched);
    let explained = match found.first() {
        None => "there is nothing to compare with".to_owned(),
        Some(first) if first.chance < SIGNIFICANT => format!("{} explains most", first.quantity),
        Some(_) => "no drawn quantity alone explains the others".to_owned(),
    };
    s.finding = format!(
        "{perched} of {} vehicles from seed {} perch; {explained}.",
        rows.len(),
        request.seed
    );
    s.table(classes(rows));
    s.table(ended(rows));
    if !found.is_empty() {
        s.table(explanation(rows, &found));
        s.text(
            "Spearman's rank correlation with perched (1) or not (0). Chance: the probability that one of all drawn \
             quantities correlates as much by accident.",
        );
        s.figure(
            "Share of the vehicles that perch, by fifths of a quantity; and each vehicle by the first two.",
            pictures(rows, &found),
        );
    }
    s
}

fn classes(rows: &[Row]) -> Table {
    let mut t = Table::new("What became of them", &["", "vehicles", "%"]);
    for class in Class::ALL {
        let count = count(rows, class) as f64;
        t.row([
            class.name().into(),
            num(count, 0),
            num(100.0 * count / rows.len() as f64, 1),
        ]);
    }
    t
}

fn ended(rows: &[Row]) -> Table {
    let mut t = Table::new("What ended the flights", &["", "cause", "vehicles"]);
    for (class, cause, count) in endings(rows) {
        t.row([class.name().into(), cause.into(), num(count as f64, 0)]);
    }
    t
}

fn explanation(rows: &[Row], found: &[Finding]) -> Table {
    let mut t = Table::new(
        "What goes with it",
        &[
            "drawn quantity",
            "correlation",
            "chance",
            "mean, perched",
            "mean, others",
        ],
    );
    for finding in found.iter().take(SHOWN) {
        let mean = |perched: bool| {
            let pairs = rows.iter().zip(&finding.values);
            let of = pairs.filter(|(row, _)| (row.class == Class::Perched) == perched);
            let values: Vec<f64> = of.map(|(_, value)| *value).collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        t.row([
            finding.quantity.clone().into(),
            num(finding.correlation, 2),
            chance(finding.chance),
            num(mean(true), 4),
            num(mean(false), 4),
        ]);
    }
    t
}

/// Four digits, and no zero: a probability is never that.
fn chance(chance: f64) -> Cell {
    if chance < 1e-4 {
        "< 0.0001".into()
    } else {
        num(chance, 4)
    }
}

fn pictures(rows: &[Row], found: &[Finding]) -> Vec<Chart> {
    let mut charts: Vec<Chart> = found
        .iter()
        .take(PICTURED)
        .map(|finding| share(rows, finding))
        .collect();
    if let [first, second, ..] = found {
        charts.push(scatter(rows, first, second));
    }
    charts
}

/// Share of the vehicles that perch over the mean of each fifth of a quantity.
fn share(rows: &[Row], finding: &Finding) -> Chart {
    let perched = |row: &Row| if row.class == Class::Perched { 100.0 } else { 0.0 };
    let mut pairs: Vec<(f64, f64)> = finding
        .values
        .iter()
        .copied()
        .zip(rows.iter().map(perched))
        .collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mean = |part: &[(f64, f64)]| {
        let (x, y) = part
            .iter()
            .fold((0.0, 0.0), |(x, y), pair| (x + pair.0, y + pair.1));
        (x / part.len() as f64, y / part.len() as f64)
    };
    let points = pairs
        .chunks(pairs.len().div_ceil(FIFTHS).max(1))
        .map(mean)
        .collect();
    Chart {
        title: format!("perched over {}", finding.quantity),
        x: Axis::new(&finding.quantity),
        y: Axis::between("perched, %", 0.0, 100.0),
        series: vec![Series::new("", 0, SeriesStyle::Line, points)],
        ..Chart::default()
    }
}

fn scatter(rows: &[Row], x: &Finding, y: &Finding) -> Chart {
    let series = Class::ALL
        .into_iter()
        .zip([2, 5, 0, 3, 1])
        .map(|(class, colour)| {
            let places = x.values.iter().copied().zip(y.values.iter().copied());
            let of_class = rows.iter().zip(places).filter(|(row, _)| row.class == class);
            let points = of_class.map(|(_, place)| place).collect();
            Series::new(class.name(), colour, SeriesStyle::Dots, points)
        });
    Chart {
        title: "each vehicle".to_owned(),
        x: Axis::new(&x.quantity),
        y: Axis::new(&y.quantity),
        series: series.filter(|series| !series.points.is_empty()).collect(),
        ..Chart::default()
    }
}
