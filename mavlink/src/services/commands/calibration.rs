//! Calibration by command. The procedure is [`sophie_control::calibration::procedure`], as at the console.
//!
//! `MAV_CMD_SOPHIE_CALIBRATE` measures one step, for a host that leads its user. `PREFLIGHT_CALIBRATION` leads by texts
//! itself, for ground stations that know no more. Parameters that are found are set: stored a second later, in force after
//! a restart.

use sophie_control::calibration::procedure::{Finding, Outcome, Procedure};
use sophie_control::calibration::step::{Calibration, Step};
use sophie_control::calibration::{Face, Unfit};
use sophie_control::maths::decimal::Decimal;
use sophie_control::params::Params;

use super::orders::Answerer;
use super::{Received, or_zero, whole};
use crate::services::Services;
use crate::services::answer::Answer;
use crate::services::telemetry::calibration_result;
use crate::vehicle::Vehicle;
use crate::wire::requests::{Command, Peer};
use sophie_dialect::*;

/// Time to turn the vehicle to the next side where texts lead, µs.
const PATIENCE_US: u64 = 60_000_000;
/// Time between two reports of progress, µs.
const PROGRESS_US: u64 = 1_000_000;

/// A line's part in the procedure, which all lines share.
#[derive(Clone, Debug)]
pub(crate) struct Calibrations {
    /// The running step was begun on this line.
    owned: bool,
    /// Time at which the texts asked for the present side, µs; `None` where a host leads.
    asked_us: Option<u64>,
    /// Time of the next report of progress, µs.
    report_us: u64,
    /// The end of the newest step.
    pub(crate) result: Option<SOPHIE_CALIBRATION_RESULT_DATA>,
    /// The command of the newest step, and its acknowledgement once it has ended.
    command: Option<(Command, Peer)>,
    ended: Option<MavResult>,
}

impl Calibrations {
    pub(crate) const fn new() -> Self {
        Self {
            owned: false,
            asked_us: None,
            report_us: 0,
            result: None,
            command: None,
            ended: None,
        }
    }

    /// The acknowledgement of a step that has ended, if `received` repeats its command: the first was lost on its way.
    fn acknowledged(&self, received: &Received<'_>) -> Option<MavResult> {
        let (command, from) = self.command?;
        let repeats =
            received.command.repeated && received.command.is_alike(&command) && received.from == from;
        self.ended.filter(|_| repeats)
    }

    /// Ends this line's running step without a result; true if one ran.
    pub(super) fn cancel(&mut self, procedure: &mut Procedure) -> bool {
        self.asked_us = None;
        core::mem::take(&mut self.owned) && procedure.cancel()
    }
}

impl Services {
    /// Measures one step for a host, or ends the running one; `None` if the acknowledgement comes later.
    pub(super) fn calibrate(
        &mut self,
        received: &Received<'_>,
        procedure: &mut Procedure,
    ) -> Option<MavResult> {
        let [which, part, number, first, second, ..] = received.command.params;
        let [which, part, number] = [which, part, number].map(or_zero).map(whole);
        if which == Some(0) {
            return Some(self.end_calibration(procedure));
        }
        if !received.vehicle.at_rest() {
            return Some(self.refuse_armed());
        }
        let mut all = Calibration::ALL.into_iter();
        let calibration = all.find(|calibration| which == Some(*calibration as u32));
        let step = calibration
            .zip(part)
            .zip(number)
            .and_then(|((calibration, part), number)| Step::new(calibration, part, number, [first, second]));
        let Some(step) = step else {
            return Some(self.deny("no such step of a calibration"));
        };
        if let Some(result) = self.calibrations.acknowledged(received) {
            return self
                .begin(received, Answerer::Calibration)
                .err()
                .unwrap_or_else(|| {
                    self.end_step(result);
                    None
                });
        }
        self.begin_calibration(received, procedure, step, None)
    }

    /// Leads through a calibration by texts, or ends the running one; `None` if the acknowledgement comes later.
    pub(super) fn guide_calibration(
        &mut self,
        received: &Received<'_>,
        procedure: &mut Procedure,
    ) -> Option<MavResult> {
        let (calibration, text) = match received.command.params.map(or_zero).map(whole) {
            [Some(0), Some(0), Some(0), Some(0), Some(0), Some(0), Some(0)] => {
                return Some(self.end_calibration(procedure));
            }
            [Some(1), Some(0), Some(0), Some(0), Some(0), Some(0), Some(0)] => {
                (Calibration::Gyro, "leave the vehicle at rest")
            }
            [Some(0), Some(0), Some(0), Some(0), Some(1), Some(0), Some(0)] => {
                (Calibration::Accel, Face::Belly.text())
            }
            [Some(0), Some(0), Some(0), Some(0), Some(2 | 4), Some(0), Some(0)] => {
                (Calibration::Level, "put the vehicle on a level table")
            }
            _ => return Some(self.unsupported("others: MAV_CMD_SOPHIE_CALIBRATE")),
        };
        if !received.vehicle.at_rest() {
            return Some(self.refuse_armed());
        }
        let Some(step) = Step::new(calibration, 0, 1, [0.0; 2]) else {
            return Some(MavResult::MAV_RESULT_UNSUPPORTED);
        };
        let answer = self.begin_calibration(received, procedure, step, Some(received.now));
        if answer.is_none() && self.calibrations.asked_us == Some(received.now) {
            self.guide(text);
        }
        answer
    }

