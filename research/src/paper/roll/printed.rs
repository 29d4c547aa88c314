//! Consistency of Table III's columns.

use super::super::printed::Printed;
use crate::results::model::{Class, Comparison, Section};

/// Compares Table III's columns with each other.
pub fn against_itself(s: &mut Section, p: &Printed) {
    let rows = kappa_rows(p).into_iter().chain(ratio_rows(p));
    s.compare("Table III against itself", rows.collect());
}

/// κ against its two equations.
fn kappa_rows(p: &Printed) -> Vec<Comparison> {
    let (angle, share) = (p.text.roll_deg.to_radians(), p.text.delta_thrust_share);
    let mut rows = vec![];
    for row in &p.table_3 {
        let bent = row.delta_alpha_max_deg.to_radians();
        rows.push(Comparison {
            what: format!("κ by Eq. 11 from its own Δα, ρ {} %", row.infill_percent),
            unit: "",
            printed: row.kappa,
            here: eq_11(bent, share, angle),
            class: Class::Inconsistent,
            why: "Eq. 11 with the printed Δα_max, 3/5 and 25°; the column is not what its equation gives (0.488 looks like a \
                  transposed 0.448)"
                .to_owned(),
        });
        rows.push(Comparison {
            what: format!("κ with the exact force, ρ {} %", row.infill_percent),
            unit: "",
            printed: row.kappa,
            here: exact(bent, share, angle),
            class: Class::Inconsistent,
            why: "the sideways force is T1 sin α1 - T3 sin α3, of first order in Δα; Eqs. 8 and 11 keep only Δα ΔT"
                .to_owned(),
        });
    }
    rows
}

/// Ratios against the largest possible in a roll to 25°.
fn ratio_rows(p: &Printed) -> Vec<Comparison> {
    let mut rows = vec![];
    for row in &p.table_3 {
        let most = (p.text.roll_deg + row.delta_alpha_max_deg) / p.text.roll_deg;
        rows.push(Comparison {
            what: format!("largest ratio that still reaches 25°, ρ {} %", row.infill_percent),
            unit: "",
            printed: row.ratio,
            here: most,
            class: if row.ratio > most { Class::Inconsistent } else { Class::Prediction },
            why: "(25° + Δα_max)/25°: a roll that reaches 25° has (φ + Δα)* of at least 25° once Δα has gone, and no more \
                  than 25° + Δα_max without corrections"
                .to_owned(),
        });
    }
    rows
}

/// κ by Eq. 11, from Δα (rad) between two pairs with ΔT/(T1+T3) = `share`, at `roll` (rad).
pub fn eq_11(delta_alpha: f64, share: f64, roll: f64) -> f64 {
    delta_alpha * share / roll.sin()
}

/// (T1 sin α1 - T3 sin α3) over (T1 cos α1 + T3 cos α3) sin φ, arms symmetric about level.
fn exact(delta_alpha: f64, share: f64, roll: f64) -> f64 {
    let (t1, t3) = (0.5 * (1.0 + share), 0.5 * (1.0 - share));
    let half = 0.5 * delta_alpha;
    (t1 * half.sin() + t3 * half.sin()) / ((t1 + t3) * half.cos() * roll.sin())
}
