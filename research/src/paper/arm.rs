//! Eq. 1 and Table I: tilt over thrust, and the K that Table III implies.

use sophie_control::allocation::arm_deflection::ArmModel;
use sophie_control::params::Params;

use super::printed::{Printed, Roll, Table1};
use crate::results::model::{Axis, Chart, Class, Comparison, Section, Series, SeriesStyle, Table, num};

/// %.
pub const INFILLS: [f64; 6] = [4.0, 5.0, 6.0, 6.9, 8.0, 10.0];

/// Literal coefficients of Eq. 1 at an infill (%): linear (°/N), quadratic (°/N²).
pub fn literal(t: &Table1, infill: f64) -> (f64, f64) {
    (t.a1 + infill * t.a2, t.b1 + infill * t.b2)
}

/// The two thrusts behind Table III: X = K (T1 - T3) and S = T1 + T3.
#[derive(Clone, Copy, Debug)]
pub struct Identified {
    /// K (T1 - T3), N.
    pub product: f64,
    /// T1 + T3, N.
    pub sum: f64,
}

/// Least squares of Δα = X ((A1 + ρA2) + (B1 + ρB2) S) over Table III, linear in X and X S.
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

struct Flown<'a> {
    printed: &'a Printed,
    k: f64,
    /// Largest thrust of a rotor, N; the arm is level at half.
    top: f64,
    identified: Identified,
}

impl<'a> Flown<'a> {
    fn new(printed: &'a Printed) -> Self {
        let d = Params::default();
        Self {
            printed,
            k: f64::from(d.gain_k),
            top: f64::from(d.thrust_max),
            identified: identify(printed),
        }
    }

    /// Gains that Table III allows: from T3 = 0, and from ΔT/(T1 + T3) as in the text.
    fn allowed(&self) -> (f64, f64) {
        let id = &self.identified;
        let share = self.printed.text.delta_thrust_share;
        (id.product / id.sum, id.product / (share * id.sum))
    }

    /// Gain of "α < 40° for ρ > 5 %", α0 = 0, at the largest thrust.
    fn gain_of_limit(&self) -> f64 {
        self.printed.eq_1.valid_tilt_deg / self.most_elastic(self.printed.eq_1.valid_infill_percent)
    }

    /// Largest literal bending, degrees.
    fn most_elastic(&self, infill: f64) -> f64 {
        let bent = self.thrusts().map(|t| elastic(self.printed, infill, t));
        bent.fold(0.0, f64::max)
    }

    /// N.
    fn thrusts(&self) -> impl Iterator<Item = f64> + use<> {
        let top = self.top;
        (0..=166).map(move |i| f64::from(i) * top / 166.0)
    }

    fn model(&self, infill: f64, k: f64) -> ArmModel {
        ArmModel::new(infill as f32, k as f32, (0.5 * self.top) as f32)
    }

    /// Degrees; `thrust` in N.
    fn tilt(&self, infill: f64, k: f64, thrust: f64) -> f64 {
        f64::from(self.model(infill, k).angle(thrust as f32)).to_degrees()
    }

    /// `f` (degrees) over the thrusts.
    fn curve(&self, name: String, colour: usize, look: SeriesStyle, f: impl Fn(f64) -> f64) -> Series {
        Series::new(name, colour, look, self.thrusts().map(|t| (t, f(t))).collect())
    }

    fn chart(title: String, series: Vec<Series>) -> Chart {
        Chart {
            title,
            x: Axis::new("thrust of the rotor (N)"),
            y: Axis::new("arm tilt α (°, tip up positive)"),
            series,
            ..Chart::default()
        }
    }
}

