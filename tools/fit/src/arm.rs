//! Least-squares fit of Eq. 1 to bench data, with confidence intervals.
//!
//! α = α0 + ((A1 + ρ A2) T + (B1 + ρ B2) T²) p^C_P. All but C_P are linear; Gauss-Newton from a linear start takes a
//! few steps. One infill cannot separate A1 and A2 (B1 and B2): A and B are fitted; C_P only where the power ratio
//! varies. K is the gain that Table I would need, fitted on its own, with the residual of Table I's shape.

use super::arm_data::Point;
use super::least_squares::{quantile, solve};

/// C_P is fitted below this power ratio.
const POWER_SEEN: f64 = 0.95;
/// Assumed: the middle of the paper's 1.6 to 1.8.
const EXPONENT: f64 = 1.7;
const STEPS: u32 = 30;
/// Smallest difference between two infills, %.
const INFILL_STEP: f64 = 0.2;

/// A fitted value.
#[derive(Clone, Copy, Debug)]
pub struct Fitted {
    /// Name as in the paper.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Estimate.
    pub value: f64,
    /// Half of the 95 % confidence interval.
    pub half: f64,
}

/// A fit of Eq. 1.
#[derive(Clone, Debug)]
pub struct Fit {
    /// All fitted values.
    pub fitted: Vec<Fitted>,
    /// A1, A2, B1, B2 (°/N, °/(N %), °/N², °/(N² %)); A, 0, B, 0 for one infill.
    pub coefficients: [f64; 4],
    /// α0, degrees.
    pub offset: f64,
    /// C_P, fitted or assumed.
    pub exponent: f64,
    /// RMS residual over the degrees of freedom, degrees.
    pub residual: f64,
    /// Best gain on Table I, and its residual RMS (°).
    pub gain: (Fitted, f64),
}

impl Fit {
    /// Tilt, degrees.
    pub fn tilt(&self, infill: f64, thrust: f64, power: f64) -> f64 {
        let [a1, a2, b1, b2] = self.coefficients;
        self.offset
            + ((a1 + infill * a2) * thrust + (b1 + infill * b2) * thrust * thrust) * power.powf(self.exponent)
    }

    /// Linear and quadratic coefficient at an infill, °/N, °/N².
    pub fn at(&self, infill: f64) -> (f64, f64) {
        let [a1, a2, b1, b2] = self.coefficients;
        (a1 + infill * a2, b1 + infill * b2)
    }

    /// Thrust (N) at which an arm of this infill is level, if any.
    pub fn level_thrust(&self, infill: f64) -> Option<f64> {
        let (a, b) = self.at(infill);
        let root = a * a - 4.0 * b * self.offset;
        (root >= 0.0 && a > 0.0).then(|| -2.0 * self.offset / (a + root.sqrt()))
    }
}

#[derive(Clone, Copy)]
struct Unknowns {
    /// Several infills: A1, A2, B1, B2 instead of A, B.
    several: bool,
    /// The power ratio varies: C_P.
    powered: bool,
}

impl Unknowns {
    fn of(points: &[Point]) -> Self {
        let (low, high) = range(points, |p| p.infill);
        Self {
            several: high - low >= INFILL_STEP,
            powered: range(points, |p| p.power).0 < POWER_SEEN,
        }
    }

    /// Number of linear unknowns: α0, A (A2), B (B2).
    const fn linear(self) -> usize {
        if self.several { 5 } else { 3 }
    }

    fn count(self) -> usize {
        self.linear() + usize::from(self.powered)
    }

    /// In column order.
    fn names(self) -> impl Iterator<Item = (&'static str, &'static str)> {
        let linear: &[(&str, &str)] = if self.several {
            &[
                ("α0", "°"),
                ("A1", "°/N"),
                ("A2", "°/(N %)"),
                ("B1", "°/N²"),
                ("B2", "°/(N² %)"),
            ]
        } else {
            &[("α0", "°"), ("A", "°/N"), ("B", "°/N²")]
        };
        linear.iter().copied().chain([("C_P", "")]).take(self.count())
    }

    fn basis(self, p: &Point) -> Vec<f64> {
        let (t, t2) = (p.thrust, p.thrust * p.thrust);
        if self.several {
            vec![t, p.infill * t, t2, p.infill * t2]
        } else {
            vec![t, t2]
        }
    }

