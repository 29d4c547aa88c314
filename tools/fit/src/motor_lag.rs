//! Lag of motor and propeller from a train of steps: the time constants with which a rotor gains and loses speed.
//!
//! The train ([`sophie_control::pilot::static_thrust_test`]) steps between two drives, a known time apart. The speed after
//! a step at t0 is ω(t) = ω1 + (ω0 - ω1) e^(-(t - t0)/τ), seen through the window of the track. A step's τ and t0 are
//! fitted together, since controller and motor begin late; the interval is Student's over the steps of one direction.

use sophie_control::pilot::static_thrust_test;

use crate::least_squares::{quantile, solve};
use crate::rotor_sound::{HOP, Track, WINDOW};

/// Steps of a train, up and down in turn.
const STEPS: usize = 2 * static_thrust_test::STEPS as usize;
/// Lags that are looked for, s.
pub const LAGS: (f64, f64) = (0.01, 0.35);
/// Least ratio of the two speeds: 30 to 60 % drive make 1.8.
const RATIO_MIN: f64 = 1.15;
/// Largest RMS error of the steps' fit, share of the step: of a track that follows something else, or a rotor that stalls.
const MISFIT_MAX: f64 = 0.12;
/// Largest delay of a step after its time in the train, s, and how far it may come early by the train's own error.
const LATE: f64 = 0.06;
/// Standard error of a median over that of a mean.
const MEDIAN: f64 = 1.25;
/// What the window's model leaves: s, and share of the lag (tests/lag.rs).
const SYSTEMATIC: (f64, f64) = (0.004, 0.04);
/// The same of a fall faster than the window is long, s: the louder tones before it hide its end.
const HIDDEN: f64 = 0.35 * WINDOW;
/// Parts of a hop into which the model is divided.
const FINE: usize = 4;

/// A lag with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Time constant, s.
    pub tau: f64,
    /// Half of the 95 % interval, s.
    pub half: f64,
}

/// The result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorLag {
    /// While the rotor gains speed.
    pub up: Lag,
    /// While it loses speed.
    pub down: Lag,
    /// Speed at the second drive over that at the first.
    pub ratio: f64,
    /// RMS error of the fit, share of the step.
    pub misfit: f64,
}

impl MotorLag {
    /// The one lag that the stack takes (`motor_tau`): the mean of both, since a loop about hover speeds up and slows down
    /// alike; never less than the rise, which is heard more exactly.
    #[must_use]
    pub fn lag(&self) -> Lag {
        if self.down.tau < self.up.tau {
            return self.up;
        }
        Lag {
            tau: 0.5 * (self.up.tau + self.down.tau),
            half: 0.5 * self.up.half.hypot(self.down.half),
        }
    }
}

/// One step, in units of the whole step.
struct Stepped {
    tau: f64,
    late: f64,
    squares: f64,
    count: usize,
}

/// Fits the train with `hold` s at each drive.
///
/// # Errors
/// One line: no such train in the track, or not a motor's.
pub fn fit(track: &Track, hold: f64) -> Result<MotorLag, String> {
    let n = (hold / HOP) as usize;
    let logs: Vec<f64> = track.rates.iter().map(|rate| rate.ln()).collect();
    if logs.len() < (STEPS + 1) * n {
        return Err(format!(
            "{:.1} s of sound: allowed is a whole train, {:.1} s",
            logs.len() as f64 * HOP,
            (STEPS as f64 + 1.0) * hold
        ));
    }
    let begin = train(&logs, n);
    // Second halves of all times at a drive.
    let level = |odd: usize| {
        let mut rates: Vec<f64> = (0..=STEPS)
            .filter(|i| i % 2 == odd)
            .flat_map(|i| {
                track.rates[begin + i * n + n / 2..begin + (i + 1) * n - n / 8]
                    .iter()
                    .copied()
            })
            .collect();
        rates.sort_by(f64::total_cmp);
        rates[rates.len() / 2]
    };
    let (low, high) = (level(0), level(1));
    let ratio = high / low;
    if !(RATIO_MIN..=4.0).contains(&ratio) {
        return Err(format!(
            "the speeds of the two drives differ by {ratio:.2}: allowed is {RATIO_MIN} to 4; is the phone beside the rotor?"
        ));
    }
    let steps: Vec<Stepped> = (1..=STEPS)
        .map(|i| {
            let at = begin + i * n;
            let (from, to) = if i % 2 == 1 { (low, high) } else { (high, low) };
            let shares: Vec<f64> = track.rates[at - n / 4..at + n - n / 8]
                .iter()
                .map(|rate| (rate - from) / (to - from))
                .collect();
            stepped(&shares, (n / 4) as f64 * HOP, to / from)
        })
        .collect();
    let count: usize = steps.iter().map(|s| s.count).sum();
    let misfit = (steps.iter().map(|s| s.squares).sum::<f64>() / count as f64).sqrt();
    if misfit > MISFIT_MAX {
        return Err(format!(
            "the speed leaves the model by {:.0} % of a step: allowed are {:.0}; quieter, and the phone nearer",
            100.0 * misfit,
            100.0 * MISFIT_MAX
        ));
    }
    let of = |odd: usize| {
        let taus: Vec<f64> = steps.iter().skip(1 - odd).step_by(2).map(|s| s.tau).collect();
        let mut found = lag(&taus);
        if odd == 0 && found.tau < WINDOW {
            found.half = found.half.hypot(HIDDEN);
        }
        found
    };
    Ok(MotorLag {
        up: of(1),
        down: of(0),
        ratio,
        misfit,
    })
}

