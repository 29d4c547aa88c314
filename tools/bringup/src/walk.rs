//! The context of every step: the builder, the vehicle, and what both are asked.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use sophie_board_link::Failure;
use sophie_board_link::vehicle::Vehicle;
use sophie_control::calibration::step::Calibration;
use sophie_control::calibration::{Unfit, procedure};
use sophie_control::maths::decimal;
use sophie_control::params::Params;
use sophie_dialect::{
    MavCmd, MavMessage, MavResult, SOPHIE_CALIBRATION_RESULT_DATA, SophieCalibrationOutcome,
};
use sophie_tasks::storage::parameters::{Allowed, Shown, Unit};

/// The builder's reply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    /// A line.
    Line(String),
    /// The input has ended.
    End,
}

/// The builder at the terminal.
pub trait User {
    /// Shows a line.
    fn say(&mut self, line: &str);
    /// Shows a line that the next such line replaces.
    fn live(&mut self, line: &str);
    /// Asks, and waits for the reply.
    fn ask(&mut self, question: &str) -> Reply;
    /// A reply that has been typed already; does not wait.
    fn answered(&mut self) -> Option<Reply>;
}

/// Reason for ending a step without a verdict.
#[derive(Debug)]
pub(super) enum Stop {
    /// The builder skips it.
    Skip,
    /// The builder stops here, or the input has ended.
    Quit,
    /// The line or the file is lost.
    Failed(Failure),
}

impl From<Failure> for Stop {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure)
    }
}

/// The result of a step.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Verdict {
    pub passed: bool,
    pub figures: Vec<String>,
    /// Parameters that are stored and in force.
    pub parameters: BTreeMap<String, f64>,
    /// Numbers of one part that a parameter of several parts is the mean of, by the parameter's name.
    pub measured: BTreeMap<String, f64>,
}

impl Verdict {
    pub(super) fn of(passed: bool, figures: Vec<String>) -> Self {
        Self {
            passed,
            figures,
            ..Self::default()
        }
    }
}

/// What one step of a calibration has given.
pub(super) enum Measured {
    /// Taken, or complete; `None` if its result was lost on its way, as its acknowledgement was not.
    Good(Option<SOPHIE_CALIBRATION_RESULT_DATA>),
    /// Why not, in a line.
    Bad(String),
}

/// The context of a run.
pub(super) struct Walk<'a> {
    pub vehicle: &'a mut Vehicle,
    pub user: &'a mut dyn User,
    /// Count of the board's starts when the builder last confirmed that the propellers are off.
    off_since: Option<u32>,
    /// Weight on the last arm's tip, N.
    pub tip_weight: String,
    /// What passed steps have measured, by step.
    pub passed: BTreeMap<String, BTreeMap<String, f64>>,
    /// Loads of the last pressure sensor, g.
    pub loads: String,
    /// Parameters set and not stored yet, with their new values.
    changed: BTreeMap<String, f32>,
    /// Folder of the protocol.
    folder: PathBuf,
}

impl<'a> Walk<'a> {
    pub(super) fn new(vehicle: &'a mut Vehicle, user: &'a mut dyn User) -> Self {
        Self {
            vehicle,
            user,
            off_since: None,
            tip_weight: "3".to_owned(),
            passed: BTreeMap::new(),
            loads: "100 140 200".to_owned(),
            changed: BTreeMap::new(),
            folder: PathBuf::new(),
        }
    }

    /// With files beside `protocol`.
    pub(super) fn with_files_at(mut self, protocol: &Path) -> Self {
        self.folder = protocol.parent().map(Path::to_owned).unwrap_or_default();
        self
    }

