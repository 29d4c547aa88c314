//! Steady solution of the discrete Riccati equation of a small system with one input, by doubling, and the exponential of
//! its matrix.

use core::array::from_fn;

/// A matrix by rows.
pub type Square<const N: usize> = [[f32; N]; N];

/// Doublings: 1,024 steps of the equation, after which a pole of 1 1/s at 100 Hz has left 4e-5 of what it began with.
const DOUBLINGS: usize = 10;
/// Halvings of the time of an exponential, and terms of its series: exact to single precision for rates up to 50 1/s
/// over 10 ms in states of about one.
const HALVINGS: usize = 6;
const TERMS: u8 = 7;

fn element<const N: usize>(m: &Square<N>, row: usize, column: usize) -> f32 {
    m.get(row).and_then(|row| row.get(column)).copied().unwrap_or(0.0)
}

fn identity<const N: usize>() -> Square<N> {
    from_fn(|row| from_fn(|column| if row == column { 1.0 } else { 0.0 }))
}

fn transposed<const N: usize>(m: &Square<N>) -> Square<N> {
    from_fn(|row| from_fn(|column| element(m, column, row)))
}

fn dot<const N: usize>(a: &[f32; N], b: &[f32; N]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn times<const N: usize>(m: &Square<N>, x: &[f32; N]) -> [f32; N] {
    m.each_ref().map(|row| dot(row, x))
}

fn product<const N: usize>(a: &Square<N>, b: &Square<N>) -> Square<N> {
    let columns = transposed(b);
    a.each_ref().map(|row| times(&columns, row))
}

fn sum<const N: usize>(a: &Square<N>, b: &Square<N>) -> Square<N> {
    from_fn(|row| from_fn(|column| element(a, row, column) + element(b, row, column)))
}

/// `m` without what rounding has made of its symmetry.
fn symmetric<const N: usize>(m: &Square<N>) -> Square<N> {
    from_fn(|row| from_fn(|column| 0.5 * (element(m, row, column) + element(m, column, row))))
}

/// e to the `m` times `time`, s.
pub fn exponential<const N: usize>(m: &Square<N>, time: f32) -> Square<N> {
    let small = time / (1_u32 << HALVINGS) as f32;
    let small = m.map(|row| row.map(|x| x * small));
    let (mut whole, mut term) = (identity(), identity());
    for order in 1..=TERMS {
        term = product(&term, &small).map(|row| row.map(|x| x / f32::from(order)));
        whole = sum(&whole, &term);
    }
    (0..HALVINGS).fold(whole, |whole, _| product(&whole, &whole))
}

/// Solutions X and Y of `m` X = `x` and `m` Y = `y`, by elimination with the largest pivot of each column. Not finite for
/// a singular `m`.
fn solved<const N: usize>(m: &Square<N>, x: &Square<N>, y: &Square<N>) -> (Square<N>, Square<N>) {
    let (mut m, mut x, mut y) = (*m, *x, *y);
    let mut pivots = [N; N];
    for column in 0..N {
        let free = (0..N).filter(|row| !pivots.contains(row));
        let size = |row: usize| element(&m, row, column).abs();
        let best = free.fold(None, |best: Option<usize>, row| match best {
            Some(best) if size(best) >= size(row) => Some(best),
            _ => Some(row),
        });
        let Some(pivot) = best else { break };
        if let Some(place) = pivots.get_mut(column) {
            *place = pivot;
        }
        let scale = 1.0 / element(&m, pivot, column);
        let line = |m: &Square<N>| m.get(pivot).map_or([0.0; N], |row| row.map(|x| x * scale));
        let (of_m, of_x, of_y) = (line(&m), line(&x), line(&y));
        for row in 0..N {
            let factor = element(&m, row, column);
            for (m, line) in [(&mut m, &of_m), (&mut x, &of_x), (&mut y, &of_y)] {
                let Some(to) = m.get_mut(row) else { continue };
                for (to, line) in to.iter_mut().zip(line) {
                    *to = if row == pivot { *line } else { *to - factor * line };
                }
            }
        }
    }
    let ordered = |m: &Square<N>| pivots.map(|row| m.get(row).copied().unwrap_or([f32::NAN; N]));
    (ordered(&x), ordered(&y))
}

/// Gains k of u = -k x that minimise the sum of `weights` x² + `effort` u² of x' = `a` x + `b` u, by the doubling of
/// Anderson (1978): each pass covers twice the steps of the one before.
pub fn gains<const N: usize>(a: &Square<N>, b: &[f32; N], weights: &[f32; N], effort: f32) -> [f32; N] {
    let mut over = *a;
    let mut reach: Square<N> = b.map(|row| b.map(|column| row * column / effort));
    let mut cost: Square<N> = from_fn(|row| {
        from_fn(|column| {
            let weight = weights.get(row).copied().unwrap_or(0.0);
            if row == column { weight } else { 0.0 }
        })
    });
    for _ in 0..DOUBLINGS {
        let both = sum(&identity(), &product(&reach, &cost));
        let (onward, reached) = solved(&both, &over, &reach);
        let back = transposed(&over);
        cost = symmetric(&sum(&cost, &product(&back, &product(&cost, &onward))));
        reach = symmetric(&sum(&reach, &product(&over, &product(&reached, &back))));
        over = product(&over, &onward);
    }
    let priced = times(&cost, b);
    let per = 1.0 / (effort + dot(&priced, b));
    times(&transposed(a), &priced).map(|x| x * per)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_double_integrator_s_gains_are_those_of_the_textbook() {
        // Continuous: k = [1, sqrt 3] for unit weights; sampled at 10 ms nearly so.
        let m = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
        let [[a, b, u], [c, d, w], _] = exponential(&m, 0.01);
        let found = gains(&[[a, b], [c, d]], &[u, w], &[0.01, 0.01], 0.01);
        for (found, wanted) in found.iter().zip([1.0, 3.0_f32.sqrt()]) {
            assert!((found / wanted - 1.0).abs() < 0.02, "{found} {wanted}");
        }
    }

    #[test]
    fn an_exponential_turns_by_its_angle() {
        let [[cos, sin], _] = exponential(&[[0.0, 30.0], [-30.0, 0.0]], 0.01);
        assert!((cos - 0.3f32.cos()).abs() < 1e-6 && (sin - 0.3f32.sin()).abs() < 1e-6);
    }

    #[test]
    fn equations_that_want_another_order_are_solved() {
        let m = [[0.0, 2.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 4.0]];
        let unit = identity::<3>();
        let (inverse, same) = solved(&m, &unit, &m);
        for (found, wanted) in [(product(&m, &inverse), unit), (same, unit)] {
            for (found, wanted) in found.iter().flatten().zip(wanted.iter().flatten()) {
                assert!((found - wanted).abs() < 1e-6, "{found} {wanted}");
            }
        }
        let (none, _) = solved(&[[1.0, 1.0], [1.0, 1.0]], &identity::<2>(), &identity());
        assert!(none.iter().flatten().any(|x| !x.is_finite()));
    }
}
