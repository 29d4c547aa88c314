//! Bench data of the skin's friction on a pipe: CSV.
//!
//! Columns: `load_n` (normal load, N), `pull_n` (along the pipe while it slides, N), `start_n` (largest pull before it
//! slides, N; 0: not read) and `wet` (1 on a wet pipe, else 0).

use std::path::Path;

use super::csv::{Column, Table};

/// A pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Normal load, N.
    pub load: f64,
    /// Pull along the pipe while it slides, N.
    pub sliding: f64,
    /// Largest pull before it slides, N; `None` if it was not read.
    pub starting: Option<f64>,
    /// On a wet pipe.
    pub wet: bool,
}

const PULL: (f64, f64) = (0.0, 200.0);

const TABLE: Table<4> = Table {
    columns: [
        Column {
            name: "load_n",
            range: (0.1, 200.0),
            unit: "N",
            default: None,
        },
        Column {
            name: "pull_n",
            range: PULL,
            unit: "N",
            default: None,
        },
        Column {
            name: "start_n",
            range: PULL,
            unit: "N",
            default: Some(0.0),
        },
        Column {
            name: "wet",
            range: (0.0, 1.0),
            unit: "",
            default: Some(0.0),
        },
    ],
    names: "load_n, pull_n and, if read, start_n and wet",
    min_rows: super::friction::ROWS_MIN,
};

impl From<[f64; 4]> for Pull {
    fn from([load, sliding, starting, wet]: [f64; 4]) -> Self {
        Self {
            load,
            sliding,
            starting: (starting > 0.0).then_some(starting),
            wet: wet > 0.5,
        }
    }
}

/// Reads a file.
///
/// # Errors
/// One line: file, line, column, value, allowed values.
pub fn load(path: &Path) -> Result<Vec<Pull>, String> {
    Ok(TABLE.load(path)?.into_iter().map(Pull::from).collect())
}

/// Parses the text of `file`.
///
/// # Errors
/// One line: file, line, column, value, allowed values.
pub fn parse(text: &str, file: &str) -> Result<Vec<Pull>, String> {
    Ok(TABLE.parse(text, file)?.into_iter().map(Pull::from).collect())
}
