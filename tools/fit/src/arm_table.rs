//! Tables of a vehicle's four arms, measured together: one Eq. 1 for all, as the stack has it, and what each arm differs
//! from it by.

use std::fmt::Write;

use super::arm::{self, Fit};
use super::arm_data::Point;
use super::least_squares::{quantile, solve};

/// A measured point of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmPoint {
    /// Arm, 0 to 3.
    pub arm: usize,
    /// Point of its table.
    pub point: Point,
}

/// What an arm differs by from the one equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Its bending over that of the equation, with half of the 95 % interval.
    pub gain: (f64, f64),
    /// Its tilt at rest over that of the equation, degrees, with half of the 95 % interval.
    pub offset: (f64, f64),
}

/// The fit of four arms.
#[derive(Clone, Debug)]
pub struct ArmsFit {
    /// Eq. 1 of all of them.
    pub all: Fit,
    /// Each arm against it.
    pub arms: Vec<Difference>,
    /// Infill, %.
    pub infill: f64,
}

/// Fits `points` of arms of one infill.
///
/// # Errors
/// What the data lack, one line.
pub fn fit(points: &[ArmPoint], table_1: [f64; 4]) -> Result<ArmsFit, String> {
    let together: Vec<Point> = points.iter().map(|p| p.point).collect();
    let all = arm::fit(&together, table_1)?;
    let infill = together.first().map_or(f64::NAN, |p| p.infill);
    let mut arms = Vec::new();
    for arm in 0..4 {
        let own: Vec<Point> = points.iter().filter(|p| p.arm == arm).map(|p| p.point).collect();
        arms.push(
            difference(&own, &all)
                .ok_or_else(|| format!("arm {}: allowed are at least four thrusts of each arm", arm + 1))?,
        );
    }
    Ok(ArmsFit { all, arms, infill })
}

/// α = α0 + offset + gain · elastic(T).
fn difference(points: &[Point], all: &Fit) -> Option<Difference> {
    if points.len() < 4 {
        return None;
    }
    let elastic = |p: &Point| all.tilt(p.infill, p.thrust, p.power) - all.offset;
    let design: Vec<Vec<f64>> = points.iter().map(|p| vec![1.0, elastic(p)]).collect();
    let tilts: Vec<f64> = points.iter().map(|p| p.tilt - all.offset).collect();
    let (x, covariance) = solve(&design, &tilts)?;
    let &[offset, gain] = x.first_chunk()?;
    let square: f64 = points
        .iter()
        .zip(&tilts)
        .map(|(p, tilt)| (tilt - offset - gain * elastic(p)).powi(2))
        .sum();
    let freedom = points.len() - 2;
    let half = |i: usize| {
        let variance = covariance.get(i)?.get(i)?;
        Some(quantile(freedom) * (square / freedom as f64 * variance).sqrt())
    };
    Some(Difference {
        gain: (gain, half(1)?),
        offset: (offset, half(0)?),
    })
}

impl ArmsFit {
    /// The board's parameters, for rotors of at most `thrust_max` N. `gain_k` is 1: the coefficients hold the gain.
    ///
    /// # Errors
    /// One line: an arm that no flight bears.
    pub fn parameters(&self, thrust_max: f64) -> Result<[(&'static str, f64); 6], String> {
        let level = self.all.level_thrust(self.infill);
        let Some(level) = level.filter(|level| (-0.5..=1.0).contains(&(level / thrust_max))) else {
            return Err(format!(
                "the arms are never level in flight: allowed is a level thrust of -0.5 to 1 times {thrust_max} N"
            ));
        };
        let [a1, a2, b1, b2] = self.all.coefficients;
        Ok([
            ("gain_k", 1.0),
            ("arm_a1", a1),
            ("arm_a2", a2),
            ("arm_b1", b1),
            ("arm_b2", b2),
            ("arm_level_share", level / thrust_max),
        ])
    }
}

/// The table as `sophie fit-arm` reads it.
#[must_use]
pub fn csv(points: &[ArmPoint]) -> String {
    let mut text = String::from("infill_percent,thrust_n,tilt_deg,power_ratio\n");
    for arm in 0..4 {
        let _ = writeln!(text, "# arm {}", arm + 1);
        for p in points.iter().filter(|p| p.arm == arm).map(|p| p.point) {
            let _ = writeln!(text, "{},{:.3},{:.2},{:.3}", p.infill, p.thrust, p.tilt, p.power);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use crate::arm_data;
    use crate::arm_table::*;

    const TABLE_1: [f64; 4] = [2.4387, -0.1997, -0.162, 0.0151];

    /// Five thrusts of arms with gains and offsets, degrees.
    fn bench(gains: [f64; 4], offsets: [f64; 4]) -> Vec<ArmPoint> {
        let mut points = Vec::new();
        for (arm, (gain, offset)) in gains.into_iter().zip(offsets).enumerate() {
            for thrust in [1.5, 2.8, 4.1, 5.4, 6.7] {
                let elastic = 8.22 * thrust - 0.448 * thrust * thrust;
                let tilt = -25.0 + offset + gain * elastic;
                let point = Point {
                    infill: 6.9,
                    thrust,
                    tilt,
                    power: 1.0,
                };
                points.push(ArmPoint { arm, point });
            }
        }
        points
    }

    #[test]
    fn one_equation_for_four_arms_and_each_arms_own_beside_it() {
        let found = fit(&bench([0.9, 1.1, 1.05, 0.95], [2.0, -2.0, 1.0, -1.0]), TABLE_1).unwrap();
        let [a, _, b, _] = found.all.coefficients;
        assert!(
            (a - 8.22).abs() < 1e-6 && (b + 0.448).abs() < 1e-6 && (found.all.offset + 25.0).abs() < 1e-6
        );
        for (arm, (gain, offset)) in [(0.9, 2.0), (1.1, -2.0), (1.05, 1.0), (0.95, -1.0)]
            .into_iter()
            .enumerate()
        {
            let own = found.arms[arm];
            assert!(
                (own.gain.0 - gain).abs() < 1e-6 && (own.offset.0 - offset).abs() < 1e-6,
                "{own:?}"
            );
        }
        let parameters = found.parameters(8.3).unwrap();
        // -25 + 8.22 T - 0.448 T² = 0 at 3.85 N.
        assert!((parameters[5].1 - 3.853 / 8.3).abs() < 1e-3, "{parameters:?}");
        assert_eq!((parameters[0], parameters[2].1), (("gain_k", 1.0), 0.0));
        assert!(found.parameters(3.0).unwrap_err().contains("never level"));
    }

    #[test]
    fn the_table_is_the_one_that_fit_arm_reads() {
        let points = bench([1.0; 4], [0.0; 4]);
        let read = arm_data::parse(&csv(&points), "arms.csv").unwrap();
        assert_eq!(read.len(), 20);
        assert!(read.iter().zip(&points).all(|(read, p)| {
            (read.thrust - p.point.thrust).abs() < 1e-3 && (read.tilt - p.point.tilt).abs() < 0.01
        }));
        let few: Vec<ArmPoint> = points.into_iter().filter(|p| p.arm != 2).collect();
        assert!(fit(&few, TABLE_1).unwrap_err().contains("arm 3"));
    }
}
