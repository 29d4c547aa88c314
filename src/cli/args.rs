//! Options of the command line and their ranges.

use std::net::{Ipv4Addr, SocketAddr};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, Parser, Subcommand, ValueEnum};
use sophie_console::Failure;
use sophie_console::port::PortName;
use sophie_console::session::Session;
use sophie_control::rc::ArmChoice;
use sophie_control::wrench::Configuration;
use sophie_report::terminal::console;
use sophie_sim::mixers::Variant;
use sophie_sim::scenario::keys::{self, Range};
use sophie_sim::scenario::{ArmBending, Assist, Overrides, PositionSensor, Scenario};

use super::key;

/// SOPHIE, the soft quadrotor that perches on pipes, flown in virtual time.
#[derive(Parser)]
#[command(name = "sophie", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    fly: FlyArgs,
}

/// Permitted seconds of flight in a second of real time: what a host can pace.
const SPEEDS: RangeInclusive<f64> = 0.01..=1000.0;

/// Permitted touches of a capture map: one of each kind, and half a day.
const TOUCHES: RangeInclusive<u64> = 10..=1_000_000;

/// Permitted vehicles of a study: what a day flies.
const VEHICLES: RangeInclusive<u64> = 1..=100_000;

/// The subcommands, as messages name them.
const VERBS: [&str; 9] = [
    "fly", "check", "bringup", "params", "capture", "study", "paper", "fit-arm", "timing",
];

#[derive(Subcommand)]
enum Command {
    /// Fly a mission and report it (the default; the word may be left out).
    ///
    /// Exit status: 0 mission accomplished, 1 not accomplished, 2 bad input or unwritable output.
    Fly(FlyArgs),
    /// Check whether a vehicle can fly its mission, in a moment and without flying it.
    ///
    /// A row each for thrust, throttle, yaw, the control loops, the arms, batteries, wind and grip: value, limit, verdict,
    /// and what to do where it fails. Exit status: 0 it can fly, 1 it cannot, 2 bad input.
    Check(CheckArgs),
    /// Lead through the set-up of a vehicle over its board's console, and write a protocol.
    ///
    /// Each step says what to do with hands, asks, types the console's commands and judges the answers. Stopped by q,
    /// Ctrl-C or a lost line, it continues with the first step that has not passed. Answers may be piped in, a line each.
    /// Exit status: 0 all passed, 1 something failed, skipped or not done, 2 bad input, file or port.
    Bringup(BringupArgs),
    /// Write a board's parameters into a file, compare them with a file, or set them from a file.
    ///
    /// FILE is the params table of a scenario file. `dump` writes all that the board has, - is stdout. `diff` shows where FILE
    /// differs from the board. `load` checks FILE as a whole, sets what differs, saves, restarts, and reads back.
    /// Exit status: 0 done or equal, 1 different, refused by the board or lost on the way, 2 bad file or port.
    Params(ParamsArgs),
    /// Fly touches of the pipe, and draw which are held, refused, flown away from or lost.
    ///
    /// Half come from anywhere on the pipe, half are what a careful pilot means; of these the half-widths are measured.
    /// Exit status: 0 nothing lost, 1 a vehicle was lost, 2 bad input or unwritable output.
    Capture(CaptureArgs),
    /// Fly a family of varied vehicles, and compare with what the design check says of each.
    ///
    /// Exit status: 0 done, 2 bad input or unwritable output.
    Study(StudyArgs),
    /// Compute and fly every table and figure of the paper, and set them beside the printed numbers.
    ///
    /// Exit status: 0 done, 2 bad input or unwritable output.
    Paper(PaperArgs),
    /// Fit the arm equation to thrust-bench data and write the arm for the simulator and the flight stack.
    ///
    /// BENCH.csv has a header line with the columns infill_percent (%), thrust_n (N), tilt_deg (degrees, tip up
    /// positive) and, if wanted, power_ratio (P/P0, 1 without it). TENDON.csv has infill_percent, force_n (along the
    /// tendon, N), thrust_n, tilt_deg and, of an arm on the pipe, pressure_pa.
    ///
    /// Exit status: 0 done, 2 bad input or unwritable output.
    FitArm(FitArgs),
    /// Print the timing of a board's log.
    ///
    /// Exit status: 0 read, also when parts were cut off (said on stderr), 2 bad input or unwritable output.
    Timing(TimingArgs),
}

