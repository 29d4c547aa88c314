//! Table IV, re-paired: the longest closure with the largest force.

use sophie_charts::units::kgcm;

use super::super::printed::Printed;
use super::bench::{INFILLS, OnBench};
use super::correlation;
use crate::results::model::{Class, Comparison, Section};

/// Closure time (s) and steady force (kgcm), second row reversed.
pub fn paired(p: &Printed) -> Vec<(f64, f64)> {
    let forces = p.table_4.force_kgcm.into_iter().rev();
    p.table_4.closure_s.into_iter().zip(forces).collect()
}

/// The same as printed.
pub fn as_printed(p: &Printed) -> Vec<(f64, f64)> {
    p.table_4
        .closure_s
        .into_iter()
        .zip(p.table_4.force_kgcm)
        .collect()
}

/// Compares each pair with the closing of nearest force.
pub fn compare(s: &mut Section, p: &Printed, all: &[OnBench]) {
    let mut rows = vec![];
    for (i, (time, force)) in paired(p).into_iter().enumerate() {
        let far = |c: &OnBench| (kgcm(c.closed.steady) / force - 1.0).abs();
        let held = all.iter().filter(|c| c.holds());
        let Some(nearest) = held.min_by(|a, b| far(a).total_cmp(&far(b))) else {
            continue;
        };
        rows.push(Comparison {
            what: format!("U({}) re-paired: ρ {} %, D {:.0} mm", i + 1, nearest.infill, 1e3 * nearest.diameter),
            unit: "kgcm",
            printed: force,
            here: kgcm(nearest.closed.steady),
            class: Class::Calibrated,
            why: "the paper does not print which infill and diameter its four closings had: the nearest of the grid above"
                .to_owned(),
        });
        rows.push(Comparison {
            what: format!("t({}) of the same closing", i + 1),
            unit: "s",
            printed: time,
            here: nearest.closed.closure.unwrap_or(f64::NAN),
            class: Class::Prediction,
            why: "the closing was chosen by its force alone; the approach speed (0.7 rad/s) was set with the range of these \
                  times in view"
                .to_owned(),
        });
    }
    s.compare("Table IV", rows);
}

/// Correlation of printed times and forces beside the bench's `over_pipes`.
pub fn correlations(p: &Printed, over_pipes: f64) -> Comparison {
    Comparison {
        what: format!("correlation of t and U, here over pipes at ρ {} %", INFILLS[0]),
        unit: "",
        printed: correlation(&as_printed(p)),
        here: over_pipes,
        class: Class::Inconsistent,
        why: "the text says that closure times and forces are both bigger for small pipes and dense arms, the table's U \
              falls while its t rises: its second row stands in reverse"
            .to_owned(),
    }
}
