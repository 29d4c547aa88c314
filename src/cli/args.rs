//! Options of the command line and their ranges.

mod console;
mod data;
mod fly;
mod message;
mod mission;
mod studies;
#[cfg(test)]
mod tests;
mod values;

use std::path::PathBuf;

use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand};

pub use console::{BringupArgs, ParamsArgs, ParamsVerb};
pub use data::{FitArgs, FitLagArgs, FitTendonArgs, FitThrustArgs, Kind, RecordingArgs, TimingArgs};
pub use fly::{FlyArgs, LiveArgs};
pub use message::Message;
pub use mission::MissionArgs;
pub use studies::{CaptureArgs, Study, UnknownArgs, VehiclesArgs};

/// SOPHIE, the soft quadrotor that perches on pipes, flown in virtual time.
#[derive(Parser)]
#[command(name = "sophie", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Task>,
    #[command(flatten)]
    fly: FlyArgs,
}

/// The subcommand of this process, with its options.
#[derive(Debug, Subcommand)]
pub enum Task {
    /// Fly a mission and report it (the default; the word may be left out).
    ///
    /// Exit status: 0 mission accomplished, 1 not accomplished, 2 bad input or unwritable output.
    Fly(FlyArgs),
    /// Check in a moment whether a vehicle can fly its mission, by calculation alone.
    ///
    /// A row each for thrust, throttle, yaw, the control loops, the arms, batteries, wind and grip: value, limit,
    /// verdict, and what to do if it fails. Exit status: 0 it can fly, 1 it cannot, 2 bad input.
    Check(CheckArgs),
    /// Lead through the set-up of a vehicle over MAVLink, and record it in a protocol.
    ///
    /// Each step names the work for the hands, asks, has the vehicle measure and judges its numbers. Stopped by q,
    /// Ctrl-C or a lost line, it continues with the first step that has not passed. Answers may be piped in, a line
    /// each.
    /// Exit status: 0 all passed, 1 something failed, skipped or not done, 2 bad input, file or port.
    Bringup(BringupArgs),
    /// Write a board's parameters into a file, compare them with a file, or set them from a file.
    ///
    /// FILE is the params table of a scenario file. `dump` writes all that the board has, - is stdout. `diff` shows
    /// where FILE differs from the board. `load` checks FILE as a whole, sets what differs, saves, restarts, and reads
    /// back.
    /// Exit status: 0 done or equal, 1 different, refused by the board or lost on the way, 2 bad file or port.
    Params(ParamsArgs),
    /// Fly touches of the pipe, and draw which are held, refused, flown away from or lost.
    ///
    /// Half come from anywhere on the pipe, half are what a careful pilot means; of these the half-widths are measured.
    /// Exit status: 0 nothing lost, 1 a vehicle was lost, 2 bad input or unwritable output.
    Capture(CaptureArgs),
    /// Fly many vehicles, each another one.
    ///
    /// Exit status: 0 done, 1 of the unknown vehicles one is fallen or not holding, 2 bad input or unwritable output.
    #[command(
        subcommand,
        arg_required_else_help = false,
        subcommand_value_name = "STUDY",
        subcommand_help_heading = "Studies",
        disable_help_subcommand = true
    )]
    Study(Study),
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
    /// Fit static thrust to readings of a scale and print lines for the console.
    ///
    /// READINGS.csv has a header line with the columns command_percent (% of full drive), voltage_v (V, by the board,
    /// rotors running), reading_g (g at the scale) or thrust_n (N) and, if wanted, rotor (1 to 4, 0 for all four) and
    /// tilt_deg (degrees, of the arms of the rotors that run, tip up positive).
    ///
    /// Exit status: 0 done, 2 bad input.
    FitThrust(FitThrustArgs),
    /// Fit the lag of a motor to the sound of a train of steps and print lines for the console.
    ///
    /// SOUND.wav is a phone's recording beside the rotor, at most a minute, of `thrust 1 30 to 60`.
    ///
    /// Exit status: 0 done, 2 bad input.
    FitLag(FitLagArgs),
    /// Fit a tendon to steps of its servo with and without a weight on the arm's tip.
    ///
    /// STEPS.csv has a header line with the columns reel_deg (from the release mark), weight_n (on the tip) and tilt_deg
    /// (tip up positive), a row a rest in the order of the measurement (docs/calibration.md, Tendons).
    ///
    /// Exit status: 0 done, 2 bad input.
    FitTendon(FitTendonArgs),
    /// Print the timing of a board's log.
    ///
    /// Exit status: 0 read, also when parts were cut off (said on stderr), 2 bad input or unwritable output.
    Timing(TimingArgs),
    /// Run recorded sensors or bytes through this stack's own filter, estimators and decoders.
    ///
    /// FILE is text, plain or gzipped: a line for each measurement (I inertial sample, F flow, R range, L thrust), a
    /// table whose first line names t_us, gx, gy, gz, ax, ay, az and others, or lines of a time in us and a byte
    /// (docs/recording.md). S and all times count from its first line.
    /// Exit status: 0 read, 2 bad input.
    Recording(RecordingArgs),
}

/// What to check.
#[derive(Args, Debug)]
pub struct CheckArgs {
    #[command(flatten)]
    pub mission: MissionArgs,
    /// Print the rows as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

/// Output of the paper's results.
#[derive(Args, Debug)]
pub struct PaperArgs {
    /// Directory for paper.html and paper.json.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Print the results as JSON on stdout, everything else on stderr.
    #[arg(long)]
    pub json: bool,
}

/// The options of this process.
pub fn parse() -> Result<Task, Message> {
    parse_from(std::env::args_os())
}

fn parse_from(
    args: impl IntoIterator<Item = impl Into<std::ffi::OsString> + Clone>,
) -> Result<Task, Message> {
    let cli = Cli::try_parse_from(args).map_err(Message)?;
    let task = cli.command.unwrap_or(Task::Fly(cli.fly));
    // Options that are valid one by one, but not together.
    let together = match &task {
        Task::Capture(args) => values::seeds(args.seed, args.touches, "touches"),
        Task::Study(Study::Vehicles(args)) => values::seeds(args.seed, args.count, "vehicles"),
        Task::Study(Study::Unknown(args)) => args.together(),
        _ => Ok(()),
    };
    together.map_err(|why| Message(Cli::command().error(ErrorKind::ValueValidation, why)))?;
    Ok(task)
}
