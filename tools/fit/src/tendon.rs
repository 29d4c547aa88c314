//! What a tendon does to an arm, from bench data: the tilt of a free arm by its force, and the force that balances a
//! thrust at equal pressure on the pipe.
//!
//! A free arm with its rotor stopped bends in proportion to the force, by `tendon_bend` · h/d · A(ρ), A the tilt per
//! thrust of Eq. 1 near rest. On the pipe, near the grip pressure, the force is linear in thrust and pressure; the share
//! of the thrust is `tendon_relief` · d/h. Each infill has its own offsets. A is taken as fitted: what flies is the
//! product, in which it cancels.

use sophie_control::params::Params;

use super::arm::{Fit, Fitted};
use super::least_squares::{quantile, solve};
use super::tendon_data::Pulled;

/// Largest thrust of a rotor that counts as stopped, N.
const STOPPED: f64 = 0.05;
/// Least span of the forces of a free arm, and of the thrusts on the pipe, N.
const FORCE_SPAN: f64 = 5.0;
const THRUST_SPAN: f64 = 0.5;
/// Rows beyond the unknowns.
const SPARE: usize = 2;

/// Both parameters with their 95 % confidence intervals.
#[derive(Clone, Debug)]
pub struct TendonFit {
    /// Tendon to neutral line, m.
    pub lever: f64,
    /// `tendon_bend`, and as tilt per tendon force at the vehicle's infill.
    pub bend: [Fitted; 2],
    /// `tendon_relief`, and as tendon force per thrust.
    pub relief: [Fitted; 2],
    /// RMS residuals: of the free arm's tilt, degrees, and of the force on the pipe, N.
    pub residuals: [f64; 2],
}

/// A least-squares solution with one coefficient of interest.
struct Slope {
    value: f64,
    half: f64,
    residual: f64,
}

impl Slope {
    /// The last column's coefficient.
    fn of(design: &[Vec<f64>], measured: &[f64], what: &str) -> Result<Self, String> {
        let unknowns = design.first().map_or(0, Vec::len);
        let freedom = design
            .len()
            .checked_sub(unknowns)
            .filter(|spare| *spare >= SPARE)
            .ok_or_else(|| {
                format!(
                    "{} rows of {what}: allowed are at least {} for {unknowns} unknowns",
                    design.len(),
                    unknowns + SPARE
                )
            })?;
        let (x, covariance) = solve(design, measured).ok_or_else(|| {
            format!(
                "the rows of {what} do not tell the unknowns apart: allowed are several values of each column"
            )
        })?;
        let square: f64 = design
            .iter()
            .zip(measured)
            .map(|(row, m)| (m - row.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>()).powi(2))
            .sum();
        let residual = (square / freedom as f64).sqrt();
        let at = unknowns - 1;
        Ok(Self {
            value: x[at],
            half: quantile(freedom) * residual * covariance[at][at].sqrt(),
            residual,
        })
    }

    fn fitted(&self, name: &'static str, unit: &'static str, scale: f64) -> Fitted {
        Fitted {
            name,
            unit,
            value: self.value * scale,
            half: self.half * scale.abs(),
        }
    }
}

/// Fits `rows` of arms whose Eq. 1 is `arm`, with the tendon `lever` m from the neutral line; tilt per force at `infill`
/// %.
///
/// # Errors
/// What the data lack, one line.
pub fn fit(rows: &[Pulled], arm: &Fit, lever: f64, infill: f64) -> Result<TendonFit, String> {
    let (pipe, free): (Vec<Pulled>, Vec<Pulled>) = rows.iter().partition(|row| row.on_pipe());
    if let Some(row) = free.iter().find(|row| row.thrust > STOPPED) {
        return Err(format!(
            "a free arm (pressure_pa 0) at thrust_n {}: allowed is 0, where an arm bends in proportion to the force",
            row.thrust
        ));
    }
    spans(&free, "force_n of the free arm", |r| r.force, FORCE_SPAN)?;
    spans(&pipe, "thrust_n on the pipe", |r| r.thrust, THRUST_SPAN)?;
    let ratio = lever / f64::from(Params::DEFAULT.arm_d);
    let groups = infills(rows);
    let own = |row: &Pulled, value: f64| {
        let of = |group: &f64| if *group == row.infill { value } else { 0.0 };
        groups.iter().map(of).collect::<Vec<f64>>()
    };

    let design = free.iter().map(|row| {
        let mut line = own(row, 1.0);
        line.push(-arm.at(row.infill).0 * ratio * row.force);
        line
    });
    let tilts: Vec<f64> = free.iter().map(|row| row.tilt).collect();
    let bend = Slope::of(&drop_empty(&design.collect::<Vec<_>>()), &tilts, "a free arm")?;

    let design = pipe.iter().map(|row| {
        let mut line = own(row, 1.0);
        line.extend(own(row, row.pressure));
        line.push(row.thrust);
        line
    });
    let forces: Vec<f64> = pipe.iter().map(|row| row.force).collect();
    let relief = Slope::of(
        &drop_empty(&design.collect::<Vec<_>>()),
        &forces,
        "an arm on the pipe",
    )?;

    Ok(TendonFit {
        lever,
        bend: [
            bend.fitted("tendon_bend", "", 1.0),
            bend.fitted("tilt per tendon force", "°/N", arm.at(infill).0 * ratio),
        ],
        relief: [
            relief.fitted("tendon_relief", "", ratio),
            relief.fitted("tendon force per thrust", "N/N", 1.0),
        ],
        residuals: [bend.residual, relief.residual],
    })
}

