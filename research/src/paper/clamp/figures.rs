//! Fig. 10, and Table IV among all closings.

use sophie_charts::units::kgcm;
use sophie_sim::test_stands::arm_stand::ClosingSample;

use super::super::printed::Printed;
use super::bench::{INFILLS, OnBench};
use super::table_4::{as_printed, paired};
use crate::results::model::{Axis, Chart, Section, Series, SeriesStyle};

/// Infill (%) and diameter (m), nearest to Table IV's forces.
const SHOWN: [(f64, f64); 4] = [(6.0, 0.35), (6.9, 0.35), (6.9, 0.25), (6.0, 0.20)];

/// Draws them.
pub fn show(s: &mut Section, p: &Printed, all: &[OnBench]) {
    s.figure(
        "As Fig. 10, in its units: pressure over the target of 950 N/m², servo force over half of 25 kgcm; the four closings \
         are those nearest to Table IV's forces. Dashed: the target, the printed times t1 to t4 and the printed forces. Below: where the printed pairs lie among all \
         closings, and the force that holds over the pipe's diameter.",
        vec![pressure(p, all), force(p, all), pairs(p, all), over_pipes(p, all)],
    );
}

fn curves(all: &[OnBench], value: impl Fn(&ClosingSample) -> f64) -> Vec<Series> {
    let curve = |(i, (infill, diameter)): (usize, (f64, f64))| {
        let c = all
            .iter()
            .find(|c| c.infill == infill && c.diameter == diameter)?;
        let points = c.closed.samples.iter().step_by(2).map(|x| (x.t, value(x)));
        let name = format!("ρ {infill} %, D {:.0} mm", 1e3 * diameter);
        Some(Series::new(name, i, SeriesStyle::Line, points.collect()))
    };
    SHOWN.into_iter().enumerate().filter_map(curve).collect()
}

fn over_time(title: &str, y: &str, series: Vec<Series>) -> Chart {
    Chart {
        title: title.to_owned(),
        x: Axis::between("time since the start of the closing (s)", 0.0, 7.0),
        y: Axis::new(y),
        series,
        ..Chart::default()
    }
}

fn pressure(p: &Printed, all: &[OnBench]) -> Chart {
    let times = p.table_4.closure_s.iter().enumerate();
    Chart {
        levels: vec![(1.0, "target".to_owned())],
        uprights: times.map(|(i, t)| (*t, format!("t{}", i + 1))).collect(),
        ..over_time(
            "Contact pressure s(t)",
            "s = P / 950 N/m²",
            curves(all, |x| x.pressure / p.text.pressure_pa),
        )
    }
}

fn force(p: &Printed, all: &[OnBench]) -> Chart {
    let half_force = 0.5 * p.text.force_max_kgcm;
    let forces = p.table_4.force_kgcm.iter();
    Chart {
        levels: forces
            .map(|u| (u / half_force, format!("{u} kgcm printed")))
            .collect(),
        ..over_time(
            "Servo force u(t)",
            "u = F / (0.5 F_max)",
            curves(all, |x| kgcm(x.torque) / half_force),
        )
    }
}

fn by_infill(look: SeriesStyle, points: impl Fn(f64) -> Vec<(f64, f64)>) -> Vec<Series> {
    let infills = INFILLS.into_iter().enumerate();
    infills
        .map(|(i, infill)| Series::new(format!("ρ {infill} %"), i, look, points(infill)))
        .collect()
}

fn pairs(p: &Printed, all: &[OnBench]) -> Chart {
    let mut series = by_infill(SeriesStyle::Dots, |infill| {
        all.iter()
            .filter(|c| c.infill == infill && c.holds())
            .map(|c| (c.closed.closure.unwrap_or(f64::NAN), kgcm(c.closed.steady)))
            .collect()
    });
    series.push(Series::new(
        "Table IV, U row reversed",
        0,
        SeriesStyle::Printed,
        paired(p),
    ));
    series.push(Series::new(
        "Table IV as printed",
        7,
        SeriesStyle::Dashed,
        as_printed(p),
    ));
    Chart {
        title: "Closure time and steady force".to_owned(),
        x: Axis::new("closure time (s)"),
        y: Axis::new("U(∞) (kgcm)").with(&[0.0]),
        series,
        ..Chart::default()
    }
}

fn over_pipes(p: &Printed, all: &[OnBench]) -> Chart {
    let forces = p.table_4.force_kgcm.iter();
    Chart {
        title: "Steady force over the pipe".to_owned(),
        x: Axis::new("pipe diameter D (mm)"),
        y: Axis::new("U(∞) (kgcm)").with(&[0.0]),
        series: by_infill(SeriesStyle::Line, |infill| {
            let of = all.iter().filter(|c| c.infill == infill);
            of.map(|c| (1e3 * c.diameter, c.held_force())).collect()
        }),
        levels: forces.map(|u| (*u, format!("{u} printed"))).collect(),
        ..Chart::default()
    }
}
