//! Least-squares fit of the stack's thrust law to readings of a scale, with 95 % intervals.
//!
//! T = T_max f_i (V/V0)^p (q u² + (1 - q) u) along the thrust of rotor i at the command u, f_i with mean 1; the scale shows
//! T cos α of an arm that its thrust has bent by α. Errors of a reading are shares of it, so logarithms weigh readings
//! alike, in two linear steps:
//!
//! 1. ln T = μ_u + p ln(V/V0) + ln f_i, with a level μ_u of its own for each command. Power and trims come from readings at
//!    one command, whatever the curve's shape.
//! 2. ln T_max + ln(q u² + (1 - q) u) through the levels, Gauss-Newton for q. What the shape leaves, at most, is part of the
//!    interval of T_max, and so is the scale's own gain, which no residual shows.
//!
//! T_max is that of the air on the day of the readings, at sea level and 15 °C 1.225 kg/m³.

use super::arm::Fitted;
use super::least_squares::{quantile, solve};
use super::thrust_data::Reading;

/// Largest plausible scatter of a reading, share: prop wash on a scale makes 1 %.
pub const SCATTER_MAX: f64 = 0.03;
/// Largest plausible distance of a reading from the law, share: the law's shape costs 3 %.
pub const WORST_MAX: f64 = 0.08;
/// Half of the 95 % interval of a kitchen scale's gain, share.
pub const SCALE: f64 = 0.003;
/// The voltage's power where two voltages do not tell it: the stack's default.
pub const POWER: f64 = 2.0;
/// Power of motors with a large winding's drop: the other end of what is usual.
const LEAST_POWER: f64 = 1.5;
/// Least range of the voltage of all rotors at one command, share: two batteries, of which one is used.
const VOLTAGE_SPAN: f64 = 0.04;
/// Largest half interval at which the readings tell the power.
const POWER_TOLD: f64 = 0.25;
/// RMS of one reading, share, where too few repeat each other to show it (assumed).
const READING: f64 = 0.01;
/// Rows beyond the unknowns that show it.
const SPARE: usize = 2;
/// Least range of the commands, share of full drive, and number of different ones.
const COMMAND_SPAN: f64 = 0.3;
const LEVELS: usize = 3;
/// Commands that differ by less are one, share of full drive.
const SAME: f64 = 0.002;
const STEPS: u32 = 30;
/// Passes for the mean of the trims: the first is off by half of their variance, 4e-4 for 3 %.
const PASSES: u32 = 4;

/// The parameters with their 95 % intervals.
#[derive(Clone, Debug)]
pub struct ThrustFit {
    /// `thrust_max`, N.
    pub max: Fitted,
    /// `thrust_curve`.
    pub curve: Fitted,
    /// `thrust_volt_exp`; `None` where the voltages do not tell it.
    pub power: Option<Fitted>,
    /// `thrust_trim_1` to `_4`; `None` where each rotor was not read alone.
    pub trims: Option<[Fitted; 4]>,
    /// RMS of a reading beside the others at its command, share; `None` where too few repeat each other.
    pub scatter: Option<f64>,
    /// Largest distance of the law from the level of a command, share.
    pub shape: f64,
    /// Row (from 0) that is farthest from the law, and its distance, share.
    pub worst: (usize, f64),
}

const TRIMS: [&str; 4] = ["thrust_trim_1", "thrust_trim_2", "thrust_trim_3", "thrust_trim_4"];