    /// Design row of a point, linearised about `x` and this exponent.
    fn row(self, p: &Point, x: &[f64], exponent: f64) -> Vec<f64> {
        let factor = p.power.powf(exponent);
        let basis = self.basis(p);
        let mut row = vec![1.0];
        row.extend(basis.iter().map(|b| b * factor));
        if self.powered {
            // ∂α/∂C_P about the last solution.
            let elastic: f64 = basis.iter().zip(x.iter().skip(1)).map(|(b, c)| b * c).sum();
            row.push(elastic * factor * p.power.ln());
        }
        row
    }

    /// # Errors
    /// Too few points or too small a range.
    fn refuse_too_little(self, points: &[Point]) -> Result<(), String> {
        let (least, most) = range(points, |p| p.thrust);
        if points.is_empty() || most - least < 0.5 {
            return Err(
                "thrust_n spans less than 0.5 N: allowed are data over the thrusts of flight".to_owned(),
            );
        }
        let (count, needed) = (self.count(), self.count() + 3);
        if points.len() < needed {
            return Err(format!(
                "{} rows: allowed are at least {needed} for {count} unknowns",
                points.len(),
            ));
        }
        Ok(())
    }
}

struct Solution {
    x: Vec<f64>,
    /// (XᵀX)⁻¹ of the last step.
    covariance: Vec<Vec<f64>>,
    exponent: f64,
}

impl Solution {
    /// `None` if the points cannot separate the unknowns.
    fn of(points: &[Point], unknowns: Unknowns) -> Option<Self> {
        let linear = unknowns.linear();
        let tilts = tilts(points);
        let mut exponent = EXPONENT;
        // C_P's derivative needs a solution.
        let start: Vec<Vec<f64>> = points
            .iter()
            .map(|p| unknowns.row(p, &[], exponent)[..linear].to_vec())
            .collect();
        let (mut x, mut covariance) = solve(&start, &tilts)?;
        for _ in 0..STEPS {
            let design: Vec<Vec<f64>> = points.iter().map(|p| unknowns.row(p, &x, exponent)).collect();
            (x, covariance) = solve(&design, &tilts)?;
            let step = x.get(linear).map_or(0.0, |step| step.clamp(-0.5, 0.5));
            exponent += step;
            if step.abs() < 1e-9 {
                break;
            }
        }
        Some(Self {
            x,
            covariance,
            exponent,
        })
    }

    /// A, 0, B, 0 for one infill.
    fn coefficients(&self) -> [f64; 4] {
        match self.x[1..] {
            [a1, a2, b1, b2, ..] => [a1, a2, b1, b2],
            [a, b, ..] => [a, 0.0, b, 0.0],
            _ => [f64::NAN; 4],
        }
    }
}

/// Fits `points`, and the gain on `table_1`.
///
/// # Errors
/// What the data lack, one line.
pub fn fit(points: &[Point], table_1: [f64; 4]) -> Result<Fit, String> {
    let unknowns = Unknowns::of(points);
    unknowns.refuse_too_little(points)?;
    let lacking = || {
        "the rows do not tell the coefficients apart: allowed are at least three thrusts at every infill, and two infills or \
         one"
            .to_owned()
    };
    let solution = Solution::of(points, unknowns).ok_or_else(lacking)?;
    let mut fit = Fit {
        fitted: vec![],
        coefficients: solution.coefficients(),
        offset: solution.x[0],
        exponent: solution.exponent,
        residual: 0.0,
        gain: gain(points, table_1, solution.exponent).ok_or_else(lacking)?,
    };
    let square: f64 = points
        .iter()
        .map(|p| (p.tilt - fit.tilt(p.infill, p.thrust, p.power)).powi(2))
        .sum();
    let freedom = points.len() - unknowns.count();
    fit.residual = (square / freedom as f64).sqrt();
    let t = quantile(freedom);
    for (i, (name, unit)) in unknowns.names().enumerate() {
        fit.fitted.push(Fitted {
            name,
            unit,
            value: if i < unknowns.linear() {
                solution.x[i]
            } else {
                solution.exponent
            },
            half: t * fit.residual * solution.covariance[i][i].sqrt(),
        });
    }
    Ok(fit)
}

