//! Friction of the skin on a pipe, from pulls along it at known normal loads: Coulomb's law with an adhesion,
//! pull = μ · load + adhesion, a line for the sliding skin and one for the pull that starts it.
//!
//! Along the pipe's axis no wrap adds to the pull: across it the capstan's law would. The flight stack's limit of a lean
//! (`control/src/contact/friction_limit.rs`) knows one coefficient. It gets the sliding one: what a push or the pipe's
//! vibration has started holds no more than that. The adhesion is left out: it is the smaller share the harder the
//! belly presses, and gone on a wet pipe.

use sophie_control::params::Params;

use super::arm::Fitted;
use super::friction_data::Pull;
use super::least_squares::{quantile, solve};

/// Least rows of a dry or of a wet pipe: two numbers, and three degrees of freedom.
pub const ROWS_MIN: usize = 5;
/// Least ratio of the largest load to the smallest.
const LOAD_RATIO: f64 = 1.5;
/// Scale errors that no scatter shows, share of the coefficient, 95 %: 1 % of a luggage scale, 0.5 % of the kitchen
/// scale that weighs the loads, and the rounding of both.
const SCALES: f64 = 0.02;

/// The skin on a dry or on a wet pipe, each number with its 95 % interval.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Wet pipe.
    pub wet: bool,
    /// Coefficient while it slides.
    pub sliding: Fitted,
    /// Pull of the sliding skin without a load, N.
    pub adhesion: Fitted,
    /// Coefficient that the starting pull has; `None` if that was not read.
    pub sticking: Option<Fitted>,
    /// RMS residual of the sliding pull over its degrees of freedom, N.
    pub residual: f64,
}

impl Surface {
    /// `dry` or `wet`.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        if self.wet { "wet" } else { "dry" }
    }
}

/// Fits the pulls: the dry pipe, then the wet one, as far as measured.
///
/// # Errors
/// One line: too few rows, loads that are alike, or a pull that does not rise with the load.
pub fn fit(pulls: &[Pull]) -> Result<Vec<Surface>, String> {
    let mut surfaces = Vec::new();
    for wet in [false, true] {
        let rows: Vec<Pull> = pulls.iter().copied().filter(|pull| pull.wet == wet).collect();
        if !rows.is_empty() {
            surfaces.push(surface(&rows, wet)?);
        }
    }
    Ok(surfaces)
}

fn surface(rows: &[Pull], wet: bool) -> Result<Surface, String> {
    let name = if wet { "wet" } else { "dry" };
    if rows.len() < ROWS_MIN {
        return Err(format!(
            "{} rows of a {name} pipe: allowed are at least {ROWS_MIN}",
            rows.len()
        ));
    }
    let loads = rows.iter().map(|row| row.load);
    let (low, high) = loads.fold((f64::INFINITY, 0.0_f64), |(l, h), load| {
        (l.min(load), h.max(load))
    });
    if high < LOAD_RATIO * low {
        return Err(format!(
            "load_n of a {name} pipe spans {low} to {high} N: allowed is a largest load of {LOAD_RATIO} times the smallest"
        ));
    }
    let sliding = Line::of(rows.iter().map(|row| (row.load, row.sliding)), name)?;
    let started: Vec<(f64, f64)> = rows
        .iter()
        .filter_map(|row| row.starting.map(|pull| (row.load, pull)))
        .collect();
    let sticking = (started.len() >= ROWS_MIN)
        .then(|| Line::of(started.into_iter(), name))
        .transpose()?;
    Ok(Surface {
        wet,
        sliding: sliding.slope("friction, sliding"),
        adhesion: Fitted {
            name: "adhesion",
            unit: "N",
            value: sliding.at_none[0],
            half: sliding.at_none[1],
        },
        sticking: sticking.map(|line| line.slope("friction, starting")),
        residual: sliding.residual,
    })
}

/// A line of pulls over loads.
struct Line {
    /// Slope and half of its interval by the scatter.
    slope: [f64; 2],
    /// The same without a load, N.
    at_none: [f64; 2],
    residual: f64,
}

