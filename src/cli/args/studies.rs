//! Options of the studies.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args, Subcommand};
use sophie_research::study::unknown::{Request, Shard};
use sophie_sim::scenario::{Assist, Known, PositionSensor, Rule, keys};

use super::values::{number, seed, seeds, within, word};

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
#[derive(Debug, Subcommand)]
pub enum Study {
    /// Fly a family of varied vehicles, and compare the results with the design check of each.
    ///
    /// Exit status: 0 done, 2 bad input or unwritable output.
    Vehicles(VehiclesArgs),
    /// Fly the default mission with vehicles, days and pipes drawn from the table of docs/uncertainty.md.
    ///
    /// A row a flight, in a file of comma-separated values in DIR. Vehicles that DIR has of the same command are not flown
    /// again. Exit status: 0 no vehicle is fallen or not holding, or a shard is written; 1 one is; 2 bad input or
    /// unwritable output.
    Unknown(UnknownArgs),
}

/// Options of `study vehicles`.
#[derive(Args, Debug)]
pub struct VehiclesArgs {
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

/// Options of `study unknown`.
#[derive(Args, Debug)]
pub struct UnknownArgs {
    /// How many, 1 to 100,000.
    #[arg(long, value_name = "N", value_parser = vehicles, default_value = "100", allow_negative_numbers = true)]
    pub count: u64,
    /// What the flight stack knows of each vehicle: exact, calibrated (each calibration with its error), or as-built.
    #[arg(long, value_name = "NAME", value_parser = known, default_value = "calibrated")]
    known: Known,
    /// Autonomy: none, or self (perches autonomously).
    #[arg(long, value_name = "NAME", value_parser = assist, default_value = "none")]
    assist: Assist,
    /// What measures the position: none, pose (poses over MAVLink), or flow (flow and range below the vehicle).
    #[arg(long, value_name = "NAME", value_parser = position_sensor, default_value = "none")]
    sensors: PositionSensor,
    /// Rule of the judge: holding (a push from any side, after half an hour too), or paper (950 N/m2 at each sensor).
    #[arg(long, value_name = "NAME", value_parser = judge, default_value = "holding")]
    judge: Rule,
    /// Mean wind, 0 to 15 m/s, with gusts of a fifth of it; the seed draws its direction.
    #[arg(long, value_name = "M_S", value_parser = wind, default_value = "0", allow_negative_numbers = true)]
    wind: f64,
    /// Seed of the first; the next have the numbers after it, in shards too.
    #[arg(long, value_name = "N", value_parser = seed, default_value = "1", allow_negative_numbers = true)]
    seed: u64,
    /// Fly share I of N alone, and write its rows; --summarise counts them.
    #[arg(long, value_name = "I/N", value_parser = shard, allow_hyphen_values = true)]
    pub shard: Option<Shard>,
    /// Print the shares that have no file in DIR as an array list (3,7-9), and fly nothing.
    #[arg(long, value_name = "DIR", conflicts_with_all = FLIGHT)]
    pub missing: Option<PathBuf>,
    /// Count the rows of all shares in DIR, write unknown.html and unknown.json there, and fly nothing.
    #[arg(long, value_name = "DIR", conflicts_with_all = FLIGHT, conflicts_with = "missing")]
    pub summarise: Option<PathBuf>,
    /// Directory for the rows, unknown.html and unknown.json.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the counts as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

/// Options that say what to fly.
const FLIGHT: [&str; 9] = [
    "count", "known", "assist", "sensors", "judge", "wind", "seed", "shard", "out",
];

impl UnknownArgs {
    /// The campaign to fly.
    #[must_use]
    pub fn request(&self) -> Request {
        Request {
            known: self.known,
            assist: self.assist,
            sensors: self.sensors,
            judge: self.judge,
            wind: self.wind,
            seed: self.seed,
            count: self.count,
        }
    }

    /// Refuses options that are not valid together.
    pub(super) fn together(&self) -> Result<(), String> {
        seeds(self.seed, self.count, "vehicles")?;
        match self.shard {
            Some(Shard { number, of }) if of > self.count => Err(format!(
                "invalid value '{number}/{of}' for '--shard <I/N>': allowed are as many shares as vehicles, here {}",
                self.count
            )),
            _ => Ok(()),
        }
    }
}

fn shard(text: &str) -> Result<Shard, String> {
    let numbers = text.split_once('/').and_then(|(number, of)| {
        let (number, of) = (number.parse().ok()?, of.parse().ok()?);
        Some(Shard { number, of })
    });
    let shard =
        numbers.filter(|shard| (1..=shard.of).contains(&shard.number) && VEHICLES.contains(&shard.of));
    shard.ok_or_else(|| "allowed I/N with I from 1 to N, such as 3/40".to_owned())
}

fn judge(text: &str) -> Result<Rule, String> {
    word(text, Rule::WORDS).map(Rule::from_word)
}

fn known(text: &str) -> Result<Known, String> {
    word(text, Known::WORDS).map(Known::from_word)
}

fn assist(text: &str) -> Result<Assist, String> {
    word(text, &["none", "self"]).map(keys::assist)
}

fn position_sensor(text: &str) -> Result<PositionSensor, String> {
    word(text, keys::POSITION_SENSORS).map(keys::position_sensor)
}

fn wind(text: &str) -> Result<f64, String> {
    number(text, keys::WIND)
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
