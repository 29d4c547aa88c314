//! Tables V and VI: how long it flies and how long it holds, from stated power models.

use std::f64::consts::PI;

use sophie_control::params::Params;
use sophie_sim::plant::GRAVITY;
use sophie_sim::plant::servo_power::MG996R;
use sophie_sim::plant::tendon::ServoSpec;
use sophie_sim::scenario::ServoProfile;

use super::clamp::{closing_thrust, mean_closing};
use super::model::{Axis, Chart, Class, Comparison, Look, Section, Series, Table, num};
use super::printed::Printed;
use super::statics::root;
use sophie_sim::parallel;

/// Density of air, kg/m³, and radius of a 10-inch propeller, m.
const AIR: f64 = 1.225;
const RADIUS: f64 = 0.127;
/// Shaft power over ideal power, and electric over shaft: figure of merit 0.70, motor and ESC 0.78 (assumed, typical).
const FIGURE_OF_MERIT: f64 = 0.70;
const DRIVE: f64 = 0.78;
/// Electronics, W (assumed), and the share of the charge that is drawn before landing (usual practice).
const ELECTRONICS: f64 = 6.0;
const USABLE: f64 = 0.8;
/// Nominal voltages of the flight battery (4S) and the servo battery (2S), V.
const FLIGHT_VOLTAGE: f64 = 14.8;
/// Pipe of the inspection times, m.
const PIPE: f64 = 0.30;

/// Ideal power of hover, W: four discs, momentum theory, thrusts leaning by `tilt` rad.
fn ideal_power(mass: f64, tilt: f64) -> f64 {
    let thrust = mass * GRAVITY / 4.0 / tilt.cos();
    4.0 * thrust * (thrust / (2.0 * AIR * PI * RADIUS * RADIUS)).sqrt()
}

/// The calibrated model: FT = η E / P(m), m = m0 + slope (ρ - ρ0).
struct Fudge {
    efficiency: f64,
    /// kg per % of infill.
    slope: f64,
}

/// Least squares of the two over rows of Table V by Gauss-Newton in ln FT: ln FT = ln η E - ln P(m).
fn fit(p: &Printed, energy: f64) -> Fudge {
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
    Fudge {
        efficiency: a.exp(),
        slope,
    }
}

