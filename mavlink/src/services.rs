//! Services to a ground station over one line: parameters, files, streams, texts, console and commands.

pub(crate) mod answer;
pub mod commands;
pub mod files;
pub mod ftp;
pub mod parameters;
pub mod shell;
pub mod streams;
pub mod telemetry;
pub mod texts;

use heapless::Deque;
use sophie_control::params::Params;

use self::answer::Answer;
use self::commands::calibration::Calibrations;
use self::commands::orders::Orders;
use self::commands::report::Running;
use self::files::FILES;
use self::ftp::Ftp;
use self::parameters::Parameters;
use self::shell::Shell;
use self::streams::Schedule;
use self::texts::Texts;
use crate::wire::requests::Peer;
use sophie_dialect::MavResult;

/// Answers that wait at most. An answer that finds no room is dropped; its station asks again.
const ANSWERS: usize = 12;

/// The services of one line.
pub(crate) struct Services {
    pub(crate) schedule: Schedule,
    pub(crate) texts: Texts,
    pub(crate) parameters: Parameters,
    pub(crate) answers: Deque<Answer, ANSWERS>,
    pub(crate) ftp: Ftp,
    pub(crate) shell: Shell,
    /// Time of a restart that a command asked for, µs since the start.
    pub(crate) restart_at: Option<u64>,
    /// A command asked to set the chip's brown-out level.
    pub(crate) set_brown_out: bool,
    /// A command asked to store the parameters now.
    pub(crate) store_now: bool,
    report: Option<Running>,
    orders: Orders,
    pub(crate) calibrations: Calibrations,
}

impl Services {
    /// Services before the first byte, with `params` in force.
    pub(crate) const fn new(params: Params) -> Self {
        Self {
            schedule: Schedule::new(),
            texts: Texts::new(),
            parameters: Parameters::new(params),
            answers: Deque::new(),
            ftp: Ftp::new(&FILES),
            shell: Shell::new(),
            restart_at: None,
            set_brown_out: false,
            store_now: false,
            report: None,
            orders: Orders::new(),
            calibrations: Calibrations::new(),
        }
    }

    pub(crate) fn acknowledge(&mut self, command: u16, to: Peer, result: MavResult, progress: u8) {
        self.answer(Answer::Ack {
            command,
            result,
            progress,
            to,
        });
    }

    pub(crate) fn answer(&mut self, answer: Answer) {
        let _ = self.answers.push_back(answer);
    }
}
