//! Options of the studies.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::values::{seed, within};

/// Permitted touches of a capture map: at least one of each kind, at most half a day's.
const TOUCHES: RangeInclusive<u64> = 10..=1_000_000;

/// Permitted vehicles of a study: at most a day's.
const VEHICLES: RangeInclusive<u64> = 1..=100_000;

/// Options of `capture`.
#[derive(Args, Debug)]
pub struct CaptureArgs {
    /// How many, 10 to 1,000,000.
    #[arg(long, value_name = "N", value_parser = touches, default_value = "2000", allow_negative_numbers = true)]
    pub touches: u64,
    /// Seed of the first; the next have the numbers after it.
    #[arg(long, value_name = "N", value_parser = seed, default_value = "1", allow_negative_numbers = true)]
    pub seed: u64,
    /// Largest angle between the vehicle and the pipe, 0 to 45 degrees.
    #[arg(long, value_name = "DEG", value_parser = heading, default_value = "5", allow_negative_numbers = true)]
    pub heading: f64,
    /// Another vehicle for each: infill 4 to 10 %, K 5 to 8.4, arms up to 20 % and tendon parameters up to 2 times off.
    #[arg(long)]
    pub uncertain: bool,
    /// Directory for capture.html and capture.json.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the counts as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

/// Subject of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Study {
    /// Vehicles that differ in stiffness, mass, motors, pilot and pipe.
    Vehicles,
}

/// Options of `study`.
#[derive(Args, Debug)]
pub struct StudyArgs {
    /// Subject of the study.
    pub study: Study,
    /// How many, 1 to 100,000.
    #[arg(long, value_name = "N", value_parser = vehicles, default_value = "80", allow_negative_numbers = true)]
    pub count: u64,
    /// Share of the whole spread of mass, inertia, torque ratio and arms, 0 to 1.
    #[arg(long, value_name = "SHARE", value_parser = spread, default_value = "1", allow_negative_numbers = true)]
    pub spread: f64,
    /// Seed of the first; the next have the numbers after it.
    #[arg(long, value_name = "N", value_parser = seed, default_value = "1", allow_negative_numbers = true)]
    pub seed: u64,
    /// Directory for vehicles.html and vehicles.json.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the results as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

fn touches(text: &str) -> Result<u64, String> {
    within(text, &TOUCHES, "")
}

fn vehicles(text: &str) -> Result<u64, String> {
    within(text, &VEHICLES, "")
}

fn spread(text: &str) -> Result<f64, String> {
    within(text, &(0.0..=1.0), "")
}

fn heading(text: &str) -> Result<f64, String> {
    within(text, &(0.0..=45.0), " degrees")
}
