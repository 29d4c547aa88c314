//! Tables V and VI: flight and holding time from stated power models.

use std::f64::consts::PI;

use sophie_control::params::Params;
use sophie_sim::plant::GRAVITY;
use sophie_sim::plant::servo_power::MG996R;

use super::inspection::{Inspection, current};
use super::printed::{Endurance, Printed};
use super::statics::root;
use crate::results::model::{Axis, Chart, Class, Comparison, Section, Series, SeriesStyle, Table, num};

/// Air density, kg/m³, and radius of a 10-inch propeller, m.
const AIR: f64 = 1.225;
const RADIUS: f64 = 0.127;
/// Figure of merit 0.70 and efficiency of motor and ESC 0.78 (assumed, typical).
const FIGURE_OF_MERIT: f64 = 0.70;
const DRIVE: f64 = 0.78;
/// Electronics, W (assumed), and usable share of the charge (usual practice).
const ELECTRONICS: f64 = 6.0;
const USABLE: f64 = 0.8;
/// 4S flight battery and 2S servo battery, V.
const FLIGHT_VOLTAGE: f64 = 14.8;
/// Ideal hover power, W: four discs, momentum theory, thrusts leaning by `tilt` rad.
fn ideal_power(mass: f64, tilt: f64) -> f64 {
    let thrust = mass * GRAVITY / 4.0 / tilt.cos();
    4.0 * thrust * (thrust / (2.0 * AIR * PI * RADIUS * RADIUS)).sqrt()
}

/// FT = η E / P(m), m = m0 + slope (ρ - ρ0).
struct Correction {
    efficiency: f64,
    /// kg per % of infill.
    slope: f64,
}

/// Gauss-Newton in ln FT over rows of Table V: ln FT = ln η E - ln P(m).
fn fit(p: &Printed, energy: f64) -> Correction {
    let rows: Vec<_> = p
        .table_5
        .iter()
        .filter(|r| r.infill_percent >= p.text.flyable_infill_percent)
        .collect();
    let (mut a, mut slope) = (0.0_f64, 0.03);
    for _ in 0..20 {
        let (mut aa, mut ab, mut bb, mut ar, mut br) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for row in &rows {
            let x = row.infill_percent - p.text.infill_percent;
            let mass = p.mass() + slope * x;
            let model = a + (energy / 60.0 / ideal_power(mass, 0.0)).ln();
            // d ln FT / d ln η = 1, d ln FT / d slope = -1.5 x / m.
            let (da, db, r) = (1.0, -1.5 * x / mass, row.flight_min.ln() - model);
            aa += da * da;
            ab += da * db;
            bb += db * db;
            ar += da * r;
            br += db * r;
        }
        let det = aa * bb - ab * ab;
        a += (ar * bb - br * ab) / det;
        slope += (br * aa - ar * ab) / det;
    }
    Correction {
        efficiency: a.exp(),
        slope,
    }
}

struct Flight<'a> {
    printed: &'a Printed,
    /// J.
    energy: f64,
    correction: Correction,
}

impl<'a> Flight<'a> {
    fn new(printed: &'a Printed) -> Self {
        let energy = printed.text.flight_battery_mah * 3.6 * FLIGHT_VOLTAGE;
        Self {
            printed,
            energy,
            correction: fit(printed, energy),
        }
    }

    /// Ideal, W, with the calibrated mass.
    fn power(&self, infill: f64) -> f64 {
        let mass = self.printed.mass() + self.correction.slope * (infill - self.printed.text.infill_percent);
        ideal_power(mass, 0.0)
    }

    /// Without losses, min.
    fn ideal(&self, infill: f64) -> f64 {
        self.energy / 60.0 / self.power(infill)
    }

    /// min.
    fn fitted(&self, infill: f64) -> f64 {
        self.correction.efficiency * self.energy / 60.0 / self.power(infill)
    }

    /// With usual losses on `share` of the charge, min.
    fn honest(&self, infill: f64, share: f64) -> f64 {
        share * self.energy / 60.0 / (self.power(infill) / (FIGURE_OF_MERIT * DRIVE) + ELECTRONICS)
    }
}

/// Endurance.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("table5", "Tables V and VI: endurance");
    let flight = Flight::new(p);
    s.text(power_of_hover(&flight));
    let mut rows = calibrated(&flight);
    rows.extend(predicted(&flight));
    s.compare("Table V: flight time", rows);
    lean_at_four_percent(&mut s, &flight);
    let inspection = Inspection::new(p);
    s.table(inspection.table());
    s.compare("Table V: inspection time", inspection.comparisons());
    table_6(&mut s, p);
    s.figure(
        "Flight time over infill: printed, fudged, honest; inspection time by the current of an MG996R at 6 V and as printed.",
        vec![flight_chart(&flight), inspection.chart()],
    );
    s.finding = finding(&flight);
    s
}