/// Eq. 1 and Table I.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("eq1", "Eq. 1 and Table I: the arm");
    let flown = Flown::new(p);
    s.finding = finding(&flown);
    s.text(what_the_gain_rests_on(&flown));
    let mut rows = calibrated(&flown);
    rows.extend(literal_rows(&flown));
    s.compare("Table III's Δα_max from Eq. 1", rows);
    s.figure(
        "Left to right, top to bottom: the arm as flown; the same with a weak battery (solid C_P 1.6, dashed 1.8); the \
         family of gains that Table III allows; what Table III fixes: the three printed differences lie on one value of \
         K (T1 - T3), whatever K.",
        vec![over_infill(&flown), over_battery(&flown), over_gain(&flown), what_table_3_identifies(&flown)],
    );
    s.table(table(&flown));
    s.text(format!(
        "The parabola of Eq. 1 turns down within the rotor's range at ρ 4 % and little above it at 6 %: more thrust would \
         then bend the arm less. Nothing measured stands behind that; the plant goes on straight from where the compliance \
         has fallen to 15 %. At ρ {:.1} % the linear coefficient vanishes: Table I does not extrapolate.",
        -p.table_1.a1 / p.table_1.a2
    ));
    s
}

fn finding(flown: &Flown<'_>) -> String {
    let (p, id, k) = (flown.printed, &flown.identified, flown.k);
    let literal_top = flown.most_elastic(6.0);
    let (k_least, k_most) = flown.allowed();
    format!(
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
    )
}

fn what_the_gain_rests_on(flown: &Flown<'_>) -> String {
    let Flown {
        printed: p, k, top, ..
    } = *flown;
    let k_from_limit = flown.gain_of_limit();
    format!(
        "What K rests on: three numbers of Table III, fitted by two (X = K (T1 - T3) and T1 + T3), so one check is left. \
         Only the product with the thrust difference is seen, never K itself. A second, independent hint: the text says \
         α < {:.0}° for ρ > {:.0} %; with α0 = 0 and {top:.1} N that means K = {k_from_limit:.1}. α0 is not printed: it is \
         set so that the arm is level at half throttle ({:.2} N), which is what \"positive when T > 50 %\" asks for. \
         These two readings of α0 exclude each other: level at half throttle, an arm of 5 % never passes {:.0}°.",
        p.eq_1.valid_tilt_deg,
        p.eq_1.valid_infill_percent,
        0.5 * top,
        flown
            .thrusts()
            .map(|t| flown.tilt(p.eq_1.valid_infill_percent, k, t))
            .fold(0.0, f64::max),
    )
}

/// At the flown gain, N.
fn thrusts_of_table_3(flown: &Flown<'_>) -> (f64, f64) {
    let id = &flown.identified;
    let difference = id.product / flown.k;
    (0.5 * (id.sum + difference), 0.5 * (id.sum - difference))
}

fn calibrated(flown: &Flown<'_>) -> Vec<Comparison> {
    let (t1, t3) = thrusts_of_table_3(flown);
    let k = flown.k;
    let row = |row: &Roll| Comparison {
        what: format!("Δα_max at ρ {} %", row.infill_percent),
        unit: "°",
        printed: row.delta_alpha_max_deg,
        here: flown.tilt(row.infill_percent, k, t1) - flown.tilt(row.infill_percent, k, t3),
        class: Class::Calibrated,
        why: format!("T1 {t1:.2} N and T3 {t3:.2} N by least squares over the three rows, K {k}"),
    };
    flown.printed.table_3.iter().map(row).collect()
}

fn literal_rows(flown: &Flown<'_>) -> Vec<Comparison> {
    let (t1, t3) = thrusts_of_table_3(flown);
    let row = |row: &Roll| {
        Comparison {
        what: format!("the same, K = 1, ρ {} %", row.infill_percent),
        unit: "°",
        printed: row.delta_alpha_max_deg,
        here: flown.tilt(row.infill_percent, 1.0, t1) - flown.tilt(row.infill_percent, 1.0, t3),
        class: Class::Inconsistent,
        why: "Eq. 1 with the coefficients of Table I as printed, in degrees and newtons, bends the arms eight times \
              less than Table III says"
            .to_owned(),
    }
    };
    flown.printed.table_3.iter().map(row).collect()
}

