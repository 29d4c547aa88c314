//! Linear least squares, and Student's quantile for the intervals.

/// Solves `design` x = `measured` by normal equations with scaled columns; x and (XᵀX)⁻¹.
pub fn solve(design: &[Vec<f64>], measured: &[f64]) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let n = design.first()?.len();
    let scale: Vec<f64> = (0..n)
        .map(|j| design.iter().map(|r| r[j] * r[j]).sum::<f64>().sqrt())
        .collect();
    if scale.iter().any(|s| !s.is_normal()) {
        return None;
    }
    // [XᵀX | I | Xᵀy] of scaled columns, reduced to [I | inverse | solution].
    let mut m: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let dot = |j: usize| design.iter().map(|r| r[i] * r[j]).sum::<f64>() / (scale[i] * scale[j]);
            let y = design.iter().zip(measured).map(|(r, m)| r[i] * m).sum::<f64>() / scale[i];
            (0..n)
                .map(dot)
                .chain((0..n).map(|j| f64::from(u8::from(i == j))))
                .chain([y])
                .collect()
        })
        .collect();
    for column in 0..n {
        let pivot = (column..n).max_by(|a, b| m[*a][column].abs().total_cmp(&m[*b][column].abs()))?;
        if m[pivot][column].abs() < 1e-11 {
            return None;
        }
        m.swap(column, pivot);
        let lead = m[column][column];
        m[column].iter_mut().for_each(|v| *v /= lead);
        let top = m[column].clone();
        for (_, row) in m.iter_mut().enumerate().filter(|(i, _)| *i != column) {
            let factor = row[column];
            row.iter_mut().zip(&top).for_each(|(v, t)| *v -= factor * t);
        }
    }
    let solution = (0..n).map(|i| m[i][2 * n] / scale[i]).collect();
    let inverse = (0..n)
        .map(|i| (0..n).map(|j| m[i][n + j] / (scale[i] * scale[j])).collect())
        .collect();
    Some((solution, inverse))
}

/// Student's 97.5 % quantile by Cornish-Fisher: within 1 % at 4 degrees of freedom.
pub fn quantile(freedom: usize) -> f64 {
    let (z, n) = (1.959_964_f64, freedom as f64);
    let (z3, z5, z7) = (z.powi(3), z.powi(5), z.powi(7));
    z + (z3 + z) / (4.0 * n)
        + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * n * n)
        + (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * n.powi(3))
}

#[cfg(test)]
mod tests {
    use crate::least_squares::*;

    #[test]
    fn student_s_quantile() {
        // Tables: 2.776 for 4, 2.228 for 10, 1.984 for 100.
        for (n, t) in [(4, 2.776), (10, 2.228), (100, 1.984)] {
            assert!((quantile(n) / t - 1.0).abs() < 0.012, "{n} {}", quantile(n));
        }
    }
}