/// Endurance.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("table5", "Tables V and VI: endurance");
    let energy = p.text.flight_battery_mah * 3.6 * FLIGHT_VOLTAGE;
    let fudge = fit(p, energy);
    let mass = |infill: f64| p.mass() + fudge.slope * (infill - p.text.infill_percent);
    let fitted = |infill: f64| fudge.efficiency * energy / 60.0 / ideal_power(mass(infill), 0.0);
    let honest = |infill: f64, share: f64| {
        share * energy / 60.0 / (ideal_power(mass(infill), 0.0) / (FIGURE_OF_MERIT * DRIVE) + ELECTRONICS)
    };
    let printed_mass = p
        .table_2
        .iter()
        .take(2)
        .map(|r| r.mass_g * 1e-3 * f64::from(r.count))
        .sum::<f64>();
    let ideal = energy / 60.0 / ideal_power(p.mass(), 0.0);
    s.text(format!(
        "Power of hover: P = 4 T √(T/(2 ρ_air A)) / η, momentum theory for four 10-inch discs; {:.0} W ideal at {:.3} kg. \
         A battery of {:.0} mAh at {FLIGHT_VOLTAGE} V holds {:.1} Wh, so that hover without any loss lasts {ideal:.1} min. \
         Table V is met with η = {:.2} and a mass that grows by {:.0} g for each % of infill ({:.0} g of Table II are \
         printed): the fudge factor. The honest prediction beside it has η = {FIGURE_OF_MERIT} · {DRIVE}, {ELECTRONICS} W of \
         electronics, and lands with a fifth of the charge left.",
        ideal_power(p.mass(), 0.0),
        p.mass(),
        p.text.flight_battery_mah,
        energy / 3600.0,
        fudge.efficiency,
        1e3 * fudge.slope,
        1e3 * printed_mass
    ));
    let mut rows = vec![];
    for row in &p.table_5 {
        let flown = row.infill_percent >= p.text.flyable_infill_percent;
        rows.push(Comparison {
            what: format!("flight time at ρ {} %, fudged", row.infill_percent),
            unit: "min",
            printed: row.flight_min,
            here: fitted(row.infill_percent),
            class: if flown { Class::Calibrated } else { Class::Inconsistent },
            why: if flown {
                format!("η {:.2} and {:.0} g/% by least squares over the rows from 6 % on", fudge.efficiency, 1e3 * fudge.slope)
            } else {
                "the paper says that large deflections cost thrust; level at half throttle, the arms lean by 2° in hover and \
                 cost nothing"
                    .to_owned()
            },
        });
    }
    for row in &p.table_5 {
        rows.push(Comparison {
            what: format!("flight time at ρ {} %, honest", row.infill_percent),
            unit: "min",
            printed: row.flight_min,
            here: honest(row.infill_percent, USABLE),
            class: Class::Prediction,
            why: "usual losses; the printed times need an efficiency of about one from battery to air"
                .to_owned(),
        });
    }
    s.compare("Table V: flight time", rows);
    lean_at_four_percent(&mut s, p, &fitted);
    let inspection = inspection(&mut s, p);
    table_6(&mut s, p);

    let infills: Vec<f64> = (40..=100).map(|i| 0.1 * f64::from(i)).collect();
    let line = |f: &dyn Fn(f64) -> f64| infills.iter().map(|i| (*i, f(*i))).collect::<Vec<_>>();
    s.figure(
        "Flight time over infill: printed, fudged, honest; inspection time by the current of an MG996R at 6 V and as printed.",
        vec![
            Chart {
                title: "Flight time".to_owned(),
                x: Axis::new("infill ρ (%)"),
                y: Axis::new("hover time (min)").with(&[0.0]),
                series: vec![
                    Series::new(
                        "Table V",
                        0,
                        Look::Printed,
                        p.table_5.iter().map(|r| (r.infill_percent, r.flight_min)).collect(),
                    ),
                    Series::new("fudged (calibrated)", 2, Look::Line, line(&fitted)),
                    Series::new("no loss at all", 7, Look::Dashed, line(&|i| energy / 60.0 / ideal_power(mass(i), 0.0))),
                    Series::new("honest, to the last drop", 0, Look::Dashed, line(&|i| honest(i, 1.0))),
                    Series::new("honest, landing with a fifth left", 0, Look::Line, line(&|i| honest(i, USABLE))),
                ],
                ..Chart::default()
            },
            inspection,
        ],
    );
    s.finding = format!(
        "The printed flight times need {:.0} % of the battery's energy to reach the air; with usual losses it is {:.1} min at \
         ρ {} % where Table V's neighbours print {:.1} and {:.1}. Inspection times follow the steady force, but those \
         printed draw up to {:.1} A a servo, where an MG996R stalls at {:.1} A.",
        100.0 * fudge.efficiency,
        honest(p.text.infill_percent, USABLE),
        p.text.infill_percent,
        p.table_5.get(1).map_or(f64::NAN, |r| r.flight_min),
        p.table_5.get(2).map_or(f64::NAN, |r| r.flight_min),
        p.table_5
            .iter()
            .map(|r| current(p, r.inspection_min))
            .fold(0.0, f64::max),
        MG996R.at_stall
    );
    s
}

/// Current of one of four servos that empties the servo battery in `minutes`, A.
fn current(p: &Printed, minutes: f64) -> f64 {
    p.text.servo_battery_mah * 1e-3 / (minutes / 60.0) / 4.0
}