/// What this process is to do.
#[derive(Debug)]
pub enum Task {
    /// Fly a mission.
    Fly(FlyArgs),
    /// Check a vehicle.
    Check(CheckArgs),
    /// Lead through a set-up.
    Bringup(BringupArgs),
    /// Parameters of a board.
    Params(ParamsArgs),
    /// Fly touches of the pipe.
    Capture(CaptureArgs),
    /// Fly a family of vehicles.
    Study(StudyArgs),
    /// Reproduce the paper.
    Paper(PaperArgs),
    /// Fit an arm.
    FitArm(FitArgs),
    /// Look at a log.
    Timing(TimingArgs),
}

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

/// Which touches, and where their map goes.
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
    /// Directory for capture.html and capture.json.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the counts as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

/// What is studied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Study {
    /// Vehicles that differ in stiffness, mass, motors, pilot and pipe.
    Vehicles,
}

/// Which vehicles, and where the results go.
#[derive(Args, Debug)]
pub struct StudyArgs {
    /// What is studied.
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

/// Where the paper's results go.
#[derive(Args, Debug)]
pub struct PaperArgs {
    /// Directory for paper.html and paper.json.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the results as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

/// What to fly and where to report it.
#[derive(Args, Debug)]
pub struct FlyArgs {
    #[command(flatten)]
    pub mission: MissionArgs,
    /// Directory for report.html, flight.mcap and summary.json.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the summary as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub live: LiveArgs,
}

/// How to fly in real time.
#[derive(Args, Debug)]
pub struct LiveArgs {
    /// Fly at the pace of real time with MAVLink on UDP, then wait on the ground until Ctrl-C.
    #[arg(long = "live")]
    pub wanted: bool,
    /// Seconds flown in a second of real time, 0.01 to 1000.
    #[arg(long, value_name = "X", value_parser = speed, default_value = "1", requires = "wanted", allow_negative_numbers = true)]
    pub speed: f64,
    /// Where MAVLink is sent to; what is sent back is answered.
    #[arg(long, value_name = "ADDR:PORT", value_parser = destination, default_value = "127.0.0.1:14550", requires = "wanted")]
    pub mavlink: SocketAddr,
    /// File with the key that signs MAVLink, 64 hexadecimal digits; without it signing is off.
    #[arg(long, value_name = "FILE", requires = "wanted")]
    pub mavlink_key: Option<PathBuf>,
    /// Who flies: none waits on the ground without a transmitter, and leaves no report.
    #[arg(long, value_name = "none", value_parser = no_pilot, requires = "wanted", conflicts_with_all = ["json", "out"])]
    pub pilot: Option<NoPilot>,
}

/// No pilot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoPilot;

/// What to check.
#[derive(Args, Debug)]
pub struct CheckArgs {
    #[command(flatten)]
    pub mission: MissionArgs,
    /// Print the rows as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

/// Which console, and how patient to be with it.
#[derive(Args, Debug)]
pub struct LineArgs {
    /// Console of the board: /dev/ttyUSB0, COM3 or tcp:HOST:PORT, serial ports at 115,200 baud; or over MAVLink
    /// mavlink:/dev/ttyUSB0 (another rate behind a comma), mavlink:tcp:HOST:PORT, udpin:HOST:PORT (listens) or udpout:HOST:PORT.
    #[arg(long, value_name = "PORT")]
    pub port: PortName,
    /// File with the key that signs MAVLink, 64 hexadecimal digits, where the board has one.
    #[arg(long, value_name = "FILE")]
    pub mavlink_key: Option<PathBuf>,
    /// Longest silence of the board while an answer is due, 1 to 600 s.
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = patience, allow_negative_numbers = true)]
    pub patience: Duration,
}

impl LineArgs {
    /// A session at that console, until `stop` is raised.
    ///
    /// # Errors
    /// One line: the port cannot be opened, no console answers there, or the key is none.
    pub fn session(&self, stop: Arc<AtomicBool>) -> Result<Session, Failure> {
        let key = self.mavlink_key.as_deref().map(key::read).transpose();
        Session::open(&self.port, key.map_err(Failure::Input)?, self.patience, stop)
    }
}

/// Which vehicle, and where its protocol is.
#[derive(Args, Debug)]
pub struct BringupArgs {
    #[command(flatten)]
    pub line: LineArgs,
    /// Protocol: begun, or continued where it is there.
    #[arg(long, value_name = "FILE", default_value = "bringup.toml")]
    pub protocol: PathBuf,
    /// Do this step again though it has passed, such as arm-2; may be given more than once.
    #[arg(long, value_name = "STEP")]
    pub again: Vec<String>,
}

/// What to do with a board's parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ParamsVerb {
    /// Write them into the file.
    Dump,
    /// Show where the file differs.
    Diff,
    /// Set them from the file.
    Load,
}

