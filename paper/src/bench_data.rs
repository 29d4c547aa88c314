//! Thrust-bench data of soft arms: CSV.
//!
//! The first line names the columns, in any order: `infill_percent` (%), `thrust_n` (N), `tilt_deg` (degrees, tip up
//! positive), optionally `power_ratio` (P/P0, default 1). Blank lines and text after `#` are skipped.

use std::path::Path;

const MAX_BYTES: u64 = 16 << 20;
/// Three more than the unknowns of one infill.
pub const MIN_ROWS: usize = 6;

/// A measured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Infill, %.
    pub infill: f64,
    /// Thrust, N.
    pub thrust: f64,
    /// Tilt, degrees, tip up positive.
    pub tilt: f64,
    /// Battery power over full, 0.3 to 1.
    pub power: f64,
}

/// Name, smallest and largest value, unit.
type Column = (&'static str, f64, f64, &'static str);

const COLUMNS: [Column; 4] = [
    ("infill_percent", 1.0, 100.0, "%"),
    ("thrust_n", 0.0, 100.0, "N"),
    ("tilt_deg", -90.0, 90.0, "deg"),
    ("power_ratio", 0.3, 1.0, ""),
];

/// Reads a file.
///
/// # Errors
/// One line: file, line, column, value, what is allowed, and which other lines are bad.
pub fn load(path: &Path) -> Result<Vec<Point>, String> {
    let file = path.display();
    let complaint = |why: String| format!("{file}: {why}");
    let size = std::fs::metadata(path)
        .map_err(|e| complaint(format!("cannot be read: {e}: allowed is a CSV file")))?;
    if size.is_dir() || size.len() > MAX_BYTES {
        return Err(complaint(
            "cannot be read: allowed is a CSV file of at most 16 MiB".to_owned(),
        ));
    }
    let bytes =
        std::fs::read(path).map_err(|e| complaint(format!("cannot be read: {e}: allowed is a CSV file")))?;
    let text = String::from_utf8(bytes)
        .map_err(|_| complaint("is not text: allowed is a CSV file in UTF-8".to_owned()))?;
    parse(&text, &file.to_string())
}

/// Parses the text of `file`.
///
/// # Errors
/// See [`load`].
pub fn parse(text: &str, file: &str) -> Result<Vec<Point>, String> {
    let content = |line: &str| line.split('#').next().unwrap_or_default().trim().to_owned();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(i, l)| (i + 1, content(l)))
        .filter(|(_, l)| !l.is_empty());
    let Some((number, header)) = lines.next() else {
        return Err(format!(
            "{file}: holds no line: allowed is a header with {}",
            names()
        ));
    };
    let order = columns(&header).map_err(|why| format!("{file}:{number}: {why}"))?;
    let header_line = number;
    let (mut points, mut bad): (Vec<Point>, Vec<BadLine>) = (vec![], vec![]);
    for (number, line) in lines {
        match row(&line, &order) {
            Ok(point) => points.push(point),
            Err(why) => bad.push(BadLine { number, why }),
        }
    }
    if let Some((first, others)) = bad.split_first() {
        return Err(format!(
            "{file}:{}: {}{}",
            first.number,
            first.why,
            bad_as_well(others)
        ));
    }
    if points.is_empty() {
        return Err(format!(
            "{file}:{header_line}: no row stands below the header: allowed are at least {MIN_ROWS}"
        ));
    }
    Ok(points)
}

struct BadLine {
    number: usize,
    why: String,
}

fn bad_as_well(others: &[BadLine]) -> String {
    if others.is_empty() {
        return String::new();
    }
    let numbers: Vec<String> = others.iter().take(8).map(|b| b.number.to_string()).collect();
    let dots = if others.len() > 8 { ", ..." } else { "" };
    format!(" (bad as well: lines {}{dots})", numbers.join(", "))
}