/// Best gain on Table I, with its own offset.
fn gain(points: &[Point], [a1, a2, b1, b2]: [f64; 4], exponent: f64) -> Option<(Fitted, f64)> {
    let shape = |p: &Point| {
        ((a1 + p.infill * a2) + (b1 + p.infill * b2) * p.thrust) * p.thrust * p.power.powf(exponent)
    };
    let design: Vec<Vec<f64>> = points.iter().map(|p| vec![1.0, shape(p)]).collect();
    let (x, covariance) = solve(&design, &tilts(points))?;
    let square: f64 = points
        .iter()
        .map(|p| (p.tilt - x[0] - x[1] * shape(p)).powi(2))
        .sum();
    let freedom = points.len() - 2;
    let residual = (square / freedom as f64).sqrt();
    let half = quantile(freedom) * residual * covariance[1][1].sqrt();
    Some((
        Fitted {
            name: "K",
            unit: "",
            value: x[1],
            half,
        },
        residual,
    ))
}

fn tilts(points: &[Point]) -> Vec<f64> {
    points.iter().map(|p| p.tilt).collect()
}

fn range(points: &[Point], of: impl Fn(&Point) -> f64) -> (f64, f64) {
    points
        .iter()
        .map(of)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        })
}

#[cfg(test)]
mod tests {
    use crate::arm::*;

    const TABLE_1: [f64; 4] = [2.4387, -0.1997, -0.162, 0.0151];

    /// Table I with gain, offset and a fixed error pattern.
    fn bench(infills: &[f64], powers: &[f64], gain: f64, noise: f64) -> Vec<Point> {
        let mut points = vec![];
        for infill in infills {
            for power in powers {
                for i in 0..16 {
                    let thrust = 0.5 * f64::from(i);
                    let elastic =
                        (2.4387 - 0.1997 * infill) * thrust + (-0.162 + 0.0151 * infill) * thrust * thrust;
                    // Without trend: estimates stay near the truth, intervals do not vanish.
                    let error = noise * (1.7 * (points.len() as f64 + 1.0).powi(2)).sin();
                    let tilt = -20.0 + gain * elastic * power.powf(1.7) + error;
                    points.push(Point {
                        infill: *infill,
                        thrust,
                        tilt,
                        power: *power,
                    });
                }
            }
        }
        points
    }

    #[test]
    fn it_finds_what_was_put_in() {
        let f = fit(&bench(&[6.0, 8.0, 10.0], &[1.0, 0.8], 7.75, 0.3), TABLE_1).unwrap();
        for (name, truth) in [
            ("α0", -20.0),
            ("A1", 7.75 * 2.4387),
            ("A2", -7.75 * 0.1997),
            ("B1", -7.75 * 0.162),
            ("B2", 7.75 * 0.0151),
            ("C_P", 1.7),
        ] {
            let found = f.fitted.iter().find(|x| x.name == name).unwrap();
            assert!(
                (found.value - truth).abs() < 1.5 * found.half,
                "{found:?} {truth}"
            );
            assert!(found.half < 0.35 * truth.abs(), "{found:?}");
        }
        assert!((f.gain.0.value - 7.75).abs() < 3.0 * f.gain.0.half && (f.residual - 0.21).abs() < 0.03);
        assert!((f.level_thrust(6.9).unwrap() - 2.9).abs() < 0.3);
    }

    #[test]
    fn one_arm_has_a_and_b_and_no_exponent_without_a_weak_battery() {
        let f = fit(&bench(&[6.9], &[1.0], 5.0, 0.0), TABLE_1).unwrap();
        let names: Vec<&str> = f.fitted.iter().map(|x| x.name).collect();
        assert_eq!(names, ["α0", "A", "B"]);
        assert!((f.coefficients[0] - 5.0 * 1.060_77).abs() < 1e-6 && f.coefficients[1] == 0.0);
        assert!((f.gain.0.value - 5.0).abs() < 1e-6);
    }

    #[test]
    fn data_that_cannot_tell_are_refused() {
        assert!(fit(&[], TABLE_1).unwrap_err().contains("thrust_n"));
        let few = bench(&[6.9], &[1.0], 5.0, 0.0)[..5].to_vec();
        assert!(fit(&few, TABLE_1).unwrap_err().contains("at least 6"));
        let two: Vec<Point> = (0..20)
            .map(|i| Point {
                infill: 6.0,
                thrust: f64::from(i % 2) * 4.0,
                tilt: 1.0,
                power: 1.0,
            })
            .collect();
        assert!(fit(&two, TABLE_1).unwrap_err().contains("apart"));
    }
}