/// Which parameters, and where.
#[derive(Args, Debug)]
pub struct ParamsArgs {
    /// What to do.
    pub verb: ParamsVerb,
    /// Parameter file; - is stdout for `dump`.
    pub file: PathBuf,
    #[command(flatten)]
    pub line: LineArgs,
}

/// Which vehicle and mission. Options win over the file.
#[derive(Args, Debug)]
pub struct MissionArgs {
    /// Scenario file; without one it is the default mission.
    pub scenario: Option<PathBuf>,
    /// Infill of the arms, 4 to 10 %.
    #[arg(long, visible_alias = "infill", value_name = "PERCENT", value_parser = infill, allow_negative_numbers = true)]
    rho: Option<f64>,
    /// How the simulated arms bend: hinge or beam.
    #[arg(long, value_name = "NAME", value_parser = bending)]
    arm_bending: Option<ArmBending>,
    /// Sense of rotation: A or B.
    #[arg(long, value_name = "A|B", value_parser = configuration)]
    config: Option<Configuration>,
    /// Allocation: flexible, rigid, paper or frozen.
    #[arg(long, value_name = "NAME", value_parser = mixer)]
    mixer: Option<Variant>,
    /// Arms that close: 4 (all), 2 (front pair) or rear.
    #[arg(long, value_name = "2|4|rear", value_parser = arms, allow_negative_numbers = true)]
    arms: Option<ArmChoice>,
    /// What measures the position: none, pose (poses over MAVLink), or flow (flow and range below the vehicle).
    #[arg(long, value_name = "NAME", value_parser = position_sensor)]
    sensors: Option<PositionSensor>,
    /// What the pilot leaves to the vehicle: none, or hold (hovers in the mode HOLD).
    #[arg(long, value_name = "NAME", value_parser = assist)]
    assist: Option<Assist>,
    /// Gain on the elastic term of the arm equation, 1 (literal) to 10.
    #[arg(long, value_name = "K", value_parser = gain_k, allow_negative_numbers = true)]
    gain_k: Option<f64>,
    /// Seed of every random number: a whole number from 0 to 9e15.
    #[arg(long, value_name = "N", value_parser = seed, allow_negative_numbers = true)]
    seed: Option<u64>,
}

impl MissionArgs {
    /// The scenario that they choose.
    ///
    /// # Errors
    /// One line that names file, line, key, value and what is allowed.
    pub fn scenario(&self) -> Result<Scenario, String> {
        match &self.scenario {
            Some(path) => Scenario::load(path, &self.overrides()).map_err(|e| e.to_string()),
            None => Ok(Scenario::default_mission_with(&self.overrides())),
        }
    }