fn over_infill(flown: &Flown<'_>) -> Chart {
    let k = flown.k;
    let line = |(i, infill): (usize, f64)| {
        flown.curve(format!("ρ {infill} %"), i, SeriesStyle::Line, |t| {
            flown.tilt(infill, k, t)
        })
    };
    let series = INFILLS.into_iter().enumerate().map(line).collect();
    let limit = (
        flown.printed.eq_1.valid_tilt_deg,
        "paper: model valid to 40°".to_owned(),
    );
    Chart {
        levels: vec![limit],
        ..Flown::chart(format!("Eq. 1 over infill, K {k}"), series)
    }
}

fn over_battery(flown: &Flown<'_>) -> Chart {
    let (p, k) = (flown.printed, flown.k);
    let infill = p.text.infill_percent;
    let arm = flown.model(infill, k);
    let mut series = vec![];
    for (colour, ratio) in [1.0, 0.9, 0.8].into_iter().enumerate() {
        for (c_p, look) in p
            .eq_1
            .power_exponent
            .iter()
            .zip([SeriesStyle::Line, SeriesStyle::Dashed])
        {
            let factor = f64::powf(ratio, *c_p);
            let name = format!("P/P0 {ratio}, C_P {c_p}");
            series.push(flown.curve(name, colour, look, |t| {
                f64::from(arm.offset + arm.elastic(t as f32) * factor as f32).to_degrees()
            }));
        }
    }
    Flown::chart(format!("Eq. 1 over battery power, ρ {infill} %, K {k}"), series)
}

fn over_gain(flown: &Flown<'_>) -> Chart {
    let infill = flown.printed.text.infill_percent;
    let (k_least, k_most) = flown.allowed();
    let line = |(i, k): (usize, f64)| {
        flown.curve(format!("K {k:.2}"), i, SeriesStyle::Line, |t| {
            flown.tilt(infill, k, t)
        })
    };
    let gains = [k_least, 6.7, flown.k, k_most];
    let mut series: Vec<Series> = gains.into_iter().enumerate().map(line).collect();
    series.push(
        flown.curve("K 1 (literal)".to_owned(), 7, SeriesStyle::Dashed, |t| {
            flown.tilt(infill, 1.0, t)
        }),
    );
    Flown::chart(format!("The family of K at ρ {infill} %"), series)
}

fn what_table_3_identifies(flown: &Flown<'_>) -> Chart {
    let (p, id) = (flown.printed, &flown.identified);
    let products: Vec<f64> = (0..=80).map(f64::from).collect();
    let mut series = vec![];
    for (i, row) in p.table_3.iter().enumerate() {
        let (a, b) = literal(&p.table_1, row.infill_percent);
        let per_product = a + b * id.sum;
        series.push(Series::new(
            format!("ρ {} %", row.infill_percent),
            i,
            SeriesStyle::Line,
            products.iter().map(|x| (*x, x * per_product)).collect(),
        ));
        series.push(Series::new(
            if i == 0 { "Table III" } else { "" },
            i,
            SeriesStyle::Printed,
            vec![(id.product, row.delta_alpha_max_deg)],
        ));
    }
    Chart {
        title: "What Table III identifies".to_owned(),
        x: Axis::new("K (T1 - T3) (N)"),
        y: Axis::new("difference of tilt Δα (°)"),
        series,
        ..Chart::default()
    }
}

fn table(flown: &Flown<'_>) -> Table {
    let Flown {
        printed: p, k, top, ..
    } = *flown;
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
            num(flown.tilt(infill, k, 0.0), 1),
            num(flown.tilt(infill, k, hover), 1),
            num(flown.tilt(infill, k, top), 1),
            num(-a / (2.0 * b), 1),
        ]);
    }
    t
}

/// Eq. 1's literal elastic part, degrees.
fn elastic(p: &Printed, infill: f64, thrust: f64) -> f64 {
    let (a, b) = literal(&p.table_1, infill);
    (a + b * thrust) * thrust
}
