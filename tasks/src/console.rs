//! Command line for builders, over any terminal program at 115,200 baud.
//!
//! It has no deadline. The parameters in force are fixed; `set` changes a working copy, which `save` stores and a
//! restart puts in force. If the terminal does not read, its text is dropped and no other task is delayed. Noise on
//! the serial line is parsed as unknown commands.

mod actuator_test;
mod calibrate;
mod chip;
mod command;
pub mod either;
mod keys;
mod line;
mod mavlink;
mod nearest;
mod output;
mod parameters;
mod report;
mod save;
mod selftest;
pub mod terminals;
mod watch;

use embassy_futures::yield_now;
use embassy_time::Timer;
use sophie_control::calibration::procedure::Procedure;
use sophie_control::params::Params;

use self::command::{Command, HELP, parse};
pub use self::keys::CANCEL;
use self::keys::{Keys, PAUSE};
use self::line::{Echo, Line, LineError};
pub use self::nearest::edits;
use self::output::Output;
use crate::links::Links;
use crate::storage::parameters as table;
use crate::storage::storing::{self, NotNow};
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

/// Prompt for a command.
const PROMPT: &[u8] = b"> ";

/// Serves the console; never returns.
pub async fn run(
    links: &Links,
    input: impl SerialInput,
    output: impl SerialOutput,
    storage: impl Storage,
    chip: impl Chip,
) -> ! {
    let mut console = Console {
        links,
        keys: Keys::new(input),
        out: Output::new(output),
        storage,
        chip,
        params: links.params,
        procedure: Procedure::new(),
        order: 0,
    };
    let mut line = Line::default();
    loop {
        match console.keys.wait().await {
            Ok(true) => {
                let mut echo = Echo::new();
                while let Some(byte) = console.keys.next() {
                    if line.push(byte, &mut echo) {
                        console.out.resume();
                        console.out.bytes(&echo).await;
                        echo.clear();
                        console.obey(line.take().as_deref()).await;
                    }
                }
                console.out.bytes(&echo).await;
                // A serial line with continuous input must not starve the other tasks of this level.
                yield_now().await;
            }
            Ok(false) => Timer::after(PAUSE).await,
            Err(_) => {
                line.spoil(LineError::Damaged);
                Timer::after(PAUSE).await;
            }
        }
    }
}

struct Console<'a, I, O, S, C> {
    links: &'a Links,
    keys: Keys<I>,
    out: Output<O>,
    storage: S,
    chip: C,
    /// The working copy.
    params: Params,
    /// The calibrations.
    procedure: Procedure,
    /// Sequence number of the newest actuator test of this console.
    order: u32,
}

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    async fn obey(&mut self, line: Result<&str, &LineError>) {
        self.out.line(format_args!("")).await;
        match line.map(parse) {
            Ok(None) => (),
            Ok(Some(Ok(command))) => self.run(command).await,
            Ok(Some(Err(misunderstood))) => self.out.line(format_args!("{misunderstood}")).await,
            Err(error) => self.out.line(format_args!("{}", error.text())).await,
        }
        self.out.bytes(PROMPT).await;
    }

    async fn run(&mut self, command: Command<'_>) {
        match command {
            Command::Help => {
                for (usage, text) in HELP {
                    self.out.line(format_args!("{usage:15} {text}")).await;
                }
            }
            Command::Status => self.status().await,
            Command::Timing => self.timing().await,
            Command::Version => {
                let (version, board) = (env!("CARGO_PKG_VERSION"), self.chip.board());
                self.out.line(format_args!("SOPHIE {version} on {board}")).await;
                let (build, count, table) = (self.chip.build(), Params::TABLE.len(), table::table_id());
                self.out
                    .line(format_args!(
                        "build {build:08x}, {count} parameters, table {table:08x}"
                    ))
                    .await;
            }
            Command::Silicon => self.silicon().await,
            Command::BrownOut => self.brown_out().await,
            Command::SetBrownOut => self.set_brown_out().await,
            Command::List(part) => self.list(part).await,
            Command::Get(name) => self.get(name).await,
            Command::Set(name, value) => self.set(name, value).await,
            Command::Reset(name) => self.reset(name).await,
            Command::Defaults => {
                self.params = *self.storage.defaults();
                self.changes().await;
            }
            Command::PropellersOff => self.propellers_off().await,
            Command::TiedDown => self.tied_down().await,
            Command::Thrust(which, percent, to) => self.thrust(which, percent, to).await,
            Command::Motor(number, percent) => self.motor(number, percent).await,
            Command::MotorPulse(number, pulse) => self.motor_by_pulse(number, pulse).await,
            Command::Servo { number, to, at } => self.servo(number, to, at).await,
            Command::Calibrate(what, arguments) => self.calibrate(what, arguments).await,
            Command::Watch(group) => self.watch(group).await,
            Command::SelfTest => self.selftest().await,
            Command::Mavlink => self.mavlink().await,
            Command::MavlinkKey(key) => self.mavlink_key(key).await,
            Command::Changes => self.changes().await,
            Command::Save => self.save().await,
            Command::Dfu => self.enter_loader().await,
            Command::Restart => match self.stopped() {
                Ok(()) => {
                    self.out.last(format_args!("restarting")).await;
                    self.chip.restart();
                }
                Err(why) => self.refuse("not restarted", why).await,
            },
        }
    }

    /// Checks that the commander reports stopped motors.
    fn stopped(&self) -> Result<(), NotNow> {
        storing::stopped(self.links)
    }

    async fn refuse(&mut self, what: &str, why: NotNow) {
        match why {
            NotNow::While(mode) => {
                let mode = mode.name();
                self.out
                    .line(format_args!("{what} while {mode}: disarm first"))
                    .await;
            }
            NotNow::Silent => {
                self.out
                    .line(format_args!("{what}: the commander is silent"))
                    .await;
            }
            NotNow::Storing => {
                self.out
                    .line(format_args!(
                        "{what}: another line stores, or waits for its restart"
                    ))
                    .await;
            }
        }
    }
}