/// Fits `rows`, with T_max at `nominal` V.
///
/// # Errors
/// What the readings lack, one line.
pub fn fit(rows: &[Reading], nominal: f64) -> Result<ThrustFit, String> {
    let alone: Vec<usize> = (0..4)
        .filter(|rotor| rows.iter().any(|row| row.rotor == Some(*rotor)))
        .collect();
    if !(alone.is_empty() || alone.len() == 4) {
        let names: Vec<String> = alone.iter().map(|rotor| (rotor + 1).to_string()).collect();
        return Err(format!(
            "rows of rotor {} alone: allowed are rows of each of the four, or of none",
            names.join(", ")
        ));
    }
    let commands = commands(rows);
    let (low, high) = (
        commands.first().copied().unwrap_or_default(),
        commands.last().copied().unwrap_or_default(),
    );
    if commands.len() < LEVELS || high - low < COMMAND_SPAN - 1e-9 {
        return Err(format!(
            "{} commands from {:.0} to {:.0} %: allowed are {LEVELS} at least, over {:.0} %",
            commands.len(),
            100.0 * low,
            100.0 * high,
            100.0 * COMMAND_SPAN
        ));
    }
    let trims = !alone.is_empty();
    let with = |power| Levels::of(rows, &commands, nominal, Unknowns { power, trims });
    let free = (voltage_span(rows, &commands) >= VOLTAGE_SPAN).then(|| with(Power::Fitted).ok());
    let free = free.flatten().filter(|free| free.half_power() <= POWER_TOLD);
    let told = free.is_some();
    let levels = match free {
        Some(levels) => levels,
        None => with(Power::Fixed(POWER))?,
    };
    let curve = Curve::through(&levels)?;
    // What an assumed power may cost the others.
    let beside = match told {
        true => [0.0; 2],
        false => {
            let other = Curve::through(&with(Power::Fixed(LEAST_POWER))?)?;
            [other.max_log - curve.max_log, other.quadratic - curve.quadratic]
        }
    };
    Ok(result(rows, &levels, &curve, beside))
}

/// Each command once, rising.
fn commands(rows: &[Reading]) -> Vec<f64> {
    let mut all: Vec<f64> = rows.iter().map(|row| row.command).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| *a - *b < SAME);
    all
}

/// Largest ratio of two voltages of all rotors at one command, less one.
fn voltage_span(rows: &[Reading], commands: &[f64]) -> f64 {
    let at = |command: &f64| {
        rows.iter()
            .filter(|row| row.rotor.is_none() && (row.command - command).abs() < SAME)
            .map(|row| row.voltage)
            .fold((f64::INFINITY, 0.0f64), |(low, high), v| {
                (low.min(v), high.max(v))
            })
    };
    let spans = commands.iter().map(at).map(|(low, high)| high / low - 1.0);
    spans.fold(0.0, f64::max)
}

#[derive(Clone, Copy)]
enum Power {
    Fitted,
    Fixed(f64),
}

#[derive(Clone, Copy)]
struct Unknowns {
    power: Power,
    trims: bool,
}

/// First step: a level for each command, the power, and ln f of rotors 1 to 3.
struct Levels {
    commands: Vec<f64>,
    nominal: f64,
    unknowns: Unknowns,
    values: Vec<f64>,
    covariance: Vec<Vec<f64>>,
    scatter: Option<f64>,
    /// Student's quantile for the scatter.
    quantile: f64,
}

impl Levels {
    /// The levels are those of a rotor of the geometric mean: the arithmetic one, of which four rotors give four times the
    /// thrust, follows from the trims in a few passes.
    fn of(rows: &[Reading], commands: &[f64], nominal: f64, unknowns: Unknowns) -> Result<Self, String> {
        let mut levels = Self::pass(rows, commands, nominal, unknowns, 1.0)?;
        for _ in 0..PASSES {
            levels = Self::pass(rows, commands, nominal, unknowns, mean(&levels.factors()))?;
        }
        Ok(levels)
    }

