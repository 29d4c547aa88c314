//! Eq. 1 and Table I: the arm's tilt over thrust, and the gain K that the paper's own Table III asks for.

use sophie_control::deflection::ArmModel;
use sophie_control::params::Params;

use super::model::{Axis, Chart, Class, Comparison, Look, Section, Series, Table, num};
use super::printed::{Printed, Table1};

/// Infills that are drawn, %.
pub const INFILLS: [f64; 6] = [4.0, 5.0, 6.0, 6.9, 8.0, 10.0];

/// Eq. 1's linear (°/N) and quadratic (°/N²) coefficient at an infill (%), literally.
pub fn literal(t: &Table1, infill: f64) -> (f64, f64) {
    (t.a1 + infill * t.a2, t.b1 + infill * t.b2)
}

/// What Table III says of the two thrusts behind it: X = K (T1 - T3) and S = T1 + T3.
#[derive(Clone, Copy, Debug)]
pub struct Identified {
    /// K (T1 - T3), N.
    pub product: f64,
    /// T1 + T3, N.
    pub sum: f64,
}

/// Least squares of Δα = X ((A1 + ρA2) + (B1 + ρB2) S) over Table III: linear in X and X S.
pub fn identify(p: &Printed) -> Identified {
    let (mut aa, mut ab, mut bb, mut ay, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for row in &p.table_3 {
        let (a, b) = literal(&p.table_1, row.infill_percent);
        let y = row.delta_alpha_max_deg;
        aa += a * a;
        ab += a * b;
        bb += b * b;
        ay += a * y;
        by += b * y;
    }
    let det = aa * bb - ab * ab;
    let product = (ay * bb - by * ab) / det;
    Identified {
        product,
        sum: (by * aa - ay * ab) / det / product,
    }
}

/// Eq. 1 and Table I.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("eq1", "Eq. 1 and Table I: the arm");
    let d = Params::default();
    let k = f64::from(d.gain_k);
    let (half, top) = (0.5 * f64::from(d.thrust_max), f64::from(d.thrust_max));
    let id = identify(p);
    let thrusts: Vec<f64> = (0..=166).map(|i| f64::from(i) * top / 166.0).collect();
    let model = |infill: f64, k: f64| ArmModel::new(infill as f32, k as f32, half as f32);
    let tilt = |infill: f64, k: f64, t: f64| f64::from(model(infill, k).angle(t as f32)).to_degrees();

    let literal_top = thrusts.iter().map(|t| elastic(p, 6.0, *t)).fold(0.0, f64::max);
    let share = p.text.delta_thrust_share;
    let (k_least, k_most) = (id.product / id.sum, id.product / (share * id.sum));
    // "α < 40° for ρ > 5 %", read with α0 = 0 at the largest thrust.
    let k_from_limit = p.eq_1.valid_tilt_deg
        / thrusts
            .iter()
            .map(|t| elastic(p, p.eq_1.valid_infill_percent, *t))
            .fold(0.0, f64::max);
    s.finding = format!(
        "Taken literally (K = 1) Eq. 1 bends an arm of 6 % by at most {literal_top:.1}°; Table III prints differences of \
         up to {:.1}° between arms. A gain K on the elastic term mends it: all three rows follow from K (T1 - T3) = \
         {:.1} N and T1 + T3 = {:.2} N, so K lies between {k_least:.1} (T3 = 0) and {k_most:.1} (ΔT/(T1+T3) = 3/5). The \
         stack flies K = {k}.",
        p.table_3
            .iter()
            .map(|r| r.delta_alpha_max_deg)
            .fold(0.0, f64::max),
        id.product,
        id.sum
    );
    s.text(format!(
        "What K rests on: three numbers of Table III, fitted by two (X = K (T1 - T3) and T1 + T3), so one check is left. \
         Only the product with the thrust difference is seen, never K itself. A second, independent hint: the text says \
         α < {:.0}° for ρ > {:.0} %; with α0 = 0 and {top:.1} N that means K = {k_from_limit:.1}. α0 is not printed: it is \
         set so that the arm is level at half throttle ({half:.2} N), which is what \"positive when T > 50 %\" asks for. \
         These two readings of α0 exclude each other: level at half throttle, an arm of 5 % never passes {:.0}°.",
        p.eq_1.valid_tilt_deg,
        p.eq_1.valid_infill_percent,
        thrusts.iter().map(|t| tilt(p.eq_1.valid_infill_percent, k, *t)).fold(0.0, f64::max),
    ));

    let mut rows = vec![];
    // The two thrusts behind the table, at the gain that is flown.
    let difference = id.product / k;
    let (t1, t3) = (0.5 * (id.sum + difference), 0.5 * (id.sum - difference));
    for row in &p.table_3 {
        rows.push(Comparison {
            what: format!("Δα_max at ρ {} %", row.infill_percent),
            unit: "°",
            printed: row.delta_alpha_max_deg,
            here: tilt(row.infill_percent, k, t1) - tilt(row.infill_percent, k, t3),
            class: Class::Calibrated,
            why: format!("T1 {t1:.2} N and T3 {t3:.2} N by least squares over the three rows, K {k}"),
        });
    }
    for row in &p.table_3 {
        rows.push(Comparison {
            what: format!("the same, K = 1, ρ {} %", row.infill_percent),
            unit: "°",
            printed: row.delta_alpha_max_deg,
            here: tilt(row.infill_percent, 1.0, t1) - tilt(row.infill_percent, 1.0, t3),
            class: Class::Inconsistent,
            why: "Eq. 1 with the coefficients of Table I as printed, in degrees and newtons, bends the arms eight times \
                  less than Table III says"
                .to_owned(),
        });
    }
    s.compare("Table III's Δα_max from Eq. 1", rows);

    let curve = |name: String, colour: usize, look: Look, f: &dyn Fn(f64) -> f64| {
        Series::new(name, colour, look, thrusts.iter().map(|t| (*t, f(*t))).collect())
    };
    let over_rho = |k: f64| {
        INFILLS
            .iter()
            .enumerate()
            .map(|(i, infill)| curve(format!("ρ {infill} %"), i, Look::Line, &|t| tilt(*infill, k, t)))
            .collect::<Vec<_>>()
    };
    let limit = (p.eq_1.valid_tilt_deg, "paper: model valid to 40°".to_owned());
    let chart = |title: String, series: Vec<Series>| Chart {
        title,
        x: Axis::new("thrust of the rotor (N)"),
        y: Axis::new("arm tilt α (°, tip up positive)"),
        series,
        ..Chart::default()
    };
    let battery: Vec<Series> = [(1.0, 0), (0.9, 1), (0.8, 2)]
        .iter()
        .flat_map(|(ratio, colour)| {
            p.eq_1
                .power_exponent
                .iter()
                .zip([Look::Line, Look::Dashed])
                .map(move |(c_p, look)| {
                    let factor = f64::powf(*ratio, *c_p);
                    (*ratio, *colour, *c_p, look, factor)
                })
        })
        .map(|(ratio, colour, c_p, look, factor)| {
            let m = model(p.text.infill_percent, k);
            let name = format!("P/P0 {ratio}, C_P {c_p}");
            curve(name, colour, look, &|t| {
                f64::from(m.offset + m.elastic(t as f32) * factor as f32).to_degrees()
            })
        })
        .collect();
    let family: Vec<Series> = [k_least, 6.7, k, k_most]
        .iter()
        .enumerate()
        .map(|(i, k)| {
            curve(format!("K {k:.2}"), i, Look::Line, &|t| {
                tilt(p.text.infill_percent, *k, t)
            })
        })
        .chain([curve("K 1 (literal)".to_owned(), 7, Look::Dashed, &|t| {
            tilt(p.text.infill_percent, 1.0, t)
        })])
        .collect();
    let products: Vec<f64> = (0..=80).map(f64::from).collect();
    let table_3: Vec<Series> = p
        .table_3
        .iter()
        .enumerate()
        .flat_map(|(i, row)| {
            let (a, b) = literal(&p.table_1, row.infill_percent);
            let per_product = a + b * id.sum;
            [
                Series::new(
                    format!("ρ {} %", row.infill_percent),
                    i,
                    Look::Line,
                    products.iter().map(|x| (*x, x * per_product)).collect(),
                ),
                Series::new(
                    if i == 0 { "Table III" } else { "" },
                    i,
                    Look::Printed,
                    vec![(id.product, row.delta_alpha_max_deg)],
                ),
            ]
        })
        .collect();
    s.figure(
        "Left to right, top to bottom: the arm as flown; the same with a weak battery (solid C_P 1.6, dashed 1.8); the \
         family of gains that Table III allows; what Table III fixes: the three printed differences lie on one value of \
         K (T1 - T3), whatever K.",
        vec![
            Chart { levels: vec![limit], ..chart(format!("Eq. 1 over infill, K {k}"), over_rho(k)) },
            chart(format!("Eq. 1 over battery power, ρ {} %, K {k}", p.text.infill_percent), battery),
            chart(format!("The family of K at ρ {} %", p.text.infill_percent), family),
            Chart {
                title: "What Table III identifies".to_owned(),
                x: Axis::new("K (T1 - T3) (N)"),
                y: Axis::new("difference of tilt Δα (°)"),
                series: table_3,
                ..Chart::default()
            },
        ],
    );

    let mut t = Table::new(
        "Eq. 1 over infill, as flown",
        &[
            "ρ %",
            "slope at hover °/N",
            "α idle °",
            "α hover °",
            "α at 8.3 N °",
            "thrust where α turns down N",
        ],
    );
    for infill in INFILLS {
        let (a, b) = literal(&p.table_1, infill);
        let hover = p.mass() * 9.806_65 / 4.0;
        t.row([
            num(infill, 1),
            num(k * (a + 2.0 * b * hover), 2),
            num(tilt(infill, k, 0.0), 1),
            num(tilt(infill, k, hover), 1),
            num(tilt(infill, k, top), 1),
            num(-a / (2.0 * b), 1),
        ]);
    }
    s.table(t);
    s.text(format!(
        "The parabola of Eq. 1 turns down within the rotor's range at ρ 4 % and little above it at 6 %: more thrust would \
         then bend the arm less. Nothing measured stands behind that; the plant goes on straight from where the compliance \
         has fallen to 15 %. At ρ {:.1} % the linear coefficient vanishes: Table I does not extrapolate.",
        -p.table_1.a1 / p.table_1.a2
    ));
    s
}

/// Eq. 1's elastic part, literally, degrees.
fn elastic(p: &Printed, infill: f64, thrust: f64) -> f64 {
    let (a, b) = literal(&p.table_1, infill);
    (a + b * thrust) * thrust
}
