//! Curves thinned to the drawing's resolution.

use sophie_sim::record::FlightRecord;

use super::time_axis::Span;

/// About two per pixel.
const COLUMNS: usize = 460;

/// Smallest and largest value per column, in their order.
pub(crate) fn thin(record: &FlightRecord, span: Span, values: &[f64]) -> Vec<(f64, f64)> {
    let shown: Vec<(f64, f64)> = record
        .samples
        .iter()
        .zip(values)
        .map(|(s, v)| (s.t, *v))
        .filter(|(t, _)| span.contains(*t))
        .collect();
    if shown.len() <= 2 * COLUMNS {
        return shown;
    }
    let size = shown.len().div_ceil(COLUMNS);
    let mut out = Vec::with_capacity(2 * COLUMNS);
    for column in shown.chunks(size) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let finite = || column.iter().filter(|(_, v)| v.is_finite());
        match (finite().min_by(by_value), finite().max_by(by_value)) {
            (Some(a), Some(b)) if a.0 < b.0 => out.extend([*a, *b]),
            (Some(a), Some(b)) if a.0 > b.0 => out.extend([*b, *a]),
            (Some(a), _) => out.push(*a),
            _ => out.extend(column.first()),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::synthetic;
    use super::*;

    #[test]
    fn thinning_keeps_peaks_and_order() {
        let record = synthetic::record();
        let mut values = vec![0.0; record.samples.len()];
        values[3210] = 7.0;
        values[3211] = -5.0;
        let thinned = thin(&record, Span::all(&record), &values);
        assert!(thinned.len() <= 2 * COLUMNS);
        assert!(thinned.iter().any(|(_, v)| *v == 7.0) && thinned.iter().any(|(_, v)| *v == -5.0));
        assert!(thinned.windows(2).all(|w| w[0].0 < w[1].0));
        let gap = thin(&record, Span::all(&record), &vec![f64::NAN; record.samples.len()]);
        assert!(!gap.is_empty() && gap.iter().all(|(_, v)| v.is_nan()));
    }
}
