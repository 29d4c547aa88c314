//! A tendon from steps of its servo: stiffness, slack and friction by the tilt of a free arm, with and without a known
//! weight on its tip.
//!
//! The arm is the scale ([`mod@bench`] has the laws). The weight on the slack thread tilts the arm by its softness c; on the
//! taut one, at a servo that stands, by 1 + k h² c times less, whatever the servo's error. The loop of winding and easing
//! gives μ, against the servo's play, which unlike friction does not grow with the tension; the angle at which the
//! thread tightens gives the slack.
//!
//! What does not follow: radius of the reel and lever scale the same equations, so k is that of the assumed ones (2 %
//! more radius are 4 % less k), and their ratio comes out no better than a print has it ([`Found::lever_share`]).

pub mod bench;
pub mod data;
pub mod plan;
mod search;

use self::bench::{Given, Rest, UNKNOWNS};
use crate::least_squares::quantile;

/// Error of a mean tilt at rest, rad: what a BNO055's running calibration leaves within minutes, 0.5°.
const TILT: f64 = 0.0087;
/// Error of a servo that stands, beyond its play, rad: a third of the stop error of the worst (0.5 to 2.5°).
const SERVO: f64 = 0.0087;
/// Mean and standard deviation of the play, rad: 0.2 to 1 times that stop error.
const PLAY: (f64, f64) = (0.016, 0.012);
/// Of the ratio of lever and radius: ± 5 % and ± 4 % as printed, evenly spread.
const RATIO: f64 = 0.037;
/// Of the radius alone.
const RADIUS: f64 = 0.023;
/// Before the data: wide.
const SOFTNESS: (f64, f64) = (1.6, 100.0);
const STIFFNESS: f64 = 4000.0;
const SLACK: f64 = 0.02;
const FRICTION: (f64, f64) = (0.3, 1.0);
/// Least rests, least weight, N, and least tilts: of the slack arm by the weight and of the arm by its tendon, rad.
const RESTS: usize = 10;
const WEIGHT: f64 = 1.0;
const TILTED: f64 = 0.07;
const WOUND: f64 = 0.17;
/// Largest RMS difference between tilts and law, rad: 1.5°.
const RESIDUAL: f64 = 0.026;
const NORMAL: f64 = 1.96;
/// Friction above which closings take 6 to 10 s.
const SLOW: f64 = 0.4;

/// A number with the ends of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranged {
    /// Best estimate.
    pub value: f64,
    /// Lower end.
    pub least: f64,
    /// Upper end.
    pub most: f64,
}

impl Ranged {
    fn around(value: f64, half: f64) -> Self {
        Self {
            value,
            least: value - half,
            most: value + half,
        }
    }

    /// The same in another unit.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            least: self.least * factor,
            most: self.most * factor,
        }
    }

    /// Whether it holds `number`.
    #[must_use]
    pub fn holds(&self, number: f64) -> bool {
        (self.least..=self.most).contains(&number)
    }
}

/// What the steps show of one tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// From reel to anchor, servo's sag included, N/m.
    pub stiffness: Ranged,
    /// Length to be wound at the release mark until a winding servo has the thread as taut as it should be, m.
    pub slack: Ranged,
    /// Coefficient of friction in the channel.
    pub friction: Ranged,
    /// Ratio of lever and radius over the assumed one.
    pub lever_share: Ranged,
    /// Tilt per moment, rad/(N·m).
    pub softness: Ranged,
    /// RMS difference between tilts and law, rad.
    pub residual: f64,
}

impl Found {
    /// The numbers with their intervals, a line each.
    #[must_use]
    pub fn lines(&self) -> Vec<String> {
        let shown = |what: &str, range: Ranged, places: usize, unit: &str| {
            let Ranged { value, least, most } = range;
            format!("{what} {value:.places$}{unit}, 95 % within {least:.places$} to {most:.places$}")
        };
        let mut lines = vec![
            shown("stiffness", self.stiffness, 0, " N/m"),
            shown("slack", self.slack.times(1e3), 1, " mm"),
            shown("friction", self.friction, 2, ""),
            shown("lever over radius", self.lever_share, 2, " of the assumed"),
            format!("tilts {:.2} deg RMS from the law", self.residual.to_degrees()),
        ];
        if self.friction.value > SLOW {
            lines.push(format!(
                "friction above {SLOW}: closings take 6 to 10 s; a channel lined with PTFE has 0.1 to 0.3"
            ));
        }
        lines
    }
}