    /// A file beside the protocol.
    pub(super) fn beside(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    pub(super) fn say(&mut self, line: &str) {
        self.user.say(line);
    }

    /// What the passed steps other than `step` have measured of `name`.
    pub(super) fn measured(&self, name: &str, step: &str) -> Vec<f64> {
        let others = self.passed.iter().filter(|(id, _)| *id != step);
        others
            .filter_map(|(_, measured)| measured.get(name).copied())
            .collect()
    }

    /// Shows what the vehicle has said.
    fn show_texts(&mut self) {
        for text in self.vehicle.texts() {
            self.user.say(&format!("  | {text}"));
        }
    }

    /// The builder's reply; `s` skips the step, `q` and the end of input stop.
    pub(super) fn ask(&mut self, question: &str) -> Result<String, Stop> {
        let reply = self.user.ask(&format!("  {question} "));
        understood(reply)
    }

    /// A reply that is one of `keys`.
    pub(super) fn one_of(&mut self, question: &str, keys: &str) -> Result<String, Stop> {
        loop {
            let reply = self.ask(question)?;
            if reply.len() == 1 && keys.contains(&reply) {
                return Ok(reply);
            }
        }
    }

    /// `N` numbers above 0 that the builder types; Enter takes those of `usual`.
    pub(super) fn numbers<const N: usize>(
        &mut self,
        question: &str,
        usual: Option<&str>,
    ) -> Result<[f32; N], Stop> {
        loop {
            let reply = self.ask(question)?;
            let text = match usual {
                Some(usual) if reply.is_empty() => usual,
                _ => &reply,
            };
            let typed: Option<Vec<f32>> = text.split_whitespace().map(decimal::parse).collect();
            let typed = typed.and_then(|numbers| <[f32; N]>::try_from(numbers).ok());
            if let Some(numbers) = typed.filter(|numbers| numbers.iter().all(|number| *number > 0.0)) {
                return Ok(numbers);
            }
            self.say(&format!("  | {N} numbers above 0"));
        }
    }

    /// Waits until the vehicle is disarmed and calibrated.
    pub(super) fn ready(&mut self) -> Result<(), Stop> {
        let user = &mut *self.user;
        let waits = |mode: &str| user.say(&format!("  waiting: {mode}"));
        Ok(self.vehicle.ready(waits)?)
    }

    /// Confirms to the vehicle that the propellers are off, once for each start of the board; its complaint if it refuses.
    pub(super) fn propellers_off(&mut self) -> Result<Option<String>, Stop> {
        self.vehicle.catch_up()?;
        if self.off_since == Some(self.vehicle.starts()) {
            return Ok(None);
        }
        while self.ask("Type off once all four propellers are off:")? != "off" {}
        match self.order(MavCmd::MAV_CMD_USER_1, &[1.0])? {
            None => {
                self.off_since = Some(self.vehicle.starts());
                Ok(None)
            }
            refused => Ok(refused),
        }
    }

    /// Gives `command`; the vehicle's reason if it refuses.
    pub(super) fn order(&mut self, command: MavCmd, params: &[f32]) -> Result<Option<String>, Stop> {
        // Older texts belong to other orders.
        self.show_texts();
        let result = self.vehicle.command(command, params)?;
        if result == MavResult::MAV_RESULT_ACCEPTED {
            return Ok(None);
        }
        Ok(Some(self.vehicle.reason()?))
    }

    /// Measures one step of a calibration and shows its result.
    pub(super) fn measure(
        &mut self,
        calibration: Calibration,
        part: usize,
        step: u8,
        values: [f32; 2],
    ) -> Result<Measured, Stop> {
        self.show_texts();
        let [first, second] = values;
        let params = [
            calibration as u8 as f32,
            part as f32,
            f32::from(step),
            first,
            second,
        ];
        let mut found = None;
        let result = self
            .vehicle
            .command_with(MavCmd::MAV_CMD_SOPHIE_CALIBRATE, &params, |message| {
                if let MavMessage::SOPHIE_CALIBRATION_RESULT(result) = message
                    && (result.calibration, result.step) == (calibration as u8, step)
                {
                    found = Some(result.clone());
                }
            })?;
        if result == MavResult::MAV_RESULT_ACCEPTED {
            return Ok(Measured::Good(found));
        }
        // The vehicle gives the reason as a text as well.
        let reason = self.vehicle.reason()?;
        Ok(Measured::Bad(match found {
            Some(found) if result == MavResult::MAV_RESULT_FAILED => unfit(&found),
            _ => format!("not taken: {reason}"),
        }))
    }

    /// Notes the parameters that a calibration of `part` (0 to 3) has set, given their values before; a line for each.
    pub(super) fn note_changes(
        &mut self,
        calibration: Calibration,
        part: usize,
        before: &BTreeMap<String, f32>,
    ) -> Result<Vec<String>, Stop> {
        let mut lines = Vec::new();
        for name in procedure::parameters(calibration, part).into_iter().flatten() {
            let now = self.vehicle.value(name)?;
            let old = before.get(name).copied().unwrap_or(now);
            lines.push(self.changed(name, old, now));
        }
        Ok(lines)
    }

    /// Values of the parameters that a calibration of `part` (0 to 3) sets.
    pub(super) fn before(
        &mut self,
        calibration: Calibration,
        part: usize,
    ) -> Result<BTreeMap<String, f32>, Stop> {
        let mut values = BTreeMap::new();
        for name in procedure::parameters(calibration, part).into_iter().flatten() {
            values.insert(name.to_owned(), self.vehicle.value(name)?);
        }
        Ok(values)
    }

    /// Notes and shows a change.
    fn changed(&mut self, name: &str, old: f32, new: f32) -> String {
        self.changed.insert(name.to_owned(), new);
        let line = match Params::row(name) {
            Some(row) => format!(
                "{name} {} -> {}{}",
                Shown(row, old),
                Shown(row, new),
                Unit(row.unit)
            ),
            None => format!("{name} {old} -> {new}"),
        };
        self.user.say(&format!("  | {line}"));
        line
    }

    /// Sets `name` to `value`; the line of the change, or why it is refused.
    pub(super) fn set(&mut self, name: &str, value: f32) -> Result<Result<String, String>, Stop> {
        let Some(row) = Params::row(name) else {
            return Ok(Err(format!("no parameter is called {name}")));
        };
        let refused = format!(
            "{name} cannot be {}; it takes {}",
            Shown(row, value),
            Allowed(row)
        );
        if !row.allows(value) {
            return Ok(Err(refused));
        }
        let old = self.vehicle.value(name)?;
        let now = self.vehicle.set(name, value)?;
        if now.to_bits() != value.to_bits() {
            return Ok(Err(self.vehicle.reason()?));
        }
        Ok(Ok(self.changed(name, old, now)))
    }

    /// Stores the set parameters and restarts; returns them, read back after the restart.
    pub(super) fn keep(&mut self) -> Result<BTreeMap<String, f64>, Stop> {
        let changed = std::mem::take(&mut self.changed);
        if changed.is_empty() {
            return Ok(BTreeMap::new());
        }
        self.restart()?;
        let mut kept = BTreeMap::new();
        for (name, value) in changed {
            let now = self.vehicle.value(&name)?;
            if now.to_bits() != value.to_bits() {
                let port = self.vehicle.port();
                return Err(Stop::Failed(Failure::Board(format!(
                    "{port}: read back after the restart: {name} is {now}, stored was {value}"
                ))));
            }
            kept.insert(name, number(value));
        }
        Ok(kept)
    }

    /// Stores the parameters and restarts.
    pub(super) fn restart(&mut self) -> Result<(), Stop> {
        self.user
            .say("  storing; the board restarts: leave the vehicle at rest");
        self.show_texts();
        self.vehicle.store_and_restart()?;
        // Texts of the start repeat the arming checks.
        self.vehicle.texts();
        self.ready()
    }
}

/// The number as it is written: a float's shortest decimal.
pub(super) fn number(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| f64::from(value))
}

/// Why a step is not taken.
fn unfit(result: &SOPHIE_CALIBRATION_RESULT_DATA) -> String {
    let unfit = Unfit {
        what: result.quantity.to_str().unwrap_or_default(),
        value: result.value,
        allowed: [result.least, result.most],
        unit: result.unit.to_str().unwrap_or_default(),
    };
    format!("not taken: {unfit}")
}

/// True where the calibration is complete.
pub(super) fn is_done(result: &SOPHIE_CALIBRATION_RESULT_DATA) -> bool {
    result.outcome == SophieCalibrationOutcome::SOPHIE_CALIBRATION_OUTCOME_DONE as u8
}

/// The text of a reply.
///
/// # Errors
/// A reply that ends the step.
pub(super) fn understood(reply: Reply) -> Result<String, Stop> {
    match reply {
        Reply::End => Err(Stop::Quit),
        Reply::Line(line) => match line.trim() {
            "q" => Err(Stop::Quit),
            "s" => Err(Stop::Skip),
            other => Ok(other.to_owned()),
        },
    }
}