fn power_of_hover(flight: &Flight<'_>) -> String {
    let Flight {
        printed: p,
        energy,
        correction,
    } = flight;
    let printed_mass = p
        .table_2
        .iter()
        .take(2)
        .map(|r| r.mass_g * 1e-3 * f64::from(r.count))
        .sum::<f64>();
    let ideal = energy / 60.0 / ideal_power(p.mass(), 0.0);
    format!(
        "Power of hover: P = 4 T √(T/(2 ρ_air A)) / η, momentum theory for four 10-inch discs; {:.0} W ideal at {:.3} kg. \
         A battery of {:.0} mAh at {FLIGHT_VOLTAGE} V holds {:.1} Wh, so that hover without any loss lasts {ideal:.1} min. \
         Table V is met with η = {:.2} and a mass that grows by {:.0} g for each % of infill ({:.0} g of Table II are \
         printed): the correction factor. The honest prediction beside it has η = {FIGURE_OF_MERIT} · {DRIVE}, {ELECTRONICS} W of \
         electronics, and lands with a fifth of the charge left.",
        ideal_power(p.mass(), 0.0),
        p.mass(),
        p.text.flight_battery_mah,
        energy / 3600.0,
        correction.efficiency,
        1e3 * correction.slope,
        1e3 * printed_mass
    )
}

fn calibrated(flight: &Flight<'_>) -> Vec<Comparison> {
    let Flight {
        printed: p,
        correction,
        ..
    } = flight;
    let row = |row: &Endurance| {
        let flown = row.infill_percent >= p.text.flyable_infill_percent;
        Comparison {
            what: format!("flight time at ρ {} %, fudged", row.infill_percent),
            unit: "min",
            printed: row.flight_min,
            here: flight.fitted(row.infill_percent),
            class: if flown {
                Class::Calibrated
            } else {
                Class::Inconsistent
            },
            why: if flown {
                format!(
                    "η {:.2} and {:.0} g/% by least squares over the rows from 6 % on",
                    correction.efficiency,
                    1e3 * correction.slope
                )
            } else {
                "the paper says that large deflections cost thrust; level at half throttle, the arms lean by 2° in hover and \
                 cost nothing"
                    .to_owned()
            },
        }
    };
    p.table_5.iter().map(row).collect()
}

/// With usual losses.
fn predicted(flight: &Flight<'_>) -> Vec<Comparison> {
    let row = |row: &Endurance| Comparison {
        what: format!("flight time at ρ {} %, honest", row.infill_percent),
        unit: "min",
        printed: row.flight_min,
        here: flight.honest(row.infill_percent, USABLE),
        class: Class::Prediction,
        why: "usual losses; the printed times need an efficiency of about one from battery to air".to_owned(),
    };
    flight.printed.table_5.iter().map(row).collect()
}

fn flight_chart(flight: &Flight<'_>) -> Chart {
    let infills: Vec<f64> = (40..=100).map(|i| 0.1 * f64::from(i)).collect();
    let line = |name: &str, colour: usize, look: SeriesStyle, f: &dyn Fn(f64) -> f64| {
        Series::new(name, colour, look, infills.iter().map(|i| (*i, f(*i))).collect())
    };
    let table_5 = flight.printed.table_5.iter();
    let printed = table_5.map(|r| (r.infill_percent, r.flight_min)).collect();
    Chart {
        title: "Flight time".to_owned(),
        x: Axis::new("infill ρ (%)"),
        y: Axis::new("hover time (min)").with(&[0.0]),
        series: vec![
            Series::new("Table V", 0, SeriesStyle::Printed, printed),
            line("fudged (calibrated)", 2, SeriesStyle::Line, &|i| flight.fitted(i)),
            line("no loss at all", 7, SeriesStyle::Dashed, &|i| flight.ideal(i)),
            line("honest, to the last drop", 0, SeriesStyle::Dashed, &|i| {
                flight.honest(i, 1.0)
            }),
            line("honest, landing with a fifth left", 0, SeriesStyle::Line, &|i| {
                flight.honest(i, USABLE)
            }),
        ],
        ..Chart::default()
    }
}

fn finding(flight: &Flight<'_>) -> String {
    let p = flight.printed;
    format!(
        "The printed flight times need {:.0} % of the battery's energy to reach the air; with usual losses it is {:.1} min at \
         ρ {} % where Table V's neighbours print {:.1} and {:.1}. Inspection times follow the steady force, but those \
         printed draw up to {:.1} A a servo, where an MG996R stalls at {:.1} A.",
        100.0 * flight.correction.efficiency,
        flight.honest(p.text.infill_percent, USABLE),
        p.text.infill_percent,
        p.table_5.get(1).map_or(f64::NAN, |r| r.flight_min),
        p.table_5.get(2).map_or(f64::NAN, |r| r.flight_min),
        p.table_5
            .iter()
            .map(|r| current(p, r.inspection_min))
            .fold(0.0, f64::max),
        MG996R.at_stall
    )
}

