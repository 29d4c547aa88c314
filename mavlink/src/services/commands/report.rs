//! Reports row by row: the self-test and the settings of the chip. The board makes the rows; one waits for the line at a time.

use super::orders::Answerer;
use super::{Received, or_zero, whole};
use crate::services::Services;
use crate::services::answer::Answer;
use sophie_control::arming::ArmingInhibits;
use sophie_dialect::*;

/// A report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Report {
    /// All parts that need not move; takes a second.
    SelfTest = 1,
    /// Settings of the chip, as the start has read them.
    Chip = 2,
}

/// Longest text of a row, bytes.
pub const FOUND: usize = 72;

/// One row of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// What was looked at, at most 24 bytes.
    pub name: &'static str,
    /// It is as it should be.
    pub passed: bool,
    /// Arming checks that belong to it.
    pub inhibits: ArmingInhibits,
    /// What was found, and what is allowed.
    pub found: heapless::String<FOUND>,
}

/// The running report of one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Running {
    report: Report,
    /// The next row.
    next: u8,
    rows: u8,
    /// Made, and not sent yet.
    row: Option<Row>,
}

impl Services {
    /// Begins a report; `None` if the acknowledgement comes later.
    pub(super) fn report(&mut self, received: &Received<'_>) -> Option<MavResult> {
        let [which, ..] = received.command.params;
        let report = match whole(or_zero(which)) {
            Some(1) => Report::SelfTest,
            Some(2) => Report::Chip,
            _ => return Some(self.deny("report 1 or 2")),
        };
        if report == Report::SelfTest && !received.vehicle.at_rest() {
            return Some(self.refuse_armed());
        }
        if let Err(answer) = self.begin(received, Answerer::Board) {
            return answer;
        }
        if self.report.is_some() {
            // Its command was withdrawn by a forced disarming, its rows still come.
            self.settle_refused(Answerer::Board, "another report is under way");
            return None;
        }
        self.report = Some(Running {
            report,
            next: 0,
            rows: 0,
            row: None,
        });
        self.progress(0);
        None
    }

    /// The row that the board makes next; `None` while one waits for the line.
    pub(crate) fn next_row(&self) -> Option<(Report, u8)> {
        let running = self.report.as_ref()?;
        running.row.is_none().then_some((running.report, running.next))
    }

    /// Takes the row that was asked for, of so many `rows`; `None` ends the report.
    pub(crate) fn take_row(&mut self, row: Option<Row>, rows: u8) {
        let Some(running) = &mut self.report else {
            return;
        };
        match row {
            Some(row) => {
                running.rows = rows;
                running.row = Some(row);
                self.answer(Answer::Row);
            }
            None => {
                self.report = None;
                self.settle(Answerer::Board, MavResult::MAV_RESULT_ACCEPTED);
            }
        }
    }

    /// The message of the row that waits.
    pub(crate) fn row_message(&mut self) -> Option<SOPHIE_CHECK_DATA> {
        let running = self.report.as_mut()?;
        let row = running.row.take()?;
        let at = running.next;
        running.next = running.next.saturating_add(1);
        Some(SOPHIE_CHECK_DATA {
            inhibits: row.inhibits.bits(),
            report: running.report as u8,
            row: at,
            rows: running.rows,
            passed: row.passed.into(),
            name: crate::services::telemetry::text::<24>(row.name).into(),
            found: crate::services::telemetry::text::<FOUND>(&row.found).into(),
        })
    }
}
