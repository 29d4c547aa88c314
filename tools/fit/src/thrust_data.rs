//! Readings of static thrust, the vehicle tied down on a scale: CSV.
//!
//! Columns: `command_percent` (% of full drive), `voltage_v` (V, by the board, rotors running), `reading_g` (g, what the
//! thrust adds to or takes from the tared scale) or `thrust_n` (N) instead, optionally `rotor` (1 to 4; 0 or no column: all
//! four), and `tilt_deg` (degrees, of the arms of the rotors that run, by their sensors, tip up positive; default 0).

use std::path::Path;

use super::csv::{Column, Table};

/// Standard gravity, m/s²: scales show mass.
pub const GRAVITY: f64 = 9.806_65;

/// One reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Command, share of full drive.
    pub command: f64,
    /// Battery voltage under load, V.
    pub voltage: f64,
    /// Rotor, 0 to 3; `None`: all four.
    pub rotor: Option<usize>,
    /// Force on the scale, N.
    pub force: f64,
    /// Tilt of the arms of the rotors that run, rad.
    pub tilt: f64,
}

const TABLE: Table<6> = Table {
    columns: [
        Column {
            name: "command_percent",
            range: (10.0, 100.0),
            unit: "%",
            default: None,
        },
        Column {
            name: "voltage_v",
            range: (5.0, 60.0),
            unit: "V",
            default: None,
        },
        Column {
            name: "rotor",
            range: (0.0, 4.0),
            unit: "",
            default: Some(0.0),
        },
        Column {
            name: "reading_g",
            range: (1.0, 20_000.0),
            unit: "g",
            default: Some(0.0),
        },
        Column {
            name: "thrust_n",
            range: (0.01, 200.0),
            unit: "N",
            default: Some(0.0),
        },
        Column {
            name: "tilt_deg",
            range: (-60.0, 60.0),
            unit: "deg",
            default: Some(0.0),
        },
    ],
    names: "command_percent, voltage_v, reading_g or thrust_n and, if wanted, rotor and tilt_deg",
    min_rows: 5,
};

/// Reads a file.
///
/// # Errors
/// One line: file, line, column, value, allowed values.
pub fn load(path: &Path) -> Result<Vec<Reading>, String> {
    let file = path.display().to_string();
    readings(TABLE.load(path)?).map_err(|why| format!("{file}: {why}"))
}

/// Parses the text of `file`.
///
/// # Errors
/// One line: file, line, column, value, allowed values.
pub fn parse(text: &str, file: &str) -> Result<Vec<Reading>, String> {
    readings(TABLE.parse(text, file)?).map_err(|why| format!("{file}: {why}"))
}

fn readings(rows: Vec<[f64; 6]>) -> Result<Vec<Reading>, String> {
    rows.into_iter().map(reading).collect()
}

fn reading([percent, voltage, rotor, grams, newtons, tilt]: [f64; 6]) -> Result<Reading, String> {
    // A column that is missing is 0, which no row may have.
    let force = match (grams > 0.0, newtons > 0.0) {
        (true, false) => grams * 1e-3 * GRAVITY,
        (false, true) => newtons,
        _ => return Err("columns reading_g and thrust_n: allowed is one of both".to_owned()),
    };
    let number = rotor as usize;
    if number as f64 != rotor {
        return Err(format!("rotor = {rotor}: allowed are 1 to 4, 0 for all"));
    }
    Ok(Reading {
        command: 0.01 * percent,
        voltage,
        rotor: number.checked_sub(1),
        force,
        tilt: tilt.to_radians(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grams_and_newtons_are_read_and_not_both() {
        let text = "command_percent,voltage_v,reading_g\n60,15.2,1000\n";
        let rows = parse(text, "t.csv").unwrap();
        assert_eq!(rows[0].rotor, None);
        assert!((rows[0].force - GRAVITY).abs() < 1e-9 && rows[0].tilt == 0.0);
        let text = "rotor,command_percent,voltage_v,thrust_n,tilt_deg\n3,60,15.2,4.1,-5 # one\n";
        let rows = parse(text, "t.csv").unwrap();
        assert_eq!((rows[0].rotor, rows[0].force), (Some(2), 4.1));
        assert!((rows[0].tilt + 0.087_27).abs() < 1e-4);
        for (text, why) in [
            (
                "command_percent,voltage_v\n60,15\n",
                "t.csv: columns reading_g and thrust_n: allowed is one of both",
            ),
            (
                "command_percent,voltage_v,reading_g,thrust_n\n60,15,900,9\n",
                "t.csv: columns reading_g and thrust_n: allowed is one of both",
            ),
            (
                "command_percent,voltage_v,reading_g\n60,15,900\n160,15,900\n",
                "t.csv:3: command_percent = '160': allowed is a number from 10 to 100 %",
            ),
            (
                "rotor,command_percent,voltage_v,reading_g\n1.5,60,15,900\n",
                "t.csv: rotor = 1.5: allowed are 1 to 4, 0 for all",
            ),
        ] {
            assert_eq!(parse(text, "t.csv").unwrap_err(), why);
        }
    }
}
