//! Which drawn quantity goes with success: Spearman's rank correlation of each with perched (1) or not (0).
//!
//! Its significance is that of z = |ρ| √(n - 1), two-sided, times the number of quantities that were tried (Bonferroni): the
//! probability that one of them correlates as much by chance. A correlation finds a quantity that acts one way; it misses
//! one that is worst in the middle, or only together with another.

use super::row::{self, ASSUMED, Row};

/// Correlation from which a later quantity says the same as an earlier one.
const SAME: f64 = 0.999;

/// A quantity and how it goes with success.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Its name, for people.
    pub quantity: String,
    /// Rank correlation with perched.
    pub correlation: f64,
    /// Probability of as much by chance among all that were tried, 0 to 1.
    pub chance: f64,
    /// Its values, one a row.
    pub values: Vec<f64>,
}

/// The quantities by their correlation with success, strongest first; none if all or no vehicles perched.
#[must_use]
pub fn explain(rows: &[Row]) -> Vec<Finding> {
    let perched: Vec<f64> = rows
        .iter()
        .map(|row| f64::from(u8::from(row.class == super::Class::Perched)))
        .collect();
    let success = ranks(&perched);
    let mut tried: Vec<(String, Vec<f64>, Vec<f64>)> = Vec::new();
    for (name, values) in quantities(rows) {
        let ranked = ranks(&values);
        let varies = ranked.iter().any(|rank| Some(rank) != ranked.first());
        let known = |earlier: &(String, Vec<f64>, Vec<f64>)| correlation(&earlier.2, &ranked).abs() > SAME;
        if varies && !tried.iter().any(known) {
            tried.push((name, values, ranked));
        }
    }
    let count = tried.len() as f64;
    let root = (rows.len().saturating_sub(1) as f64).sqrt();
    let findings = tried.into_iter().map(|(quantity, values, ranked)| {
        let correlation = correlation(&success, &ranked);
        let alone = libm::erfc(correlation.abs() * root / core::f64::consts::SQRT_2);
        Finding {
            quantity,
            correlation,
            chance: (count * alone).min(1.0),
            values,
        }
    });
    let mut findings: Vec<Finding> = findings.filter(|found| found.correlation.is_finite()).collect();
    findings.sort_by(|a, b| b.correlation.abs().total_cmp(&a.correlation.abs()));
    findings
}

/// Each number; of several of one key their mean, and the largest less the smallest; and the
/// parameters' assumption less the truth, of several the mean.
fn quantities(rows: &[Row]) -> Vec<(String, Vec<f64>)> {
    let names = row::names();
    let key = |name: &str| name.split('[').next().unwrap_or_default().to_owned();
    let columns = |wanted: &str| -> Vec<usize> {
        let named = names.iter().enumerate();
        named
            .filter(|(_, name)| key(name) == wanted)
            .map(|(index, _)| index)
            .collect()
    };
    let numbers = |row: &Row, columns: &[usize]| -> Vec<f64> {
        let of = columns.iter().map(|index| row.numbers.get(*index).copied());
        of.map(|number| number.unwrap_or(f64::NAN)).collect()
    };
    let mean = |numbers: &[f64]| numbers.iter().sum::<f64>() / numbers.len() as f64;
    let range = |numbers: &[f64]| {
        let (low, high) = numbers
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), n| {
                (l.min(*n), h.max(*n))
            });
        high - low
    };
    let mut keys: Vec<String> = names.iter().map(|name| key(name)).collect();
    keys.dedup();
    let mut all = Vec::new();
    for key in keys {
        let of = columns(&key);
        let by_row: Vec<Vec<f64>> = rows.iter().map(|row| numbers(row, &of)).collect();
        let means: Vec<f64> = by_row.iter().map(|numbers| mean(numbers)).collect();
        if let Some(truth) = key.strip_prefix(ASSUMED) {
            let of = columns(truth);
            let errors = rows.iter().zip(means);
            let errors = errors.map(|(row, assumed)| assumed - mean(&numbers(row, &of)));
            all.push((format!("{truth}, assumed less true"), errors.collect()));
        } else if of.len() > 1 {
            all.push((format!("{key}, mean"), means));
            let ranges = by_row.iter().map(|numbers| range(numbers));
            all.push((format!("{key}, largest less smallest"), ranges.collect()));
        } else {
            all.push((key, means));
        }
    }
    all
}

