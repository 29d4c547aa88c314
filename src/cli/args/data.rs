//! Which measured data are read.

use std::path::PathBuf;

use clap::Args;

use super::values::within;

/// Which log to look at and what to make of it.
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

/// Which data, and where the fit goes.
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
    /// Directory for fit.html, fit.json, arm.toml and arm.console.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the fit as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

fn lever(text: &str) -> Result<f64, String> {
    within(text, &(5.0..=100.0), " mm")
}
