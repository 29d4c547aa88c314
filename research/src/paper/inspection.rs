//! Table V's inspection times: how long a servo battery holds a pipe.

use sophie_charts::units::kgcm;
use sophie_sim::parallel;
use sophie_sim::plant::servo_power::MG996R;
use sophie_sim::plant::tendon::ServoProfile;
use sophie_sim::plant::tendon::ServoSpec;

use super::clamp::{closing_thrust, mean_closing};
use super::printed::{Endurance, Printed};
use crate::results::model::{Axis, Chart, Class, Comparison, Series, SeriesStyle, Table, num};

/// m.
const PIPE: f64 = 0.30;

fn drawn(torque: f64) -> f64 {
    MG996R.at(torque / kgcm(1.0))
}

/// Current per servo of four that empties the battery in `minutes`, A.
pub fn current(p: &Printed, minutes: f64) -> f64 {
    p.text.servo_battery_mah * 1e-3 / (minutes / 60.0) / 4.0
}

/// Inspection times from the steady force on a pipe, per row of Table V.
pub struct Inspection<'a> {
    printed: &'a Printed,
    rows: Vec<Held<'a>>,
}

struct Held<'a> {
    row: &'a Endurance,
    /// Steady force, kgcm; NaN if the arms do not close.
    force: f64,
    /// Servo current for it, A.
    amps: f64,
    /// Implied by the printed time, A.
    meant: f64,
}

impl<'a> Inspection<'a> {
    /// Closes the arms at every infill.
    pub fn new(printed: &'a Printed) -> Self {
        let infills: Vec<f64> = printed.table_5.iter().map(|r| r.infill_percent).collect();
        let servo = ServoSpec::from(ServoProfile::Paper);
        let forces = parallel::each(&infills, |i| {
            let closed = mean_closing(*i, PIPE, servo, closing_thrust(printed));
            closed.closure.map_or(f64::NAN, |_| kgcm(closed.steady))
        });
        let rows = printed.table_5.iter().zip(forces).map(|(row, force)| Held {
            row,
            force,
            amps: drawn(force),
            meant: current(printed, row.inspection_min),
        });
        Self {
            printed,
            rows: rows.collect(),
        }
    }

    fn minutes(&self, held: &Held<'_>, arms: f64) -> f64 {
        60.0 * (self.printed.text.servo_battery_mah * 1e-3) / (arms * held.amps)
    }

    /// Current and times per infill.
    pub fn table(&self) -> Table {
        let mut t = Table::new(
            "Inspection: servo current for the steady force on a 300 mm pipe, and what the printed times mean",
            &[
                "ρ %",
                "U(∞) kgcm",
                "current A a servo",
                "four arms min",
                "two arms min",
                "printed min",
                "current that means, A a servo",
                "over stall current",
            ],
        );
        for held in &self.rows {
            t.row([
                num(held.row.infill_percent, 0),
                num(held.force, 2),
                num(held.amps, 2),
                num(self.minutes(held, 4.0), 1),
                num(self.minutes(held, 2.0), 1),
                num(held.row.inspection_min, 1),
                num(held.meant, 2),
                num(held.meant / MG996R.at_stall, 2),
            ]);
        }
        t
    }

    /// Table V's times against servo current.
    pub fn comparisons(&self) -> Vec<Comparison> {
        let row = |held: &Held<'_>| {
            let impossible = held.meant > MG996R.at_stall;
            Comparison {
                what: format!("inspection time, four arms, ρ {} %", held.row.infill_percent),
                unit: "min",
                printed: held.row.inspection_min,
                here: self.minutes(held, 4.0),
                class: if impossible {
                    Class::Inconsistent
                } else {
                    Class::Prediction
                },
                why: if impossible {
                    let beyond = if held.force > kgcm(MG996R.stall) {
                        "; the steady force itself is beyond its stall torque"
                    } else {
                        ""
                    };
                    format!(
                        "the printed time draws more than the stall current of the servo that the paper names{beyond}"
                    )
                } else {
                    "a line from no-load to stall current over torque; the diameter behind the printed times is not given".to_owned()
                },
            }
        };
        self.rows.iter().map(row).collect()
    }

    /// Time over infill.
    pub fn chart(&self) -> Chart {
        let line = |name: &str, colour: usize, look: SeriesStyle, f: &dyn Fn(&Held<'_>) -> f64| {
            let points = self.rows.iter().map(|held| (held.row.infill_percent, f(held)));
            Series::new(name, colour, look, points.collect())
        };
        Chart {
            title: "Inspection time on a 300 mm pipe".to_owned(),
            x: Axis::new("infill ρ (%)"),
            y: Axis::new("time (min)").with(&[0.0]),
            series: vec![
                line("Table V", 0, SeriesStyle::Printed, &|held| {
                    held.row.inspection_min
                }),
                line("four arms", 0, SeriesStyle::Line, &|held| self.minutes(held, 4.0)),
                line("two arms", 1, SeriesStyle::Line, &|held| self.minutes(held, 2.0)),
            ],
            ..Chart::default()
        }
    }
}
