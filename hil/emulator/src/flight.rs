//! A flight of an image in closed loop, with its verdict.

use sophie_sim::flight::{fly_with, stand_with};
use sophie_sim::record::{FlightRecord, Observer};
use sophie_sim::scenario::Scenario;

use crate::bench_operator::BenchOperator;
use crate::closed_loop::{ClosedLoop, Finished, Setup};
use crate::elf::Firmware;
use crate::log;
use crate::wires::Gap;
use crate::{flyable, gaps};

/// A flight.
pub struct Flight {
    /// Flight record.
    pub record: FlightRecord,
    /// Record of the emulated board.
    pub board: Finished,
    /// Disallowed emulation gaps: the flight then proves nothing.
    pub gaps: Vec<Gap>,
}

impl Flight {
    /// Mission flown without gaps.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.record.outcome.accomplished && self.gaps.is_empty()
    }

    /// Digest of log and pins; equal for equal runs.
    #[must_use]
    pub fn digest(&self) -> u64 {
        let mut digest = crate::wires::Digest::default();
        digest.word(self.board.log_digest);
        digest.word(self.board.run.pins_digest);
        digest.0
    }
}

/// Flies `scenario` with `firmware` on a board as in `setup`; `logged` receives log lines.
///
/// # Errors
/// One line: why the scenario cannot be flown, or the emulator failed.
pub fn fly(
    firmware: &Firmware,
    scenario: &Scenario,
    setup: Setup,
    logged: impl FnMut(&log::Line),
    observer: &mut dyn Observer,
) -> Result<Flight, String> {
    flyable::check(scenario)?;
    let make = || ClosedLoop::new(firmware, scenario, setup, logged);
    let (record, bench) = fly_with(scenario, make, observer);
    let board = bench.finish()?;
    let gaps = gaps::not_allowed(&board.run.gaps)?.into_iter().cloned().collect();
    Ok(Flight { record, board, gaps })
}

/// A vehicle that stood on the ground.
pub struct Stood {
    /// Record of the emulated board.
    pub board: Finished,
    /// Disallowed emulation gaps.
    pub gaps: Vec<Gap>,
}

/// Runs the board of `scenario`'s vehicle without a pilot, on the ground or with a bench operator, until `over`;
/// otherwise as [`fly`].
///
/// # Errors
/// As [`fly`].
pub fn stand(
    firmware: &Firmware,
    scenario: &Scenario,
    setup: Setup,
    operator: Option<BenchOperator>,
    logged: impl FnMut(&log::Line),
    mut over: impl FnMut() -> bool,
) -> Result<Stood, String> {
    flyable::check(scenario)?;
    let make = || {
        let bench = ClosedLoop::new(firmware, scenario, setup, logged);
        match operator {
            Some(operator) => bench.with_operator(operator),
            None => bench,
        }
    };
    let board = stand_with(scenario, make, |_| over())?.finish()?;
    let gaps = gaps::not_allowed(&board.run.gaps)?.into_iter().cloned().collect();
    Ok(Stood { board, gaps })
}