fn spans(rows: &[Pulled], what: &str, of: impl Fn(&Pulled) -> f64, least: f64) -> Result<(), String> {
    let (low, high) = rows
        .iter()
        .map(of)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
    if high - low >= least {
        return Ok(());
    }
    Err(format!(
        "{what} spans less than {least} N: allowed are rows of both, a free arm and one on the pipe"
    ))
}

/// Each infill once.
fn infills(rows: &[Pulled]) -> Vec<f64> {
    let mut all: Vec<f64> = rows.iter().map(|row| row.infill).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Without the columns of infills that these rows do not have.
fn drop_empty(design: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = design.first().map_or(0, Vec::len);
    let kept: Vec<usize> = (0..count)
        .filter(|j| design.iter().any(|row| row[*j] != 0.0))
        .collect();
    design
        .iter()
        .map(|row| kept.iter().map(|j| row[*j]).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::arm;
    use super::super::arm_data::Point;
    use crate::tendon::*;

    const TABLE_1: [f64; 4] = [2.4387, -0.1997, -0.162, 0.0151];

    fn arm() -> Fit {
        let points: Vec<Point> = [6.0, 8.0]
            .into_iter()
            .flat_map(|infill| {
                (0..16).map(move |i| {
                    let t = 0.5 * f64::from(i);
                    let [a1, a2, b1, b2] = TABLE_1;
                    let tilt = -20.0 + 7.75 * ((a1 + infill * a2) * t + (b1 + infill * b2) * t * t);
                    Point {
                        infill,
                        thrust: t,
                        tilt,
                        power: 1.0,
                    }
                })
            })
            .collect();
        arm::fit(&points, TABLE_1).unwrap()
    }

    /// Rows of a known arm with a fixed pattern of errors: `bend` °/N at 6 %, `relief` N/N.
    fn bench(bend: f64, relief: f64, noise: f64) -> Vec<Pulled> {
        let mut rows: Vec<Pulled> = vec![];
        let error = |rows: &[Pulled]| noise * (1.7 * (rows.len() as f64 + 1.0).powi(2)).sin();
        for infill in [6.0, 8.0] {
            let softer = (2.4387 - 0.1997 * infill) / (2.4387 - 0.1997 * 6.0);
            for i in 0..8 {
                let force = 5.0 * f64::from(i);
                let tilt = -20.0 - infill - bend * softer * force + error(&rows);
                rows.push(Pulled {
                    infill,
                    force,
                    thrust: 0.0,
                    tilt,
                    pressure: 0.0,
                });
            }
            for i in 0..9 {
                let (thrust, pressure) = (f64::from(i % 3), 800.0 + 150.0 * f64::from(i / 3));
                let force = 2.0 * infill + relief * thrust + 0.011 * pressure + error(&rows);
                rows.push(Pulled {
                    infill,
                    force,
                    thrust,
                    tilt: -68.0,
                    pressure,
                });
            }
        }
        rows
    }

    #[test]
    fn it_finds_what_was_put_in_with_intervals_that_hold_it() {
        let arm = arm();
        for (noise, width) in [(0.0, 1e-6), (0.3, 0.15)] {
            let f = fit(&bench(1.6, 6.5, noise), &arm, 0.015, 6.0).unwrap();
            // 7.75 · 1.2405 °/N · 0.015/0.178 is 0.81015 °/N for each unit of tendon_bend.
            for (found, truth) in
                f.bend
                    .iter()
                    .chain(&f.relief)
                    .zip([1.6 / 0.810_15, 1.6, 6.5 * 0.015 / 0.178, 6.5])
            {
                let within = found.half.max(1e-4 * truth);
                assert!(
                    (found.value - truth).abs() <= 1.2 * within && found.half <= width * truth,
                    "{found:?} {truth}"
                );
            }
        }
    }

    #[test]
    fn rows_that_cannot_tell_are_refused() {
        let (arm, rows) = (arm(), bench(1.6, 6.5, 0.0));
        let free: Vec<Pulled> = rows.iter().copied().filter(|r| !r.on_pipe()).collect();
        let why = |rows: &[Pulled]| fit(rows, &arm, 0.015, 6.0).unwrap_err();
        assert!(why(&free).starts_with("thrust_n on the pipe spans less than 0.5 N"));
        assert!(why(&rows[8..17]).starts_with("force_n of the free arm spans"));
        let turning: Vec<Pulled> = rows.iter().map(|r| Pulled { thrust: 1.0, ..*r }).collect();
        assert!(why(&turning).starts_with("a free arm (pressure_pa 0) at thrust_n 1: allowed is 0"));
        let few: Vec<Pulled> = rows[..2].iter().chain(&rows[5..14]).copied().collect();
        assert!(fit(&few, &arm, 0.015, 6.0).is_ok());
        let fewer: Vec<Pulled> = rows[..2].iter().chain(&rows[8..17]).copied().collect();
        assert!(why(&fewer).contains("2 rows of a free arm: allowed are at least 4 for 2 unknowns"));
    }
}