    /// What they change in a scenario.
    fn overrides(&self) -> Overrides {
        Overrides {
            infill: self.rho,
            gain_k: self.gain_k,
            arm_bending: self.arm_bending,
            configuration: self.config,
            mixer: self.mixer,
            arms: self.arms,
            sensors: self.sensors,
            assist: self.assist,
            seed: self.seed,
        }
    }
}

/// Something to show instead of a flight: help, version, or a refusal.
pub struct Message(clap::Error);

impl Message {
    /// Shows it and gives the exit status.
    pub fn show(&self) -> ExitCode {
        match self.0.kind() {
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => match console::written(self.0.print()) {
                Ok(()) => ExitCode::SUCCESS,
                Err(line) => super::refuse(&line),
            },
            _ => super::refuse(&self.line()),
        }
    }

    /// clap's message without its usage and hints at help, as one line.
    fn line(&self) -> String {
        // Only behind `help` may no file stand in a subcommand's place.
        if self.0.kind() == ErrorKind::InvalidSubcommand
            && let Some(ContextValue::String(topic)) = self.0.get(ContextKind::InvalidSubcommand)
        {
            return format!("no help on '{topic}': allowed are {}", VERBS.join(", "));
        }
        // clap takes a second file for a subcommand where one could stand.
        let extra = match self.0.kind() {
            ErrorKind::UnknownArgument => self.0.get(ContextKind::InvalidArg),
            ErrorKind::ArgumentConflict => self.0.get(ContextKind::InvalidSubcommand),
            _ => None,
        };
        if let Some(ContextValue::String(extra)) = extra
            && !extra.starts_with('-')
            && !VERBS.contains(&extra.as_str())
        {
            let allowed = match std::env::args().nth(1).as_deref() {
                Some("paper" | "capture") => "no file",
                Some("study") => "vehicles and no file",
                Some("fit-arm") => "one CSV file",
                Some("params") => "one parameter file",
                Some("bringup") => "no file",
                _ => "one scenario file",
            };
            return format!("unexpected argument '{extra}': allowed is {allowed}");
        }
        let text = self.0.to_string();
        let lines = text.lines().map(str::trim).filter(|l| !l.is_empty());
        let first = lines.take_while(|l| !l.starts_with("Usage:") && !l.starts_with("For more information"));
        let line = first.collect::<Vec<_>>().join("; ").replace(":; ", ": ");
        line.strip_prefix("error: ").unwrap_or(&line).to_owned()
    }
}

/// The options of this process.
pub fn parse() -> Result<Task, Message> {
    parse_from(std::env::args_os())
}

fn parse_from(
    args: impl IntoIterator<Item = impl Into<std::ffi::OsString> + Clone>,
) -> Result<Task, Message> {
    let cli = Cli::try_parse_from(args).map_err(Message)?;
    Ok(match cli.command {
        Some(Command::Fly(fly)) => Task::Fly(fly),
        Some(Command::Check(check)) => Task::Check(check),
        Some(Command::Bringup(bringup)) => Task::Bringup(bringup),
        Some(Command::Params(params)) => Task::Params(params),
        Some(Command::Capture(capture)) => Task::Capture(capture),
        Some(Command::Study(study)) => Task::Study(study),
        Some(Command::Paper(paper)) => Task::Paper(paper),
        Some(Command::FitArm(fit)) => Task::FitArm(fit),
        Some(Command::Timing(timing)) => Task::Timing(timing),
        None => Task::Fly(cli.fly),
    })
}

fn number(text: &str, range: Range) -> Result<f64, String> {
    let value = text.parse().ok().and_then(|v| range.to_si(v));
    value.ok_or_else(|| format!("allowed {}", range.allowed()))
}

fn infill(text: &str) -> Result<f64, String> {
    number(text, keys::INFILL)
}