impl Line {
    fn of(points: impl Iterator<Item = (f64, f64)>, name: &str) -> Result<Self, String> {
        let (design, pulls): (Vec<Vec<f64>>, Vec<f64>) =
            points.map(|(load, pull)| (vec![load, 1.0], pull)).unzip();
        let (x, covariance) =
            solve(&design, &pulls).ok_or_else(|| format!("the rows of a {name} pipe have one load alone"))?;
        let freedom = design.len() - 2;
        let square: f64 = design
            .iter()
            .zip(&pulls)
            .map(|(row, pull)| (pull - row[0] * x[0] - x[1]).powi(2))
            .sum();
        let residual = (square / freedom as f64).sqrt();
        let half = |at: usize| quantile(freedom) * residual * covariance[at][at].sqrt();
        if x[0] <= half(0) {
            return Err(format!(
                "the pull on a {name} pipe does not rise with the load: {:.3} ± {:.3} N/N, allowed is more than that \
                 interval",
                x[0],
                half(0)
            ));
        }
        Ok(Self {
            slope: [x[0], half(0)],
            at_none: [x[1], half(1)],
            residual,
        })
    }

    fn slope(&self, name: &'static str) -> Fitted {
        let [value, half] = self.slope;
        Fitted {
            name,
            unit: "",
            value,
            half: half.hypot(SCALES * value),
        }
    }
}

/// `pipe_friction` by the `surfaces`: the least that slides, since a pipe that was wet once will be again; `None` of
/// none.
///
/// # Errors
/// One line: the coefficient, and the range of the parameter.
pub fn parameter(surfaces: &[Surface]) -> Result<Option<Fitted>, String> {
    let least = surfaces
        .iter()
        .min_by(|a, b| a.sliding.value.total_cmp(&b.sliding.value));
    let Some(surface) = least else {
        return Ok(None);
    };
    let found = surface.sliding;
    if let Some(row) = Params::row("pipe_friction")
        && !row.allows(found.value as f32)
    {
        return Err(format!(
            "friction of the {} pipe is {:.3}: pipe_friction takes {} to {}",
            surface.name(),
            found.value,
            row.min,
            row.max
        ));
    }
    Ok(Some(found))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pulls at 5, 10 and 15 N, two each, with `off` N added to one and taken off the other.
    fn pulls(wet: bool, friction: f64, adhesion: f64, off: f64) -> Vec<Pull> {
        [5.0, 10.0, 15.0]
            .into_iter()
            .flat_map(|load| {
                [off, -off].map(|off| Pull {
                    load,
                    sliding: friction * load + adhesion + off,
                    starting: Some(1.4 * friction * load + adhesion),
                    wet,
                })
            })
            .collect()
    }

    #[test]
    fn coefficient_and_adhesion_are_found_with_their_intervals() {
        let rows = [pulls(false, 0.6, 0.3, 0.2), pulls(true, 0.25, 0.0, 0.0)].concat();
        let [dry, wet] = fit(&rows).unwrap().try_into().unwrap();
        assert!((dry.sliding.value - 0.6).abs() < 1e-9 && (dry.adhesion.value - 0.3).abs() < 1e-9);
        assert!((dry.sticking.unwrap().value - 0.84).abs() < 1e-9);
        // Residuals of 0.2 N, six rows: s² = 6 · 0.04 / 4; Σ(x - 10)² = 100: 2.776 · 0.24495 / 10 = 0.0680.
        let by_hand = 0.068_f64.hypot(0.6 * SCALES);
        assert!((dry.sliding.half - by_hand).abs() < 0.001, "{dry:?}");
        assert!((wet.sliding.half - 0.25 * SCALES).abs() < 1e-6 && wet.wet);
        // The wet pipe is the worse one.
        assert!((parameter(&[dry, wet]).unwrap().unwrap().value - 0.25).abs() < 1e-9);
        assert!(parameter(&[]).unwrap().is_none());
    }

    #[test]
    fn rows_that_cannot_tell_are_refused_in_a_line() {
        let why = |rows: &[Pull]| fit(rows).unwrap_err();
        let rows = pulls(false, 0.6, 0.3, 0.1);
        assert!(why(&rows[..4]).starts_with("4 rows of a dry pipe: allowed are at least 5"));
        let alike: Vec<Pull> = rows.iter().map(|row| Pull { load: 10.0, ..*row }).collect();
        assert!(why(&alike).starts_with("load_n of a dry pipe spans 10 to 10 N"));
        assert!(why(&pulls(true, 0.02, 1.0, 0.3)).starts_with("the pull on a wet pipe does not rise"));
        let slippery = fit(&pulls(true, 0.05, 0.0, 0.0)).unwrap();
        assert!(
            parameter(&slippery)
                .unwrap_err()
                .starts_with("friction of the wet pipe is 0.050")
        );
    }
}