/// Tilt that would explain the 10.7 min at 4 %.
fn lean_at_four_percent(s: &mut Section, flight: &Flight<'_>) {
    let p = flight.printed;
    let Some(row) = p.table_5.first() else { return };
    let share = row.flight_min / flight.fitted(row.infill_percent);
    // Flight time is proportional to cos^1.5 of the lean.
    let lean = share.powf(2.0 / 3.0).acos().to_degrees();
    let k = f64::from(Params::default().gain_k);
    // α0 = 0: the arm's tilt at the required thrust.
    let droopless = |infill: f64| {
        let (a, b) = super::arm::literal(&p.table_1, infill);
        let tilt = |t: f64| (k * (a + b * t) * t).to_radians();
        let weight = p.mass() * GRAVITY / 4.0;
        root(weight, 8.0, |t| t * tilt(t).cos() - weight).map_or(f64::NAN, |t| tilt(t).to_degrees())
    };
    s.text(format!(
        "At ρ {} % the paper prints {:.2} of what its other rows lead to. A lean costs cos^1.5 α: that would be α = \
         {lean:.0}° in hover. With α0 = 0 instead of level at half throttle, K = {k} gives {:.0}° there, but also {:.0}° at 6 \
         % and {:.0}° at 8 %, which would cost those rows {:.0} and {:.0} % of their time. One α0 does not explain the column.",
        row.infill_percent,
        share,
        droopless(row.infill_percent),
        droopless(6.0),
        droopless(8.0),
        100.0 * (1.0 - droopless(6.0).to_radians().cos().powf(1.5)),
        100.0 * (1.0 - droopless(8.0).to_radians().cos().powf(1.5)),
    ));
}

fn printed_robots(p: &Printed) -> Table {
    let mut t = Table::new(
        "Table VI as printed; specific strength of Tables V and VI is quoted, not computed: it is a material test",
        &[
            "robot",
            "flight min",
            "inspection min",
            "specific strength kNm/kg",
        ],
    );
    for r in &p.table_6 {
        t.row([
            r.robot.as_str().into(),
            num(r.flight_min, 2),
            num(r.inspection_min, 2),
            num(r.strength_knm_per_kg, 2),
        ]);
    }
    for r in &p.table_5 {
        t.row([
            format!("SOPHIE, Table V, ρ {} %", r.infill_percent).into(),
            num(r.flight_min, 2),
            num(r.inspection_min, 2),
            num(r.strength_knm_per_kg, 2),
        ]);
    }
    t
}

fn table_6(s: &mut Section, p: &Printed) {
    s.table(printed_robots(p));
    let (Some(sophie), Some(semi), Some(mhyro)) = (p.table_6.first(), p.table_6.get(1), p.table_6.get(2))
    else {
        return;
    };
    // Table V interpolated at the prototype's infill.
    let between = |f: &dyn Fn(&Endurance) -> f64| {
        let (Some(a), Some(b)) = (p.table_5.get(1), p.table_5.get(2)) else {
            return f64::NAN;
        };
        let x = (p.text.infill_percent - a.infill_percent) / (b.infill_percent - a.infill_percent);
        f(a) + x * (f(b) - f(a))
    };
    let line = |what: &str, unit, printed, here, class, why: &str| Comparison {
        what: what.to_owned(),
        unit,
        printed,
        here,
        class,
        why: why.to_owned(),
    };
    s.compare(
        "Table VI against Table V and the text",
        vec![
            line("flight time at ρ 6.9 % from Table V", "min", sophie.flight_min, between(&|r| r.flight_min),
                Class::Inconsistent, "Table VI's prototype outlasts both neighbours of Table V"),
            line("inspection time at ρ 6.9 % from Table V", "min", sophie.inspection_min, between(&|r| r.inspection_min),
                Class::Prediction, "straight between 6 and 8 %"),
            line("specific strength at ρ 6.9 % from Table V", "kNm/kg", sophie.strength_knm_per_kg,
                between(&|r| r.strength_knm_per_kg), Class::Prediction, "straight between 6 and 8 %; the column curves"),
            line("gain in inspection time over MHYRO", "%", p.text.inspection_gain_percent,
                100.0 * (sophie.inspection_min / mhyro.inspection_min - 1.0), Class::Inconsistent,
                "7.1 over 4.75 min is more than the text claims; 33 % is the share of 7.1 min that MHYRO lacks"),
            line("loss in flight time against the semi-rigid UAV", "%", p.text.efficiency_loss_percent,
                100.0 * (1.0 - sophie.flight_min / semi.flight_min), Class::Inconsistent,
                "16.1 against 16.8 min is less than the text's \"barely exceed 6 %\""),
        ],
    );
}