/// Ranks from 1, equal values at the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<(usize, f64)> = values.iter().copied().enumerate().collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut ranked: Vec<(usize, f64)> = Vec::new();
    for tied in order.chunk_by(|a, b| a.1 == b.1) {
        let begin = ranked.len() as f64;
        let rank = begin + 0.5 * (tied.len() as f64 + 1.0);
        ranked.extend(tied.iter().map(|(index, _)| (*index, rank)));
    }
    ranked.sort_by_key(|(index, _)| *index);
    ranked.into_iter().map(|(_, rank)| rank).collect()
}

/// Pearson's, of ranks; NaN if either does not vary.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut both, mut of_a, mut of_b) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        both += a * b;
        of_a += a * a;
        of_b += b * b;
    }
    both / (of_a * of_b).sqrt()
}

#[cfg(test)]
mod tests {
    use sophie_sim::streams::Streams;

    use super::*;
    use crate::study::unknown::Class;

    #[test]
    fn ties_share_a_rank_and_monotone_numbers_correlate_fully() {
        assert_eq!(ranks(&[3.0, 1.0, 3.0, -2.0]), [3.5, 2.0, 3.5, 1.0]);
        let numbers: Vec<f64> = (0..20).map(f64::from).collect();
        let cubes: Vec<f64> = numbers.iter().map(|n| -n * n * n).collect();
        assert!((correlation(&ranks(&numbers), &ranks(&cubes)) + 1.0).abs() < 1e-12);
        assert!(correlation(&ranks(&[1.0; 20]), &ranks(&cubes)).is_nan());
    }

    /// Rows of random numbers of which the one at `cause` decides; `None`: chance does.
    fn rows(count: u64, cause: Option<usize>) -> Vec<Row> {
        let width = row::names().len();
        let row = |vehicle: u64| {
            let streams = Streams::new(vehicle);
            let numbers: Vec<f64> = (0..width).map(|i| streams.unit(&format!("n {i}"))).collect();
            let decides = cause.map_or_else(|| streams.unit("chance"), |cause| numbers[cause]);
            Row {
                vehicle,
                seed: vehicle,
                class: if decides < 0.3 {
                    Class::Perched
                } else {
                    Class::HandedBack
                },
                accomplished: false,
                seconds: 1.0,
                digest: String::new(),
                reason: String::new(),
                numbers,
            }
        };
        (1..=count).map(row).collect()
    }

    #[test]
    fn the_quantity_that_decides_is_found_and_chance_is_called_chance() {
        let names = row::names();
        let cause = names
            .iter()
            .position(|name| name == "world.pipe_friction")
            .unwrap();
        let found = explain(&rows(60, Some(cause)));
        assert_eq!(found[0].quantity, "world.pipe_friction");
        assert!(
            found[0].correlation < -0.7 && found[0].chance < 1e-5,
            "{:?}",
            found[0].chance
        );
        // What the parameters assume of it less itself goes with it.
        let mut others = found
            .iter()
            .filter(|f| !f.quantity.starts_with("world.pipe_friction"));
        let other = others.next().unwrap();
        assert!(other.chance > 0.05, "{}: {}", other.quantity, other.chance);
        assert!(explain(&rows(60, None))[0].chance > 0.05);
        // A dozen flights prove little.
        assert!(
            explain(&rows(8, Some(cause)))
                .iter()
                .all(|found| found.chance > 0.05)
        );
    }

    #[test]
    fn equal_ends_explain_nothing() {
        let mut same = rows(20, None);
        same.iter_mut().for_each(|row| row.class = Class::Fallen);
        assert!(explain(&same).is_empty());
        assert!(explain(&[]).is_empty());
    }
}
