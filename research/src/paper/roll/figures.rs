//! Table III's columns over infill, and Fig. 8's manoeuvres over time.

use crate::study::rig::Moment;

use super::super::flights::{curve, delta_alpha};
use super::super::printed::{Printed, Roll};
use super::manoeuvre::{Arms, SECONDS};
use super::{FLEXIBLE_HARD, FLEXIBLE_SOFT, Flights, RIGID_HARD};
use crate::results::model::{Axis, Chart, Section, Series, SeriesStyle};

/// Table III's columns over infill, printed and flown.
pub fn columns(s: &mut Section, p: &Printed, flights: &Flights) {
    let hard = |infill, arms| flights.found(RIGID_HARD, infill, arms);
    let soft = |infill, arms| flights.found(FLEXIBLE_SOFT, infill, arms);
    let column = |title: &str, y: &str, printed: &dyn Fn(&Roll) -> f64, here: &Flown<'_>| Chart {
        title: title.to_owned(),
        x: Axis::new("infill ρ (%)"),
        y: Axis::new(y).with(&[0.0]),
        series: column_series(p, flights.fitted, printed, here),
        ..Chart::default()
    };
    s.figure(
        "Table III against the hard step with the rigid mixer; the ratio is over the stack's own prefiltered command.",
        vec![
            column("Largest difference of tilt", "Δα_max (°)", &|r| r.delta_alpha_max_deg, &|infill, arms| {
                Some(hard(infill, arms)?.delta_alpha.to_degrees())
            }),
            column("κ", "κ, flown by the exact force", &|r| r.kappa, &|infill, arms| Some(hard(infill, arms)?.kappa)),
            column("What a softer command saves", "(φ+Δα)_max over (φ+Δα)*_max", &|r| r.ratio, &|infill, arms| {
                Some(hard(infill, arms)?.effective / soft(infill, arms)?.effective)
            }),
        ],
    );
}

type Flown<'a> = dyn Fn(f64, Arms) -> Option<f64> + 'a;

fn column_series(p: &Printed, fitted: Arms, printed: &dyn Fn(&Roll) -> f64, here: &Flown<'_>) -> Vec<Series> {
    let points = p.table_3.iter().map(|r| (r.infill_percent, printed(r))).collect();
    let mut series = vec![Series::new("Table III", 0, SeriesStyle::Printed, points)];
    let kinds = [
        ("massless, ζ 0.7", Arms::Static),
        ("massless, fitted ζ", fitted),
        ("with tip mass", Arms::Heavy),
    ];
    for (i, (name, arms)) in kinds.into_iter().enumerate() {
        let flown = |r: &Roll| {
            let value = here(r.infill_percent, arms);
            (r.infill_percent, value.unwrap_or(f64::NAN))
        };
        let points: Vec<(f64, f64)> = p.table_3.iter().map(flown).collect();
        series.push(Series::new(name, i, SeriesStyle::Line, points.clone()));
        series.push(Series::new("", i, SeriesStyle::Dots, points));
    }
    series
}

/// The manoeuvres over time.
pub fn manoeuvres(s: &mut Section, p: &Printed, flights: &Flights) {
    let massless = [6.0, 8.0, 10.0].map(|infill| Drawn {
        flights,
        infill,
        arms: flights.fitted,
        word: "massless arms",
    });
    s.figure(
        "The manoeuvre of Fig. 8 (printed for ρ 8 %) with massless arms of the fitted damping; rigid and flexible mixer lie \
         on each other (the tilts are the flexible one's). The arms bend only while the vehicle is being turned: Δα and 25° never stand together.",
        massless.into_iter().flat_map(|drawn| drawn.charts(p)).collect(),
    );
    let heavy = Drawn {
        flights,
        infill: 8.0,
        arms: Arms::Heavy,
        word: "tip mass",
    };
    s.figure(
        "The same with arms that carry their own tip mass. The hard gains excite the arms' mode already in hover, which the \
         stack's own gains and prefilter do not; a curve that ends is a vehicle that was lost.",
        heavy.charts(p).into(),
    );
}

struct Drawn<'a> {
    flights: &'a Flights,
    infill: f64,
    arms: Arms,
    word: &'static str,
}

impl Drawn<'_> {
    fn charts(&self, p: &Printed) -> [Chart; 3] {
        let roll = |m: &Moment| m.attitude[0].to_degrees();
        let effective = |m: &Moment| (m.attitude[0] + delta_alpha(m)).to_degrees();
        let row = p.table_3.iter().find(|r| r.infill_percent == self.infill);
        let most = row.map(|r| p.text.roll_deg + r.delta_alpha_max_deg);
        let bound = most.map(|m| (m, format!("25° + printed Δα_max = {m:.1}°")));
        [
            Chart {
                levels: vec![(p.text.roll_deg, "commanded, and the paper's φ_max".to_owned())],
                ..self.chart("Roll φ", "φ (°)", self.cases(roll))
            },
            self.chart("Tilt of the arms", "α (°)", self.tilts()),
            Chart {
                levels: bound.into_iter().collect(),
                ..self.chart("Effective angle φ + Δα", "φ + Δα (°)", self.cases(effective))
            },
        ]
    }

    fn chart(&self, title: &str, y: &str, series: Vec<Series>) -> Chart {
        Chart {
            title: format!("{title}, {}, ρ {} %", self.word, self.infill),
            x: Axis::between("time (s)", 0.0, SECONDS),
            y: Axis::new(y),
            series,
            ..Chart::default()
        }
    }

    fn cases(&self, value: impl Fn(&Moment) -> f64) -> Vec<Series> {
        let cases = self.flights.cases.iter().enumerate();
        let curves = cases.filter_map(|(i, case)| {
            let flown = self.flights.of(i, self.infill, self.arms)?;
            Some(Series::new(
                case.name,
                i,
                SeriesStyle::Line,
                curve(flown, 5, &value),
            ))
        });
        curves.collect()
    }

    fn tilts(&self) -> Vec<Series> {
        let mut series = vec![];
        for (case, look, word) in [
            (FLEXIBLE_HARD, SeriesStyle::Line, "hard"),
            (FLEXIBLE_SOFT, SeriesStyle::Dashed, "prefiltered"),
        ] {
            let Some(flown) = self.flights.of(case, self.infill, self.arms) else {
                continue;
            };
            let mean = |i: usize, j: usize| move |m: &Moment| (0.5 * (m.tilt[i] + m.tilt[j])).to_degrees();
            for (side, colour, tilt) in [("left", 3, mean(0, 1)), ("right", 2, mean(2, 3))] {
                let name = format!("{side} arms, {word}");
                series.push(Series::new(name, colour, look, curve(flown, 5, tilt)));
            }
        }
        series
    }
}