/// Index at which the first time at the first drive begins: where the track is the most like the train.
fn train(logs: &[f64], n: usize) -> usize {
    let prefix: Vec<f64> = std::iter::once(0.0)
        .chain(logs.iter().scan(0.0, |sum, log| {
            *sum += log;
            Some(*sum)
        }))
        .collect();
    let squares: Vec<f64> = std::iter::once(0.0)
        .chain(logs.iter().scan(0.0, |sum, log| {
            *sum += log * log;
            Some(*sum)
        }))
        .collect();
    let length = (STEPS + 1) * n;
    let likeness = |begin: usize| {
        let part = |i: usize| prefix[begin + (i + 1) * n] - prefix[begin + i * n];
        let (mut odd, mut even) = (0.0, 0.0);
        for i in 0..=STEPS {
            if i % 2 == 1 {
                odd += part(i)
            } else {
                even += part(i)
            }
        }
        let (odds, evens) = ((STEPS / 2 * n) as f64, ((STEPS / 2 + 1) * n) as f64);
        let (high, low) = (odd / odds, even / evens);
        // What the two levels explain of the spread.
        let rest = squares[begin + length] - squares[begin] - odds * high * high - evens * low * low;
        if high > low { rest } else { f64::INFINITY }
    };
    (0..=logs.len() - length)
        .min_by(|a, b| likeness(*a).total_cmp(&likeness(*b)))
        .unwrap_or(0)
}

/// Fits τ and delay to the shares of a step, which is due `due` s after their begin.
fn stepped(shares: &[f64], due: f64, ratio: f64) -> Stepped {
    let mut best = Stepped {
        tau: f64::NAN,
        late: 0.0,
        squares: f64::INFINITY,
        count: shares.len(),
    };
    let error = |tau: f64, late: f64| -> f64 {
        shares
            .iter()
            .zip(model(shares.len(), due + late, tau, ratio))
            .map(|(share, model)| (share - model).clamp(-0.5, 0.5).powi(2))
            .sum()
    };
    let mut tau = LAGS.0;
    while tau <= LAGS.1 {
        let mut late = -LATE;
        while late <= 2.0 * LATE {
            let squares = error(tau, late);
            if squares < best.squares {
                best = Stepped {
                    tau,
                    late,
                    squares,
                    ..best
                };
            }
            late += 0.004;
        }
        tau *= 1.08;
    }
    // Gauss-Newton from there.
    for _ in 0..8 {
        let (dt, dl) = (0.01 * best.tau, 0.0005);
        let base = model(shares.len(), due + best.late, best.tau, ratio);
        let by_tau = model(shares.len(), due + best.late, best.tau + dt, ratio);
        let by_late = model(shares.len(), due + best.late + dl, best.tau, ratio);
        let design: Vec<Vec<f64>> = (0..shares.len())
            .map(|i| vec![(by_tau[i] - base[i]) / dt, (by_late[i] - base[i]) / dl])
            .collect();
        let rest: Vec<f64> = shares
            .iter()
            .zip(&base)
            .map(|(share, model)| (share - model).clamp(-0.5, 0.5))
            .collect();
        let Some((x, _)) = solve(&design, &rest) else {
            break;
        };
        let (tau, late) = ((best.tau + x[0]).clamp(LAGS.0, LAGS.1), best.late + x[1]);
        let squares = error(tau, late);
        if squares >= best.squares {
            break;
        }
        best = Stepped {
            tau,
            late,
            squares,
            ..best
        };
    }
    best
}

/// Shares of a step to `ratio` times the speed at `at` s with `tau`, as the track sees them: mean over a window by what each
/// moment gives to its spectrum, the window's square and the sound's energy. The sound goes with the thrust, its energy
/// with the fourth power of the speed.
fn model(count: usize, at: f64, tau: f64, ratio: f64) -> Vec<f64> {
    let step = HOP / FINE as f64;
    let half = (0.5 * WINDOW / step) as isize;
    let window: Vec<f64> = (-half..=half)
        .map(|i| (std::f64::consts::PI * i as f64 * step / WINDOW).cos().powi(4))
        .collect();
    let share = |t: f64| {
        if t > at {
            1.0 - (-(t - at) / tau).exp()
        } else {
            0.0
        }
    };
    let fine: Vec<(f64, f64)> = (-half..(count * FINE) as isize + half)
        .map(|i| {
            let share = share(i as f64 * step);
            (share, (1.0 + (ratio - 1.0) * share).powi(4))
        })
        .collect();
    (0..count)
        .map(|i| {
            let within = fine[i * FINE..].iter().zip(&window);
            let (sum, all) = within.fold((0.0, 0.0), |(sum, all), ((share, energy), weight)| {
                (sum + share * energy * weight, all + energy * weight)
            });
            sum / all
        })
        .collect()
}

/// Median, so that one bad step does no harm, and an interval by Student and the spread.
fn lag(taus: &[f64]) -> Lag {
    let mut sorted = taus.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = taus.len() as f64;
    let mean = taus.iter().sum::<f64>() / n;
    let spread = (taus.iter().map(|tau| (tau - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let chance = MEDIAN * quantile(taus.len() - 1) * spread / n.sqrt();
    let tau = sorted[taus.len() / 2];
    Lag {
        tau,
        half: chance.hypot(SYSTEMATIC.0 + SYSTEMATIC.1 * tau),
    }
}
