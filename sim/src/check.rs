//! Design check: compares the vehicle's abilities with the needs of its mission, computed by the plant's parts and the
//! flown control laws. `docs/design-check.md` explains each row.

mod endurance;
mod grip;
mod hover;
pub mod loops;
mod row;
mod stability;
mod thrust;
pub(crate) mod wind;
mod yaw;

pub(crate) use self::grip::needed;
use self::hover::Built;
pub use self::row::{Limit, Row};
use crate::scenario::{Assist, Scenario, Step};

/// Result of the check.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Rows in a builder's order.
    pub rows: Vec<Row>,
}

impl Check {
    /// Checks the vehicle of `scenario` for its mission; rows of grip and pipe only for missions that touch one.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let built = Built::of(scenario);
        let perches = scenario
            .steps
            .iter()
            .any(|step| matches!(step, Step::Touch | Step::Clamp { .. } | Step::Perch { .. }));
        let mut rows = vec![
            thrust::to_weight(scenario, &built, perches),
            thrust::hover_throttle(scenario, &built),
        ];
        rows.extend(yaw::rows(scenario, &built));
        rows.extend(stability::rows(&loops::margins(scenario), &built));
        if scenario.pilot.assist != Assist::None {
            rows.push(stability::hold(&loops::hold_margins(scenario)));
        }
        rows.push(endurance::flight(scenario, &built));
        rows.push(wind::row(scenario, &built));
        if perches {
            let tries = grip::tries(scenario);
            rows.push(thrust::release(scenario, &built));
            rows.extend(grip::rows(scenario, &tries));
            rows.push(endurance::inspection(scenario, &tries));
        }
        Self { rows }
    }

    /// Whether every row passes.
    #[must_use]
    pub fn can_fly(&self) -> bool {
        self.rows.iter().all(|row| row.pass)
    }

    /// Rows that do not pass.
    pub fn failing(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| !row.pass)
    }
}

#[cfg(test)]
mod tests;
