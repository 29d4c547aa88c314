//! Options of the subcommands that read measured data.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use sophie_control::params::{ParamInfo, Params, Renamed};

use super::values::within;

/// Options of `timing`.
#[derive(Args, Debug)]
pub struct TimingArgs {
    /// Log: text as `probe-rs run` or the bench writes it, or the log's own bytes.
    pub capture: PathBuf,
    /// Image that wrote it; needed for the log's own bytes only.
    #[arg(long, value_name = "FILE")]
    pub elf: Option<PathBuf>,
    /// Also bound every response in the worst case, and say how far it is from its deadline on each board.
    #[arg(long)]
    pub analyse: bool,
    /// Directory for timing.html and timing.csv.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
}

/// Contents of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Inertial samples, flow, range, thrust.
    Sensors,
    /// Bytes of an SBUS or S.BUS2 receiver.
    Sbus,
    /// Bytes of a CRSF receiver.
    Crsf,
    /// Bytes of a module of flow and range.
    Msp,
}

/// Options of `recording`.
#[derive(Args, Debug)]
pub struct RecordingArgs {
    /// The recording.
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Table of places, velocities or attitudes by motion capture, to compare with.
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// Drop flow and range before this, s from the first line, 0 to 1000000.
    #[arg(long, value_name = "S", value_parser = from, default_value = "0", allow_negative_numbers = true)]
    pub from: f64,
    /// What FILE holds: sensors, sbus, crsf or msp.
    #[arg(
        long = "as",
        value_name = "KIND",
        value_enum,
        hide_possible_values = true,
        default_value = "sensors"
    )]
    pub kind: Kind,
    /// A parameter of the vehicle, may be given more than once; choices are given by name.
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = parameter)]
    pub params: Vec<(&'static ParamInfo, f32)>,
    /// Print the result as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

fn from(text: &str) -> Result<f64, String> {
    within(text, &(0.0..=1e6), " s")
}

/// A parameter and its value. Old names are converted.
fn parameter(text: &str) -> Result<(&'static ParamInfo, f32), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("allowed NAME=VALUE, such as mass=1.8")?;
    let renamed = Renamed::find(name);
    let row = Params::row(renamed.map_or(name, |r| r.new))
        .ok_or_else(|| format!("no parameter '{name}', allowed are those of docs/parameters.md"))?;
    let named = row.choice_named(value).map(|choice| choice.value);
    let number = value.parse().ok().map(|n| renamed.map_or(n, |r| r.convert(n)));
    let found = named.or(number).filter(|n| row.allows(*n));
    let names: Vec<&str> = row
        .choices
        .iter()
        .map(|c| c.name)
        .filter(|n| !n.is_empty())
        .collect();
    let allowed = match names.as_slice() {
        [] if row.choices.is_empty() => format!("{} to {} {}", row.min, row.max, row.unit),
        [] => row
            .choices
            .iter()
            .map(|c| c.value.to_string())
            .collect::<Vec<_>>()
            .join(", "),
        names => names.join(", "),
    };
    found
        .map(|n| (row, n))
        .ok_or_else(|| format!("allowed {allowed}"))
}

/// Options of `fit-arm`.
#[derive(Args, Debug)]
pub struct FitArgs {
    /// Bench data.
    #[arg(value_name = "BENCH.csv")]
    pub bench: PathBuf,
    /// Bench data of the tendon: a second table, for tendon_bend and tendon_relief.
    #[arg(long, value_name = "TENDON.csv")]
    pub tendon: Option<PathBuf>,
    /// Distance of that tendon from the arm's neutral line, 5 to 100 mm.
    #[arg(long, value_name = "MM", value_parser = lever, default_value = "15", allow_negative_numbers = true)]
    pub lever: f64,
    /// Pulls of the skin along the pipe: a third table, for pipe_friction.
    #[arg(long, value_name = "FRICTION.csv")]
    pub friction: Option<PathBuf>,
    /// Directory for fit.html, fit.json, arm.toml and arm.console.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the fit as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

/// Options of `fit-tendon`.
#[derive(Args, Debug)]
pub struct FitTendonArgs {
    /// Steps of one tendon's servo.
    #[arg(value_name = "STEPS.csv")]
    pub steps: PathBuf,
    /// Distance of the tendon from the arm's neutral line, 5 to 100 mm.
    #[arg(long, value_name = "MM", value_parser = lever, default_value = "15", allow_negative_numbers = true)]
    pub lever: f64,
    /// Radius of the reel, 5 to 100 mm.
    #[arg(long, value_name = "MM", value_parser = lever, default_value = "15", allow_negative_numbers = true)]
    pub reel: f64,
}

/// Options of `fit-thrust`.
#[derive(Args, Debug)]
pub struct FitThrustArgs {
    /// Readings of the scale.
    #[arg(value_name = "READINGS.csv")]
    pub readings: PathBuf,
    /// Voltage of thrust_max, 6 to 52 V: the parameter battery_nominal.
    #[arg(long, value_name = "V", value_parser = nominal, default_value = "14.8", allow_negative_numbers = true)]
    pub nominal: f64,
}

/// Options of `fit-lag`.
#[derive(Args, Debug)]
pub struct FitLagArgs {
    /// Recording of the steps.
    #[arg(value_name = "SOUND.wav")]
    pub sound: PathBuf,
}

fn nominal(text: &str) -> Result<f64, String> {
    within(text, &(6.0..=52.0), " V")
}

fn lever(text: &str) -> Result<f64, String> {
    within(text, &(5.0..=100.0), " mm")
}