    /// One pass, in which four rotors give `mean` times the thrust of four of the geometric mean.
    fn pass(
        rows: &[Reading],
        commands: &[f64],
        nominal: f64,
        unknowns: Unknowns,
        mean: f64,
    ) -> Result<Self, String> {
        let ratio = |row: &Reading| (row.voltage / nominal).ln();
        let design: Vec<Vec<f64>> = rows
            .iter()
            .map(|row| {
                let of = |command: &f64| f64::from(u8::from((row.command - command).abs() < SAME));
                let mut line: Vec<f64> = commands.iter().map(of).collect();
                if matches!(unknowns.power, Power::Fitted) {
                    line.push(ratio(row));
                }
                if unknowns.trims {
                    line.extend((0..3).map(|i| match row.rotor {
                        Some(3) => -1.0,
                        Some(rotor) if rotor == i => 1.0,
                        _ => 0.0,
                    }));
                }
                line
            })
            .collect();
        let fixed = match unknowns.power {
            Power::Fitted => 0.0,
            Power::Fixed(power) => power,
        };
        let measured: Vec<f64> = rows
            .iter()
            .map(|row| {
                let rotors = if row.rotor.is_some() { 1.0 } else { 4.0 * mean };
                (row.force / (rotors * row.tilt.cos())).ln() - fixed * ratio(row)
            })
            .collect();
        let (values, inverse) = solve(&design, &measured).ok_or_else(|| {
            "the readings do not tell the unknowns apart: allowed are several rows of each command".to_owned()
        })?;
        let square: f64 = design
            .iter()
            .zip(&measured)
            .map(|(line, m)| (m - line.iter().zip(&values).map(|(a, b)| a * b).sum::<f64>()).powi(2))
            .sum();
        let spare = rows
            .len()
            .checked_sub(values.len())
            .filter(|spare| *spare >= SPARE);
        let scatter = spare.map(|spare| (square / spare as f64).sqrt());
        let variance = scatter.unwrap_or(READING).powi(2);
        Ok(Self {
            commands: commands.to_vec(),
            nominal,
            unknowns,
            values,
            covariance: inverse
                .into_iter()
                .map(|line| line.into_iter().map(|c| c * variance).collect())
                .collect(),
            scatter,
            quantile: spare.map_or(2.0, quantile),
        })
    }

    fn half(&self, at: usize) -> f64 {
        self.quantile * self.covariance[at][at].max(0.0).sqrt()
    }

    fn power(&self) -> f64 {
        match self.unknowns.power {
            Power::Fitted => self.values[self.commands.len()],
            Power::Fixed(power) => power,
        }
    }

    /// Half interval of the power; infinite where the rows show no scatter to judge it by.
    fn half_power(&self) -> f64 {
        match (self.unknowns.power, self.scatter) {
            (Power::Fitted, Some(_)) => self.half(self.commands.len()),
            _ => f64::INFINITY,
        }
    }

    fn trims_at(&self) -> usize {
        self.commands.len() + usize::from(matches!(self.unknowns.power, Power::Fitted))
    }

    /// Thrust of each rotor over the geometric mean.
    fn factors(&self) -> [f64; 4] {
        self.trims()
            .map_or([1.0; 4], |logs| logs.map(|(log, _)| log.exp()))
    }

    /// ln f of each rotor, whose sum is 0, with its half interval.
    fn trims(&self) -> Option<[(f64, f64); 4]> {
        if !self.unknowns.trims {
            return None;
        }
        let at = self.trims_at();
        let three = [at, at + 1, at + 2];
        let last = -three.iter().map(|i| self.values[*i]).sum::<f64>();
        let variance: f64 = three
            .iter()
            .flat_map(|i| three.iter().map(|j| self.covariance[*i][*j]))
            .sum();
        let [a, b, c] = three.map(|i| (self.values[i], self.half(i)));
        Some([a, b, c, (last, self.quantile * variance.max(0.0).sqrt())])
    }
}

/// Second step: the law through the levels.
struct Curve {
    max_log: f64,
    quadratic: f64,
    /// Half intervals of both by the readings' scatter.
    halves: [f64; 2],
    /// Distance of each level from the law.
    misses: Vec<f64>,
    /// (XᵀX)⁻¹ of q.
    spread: f64,
}

