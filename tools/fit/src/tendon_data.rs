//! Bench data of an arm's tendon: CSV.
//!
//! Columns: `infill_percent` (%), `force_n` (along the tendon, N), `thrust_n` (N), `tilt_deg` (degrees, tip up positive)
//! and, of an arm on the pipe, `pressure_pa` at its sensor (Pa; 0 for a free arm).

use std::path::Path;

use super::arm_data::{INFILL, THRUST, TILT};
use super::csv::{Column, Table};

/// A measured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulled {
    /// Infill, %.
    pub infill: f64,
    /// Along the tendon, N.
    pub force: f64,
    /// Of the rotor, N.
    pub thrust: f64,
    /// Degrees, tip up positive.
    pub tilt: f64,
    /// At the sensor, Pa; 0 for a free arm.
    pub pressure: f64,
}

impl Pulled {
    /// Whether the arm lies on the pipe.
    #[must_use]
    pub fn on_pipe(&self) -> bool {
        self.pressure > 0.0
    }
}

const TABLE: Table<5> = Table {
    columns: [
        INFILL,
        Column {
            name: "force_n",
            range: (0.0, 500.0),
            unit: "N",
            default: None,
        },
        THRUST,
        TILT,
        Column {
            name: "pressure_pa",
            range: (0.0, 20_000.0),
            unit: "Pa",
            default: Some(0.0),
        },
    ],
    names: "infill_percent, force_n, thrust_n, tilt_deg and, of an arm on the pipe, pressure_pa",
    min_rows: 5,
};

impl From<[f64; 5]> for Pulled {
    fn from([infill, force, thrust, tilt, pressure]: [f64; 5]) -> Self {
        Self {
            infill,
            force,
            thrust,
            tilt,
            pressure,
        }
    }
}

/// Reads a file.
///
/// # Errors
/// One line: file, line, column, value, allowed values.
pub fn load(path: &Path) -> Result<Vec<Pulled>, String> {
    Ok(TABLE.load(path)?.into_iter().map(Pulled::from).collect())
}

/// Parses the text of `file`.
///
/// # Errors
/// One line: file, line, column, value, allowed values.
pub fn parse(text: &str, file: &str) -> Result<Vec<Pulled>, String> {
    Ok(TABLE.parse(text, file)?.into_iter().map(Pulled::from).collect())
}
