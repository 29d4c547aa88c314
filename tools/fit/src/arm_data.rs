//! Thrust-bench data of soft arms: CSV.
//!
//! Columns: `infill_percent` (%), `thrust_n` (N), `tilt_deg` (degrees, tip up positive), optionally `power_ratio` (P/P0,
//! default 1).

use std::path::Path;

use super::csv::{Column, Table};

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

/// Column of the infill, %.
pub const INFILL: Column = Column {
    name: "infill_percent",
    range: (1.0, 100.0),
    unit: "%",
    default: None,
};
/// Column of a rotor's thrust, N.
pub const THRUST: Column = Column {
    name: "thrust_n",
    range: (0.0, 100.0),
    unit: "N",
    default: None,
};
/// Column of the tip's tilt, degrees.
pub const TILT: Column = Column {
    name: "tilt_deg",
    range: (-90.0, 90.0),
    unit: "deg",
    default: None,
};
const TABLE: Table<4> = Table {
    columns: [
        INFILL,
        THRUST,
        TILT,
        Column {
            name: "power_ratio",
            range: (0.3, 1.0),
            unit: "",
            default: Some(1.0),
        },
    ],
    names: "infill_percent, thrust_n, tilt_deg and, if wanted, power_ratio",
    min_rows: MIN_ROWS,
};

impl From<[f64; 4]> for Point {
    fn from([infill, thrust, tilt, power]: [f64; 4]) -> Self {
        Self {
            infill,
            thrust,
            tilt,
            power,
        }
    }
}

/// Reads a file.
///
/// # Errors
/// One line: file, line, column, value, allowed values.
pub fn load(path: &Path) -> Result<Vec<Point>, String> {
    Ok(points(TABLE.load(path)?))
}

/// Parses the text of `file`.
///
/// # Errors
/// One line: file, line, column, value, allowed values.
pub fn parse(text: &str, file: &str) -> Result<Vec<Point>, String> {
    Ok(points(TABLE.parse(text, file)?))
}

fn points(rows: Vec<[f64; 4]>) -> Vec<Point> {
    rows.into_iter().map(Point::from).collect()
}

#[cfg(test)]
mod tests {
    use crate::arm_data::*;

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