fn gain_k(text: &str) -> Result<f64, String> {
    number(text, keys::GAIN_K)
}

fn patience(text: &str) -> Result<Duration, String> {
    let seconds = text
        .parse()
        .ok()
        .filter(|seconds| (1.0..=600.0).contains(seconds));
    let seconds = seconds.ok_or_else(|| "allowed 1 to 600 s".to_owned())?;
    Ok(Duration::from_secs_f64(seconds))
}

fn seed(text: &str) -> Result<u64, String> {
    let seed = text.parse().ok().and_then(keys::seed);
    seed.ok_or_else(|| format!("allowed {}", keys::SEED_ALLOWED))
}

fn touches(text: &str) -> Result<u64, String> {
    let count = text.parse().ok().filter(|count| TOUCHES.contains(count));
    count.ok_or_else(|| format!("allowed {} to {}", TOUCHES.start(), TOUCHES.end()))
}

fn vehicles(text: &str) -> Result<u64, String> {
    let count = text.parse().ok().filter(|count| VEHICLES.contains(count));
    count.ok_or_else(|| format!("allowed {} to {}", VEHICLES.start(), VEHICLES.end()))
}

fn spread(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "allowed 0 to 1".to_owned())
}

fn heading(text: &str) -> Result<f64, String> {
    let degrees = text.parse().ok().filter(|degrees| (0.0..=45.0).contains(degrees));
    degrees.ok_or_else(|| "allowed 0 to 45 degrees".to_owned())
}

fn lever(text: &str) -> Result<f64, String> {
    let mm = text.parse().ok().filter(|mm| (5.0..=100.0).contains(mm));
    mm.ok_or_else(|| "allowed 5 to 100 mm".to_owned())
}