/// Fits the `rests` of one arm, in the order in which they were measured.
///
/// # Errors
/// What the rests lack, one line.
pub fn fit(rests: &[Rest], given: &Given) -> Result<Found, String> {
    let first = check(rests)?;
    let priors: [(f64, f64); UNKNOWNS] = [
        (first.tilt, 1.0),
        SOFTNESS,
        (1.0 / STIFFNESS, 1.0),
        (0.0, SLACK),
        FRICTION,
        PLAY,
        (1.0, RATIO),
    ];
    let (x, covariance, residual) = search::best(rests, given, &priors)?;
    if residual > RESIDUAL {
        return Err(format!(
            "the tilts differ from the law by {:.1} deg RMS: allowed is {:.1}; the arm touched something, or the weight \
             another one",
            residual.to_degrees(),
            RESIDUAL.to_degrees()
        ));
    }
    // Seven unknowns; a scatter beyond the assumed errors widens all intervals.
    let freedom = rests.len().saturating_sub(UNKNOWNS).max(1);
    let scatter = residual * (rests.len() as f64 / freedom as f64).sqrt() / TILT;
    let wide = scatter.max(1.0) * quantile(freedom.max(4));
    let sigma = |k: usize| covariance[k][k].max(0.0).sqrt();
    let [_, softness, give, slack, friction, play, share] = x;
    let log = wide * sigma(2) / give;
    let log = log.hypot(NORMAL * 2.0 * RADIUS);
    let radius = given.reel_radius;
    let slack_error =
        (covariance[3][3] + 2.0 * radius * covariance[3][5] + radius * radius * covariance[5][5])
            .max(0.0)
            .sqrt();
    Ok(Found {
        stiffness: Ranged {
            value: 1.0 / give,
            least: (-log).exp() / give,
            most: log.exp() / give,
        },
        slack: Ranged::around(slack + radius * play, wide * slack_error),
        friction: Ranged::around(friction, wide * sigma(4)),
        lever_share: Ranged::around(share, wide * sigma(6)),
        softness: Ranged::around(softness, wide * sigma(1)),
        residual,
    })
}

/// The first rest of `rests` that suffice.
fn check(rests: &[Rest]) -> Result<&Rest, String> {
    let first = rests
        .first()
        .filter(|_| rests.len() >= RESTS)
        .ok_or_else(|| format!("{} rests: allowed are at least {RESTS}", rests.len()))?;
    if first.reel > 0.0 || first.weight > 0.0 {
        return Err("the first rest is to be at the release mark without the weight".to_owned());
    }
    if rests.iter().all(|rest| rest.weight < WEIGHT) {
        return Err(format!("no rest with a weight: allowed are {WEIGHT} N and more"));
    }
    let slack = |rest: &&Rest| rest.reel == 0.0 && rest.weight >= WEIGHT;
    let taut = |rest: &&Rest| rest.reel > 0.0 && rest.weight >= WEIGHT;
    let (Some(hung), Some(_)) = (rests.iter().find(slack), rests.iter().find(taut)) else {
        return Err("the weight is to hang on the slack thread once, and on the taut one".to_owned());
    };
    let tilted = first.tilt - hung.tilt;
    if tilted < TILTED {
        return Err(format!(
            "the weight tilts the free arm by {:.1} deg: allowed are {:.0} and more; a heavier one, or the arm's sensor",
            tilted.to_degrees(),
            TILTED.to_degrees()
        ));
    }
    let unloaded = rests.iter().filter(|rest| rest.weight == 0.0);
    let deepest = unloaded.map(|rest| rest.tilt).fold(first.tilt, f64::min);
    let wound = first.tilt - deepest;
    if wound < WOUND {
        return Err(format!(
            "the tendon tilts the arm by {:.1} deg: allowed are {:.0} and more; a torn thread, or a servo without power",
            wound.to_degrees(),
            WOUND.to_degrees()
        ));
    }
    Ok(first)
}

#[cfg(test)]
mod tests {
    use super::bench::{Unknowns, tilts};
    use super::*;

