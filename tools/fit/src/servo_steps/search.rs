//! Search for the unknowns that bring the laws nearest to the measured tilts: least squares after Levenberg and Marquardt.

use super::bench::{Given, Rest, UNKNOWNS, Unknowns, tilts};
use super::{SERVO, TILT};
use crate::least_squares::solve;

/// Most steps.
const STEPS: usize = 60;
/// Differences for the slopes, in the unknowns' order, then of a servo's error.
const APART: [f64; UNKNOWNS] = [1e-4, 1e-3, 2e-7, 1e-6, 1e-3, 1e-4, 1e-4];
const SERVO_APART: f64 = 1e-4;
/// Limits: tilt from α0, and what every arm, thread and channel keeps.
const WITHIN: [(f64, f64); UNKNOWNS] = [
    (-2.0, 1.0),
    (0.1, 30.0),
    (2e-5, 5e-3),
    (-0.02, 0.02),
    (0.0, 1.5),
    (0.0, 0.1),
    (0.8, 1.25),
];

/// The problem: rests, the servo's placement that each belongs to, and prior knowledge (mean, deviation).
struct Problem<'a> {
    rests: &'a [Rest],
    place: Vec<usize>,
    given: &'a Given,
    priors: Vec<(f64, f64)>,
}

impl Problem<'_> {
    fn tilts(&self, x: &[f64]) -> Vec<f64> {
        let mut unknowns: Unknowns = [0.0; UNKNOWNS];
        unknowns.copy_from_slice(&x[..UNKNOWNS]);
        let errors: Vec<f64> = self.place.iter().map(|place| x[UNKNOWNS + place]).collect();
        tilts(self.rests, &errors, &unknowns, self.given)
    }

    /// Residuals at `x`, in deviations: of the tilts, then of the priors.
    fn left(&self, x: &[f64]) -> Vec<f64> {
        let tilts = self.tilts(x);
        let measured = self
            .rests
            .iter()
            .zip(tilts)
            .map(|(rest, tilt)| (rest.tilt - tilt) / TILT);
        let known = self
            .priors
            .iter()
            .zip(x)
            .map(|((mean, deviation), x)| (mean - x) / deviation);
        measured.chain(known).collect()
    }

    /// Slopes of the tilts and of the priors, in deviations.
    fn slopes(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let columns: Vec<Vec<f64>> = (0..x.len())
            .map(|k| {
                let apart = APART.get(k).copied().unwrap_or(SERVO_APART);
                let at = |by: f64| {
                    let mut x = x.to_vec();
                    x[k] += by;
                    self.tilts(&x)
                };
                let (up, down) = (at(apart), at(-apart));
                up.iter()
                    .zip(down)
                    .map(|(up, down)| (up - down) / (2.0 * apart * TILT))
                    .collect()
            })
            .collect();
        let tilts = (0..self.rests.len()).map(|i| columns.iter().map(|column| column[i]).collect());
        let known = self.priors.iter().enumerate().map(|(k, (_, deviation))| {
            let mut row = vec![0.0; x.len()];
            row[k] = 1.0 / deviation;
            row
        });
        tilts.chain(known).collect()
    }
}

/// Best unknowns, their covariance, and the RMS residual of the tilts, rad.
pub fn best(
    rests: &[Rest],
    given: &Given,
    priors: &[(f64, f64); UNKNOWNS],
) -> Result<(Unknowns, Vec<Vec<f64>>, f64), String> {
    // A servo's error is that of its placement: a weight at a standing servo changes none.
    let mut place = vec![0];
    for pair in rests.windows(2) {
        let last = place.last().copied().unwrap_or_default();
        place.push(last + usize::from(pair[0].reel != pair[1].reel));
    }
    let places = place.last().map_or(0, |last| last + 1);
    let servo = std::iter::repeat_n((0.0, SERVO), places);
    let problem = Problem {
        rests,
        place,
        given,
        priors: priors.iter().copied().chain(servo).collect(),
    };
    let mut x: Vec<f64> = problem.priors.iter().map(|(mean, _)| *mean).collect();
    let cost = |left: &[f64]| left.iter().map(|l| l * l).sum::<f64>();
    let mut left = problem.left(&x);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let slopes = problem.slopes(&x);
        let before = cost(&left);
        for _ in 0..10 {
            let Some(step) = damped(&slopes, &left, damping) else {
                break;
            };
            let mut next: Vec<f64> = x.iter().zip(step).map(|(x, step)| x + step).collect();
            for (x, (least, most)) in next.iter_mut().zip(WITHIN) {
                *x = x.max(least).min(most);
            }
            let now = problem.left(&next);
            if cost(&now) < before {
                (x, left) = (next, now);
                damping = (damping * 0.2_f64).max(1e-9);
                break;
            }
            damping *= 5.0;
        }
        if before - cost(&left) < 1e-6 * before.max(1.0) {
            break;
        }
    }
    let covariance = solve(&problem.slopes(&x), &left)
        .map(|(_, covariance)| covariance)
        .ok_or("the rests do not tell the unknowns apart: allowed are steps up and down, with the weight and without")?;
    let square: f64 = left[..rests.len()].iter().map(|l| l * l).sum();
    let mut unknowns: Unknowns = [0.0; UNKNOWNS];
    unknowns.copy_from_slice(&x[..UNKNOWNS]);
    Ok((unknowns, covariance, TILT * (square / rests.len() as f64).sqrt()))
}

/// The step of least squares from the residuals `left`, shortened by `damping`.
fn damped(slopes: &[Vec<f64>], left: &[f64], damping: f64) -> Option<Vec<f64>> {
    let mut design = slopes.to_vec();
    let mut measured = left.to_vec();
    let unknowns = slopes.first()?.len();
    for k in 0..unknowns {
        let norm: f64 = slopes.iter().map(|row| row[k] * row[k]).sum();
        let mut row = vec![0.0; unknowns];
        row[k] = (damping * norm).sqrt();
        design.push(row);
        measured.push(0.0);
    }
    solve(&design, &measured).map(|(step, _)| step)
}