fn speed(text: &str) -> Result<f64, String> {
    let speed = text.parse().ok().filter(|speed| SPEEDS.contains(speed));
    speed.ok_or_else(|| format!("allowed {} to {}", SPEEDS.start(), SPEEDS.end()))
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

fn configuration(text: &str) -> Result<Configuration, String> {
    word(&text.to_uppercase(), keys::CONFIGURATIONS).map(keys::configuration)
}

fn bending(text: &str) -> Result<ArmBending, String> {
    word(text, keys::BENDINGS).map(keys::bending)
}

fn position_sensor(text: &str) -> Result<PositionSensor, String> {
    word(text, keys::POSITION_SENSORS).map(keys::position_sensor)
}

fn assist(text: &str) -> Result<Assist, String> {
    word(text, keys::ASSISTS).map(keys::assist)
}

fn mixer(text: &str) -> Result<Variant, String> {
    word(text, keys::MIXERS).map(keys::mixer)
}

fn arms(text: &str) -> Result<ArmChoice, String> {
    match text {
        "4" => Ok(ArmChoice::All),
        "2" => Ok(ArmChoice::Front),
        _ => word(text, keys::ARMS)
            .map(keys::arms)
            .map_err(|_| "allowed 4 or all, 2 or front, rear".to_owned()),
    }
}

fn word<'a>(text: &'a str, allowed: &[&str]) -> Result<&'a str, String> {
    if allowed.contains(&text) {
        Ok(text)
    } else {
        Err(format!("allowed {}", allowed.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(line: &str) -> Result<FlyArgs, String> {
        match parse_from(["sophie"].into_iter().chain(line.split_whitespace())).map_err(|m| m.line())? {
            Task::Fly(fly) => Ok(fly),
            other => Err(format!("{other:?}")),
        }
    }

    #[test]
    fn clap_agrees_with_the_definition() {
        use clap::CommandFactory;
        Cli::command().debug_assert();
    }

    #[test]
    fn fly_may_be_left_out() {
        for line in [
            "--infill 8 --arms 2 x.toml",
            "fly x.toml --rho 8 --arms front",
            "fly --arms 2 --infill=8 x.toml",
        ] {
            let fly = args(line).unwrap();
            assert_eq!(fly.mission.scenario, Some(PathBuf::from("x.toml")), "{line}");
            let o = fly.mission.overrides();
            assert_eq!(
                (o.infill, o.arms, o.seed),
                (Some(8.0), Some(ArmChoice::Front), None),
                "{line}"
            );
        }
        let fly = args("").unwrap();
        assert!(fly.mission.scenario.is_none() && !fly.json && fly.out.as_os_str() == "out");
        let o = args("--config a --mixer paper --gain-k 1 --seed 9 --json")
            .unwrap()
            .mission
            .overrides();
        assert_eq!(
            (o.configuration, o.mixer),
            (Some(Configuration::A), Some(Variant::Paper))
        );
        assert_eq!((o.gain_k, o.seed), (Some(1.0), Some(9)));
    }

    #[test]
    fn refusals_are_one_line_that_says_what_is_allowed() {
        for (line, message) in [
            (
                "--infill 3.5",
                "invalid value '3.5' for '--rho <PERCENT>': allowed 4 to 10 %",
            ),
            (
                "--rho -1",
                "invalid value '-1' for '--rho <PERCENT>': allowed 4 to 10 %",
            ),
            (
                "--seed -1",
                "invalid value '-1' for '--seed <N>': allowed a whole number from 0 to 9e15",
            ),
            (
                "--seed 18446744073709551615",
                "invalid value '18446744073709551615' for '--seed <N>': allowed a whole number from 0 to 9e15",
            ),
            (
                "a.toml b.toml",
                "unexpected argument 'b.toml': allowed is one scenario file",
            ),
            (
                "fly a.toml b.toml",
                "unexpected argument 'b.toml': allowed is one scenario file",
            ),
            (
                "--gain-k NaN",
                "invalid value 'NaN' for '--gain-k <K>': allowed 1 to 10",
            ),
            (
                "--config C",
                "invalid value 'C' for '--config <A|B>': allowed A, B",
            ),
            (
                "--arm-bending soft",
                "invalid value 'soft' for '--arm-bending <NAME>': allowed hinge, beam",
            ),
            (
                "--mixer best",
                "invalid value 'best' for '--mixer <NAME>': allowed flexible, rigid, paper, frozen",
            ),
            (
                "--live --speed 0",
                "invalid value '0' for '--speed <X>': allowed 0.01 to 1000",
            ),
            (
                "--live --speed nan",
                "invalid value 'nan' for '--speed <X>': allowed 0.01 to 1000",
            ),
            (
                "--live --mavlink 127.0.0.1",
                "invalid value '127.0.0.1' for '--mavlink <ADDR:PORT>': allowed the address of one machine and its port, \
                 such as 127.0.0.1:14550",
            ),
            (
                "--live --mavlink 255.255.255.255:14550",
                "invalid value '255.255.255.255:14550' for '--mavlink <ADDR:PORT>': allowed the address of one machine \
                 and its port, such as 127.0.0.1:14550",
            ),
            (
                "--live --pilot me",
                "invalid value 'me' for '--pilot <none>': allowed none",
            ),
            (
                "--arms 3",
                "invalid value '3' for '--arms <2|4|rear>': allowed 4 or all, 2 or front, rear",
            ),
        ] {
            assert_eq!(args(line).unwrap_err(), message);
        }
        for line in [
            "--seed x",
            "--seed 1.5",
            "--seed nan",
            "--infil 6",
            "--out",
            "--infill 6 --infill 7",
            "--speed 2",
            "--mavlink 127.0.0.1:14550",
            "--pilot none",
            "--live --pilot none --json",
            "--live --mavlink 127.0.0.1:0",
            "--live --mavlink 0.0.0.0:14550",
            "--live --mavlink 224.0.0.1:14550",
        ] {
            let message = args(line).unwrap_err();
            assert!(
                !message.contains('\n') && message.len() < 200 && !message.contains("Usage"),
                "{message}"
            );
        }
    }
}
