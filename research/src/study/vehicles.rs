//! How many of a varied family of vehicles accomplish the mission, and whether the design check knows which.
//!
//! Infill, stiffness, pipe, motors, pilot, battery and gusts differ from one to the next, and so do mass, inertia and torque
//! ratio, which the flight stack's parameters follow; of the arms' own gains and offsets it knows nothing.

pub mod report;
mod sampling;

use sophie_sim::check::Check;
use sophie_sim::parallel;
use sophie_sim::record::{Outcome, Silent};

pub use self::sampling::{SampledVehicle, sample};
use super::cause::cause;

/// A vehicle, what the design check says of it, and how it flew.
#[derive(Clone, Debug)]
pub struct Flown {
    /// The vehicle.
    pub sampled: SampledVehicle,
    /// Rows of the check that it fails, each with value and limit; none: it can fly.
    pub check: Vec<String>,
    /// Of its flight.
    pub outcome: Outcome,
}

impl Flown {
    /// Whether the check lets it pass.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.check.is_empty()
    }

    /// What ended the flight, without its numbers; none where the mission was accomplished.
    #[must_use]
    pub fn cause(&self) -> Option<String> {
        (!self.outcome.accomplished).then(|| cause(&self.outcome.reason))
    }
}

/// Checks and flies `count` vehicles with the seeds `seed`, `seed` + 1, …
///
/// # Errors
/// One line: a vehicle that does not make a valid scenario.
pub fn fly(count: u64, seed: u64, spread: f64) -> Result<Vec<Flown>, String> {
    let sampled = (0..count)
        .map(|i| sample(seed.saturating_add(i), spread))
        .collect::<Result<Vec<_>, _>>()?;
    Ok(parallel::each(&sampled, |sampled| Flown {
        sampled: sampled.clone(),
        check: Check::of(&sampled.scenario)
            .failing()
            .map(|row| row.shortfall())
            .collect(),
        outcome: sophie_sim::flight::fly(&sampled.scenario, &mut Silent).outcome,
    }))
}