impl Curve {
    fn through(levels: &Levels) -> Result<Self, String> {
        let (mut max_log, mut quadratic) = (2.0, 0.75);
        let mut inverse = Vec::new();
        let mut design = Vec::new();
        let misses = |max_log: f64, q: f64| -> Vec<f64> {
            let at = levels.commands.iter().zip(&levels.values);
            at.map(|(u, level)| level - max_log - (rest(q, *u) * u).ln())
                .collect()
        };
        for _ in 0..STEPS {
            design = levels
                .commands
                .iter()
                .map(|u| vec![1.0, (u - 1.0) / rest(quadratic, *u)])
                .collect::<Vec<_>>();
            let (step, found) = solve(&design, &misses(max_log, quadratic)).ok_or_else(|| {
                "the readings do not tell the curve: allowed are several commands".to_owned()
            })?;
            inverse = found;
            max_log += step[0];
            quadratic = (quadratic + step[1]).clamp(-0.5, 1.3);
        }
        // Both are sums of levels: x = (XᵀX)⁻¹ Xᵀ μ.
        let weights = |i: usize| -> Vec<f64> {
            let row = |line: &Vec<f64>| (0..2).map(|j| inverse[i][j] * line[j]).sum();
            design.iter().map(row).collect()
        };
        let half = |i: usize| {
            let w = weights(i);
            let variance: f64 = (0..w.len())
                .flat_map(|a| (0..w.len()).map(move |b| (a, b)))
                .map(|(a, b)| w[a] * w[b] * levels.covariance[a][b])
                .sum();
            levels.quantile * variance.max(0.0).sqrt()
        };
        Ok(Self {
            max_log,
            quadratic,
            halves: [half(0), half(1)],
            misses: misses(max_log, quadratic),
            spread: inverse[1][1],
        })
    }

    fn shape(&self) -> f64 {
        self.misses.iter().map(|miss| miss.abs()).fold(0.0, f64::max)
    }
}

fn mean(numbers: &[f64; 4]) -> f64 {
    numbers.iter().sum::<f64>() / 4.0
}

/// (q u² + (1 - q) u) / u.
fn rest(q: f64, u: f64) -> f64 {
    (q * u + 1.0 - q).max(1e-3)
}

fn result(rows: &[Reading], levels: &Levels, curve: &Curve, beside: [f64; 2]) -> ThrustFit {
    let whole = |halves: &[f64]| halves.iter().map(|half| half * half).sum::<f64>().sqrt();
    let fitted = |name, unit, value, half| Fitted {
        name,
        unit,
        value,
        half,
    };
    let logs = levels.trims();
    let factors = levels.factors();
    let mean = mean(&factors);
    let max = curve.max_log.exp() * mean;
    let shape = curve.shape();
    let distance = |row: &Reading| {
        let factor = row.rotor.map_or(4.0, |rotor| factors[rotor] / mean);
        let ratio = f64::powf(row.voltage / levels.nominal, levels.power());
        let law = max * ratio * rest(curve.quadratic, row.command) * row.command;
        row.force / (factor * law * row.tilt.cos()) - 1.0
    };
    let worst = rows
        .iter()
        .map(distance)
        .enumerate()
        .max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
        .unwrap_or_default();
    ThrustFit {
        max: fitted(
            "thrust_max",
            "N",
            max,
            max * whole(&[curve.halves[0], beside[0], shape, SCALE]),
        ),
        curve: fitted(
            "thrust_curve",
            "",
            curve.quadratic,
            whole(&[curve.halves[1], beside[1], shape * curve.spread.sqrt()]),
        ),
        power: matches!(levels.unknowns.power, Power::Fitted)
            .then(|| fitted("thrust_volt_exp", "", levels.power(), levels.half_power())),
        trims: logs.map(|logs| {
            core::array::from_fn(|i| {
                let trim = factors[i] / mean;
                fitted(TRIMS[i], "", trim, trim * logs[i].1)
            })
        }),
        scatter: levels.scatter,
        shape,
        worst,
    }
}