fn columns(header: &str) -> Result<Vec<usize>, String> {
    commas(header)?;
    let header: Vec<&str> = header.split(',').map(str::trim).collect();
    if header.iter().all(|cell| cell.parse::<f64>().is_ok()) {
        return Err(format!(
            "a row of numbers where the header should be: allowed is a header with {}",
            names()
        ));
    }
    let mut order = vec![];
    for name in &header {
        let Some(column) = COLUMNS.iter().position(|c| c.0 == *name) else {
            return Err(format!("column '{name}' is not known: allowed are {}", names()));
        };
        if order.contains(&column) {
            return Err(format!("column '{name}' stands twice: allowed is once"));
        }
        order.push(column);
    }
    if let Some(missing) = (0..3).find(|c| !order.contains(c)) {
        return Err(format!(
            "column '{}' is missing: needed are {}",
            COLUMNS[missing].0,
            names()
        ));
    }
    Ok(order)
}

fn names() -> String {
    "infill_percent, thrust_n, tilt_deg and, if wanted, power_ratio".to_owned()
}

/// Refuses other separators, as spreadsheets write with a decimal comma.
fn commas(line: &str) -> Result<(), String> {
    let other = [(';', "';'"), ('\t', "a tab")];
    other
        .into_iter()
        .find(|(sign, _)| line.contains(*sign))
        .map_or(Ok(()), |(_, name)| {
            Err(format!(
                "{name} between the columns: allowed is ',', and '.' within numbers"
            ))
        })
}

fn row(line: &str, order: &[usize]) -> Result<Point, String> {
    commas(line)?;
    let cells: Vec<&str> = line.split(',').map(str::trim).collect();
    if cells.len() != order.len() {
        return Err(format!(
            "{} values: allowed are {}, as in the header",
            cells.len(),
            order.len()
        ));
    }
    let mut values = [f64::NAN, f64::NAN, f64::NAN, 1.0];
    for (cell, column) in cells.iter().zip(order) {
        let (name, low, high, unit) = COLUMNS[*column];
        let value = cell.parse().ok().filter(|v| (low..=high).contains(v));
        let allowed = format!("{low} to {high} {unit}");
        values[*column] = value.ok_or_else(|| {
            format!(
                "{name} = '{cell}': allowed is a number from {}",
                allowed.trim_end()
            )
        })?;
    }
    let [infill, thrust, tilt, power] = values;
    Ok(Point {
        infill,
        thrust,
        tilt,
        power,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_may_come_in_any_order_and_comments_are_skipped() {
        let points = parse(
            "# bench\ntilt_deg, thrust_n ,infill_percent\n1.5,2,6 # good\n\n-3,0,8\n",
            "b.csv",
        )
        .unwrap();
        assert_eq!(
            points[0],
            Point {
                infill: 6.0,
                thrust: 2.0,
                tilt: 1.5,
                power: 1.0
            }
        );
        assert_eq!(points.len(), 2);
    }

    #[test]
    fn a_bad_row_is_told_by_its_line_with_the_others() {
        let head = "infill_percent,thrust_n,tilt_deg\n";
        for (rows, message) in [
            (
                "6,2,1\n6,x,1\n",
                "b.csv:3: thrust_n = 'x': allowed is a number from 0 to 100 N",
            ),
            ("6,2\n", "b.csv:2: 2 values: allowed are 3, as in the header"),
            (
                "6,2,NaN\n0.5,2,3\n",
                "b.csv:2: tilt_deg = 'NaN': allowed is a number from -90 to 90 deg (bad as well: lines 3)",
            ),
        ] {
            assert_eq!(parse(&format!("{head}{rows}"), "b.csv").unwrap_err(), message);
        }
        assert!(
            parse("thrust_n,tilt_deg\n", "b")
                .unwrap_err()
                .contains("'infill_percent' is missing")
        );
        assert!(
            parse("thrust_n,thrust\n", "b")
                .unwrap_err()
                .contains("'thrust' is not known")
        );
        assert!(parse("", "b").unwrap_err().contains("no line"));
    }
}
