//! Torsional stiffness of an arm from weights that hang beside its axis at the tip, and the twist that an inclinometer
//! across the arm reads.
//!
//! A mass m on a lever l across the arm's axis, turned by φ, gives the moment m g l cos φ; φ = φ0 + s M / K, a straight line
//! in the moment. φ0 takes the inclinometer's own zero and the arm's; the lever's weight, which hangs there all the time,
//! goes into it.
//!
//! The tip is level, its root leans by the slope α at which the arm hangs. A section at the share ξ of the length is twisted
//! by M cos β and bent sideways by M sin β, β = α (1 - ξ), and turns the tip by the same share of each: s = ∫ cos² β + (G
//! J / E I) sin² β dξ = 1 - (1 - 0.562) α²/3, 0.97 for 26°.

use std::f64::consts::PI;

use super::arm::Fitted;
use super::least_squares::{quantile, solve};

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.806_65;
/// Half of the 95 % interval of the moment, share: a lever of 0.1 m by a ruler to 2 mm, weights by a kitchen scale, the
/// tip's slope.
pub const MOMENT_ERROR: f64 = 0.02;
/// Largest scatter of sound readings about the line, degrees: a phone reads to 0.1°, laid on again to 0.3°.
pub const SCATTER_MAX: f64 = 1.0;
/// Length of an arm, m, and its torsional over its bending stiffness, G J / E I of a square section with ν = 0.5: those
/// of the simulated arm, which a test compares.
const ARM_LENGTH: f64 = 0.178;
const STIFFNESS_RATIO: f64 = 0.562;

/// A reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Mass on the lever, kg; negative on its other side.
    pub mass: f64,
    /// Distance of the mass from the arm's axis, m.
    pub lever: f64,
    /// Twist, degrees, positive where positive masses pull.
    pub twist: f64,
}

impl Reading {
    /// Moment about the arm's axis, N·m.
    #[must_use]
    pub fn moment(&self) -> f64 {
        self.mass * GRAVITY * self.lever * (self.twist * PI / 180.0).cos()
    }
}

/// Torsional stiffness of the simulator's arm that bends by `elastic` rad/N at rest, N·m/rad: ratio · E I / L with
/// E I = L² / (2 · elastic).
#[must_use]
pub fn derived(elastic: f64) -> f64 {
    STIFFNESS_RATIO * ARM_LENGTH / (2.0 * elastic)
}

/// A fit.
#[derive(Clone, Copy, Debug)]
pub struct TwistFit {
    /// Torsional stiffness, N·m/rad, with half of its 95 % interval, which holds [`MOMENT_ERROR`].
    pub stiffness: Fitted,
    /// RMS of what the line leaves over the degrees of freedom, degrees.
    pub scatter: f64,
}

/// Fits `readings` of an arm between whose root and tip is the angle `slope`, rad.
///
/// # Errors
/// One line: what they lack, or that they do not lie on a line.
pub fn fit(readings: &[Reading], slope: f64) -> Result<TwistFit, String> {
    let design: Vec<Vec<f64>> = readings.iter().map(|r| vec![1.0, r.moment()]).collect();
    let twists: Vec<f64> = readings.iter().map(|r| r.twist * PI / 180.0).collect();
    let found = match readings.len() {
        4.. => solve(&design, &twists),
        _ => None,
    };
    let Some((x, covariance)) = found else {
        return Err(
            "the readings do not show a stiffness: allowed are at least 4 with different weights".to_owned(),
        );
    };
    let (Some(&[zero, compliance]), Some(variance)) =
        (x.first_chunk(), covariance.get(1).and_then(|row| row.get(1)))
    else {
        return Err("the readings do not show a stiffness".to_owned());
    };
    let square: f64 = readings
        .iter()
        .zip(&twists)
        .map(|(r, twist)| (twist - zero - compliance * r.moment()).powi(2))
        .sum();
    let freedom = readings.len() - 2;
    let scatter = (square / freedom as f64).sqrt();
    let degrees = scatter * 180.0 / PI;
    if degrees > SCATTER_MAX {
        return Err(format!(
            "the readings lie {degrees:.1} deg off a line, allowed {SCATTER_MAX}: does the lever slip, or the clamp give?"
        ));
    }
    let half = quantile(freedom) * scatter * variance.sqrt();
    if compliance <= half {
        return Err(format!(
            "twist per moment {compliance:.2} +- {half:.2} rad/(N m): allowed is one that shows; take heavier weights"
        ));
    }
    let share = (half / compliance).hypot(MOMENT_ERROR);
    let stiffness = (1.0 - (1.0 - STIFFNESS_RATIO) * slope * slope / 3.0) / compliance;
    Ok(TwistFit {
        stiffness: Fitted {
            name: "torsional stiffness",
            unit: "N m/rad",
            value: stiffness,
            half: share * stiffness,
        },
        scatter: degrees,
    })
}

#[cfg(test)]
mod tests {
    use crate::twist::*;

    /// Without error, of `stiffness`, with a lever that weighs nothing.
    fn bench(stiffness: f64, zero: f64) -> Vec<Reading> {
        [-0.09, -0.06, -0.03, 0.0, 0.03, 0.06, 0.09]
            .map(|mass: f64| {
                let mut twist = 0.0f64;
                for _ in 0..100 {
                    twist = mass * GRAVITY * 0.1 * (twist + zero).cos() / stiffness;
                }
                Reading {
                    mass,
                    lever: 0.1,
                    twist: (twist + zero).to_degrees(),
                }
            })
            .to_vec()
    }

    #[test]
    fn it_finds_what_was_put_in_in_n_m_per_rad() {
        // 90 g at 0.1 m are 0.088 N m: a quarter of a radian on 0.349.
        let readings = bench(0.349, 0.0);
        assert!((readings[6].twist - 14.1).abs() < 0.3, "{readings:?}");
        for (stiffness, zero) in [(0.17, 0.02), (0.349, -0.05), (0.7, 0.0)] {
            let found = fit(&bench(stiffness, zero), 0.0).unwrap();
            assert!(
                (found.stiffness.value / stiffness - 1.0).abs() < 1e-6,
                "{found:?}"
            );
            assert!((found.stiffness.half / stiffness - MOMENT_ERROR).abs() < 1e-6);
        }
    }

    #[test]
    fn what_shows_no_stiffness_is_refused() {
        assert!(
            fit(&bench(0.3, 0.0)[..3], 0.0)
                .unwrap_err()
                .contains("at least 4")
        );
        let same = [Reading {
            mass: 0.03,
            lever: 0.1,
            twist: 5.0,
        }; 6];
        assert!(fit(&same, 0.0).unwrap_err().contains("different weights"));
        let mut slipped = bench(0.3, 0.0);
        slipped[4].twist += 6.0;
        assert!(fit(&slipped, 0.0).unwrap_err().contains("slip"));
        let mut reversed = bench(0.3, 0.0);
        reversed.iter_mut().for_each(|r| r.mass = -r.mass);
        assert!(fit(&reversed, 0.0).unwrap_err().contains("heavier"));
        assert!(fit(&bench(80.0, 0.0), 0.0).is_ok(), "stiff, without scatter");
    }
}