impl ThrustFit {
    /// Every parameter that the readings tell.
    pub fn parameters(&self) -> Vec<Fitted> {
        let trims = self.trims.iter().flatten().copied();
        [self.max, self.curve]
            .into_iter()
            .chain(self.power)
            .chain(trims)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings of the law itself: five commands with all rotors at two batteries, each rotor at two.
    fn readings(max: f64, q: f64, power: f64, trims: [f64; 4], second: bool) -> Vec<Reading> {
        let mut rows = Vec::new();
        let mut push = |command: f64, voltage: f64, rotor: Option<usize>| {
            let sum = rotor.map_or_else(|| trims.iter().sum(), |rotor| trims[rotor]);
            let tilt = 0.2 * command - 0.1;
            let share = (q * command + 1.0 - q) * command;
            let thrust: f64 = max * sum * f64::powf(voltage / 14.8, power) * share;
            rows.push(Reading {
                command,
                voltage,
                rotor,
                force: thrust * tilt.cos(),
                tilt,
            });
        };
        for rest in if second { &[16.4, 15.0][..] } else { &[16.4][..] } {
            for command in [0.4, 0.55, 0.7, 0.85, 1.0] {
                push(command, rest - 1.3 * command, None);
            }
        }
        for rotor in 0..4 {
            for command in [0.55, 0.85] {
                push(command, 16.3 - 0.3 * command, Some(rotor));
            }
        }
        rows
    }

    const TRIM: [f64; 4] = [0.96, 1.03, 1.02, 0.99];

    #[test]
    fn the_law_s_own_readings_give_its_numbers_back() {
        let fit = fit(&readings(9.1, 0.62, 1.7, TRIM, true), 14.8).unwrap();
        let near = |found: Fitted, truth: f64| (found.value - truth).abs() < 1e-6;
        assert!(near(fit.max, 9.1) && near(fit.curve, 0.62), "{fit:?}");
        assert!(near(fit.power.unwrap(), 1.7), "{fit:?}");
        for (found, truth) in fit.trims.unwrap().into_iter().zip(TRIM) {
            assert!(near(found, truth) && found.half < 1e-6, "{found:?}");
        }
        // The scale's gain stays in the interval.
        assert!((fit.max.half / fit.max.value - SCALE).abs() < 1e-6, "{fit:?}");
        assert!(fit.scatter.unwrap() < 1e-9 && fit.shape < 1e-9, "{fit:?}");
    }

    #[test]
    fn one_battery_leaves_the_power_assumed_and_says_what_that_may_cost() {
        let fit = fit(&readings(9.1, 0.62, 2.0, [1.0; 4], false)[..5], 14.8).unwrap();
        assert!(
            fit.trims.is_none() && fit.power.is_none() && fit.scatter.is_none(),
            "{fit:?}"
        );
        assert!((fit.max.value - 9.1).abs() < 1e-6, "{fit:?}");
        // Exact readings tell even what a real scale does not.
        let mut rows = readings(9.1, 0.62, 1.7, TRIM, false);
        for (i, row) in rows.iter_mut().enumerate() {
            row.force *= 1.0 + 0.01 * f64::from((i as i32 * 7) % 5 - 2) / 2.0;
        }
        let fit = super::fit(&rows, 14.8).unwrap();
        assert!(fit.power.is_none(), "{fit:?}");
        assert!((fit.max.value - 9.1).abs() < fit.max.half, "{fit:?}");
        assert!(fit.max.half > 0.015 * 9.1, "{fit:?}");
    }

    #[test]
    fn a_reading_that_was_mistyped_is_named() {
        let mut rows = readings(9.1, 0.62, 1.7, TRIM, true);
        rows[3].force *= 1.2;
        let fit = fit(&rows, 14.8).unwrap();
        assert!(fit.worst.0 == 3 && fit.worst.1 > 0.1, "{fit:?}");
        assert!(fit.scatter.unwrap() > 0.03, "{fit:?}");
    }

    #[test]
    fn what_is_missing_is_said() {
        let rows = readings(9.1, 0.62, 1.7, TRIM, true);
        let lacks = |rows: &[Reading]| fit(rows, 14.8).unwrap_err();
        assert_eq!(
            lacks(&rows[..12]),
            "rows of rotor 1 alone: allowed are rows of each of the four, or of none"
        );
        assert_eq!(
            lacks(&rows[..1]),
            "1 commands from 40 to 40 %: allowed are 3 at least, over 30 %"
        );
    }
}
