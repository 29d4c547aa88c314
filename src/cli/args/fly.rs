//! Options of `fly`: reports, and flight in real time.

use std::net::{Ipv4Addr, SocketAddr};
use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::Args;
use sophie_flight_report::terminal::FILES;
use sophie_terminal::output::OutDir;

use super::MissionArgs;
use super::values::{within, word};

/// Permitted seconds of flight in a second of real time: what a host can pace.
const SPEEDS: RangeInclusive<f64> = 0.01..=1000.0;

/// Options of `fly`.
#[derive(Args, Debug)]
pub struct FlyArgs {
    #[command(flatten)]
    pub mission: MissionArgs,
    /// Directory for report.html, flight.mcap and summary.json.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Fly and print only, in half the processor time: no directory, no files.
    #[arg(long, conflicts_with = "out")]
    pub no_files: bool,
    /// Print the summary as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub live: LiveArgs,
}

/// Options of a flight in real time.
#[derive(Args, Debug)]
pub struct LiveArgs {
    /// Fly at the pace of real time with MAVLink on UDP, then wait on the ground until Ctrl-C.
    #[arg(long = "live")]
    pub wanted: bool,
    /// Seconds flown in a second of real time, 0.01 to 1000.
    #[arg(long, value_name = "X", value_parser = speed, default_value = "1", requires = "wanted", allow_negative_numbers = true)]
    pub speed: f64,
    /// Destination of MAVLink; packets from there are answered.
    #[arg(long, value_name = "ADDR:PORT", value_parser = destination, default_value = "127.0.0.1:14550", requires = "wanted")]
    pub mavlink: SocketAddr,
    /// File with the key that signs MAVLink, 64 hexadecimal digits; without it signing is off.
    #[arg(long, value_name = "FILE", requires = "wanted")]
    pub mavlink_key: Option<PathBuf>,
    /// Who flies: none waits on the ground without a transmitter, and leaves no report.
    #[arg(long, value_name = "none", value_parser = no_pilot, requires = "wanted", conflicts_with_all = ["json", "out"])]
    pub pilot: Option<NoPilot>,
}

impl FlyArgs {
    /// The directory of the report, tried before the flight, so that a bad one is reported at once; `None` without files.
    ///
    /// # Errors
    /// One line: directory, reason, allowed values.
    pub fn report_directory(&self) -> Result<Option<OutDir>, String> {
        let wanted = (!self.no_files).then_some(&self.out);
        wanted.map(|out| OutDir::prepare(out, &FILES)).transpose()
    }
}

/// No pilot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoPilot;

fn speed(text: &str) -> Result<f64, String> {
    within(text, &SPEEDS, "")
}

fn destination(text: &str) -> Result<SocketAddr, String> {
    let one = |to: &SocketAddr| {
        let ip = to.ip();
        to.port() != 0 && !ip.is_unspecified() && !ip.is_multicast() && ip != Ipv4Addr::BROADCAST
    };
    let to = text.parse().ok().filter(one);
    to.ok_or_else(|| "allowed the address of one machine and its port, such as 127.0.0.1:14550".to_owned())
}

fn no_pilot(text: &str) -> Result<NoPilot, String> {
    word(text, &["none"]).map(|_| NoPilot)
}
