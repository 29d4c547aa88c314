//! Table III against the flights.

use super::super::printed::{Printed, Roll};
use super::manoeuvre::Arms;
use super::{FLEXIBLE_SOFT, Flights, RIGID_HARD};
use crate::results::model::{Class, Comparison, Section};

/// Compares every row of Table III.
pub fn with_flights(s: &mut Section, p: &Printed, flights: &Flights) {
    let share = p.text.delta_thrust_share;
    let rows = p.table_3.iter().flat_map(|row| {
        let row = Row { row, flights };
        let all = row.delta_alpha(share).into_iter().chain(row.kappa());
        all.chain(row.ratio())
    });
    // A vehicle lost before the turn has no numbers.
    s.compare(
        "Table III against the flights",
        rows.filter(|r| r.here.is_finite()).collect(),
    );
}

struct Row<'a> {
    row: &'a Roll,
    flights: &'a Flights,
}

impl Row<'_> {
    fn line(&self, what: &str, unit: &'static str, printed: f64, here: f64, why: &str) -> Comparison {
        Comparison {
            what: format!("{what}, ρ {} %", self.row.infill_percent),
            unit,
            printed,
            here,
            class: Class::Prediction,
            why: why.to_owned(),
        }
    }

    /// Δα_max; ΔT/T = `share` sets the step's hardness.
    fn delta_alpha(&self, share: f64) -> [Comparison; 3] {
        let fitted = self.flights.fitted;
        let command = format!("hardness of the step from ΔT/T = {share} at ρ 8 %, K from this column");
        let zeta = fitted.damping();
        let (class, why) = if self.row.infill_percent == 8.0 {
            let why = format!("damping ratio {zeta:.2} from this very number");
            (Class::Calibrated, why)
        } else {
            let why = format!("damping ratio {zeta:.2} from the row of 8 %; {command}");
            (Class::Prediction, why)
        };
        let bent = |what: &str, arms, why: &str| {
            let here = self.flights.bent(RIGID_HARD, self.row.infill_percent, arms);
            self.line(what, "°", self.row.delta_alpha_max_deg, here, why)
        };
        [
            bent("Δα_max, static arms", Arms::Static, &command),
            Comparison {
                class,
                ..bent("Δα_max, fitted arms", fitted, &why)
            },
            bent(
                "Δα_max, arms with tip mass",
                Arms::Heavy,
                "the same command on the vehicle that the rest of this stack flies",
            ),
        ]
    }

    fn kappa(&self) -> [Comparison; 2] {
        let kappa = |what: &str, arms| {
            let found = self.flights.found(RIGID_HARD, self.row.infill_percent, arms);
            let here = found.map_or(f64::NAN, |f| f.kappa);
            let force = "largest sideways force of the leaning arms over the largest of the rolled thrust";
            self.line(what, "", self.row.kappa, here, force)
        };
        [
            kappa("κ, exact, fitted arms", self.flights.fitted),
            kappa("κ, exact, arms with tip mass", Arms::Heavy),
        ]
    }

    /// Reduction of φ + Δα by a softer command.
    fn ratio(&self) -> [Comparison; 2] {
        let ratio = |what: &str, arms| {
            let of = |case| self.flights.found(case, self.row.infill_percent, arms);
            let here = match (of(RIGID_HARD), of(FLEXIBLE_SOFT)) {
                (Some(hard), Some(soft)) => hard.effective / soft.effective,
                _ => f64::NAN,
            };
            let soft = "hard step with the rigid mixer over the stack's own prefiltered command";
            self.line(what, "", self.row.ratio, here, soft)
        };
        [
            ratio("(φ+Δα)_max ratio, fitted arms", self.flights.fitted),
            ratio("(φ+Δα)_max ratio, arms with tip mass", Arms::Heavy),
        ]
    }
}