    fn end_calibration(&mut self, procedure: &mut Procedure) -> MavResult {
        if self.calibrations.cancel(procedure) {
            self.settle(Answerer::Calibration, MavResult::MAV_RESULT_CANCELLED);
        }
        MavResult::MAV_RESULT_ACCEPTED
    }

    fn begin_calibration(
        &mut self,
        received: &Received<'_>,
        procedure: &mut Procedure,
        step: Step,
        asked_us: Option<u64>,
    ) -> Option<MavResult> {
        if procedure.running().is_some() && !self.calibrations.owned {
            return Some(self.refuse("another line calibrates"));
        }
        if let Err(answer) = self.begin(received, Answerer::Calibration) {
            return answer;
        }
        if procedure.begin(step, received.now).is_err() {
            self.settle_refused(Answerer::Calibration, "the step before it first");
            return None;
        }
        self.calibrations.owned = true;
        self.calibrations.command = Some((*received.command, received.from));
        self.calibrations.ended = None;
        self.calibrations.asked_us = asked_us;
        self.calibrations.report_us = received.now.saturating_add(PROGRESS_US);
        self.progress(0);
        None
    }

    fn guide(&mut self, text: &str) {
        self.texts.say(
            MavSeverity::MAV_SEVERITY_INFO,
            format_args!("calibration: {text}"),
        );
    }

    /// Samples the running step; the sensors are read with the parameters `in_force`.
    pub(crate) fn continue_calibration(
        &mut self,
        now: u64,
        vehicle: &Vehicle,
        in_force: &Params,
        procedure: &mut Procedure,
    ) {
        if !self.calibrations.owned {
            return;
        }
        if !vehicle.at_rest() {
            self.calibrations.cancel(procedure);
            let result = self.refuse_armed();
            return self.settle(Answerer::Calibration, result);
        }
        let working = self.parameters.copy();
        let found = procedure.sample(now, &vehicle.readings, in_force, working);
        match found {
            Some(finding) => self.take(&finding, now, procedure),
            None if self.calibrations.asked_us.is_none() && now >= self.calibrations.report_us => {
                self.calibrations.report_us = now.saturating_add(PROGRESS_US);
                self.progress(procedure.progress(now));
            }
            None => (),
        }
    }

    /// Takes the end of a step.
    fn take(&mut self, finding: &Finding, now: u64, procedure: &mut Procedure) {
        if let Some(asked_us) = self.calibrations.asked_us
            && self.guide_on(finding, asked_us, now, procedure)
        {
            return;
        }
        self.calibrations.owned = false;
        self.calibrations.asked_us = None;
        self.calibrations.result = Some(calibration_result(finding));
        match finding.result {
            Ok(outcome) => {
                if let Outcome::Done(changes) = outcome {
                    for (name, value) in changes.into_iter().flatten() {
                        if let Some(place) = self.parameters.put(name, value, now) {
                            self.answer(Answer::Parameter(place));
                        }
                    }
                    self.guide("done");
                }
                self.end_step(MavResult::MAV_RESULT_ACCEPTED);
            }
            Err(unfit) => {
                self.say_unfit(unfit);
                self.end_step(MavResult::MAV_RESULT_FAILED);
            }
        }
    }

    /// Sends the result of a step, then acknowledges its command.
    fn end_step(&mut self, acknowledgement: MavResult) {
        self.calibrations.ended = Some(acknowledgement);
        self.answer(Answer::CalibrationResult);
        self.settle(Answerer::Calibration, acknowledgement);
    }

    /// Where texts lead: asks for the next side, or waits on for this one; false at the end.
    fn guide_on(&mut self, finding: &Finding, asked_us: u64, now: u64, procedure: &mut Procedure) -> bool {
        let step = finding.step;
        let next = match finding.result {
            Ok(Outcome::Taken) => step.number.saturating_add(1),
            // The vehicle is being turned.
            Err(_)
                if step.calibration == Calibration::Accel && now.saturating_sub(asked_us) < PATIENCE_US =>
            {
                step.number
            }
            _ => return false,
        };
        let again = Step { number: next, ..step };
        if procedure.begin(again, now).is_err() {
            return false;
        }
        if next > step.number {
            self.calibrations.asked_us = Some(now);
            let done = usize::from(step.number);
            self.progress((done * 100 / Face::ALL.len()) as u8);
            if let Some(side) = Face::ALL.get(done) {
                self.guide(side.text());
            }
        }
        true
    }

    /// Shorter than [`Unfit`] itself: STATUSTEXT has 50 characters.
    fn say_unfit(&mut self, unfit: Unfit) {
        let Unfit {
            what, value, unit, ..
        } = unfit;
        let [value, least, most] = [value, unfit.allowed[0], unfit.allowed[1]].map(Decimal);
        self.texts.say(
            MavSeverity::MAV_SEVERITY_WARNING,
            format_args!("{what} {value:.2} not in {least:.2}..{most:.2} {unit}"),
        );
    }
}
