//! The printed mixer matrix, its corrections and their ranks.

use sophie_control::allocation::wrench::{FORE, SIDE, YAW};
use sophie_control::params::Params;

use super::super::printed::Printed;
use super::super::statics::{AtThrust, root};
use crate::results::model::{Class, Comparison, Section, Table, num};

/// Rows f_z, τ_φ, τ_θ, τ_ψ over C_T.
type Matrix = [[f64; 4]; 4];

fn matrix(tilt: f64, yaw: [f64; 4]) -> Matrix {
    let p = Params::default();
    let (d, b) = (f64::from(p.arm_d), f64::from(p.arm_b));
    [
        [tilt.cos(); 4],
        SIDE.map(|s| d * f64::from(s)),
        FORE.map(|s| b * f64::from(s)),
        yaw,
    ]
}

struct Rank {
    rank: usize,
    /// |determinant| over the rigid, level frame's.
    determinant: f64,
}

/// By elimination with row pivoting; rows over the rigid, level frame's lengths.
fn rank(mut m: Matrix) -> Rank {
    let p = Params::default();
    for (row, unit) in m.iter_mut().zip([1.0, p.arm_d, p.arm_b, p.torque_ratio]) {
        row.iter_mut().for_each(|x| *x /= 2.0 * f64::from(unit));
    }
    let (mut rank, mut determinant) = (0, 1.0);
    for column in 0..4 {
        let pivot = (rank..4).max_by(|a, b| m[*a][column].abs().total_cmp(&m[*b][column].abs()));
        let Some(pivot) = pivot.filter(|r| m[*r][column].abs() > 1e-6) else {
            determinant = 0.0;
            continue;
        };
        m.swap(rank, pivot);
        determinant *= m[rank][column].abs();
        let top = m[rank];
        for row in m.iter_mut().skip(rank + 1) {
            let factor = row[column] / top[column];
            for (x, t) in row.iter_mut().zip(top) {
                *x -= factor * t;
            }
        }
        rank += 1;
    }
    Rank { rank, determinant }
}

struct Named {
    what: &'static str,
    matrix: Matrix,
}

/// The printed matrix, readings of its yaw row, and those with sideways thrust: in hover, and at the thrust per rotor
/// (N) where the frozen inverse's divisor changes sign.
fn all(p: &Printed, hover: &AtThrust, reversal: f64) -> [Named; 6] {
    let k_q = f64::from(Params::default().torque_ratio);
    let tilt = hover.sin.atan2(hover.cos);
    let signs = |row: [f64; 4]| matrix(tilt, row.map(|x| x * k_q));
    let full = |a: AtThrust, chi: f64| {
        let yaw = YAW.map(|y| f64::from(y) * a.frozen(chi) * k_q);
        matrix(tilt, yaw)
    };
    let named = |what, matrix| Named { what, matrix };
    [
        named("as printed", signs(p.mixer_matrix.yaw_row)),
        named(
            "Algorithm 1: CW, CW, CCW, CCW",
            signs(p.mixer_matrix.algorithm_1_row),
        ),
        named("the text: 1 and 4 against 2 and 3", signs([-1.0, 1.0, 1.0, -1.0])),
        named("with the sideways thrust, B in hover", full(*hover, 1.0)),
        named("with the sideways thrust, A in hover", full(*hover, -1.0)),
        named(
            "with the sideways thrust, B at the frozen reversal",
            full(at(reversal), 1.0),
        ),
    ]
}

fn at(thrust: f64) -> AtThrust {
    AtThrust::new(6.9, f64::from(Params::default().gain_k), thrust)
}

/// Shows the matrices and their ranks.
pub fn show(s: &mut Section, p: &Printed, hover: &AtThrust) {
    let reversal = root(1.0, 6.0, |t| at(t).frozen(1.0)).unwrap_or(f64::NAN);
    let all = all(p, hover, reversal);
    let ranks = all.each_ref().map(|m| rank(m.matrix));
    s.table(entries([&all[0], &all[2], &all[3]]));
    s.table(ranks_table(&all, &ranks));
    s.compare(
        "What a mixer for four axes needs",
        vec![Comparison {
            what: "rank of the matrix as printed".to_owned(),
            unit: "",
            printed: 4.0,
            here: ranks[0].rank as f64,
            class: Class::Inconsistent,
            why: "four controls need rank 4; the printed yaw row is the pitch row over again, Algorithm 1's senses of \
                  rotation are the roll row"
                .to_owned(),
        }],
    );
    s.text(format!(
        "The last matrix is that of {reversal:.2} N a rotor, where b sin α = -k_q: what a frozen inverse divides by changes its \
         sign there."
    ));
}

fn entries(shown: [&Named; 3]) -> Table {
    let mut t = Table::new(
        "The matrices in hover, divided by C_T: f_z pure, moments in m",
        &["matrix", "row", "rotor 1", "rotor 2", "rotor 3", "rotor 4"],
    );
    for named in shown {
        for (name, row) in ["f_z", "τ_φ", "τ_θ", "τ_ψ"].into_iter().zip(named.matrix) {
            let numbers = row.map(|x| num(x, 4));
            t.row([named.what.into(), name.into()].into_iter().chain(numbers));
        }
    }
    t
}

fn ranks_table(all: &[Named], ranks: &[Rank]) -> Table {
    let mut t = Table::new(
        "Mixer matrices and their rank",
        &[
            "yaw row",
            "signs of rotors 1 to 4",
            "rank",
            "determinant over the stiff frame's",
        ],
    );
    for (named, found) in all.iter().zip(ranks) {
        let signs = named.matrix[3].map(|x| match x {
            x if x.abs() < 1e-6 => "0",
            x if x < 0.0 => "-",
            _ => "+",
        });
        t.row([
            named.what.into(),
            signs.join(" ").into(),
            num(found.rank as f64, 0),
            num(found.determinant, 3),
        ]);
    }
    t
}
