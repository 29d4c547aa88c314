//! Steps of a tendon's servo that a person has read at the console: CSV.
//!
//! Columns: `reel_deg` (the reel from its release mark, as `watch arms` shows it), `weight_n` (on the tip, N) and
//! `tilt_deg` (tip up positive), a row a rest, in the order in which they were measured.

use std::path::Path;

use super::bench::Rest;
use crate::csv::{Column, Table};

const TABLE: Table<3> = Table {
    columns: [
        Column {
            name: "reel_deg",
            range: (0.0, 360.0),
            unit: "deg",
            default: None,
        },
        Column {
            name: "weight_n",
            range: (0.0, 20.0),
            unit: "N",
            default: None,
        },
        Column {
            name: "tilt_deg",
            range: (-140.0, 90.0),
            unit: "deg",
            default: None,
        },
    ],
    names: "reel_deg, weight_n and tilt_deg",
    min_rows: super::RESTS,
};

/// Reads a file.
///
/// # Errors
/// One line: file, line, column, value, allowed values.
pub fn load(path: &Path) -> Result<Vec<Rest>, String> {
    Ok(TABLE.load(path)?.into_iter().map(rest).collect())
}

/// Parses the text of `file`.
///
/// # Errors
/// One line: file, line, column, value, allowed values.
pub fn parse(text: &str, file: &str) -> Result<Vec<Rest>, String> {
    Ok(TABLE.parse(text, file)?.into_iter().map(rest).collect())
}

fn rest([reel, weight, tilt]: [f64; 3]) -> Rest {
    Rest {
        reel: reel.to_radians(),
        weight,
        tilt: tilt.to_radians(),
    }
}
