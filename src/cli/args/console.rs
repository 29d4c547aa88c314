//! Options of the subcommands that use a board: `bringup` and `params`.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use clap::{Args, ValueEnum};
use sophie_board_link::Failure;
use sophie_board_link::port::PortName;
use sophie_board_link::vehicle::Vehicle;

use super::values::within;
use crate::cli::key;
use sophie_sim::live::Key;

/// Key of a line to a board, and its longest silence.
#[derive(Args, Debug)]
pub struct LineArgs {
    /// File with the key that signs MAVLink, 64 hexadecimal digits, where the board has one.
    #[arg(long, value_name = "FILE")]
    pub mavlink_key: Option<PathBuf>,
    /// Longest silence of the board while an answer is due, 1 to 600 s.
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = patience, allow_negative_numbers = true)]
    pub patience: Duration,
}

impl LineArgs {
    /// Opens `port`; raising `stop` ends the session.
    ///
    /// # Errors
    /// One line: the port cannot be opened, no vehicle answers there, or the key is invalid.
    pub fn vehicle(&self, port: &PortName, stop: Arc<AtomicBool>) -> Result<Vehicle, Failure> {
        Vehicle::open(port, self.key()?, self.patience, stop)
    }

    fn key(&self) -> Result<Option<Key>, Failure> {
        let key = self.mavlink_key.as_deref().map(key::read).transpose();
        key.map_err(Failure::Input)
    }
}

/// Vehicle and protocol of the set-up.
#[derive(Args, Debug)]
pub struct BringupArgs {
    /// MAVLink of the vehicle: the board's USB socket as /dev/ttyACM0 or COM3; its MAVLink port as /dev/ttyUSB0 (57,600
    /// baud, another rate behind a comma); tcp:HOST:PORT, udpin:HOST:PORT (listens) or udpout:HOST:PORT. The pads of
    /// the serial console have no MAVLink.
    #[arg(long, value_name = "PORT")]
    pub port: PortName,
    #[command(flatten)]
    pub line: LineArgs,
    /// Protocol file: continued if it exists, otherwise begun.
    #[arg(long, value_name = "FILE", default_value = "bringup.toml")]
    pub protocol: PathBuf,
    /// Do this step again though it has passed, such as arm-2; may be given more than once.
    #[arg(long, value_name = "STEP")]
    pub again: Vec<String>,
}

/// Action on a board's parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ParamsVerb {
    /// Write them into the file.
    Dump,
    /// Show where the file differs.
    Diff,
    /// Set them from the file.
    Load,
}

/// Options of `params`.
#[derive(Args, Debug)]
pub struct ParamsArgs {
    /// What to do.
    pub verb: ParamsVerb,
    /// Parameter file; - is stdout for `dump`.
    pub file: PathBuf,
    /// MAVLink of the vehicle: the board's USB socket as /dev/ttyACM0 or COM3; its MAVLink port as /dev/ttyUSB0 (57,600
    /// baud, another rate behind a comma); tcp:HOST:PORT, udpin:HOST:PORT (listens) or udpout:HOST:PORT. The pads of
    /// the serial console have no MAVLink.
    #[arg(long, value_name = "PORT")]
    pub port: PortName,
    #[command(flatten)]
    pub line: LineArgs,
}

fn patience(text: &str) -> Result<Duration, String> {
    within(text, &(1.0..=600.0), " s").map(Duration::from_secs_f64)
}