    const GIVEN: Given = Given {
        reel_radius: 0.015,
        lever: 0.015,
        length: 0.178,
        bend: 2.0,
        reference: 0.4,
        speed: 6.16,
    };

    /// Rests of a known tendon: free, with the weight, up, with the weight twice, and down; `error` rad of tilt.
    fn rests(x: &Unknowns, error: f64) -> Vec<Rest> {
        let wound = [
            0.0, 0.0, 0.0, 1.1, 1.4, 1.7, 1.7, 1.7, 2.0, 2.3, 2.3, 2.3, 2.3, 2.3, 2.0, 1.7, 1.4, 1.1, 0.0,
        ];
        let hung = [1, 6, 10, 12];
        let mut rests: Vec<Rest> = wound
            .iter()
            .enumerate()
            .map(|(i, reel)| Rest {
                reel: *reel,
                weight: if hung.contains(&i) { 3.0 } else { 0.0 },
                tilt: 0.0,
            })
            .collect();
        let found = tilts(&rests, &vec![0.0; rests.len()], x, &GIVEN);
        for (i, (rest, tilt)) in rests.iter_mut().zip(found).enumerate() {
            rest.tilt = tilt + error * (1.7 * (i as f64 + 1.0).powi(2)).sin();
        }
        rests
    }

    fn known(stiffness: f64, slack: f64, friction: f64) -> Unknowns {
        [-0.55, 1.5, 1.0 / stiffness, slack, friction, 0.01, 1.0]
    }

    #[test]
    fn it_finds_what_was_put_in_with_intervals_that_hold_it() {
        for (stiffness, slack, friction) in [(8000.0, 0.0, 0.1), (4000.0, 1e-3, 0.3), (2000.0, 2e-3, 0.6)] {
            let found = fit(&rests(&known(stiffness, slack, friction), 0.004), &GIVEN).unwrap();
            assert!(
                found.stiffness.holds(stiffness) && (found.stiffness.value / stiffness - 1.0).abs() < 0.1,
                "{found:?}"
            );
            assert!(
                found.slack.holds(slack + 0.01 * 0.015) && found.friction.holds(friction),
                "{found:?}"
            );
            assert!((found.friction.value - friction).abs() < 0.12, "{found:?}");
        }
    }

    #[test]
    fn a_lighter_weight_makes_a_wider_interval() {
        let x = known(4000.0, 0.0, 0.3);
        let width = |rests: &[Rest]| {
            let found = fit(rests, &GIVEN).unwrap().stiffness;
            (found.most - found.least) / found.value
        };
        let heavy = rests(&x, 0.0);
        let mut light = heavy.clone();
        for rest in light.iter_mut().filter(|rest| rest.weight > 0.0) {
            rest.weight = 1.0;
        }
        let found = tilts(&light, &vec![0.0; light.len()], &x, &GIVEN);
        for (rest, tilt) in light.iter_mut().zip(found) {
            rest.tilt = tilt;
        }
        assert!(width(&light) > 1.3 * width(&heavy));
    }

    #[test]
    fn rests_that_cannot_tell_are_refused() {
        let good = rests(&known(4000.0, 0.0, 0.3), 0.0);
        let why = |change: &dyn Fn(&mut Vec<Rest>)| {
            let mut rests = good.clone();
            change(&mut rests);
            fit(&rests, &GIVEN).unwrap_err()
        };
        assert_eq!(
            why(&|rests| rests.truncate(9)),
            "9 rests: allowed are at least 10"
        );
        assert!(why(&|rests| rests[0].reel = 0.1).contains("at the release mark without the weight"));
        assert!(
            why(&|rests| rests.iter_mut().for_each(|rest| rest.weight = 0.0)).starts_with("no rest with")
        );
        assert!(why(&|rests| rests[1].weight = 0.0).contains("on the slack thread once"));
        assert!(why(&|rests| rests[1].tilt = rests[0].tilt).contains("tilts the free arm by 0.0 deg"));
        assert!(
            why(&|rests| rests.iter_mut().for_each(|rest| if rest.weight == 0.0 {
                rest.tilt = -0.55
            }))
            .contains("a torn thread")
        );
        assert!(why(&|rests| rests[5].tilt += 0.4).contains("differ from the law by"));
    }
}