/// What tilt would explain the 10.7 min at 4 %.
fn lean_at_four_percent(s: &mut Section, p: &Printed, fitted: &impl Fn(f64) -> f64) {
    let Some(row) = p.table_5.first() else { return };
    let share = row.flight_min / fitted(row.infill_percent);
    // Time goes with cos^1.5 of the lean.
    let lean = share.powf(2.0 / 3.0).acos().to_degrees();
    let k = f64::from(Params::default().gain_k);
    // α0 = 0: the arm's tilt at the thrust that it then needs.
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

fn inspection(s: &mut Section, p: &Printed) -> Chart {
    let (stall, at_stall) = (sophie_report::units::kgcm(MG996R.stall), MG996R.at_stall);
    let drawn = |force: f64| MG996R.at(force / stall * MG996R.stall);
    let capacity = p.text.servo_battery_mah * 1e-3;
    let infills: Vec<f64> = p.table_5.iter().map(|r| r.infill_percent).collect();
    let servo = ServoSpec::from(ServoProfile::Paper);
    let forces = parallel::each(&infills, |i| {
        let closed = mean_closing(*i, PIPE, servo, closing_thrust(p));
        closed
            .closure
            .map_or(f64::NAN, |_| sophie_report::units::kgcm(closed.steady))
    });
    let minutes = |force: f64, arms: f64| 60.0 * capacity / (arms * drawn(force));
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
    let mut rows = vec![];
    for (row, force) in p.table_5.iter().zip(&forces) {
        let amps = drawn(*force);
        let meant = current(p, row.inspection_min);
        t.row([
            num(row.infill_percent, 0),
            num(*force, 2),
            num(amps, 2),
            num(minutes(*force, 4.0), 1),
            num(minutes(*force, 2.0), 1),
            num(row.inspection_min, 1),
            num(meant, 2),
            num(meant / at_stall, 2),
        ]);
        rows.push(Comparison {
            what: format!("inspection time, four arms, ρ {} %", row.infill_percent),
            unit: "min",
            printed: row.inspection_min,
            here: minutes(*force, 4.0),
            class: if meant > at_stall { Class::Inconsistent } else { Class::Prediction },
            why: if meant > at_stall {
                let beyond = if *force > stall { "; the steady force itself is beyond its stall torque" } else { "" };
                format!("the printed time draws more than the stall current of the servo that the paper names{beyond}")
            } else {
                "a line from no-load to stall current over torque; the diameter behind the printed times is not given".to_owned()
            },
        });
    }
    s.table(t);
    s.compare("Table V: inspection time", rows);
    let rows = |f: &dyn Fn(usize) -> f64| {
        infills
            .iter()
            .enumerate()
            .map(|(i, infill)| (*infill, f(i)))
            .collect::<Vec<_>>()
    };
    let of = |arms: f64| rows(&|i| forces.get(i).map_or(f64::NAN, |f| minutes(*f, arms)));
    Chart {
        title: "Inspection time on a 300 mm pipe".to_owned(),
        x: Axis::new("infill ρ (%)"),
        y: Axis::new("time (min)").with(&[0.0]),
        series: vec![
            Series::new(
                "Table V",
                0,
                Look::Printed,
                rows(&|i| p.table_5.get(i).map_or(f64::NAN, |r| r.inspection_min)),
            ),
            Series::new("four arms", 0, Look::Line, of(4.0)),
            Series::new("two arms", 1, Look::Line, of(2.0)),
        ],
        ..Chart::default()
    }
}

/// Table VI as printed, with Table V below it.
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

/// Table VI against Table V and the text.
fn table_6(s: &mut Section, p: &Printed) {
    s.table(printed_robots(p));
    let (Some(sophie), Some(semi), Some(mhyro)) = (p.table_6.first(), p.table_6.get(1), p.table_6.get(2))
    else {
        return;
    };
    // Table V at the infill of the prototype, on the line between its neighbours.
    let between = |f: &dyn Fn(&super::printed::Endurance) -> f64| {
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
