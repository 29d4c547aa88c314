//! Gains of the lateral feedback, from the steady solution of a Riccati equation (docs/design/position-hold.md).

/// On position (1/s²), velocity (1/s), acceleration of the tilt (1), its rate (s), its second derivative (s²), second and
/// first stage of the setpoint's filter (1), disturbance (1). For the default loops at 100 Hz; the test computes them.
pub const GAINS: [f32; 8] = [12.19, 10.08, 1.908, 0.1771, 0.008159, 0.6091, 0.4892, 3.241];

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::params::Params;

    type Matrix = Vec<Vec<f64>>;

    /// Period of the law, s.
    const DT: f64 = 0.01;
    /// Deviations that weigh alike: m, m/s, m/s² of acceleration asked for beyond the wind's.
    const POSITION: f64 = 0.08;
    const VELOCITY: f64 = 0.5;
    const EFFORT: f64 = 1.0;
    /// Correlation time of the gusts, s.
    const GUST: f64 = 1.0;
    const STATES: usize = 8;

    fn zeros(n: usize, m: usize) -> Matrix {
        std::vec![std::vec![0.0; m]; n]
    }

    fn transposed(a: &Matrix) -> Matrix {
        (0..a[0].len())
            .map(|j| a.iter().map(|row| row[j]).collect())
            .collect()
    }

    fn product(a: &Matrix, b: &Matrix) -> Matrix {
        let columns = transposed(b);
        let dot = |row: &Vec<f64>, column: &Vec<f64>| row.iter().zip(column).map(|(x, y)| x * y).sum();
        a.iter()
            .map(|row| columns.iter().map(|column| dot(row, column)).collect())
            .collect()
    }

    /// Position, velocity, tilt, its rate, its second derivative, both stages, disturbance; then the input.
    fn continuous(p: &Params) -> Matrix {
        let filter = std::f64::consts::TAU * f64::from(p.setpoint_lpf_hz);
        let (angle, rate) = (f64::from(p.attitude_p), f64::from(p.rate_p));
        let motor = 1.0 / f64::from(p.motor_tau);
        let mut m = zeros(STATES + 1, STATES + 1);
        m[0][1] = 1.0;
        (m[1][2], m[1][7]) = (1.0, 1.0);
        m[2][3] = 1.0;
        m[3][4] = 1.0;
        (m[4][5], m[4][2]) = (motor * rate * angle, -motor * rate * angle);
        (m[4][3], m[4][4]) = (-motor * rate, -motor);
        (m[5][6], m[5][5]) = (filter, -filter);
        (m[6][8], m[6][6]) = (filter, -filter);
        m[7][7] = -1.0 / GUST;
        m
    }

    /// exp(m dt) by the series of dt/1024, squared ten times.
    fn exponential(m: &Matrix, dt: f64) -> Matrix {
        let n = m.len();
        let small: Matrix = m
            .iter()
            .map(|row| row.iter().map(|x| x * dt / 1024.0).collect())
            .collect();
        let mut sum = zeros(n, n);
        (0..n).for_each(|i| sum[i][i] = 1.0);
        let mut term = sum.clone();
        for k in 1..10 {
            term = product(&term, &small);
            for (row, term) in sum.iter_mut().zip(&mut term) {
                for (x, t) in row.iter_mut().zip(term) {
                    *t /= f64::from(k);
                    *x += *t;
                }
            }
        }
        (0..10).fold(sum, |sum, _| product(&sum, &sum))
    }

    /// Discrete model: A and B.
    fn discrete(p: &Params) -> (Matrix, Matrix) {
        sampled(&continuous(p))
    }

    fn sampled(m: &Matrix) -> (Matrix, Matrix) {
        let e = exponential(m, DT);
        let rows = || e.iter().take(STATES);
        (
            rows().map(|row| row[..STATES].to_vec()).collect(),
            rows().map(|row| std::vec![row[STATES]]).collect(),
        )
    }

    fn riccati(p: &Params) -> Vec<f64> {
        let (a, b) = discrete(p);
        let mut q = zeros(STATES, STATES);
        q[0][0] = POSITION.powi(-2);
        q[1][1] = VELOCITY.powi(-2);
        // (input + disturbance)²: what holds against a gust costs nothing.
        let effort = EFFORT.powi(-2);
        q[7][7] = effort;
        let mut cost = q.clone();
        let mut gains = Vec::new();
        for _ in 0..2000 {
            let (ca, cb) = (product(&cost, &a), product(&cost, &b));
            let s = effort + product(&transposed(&b), &cb)[0][0];
            let mut f = product(&transposed(&b), &ca).remove(0);
            f[7] += effort;
            let (previous, acca) = (cost, product(&transposed(&a), &ca));
            gains = f.iter().map(|x| x / s).collect();
            cost = (0..STATES)
                .map(|i| {
                    (0..STATES)
                        .map(|j| acca[i][j] + q[i][j] - f[i] * f[j] / s)
                        .collect()
                })
                .collect();
            let pairs = || cost.iter().flatten().zip(previous.iter().flatten());
            let largest = cost.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
            if pairs().all(|(x, y)| (x - y).abs() < 1e-12 * largest) {
                return gains;
            }
        }
        gains
    }

    /// Largest share of the state's length left after 30 s.
    fn left(p: &Params) -> f64 {
        left_with(p, 1.0)
    }

    /// The same where a tilt gives `share` of its acceleration.
    fn left_with(p: &Params, share: f64) -> f64 {
        left_leaning(p, share, 0.0)
    }

    /// The same where the arms push by `arms` s² of the tilt's second derivative, which the law takes for a disturbance.
    fn left_leaning(p: &Params, share: f64, arms: f64) -> f64 {
        let mut m = continuous(p);
        (m[1][2], m[1][4]) = (share, arms);
        let (a, b) = sampled(&m);
        let step = |x: &Vec<f64>| -> Vec<f64> {
            let mut seen = x.clone();
            seen[7] += arms * x[4];
            let u: f64 = -GAINS
                .iter()
                .zip(&seen)
                .map(|(k, x)| f64::from(*k) * x)
                .sum::<f64>();
            let row = |(row, b): (&Vec<f64>, &Vec<f64>)| {
                row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() + b[0] * u
            };
            a.iter().zip(&b).map(row).collect()
        };
        (0..STATES)
            .map(|i| {
                let mut x = std::vec![0.0; STATES];
                x[i] = 1.0;
                for _ in 0..3000 {
                    x = step(&x);
                }
                x.iter().map(|x| x * x).sum::<f64>().sqrt()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn the_gains_are_the_riccati_equations() {
        let computed = riccati(&Params::DEFAULT);
        for (k, wanted) in GAINS.iter().zip(&computed) {
            assert!((f64::from(*k) / wanted - 1.0).abs() < 2e-3, "{computed:?}");
        }
    }

    #[test]
    fn loops_that_are_tuned_or_lag_otherwise_stay_stable() {
        let p = Params::DEFAULT;
        let others = [
            p,
            Params { attitude_p: 3.0, ..p },
            Params { attitude_p: 8.0, ..p },
            Params { rate_p: 7.0, ..p },
            Params { rate_p: 16.0, ..p },
            Params {
                motor_tau: 0.025,
                ..p
            },
            Params { motor_tau: 0.09, ..p },
            Params {
                setpoint_lpf_hz: 1.1,
                ..p
            },
            Params {
                setpoint_lpf_hz: 5.0,
                ..p
            },
        ];
        for other in others {
            assert!(left(&other) < 1e-3, "{}: {other:?}", left(&other));
        }
        // At 9 rad/s the arms' twist makes 1.26 of it.
        assert!(left_with(&p, 1.6) < 1e-3, "{}", left_with(&p, 1.6));
        // The attitude far too slow: the law cannot know.
        assert!(left(&Params { attitude_p: 0.7, ..p }) > 1.0);
    }

    /// A roll acceleration bends the arms of the two sides apart, and their thrusts lean to the side of the roll: I φ'' = 4 d δ
    /// needs δ on each rotor, and 4 δ d(T sin α)/dT push. The statics are the most; tips with mass bend less.
    #[test]
    fn what_the_arms_push_in_a_roll_matters_little() {
        let p = Params::DEFAULT;
        let hover = p.mass * crate::maths::scalar::GRAVITY / 4.0;
        let arm = crate::allocation::arm_deflection::ArmModel::from_params(&p);
        let lean = |thrust: f32| f64::from(thrust * crate::maths::scalar::sin(arm.angle(thrust)));
        let per_thrust = (lean(hover + 0.1) - lean(hover - 0.1)) / 0.2;
        let g = f64::from(crate::maths::scalar::GRAVITY);
        let arms = f64::from(p.inertia_roll) * per_thrust / (f64::from(p.arm_d * p.mass) * g);
        assert!((arms - 2.3e-3).abs() < 1e-4, "{arms}");
        for times in [1.0, 20.0] {
            let left = left_leaning(&p, 1.0, times * arms);
            assert!(left < 1e-3, "{times}: {left}");
        }
        assert!(left_leaning(&p, 1.0, 30.0 * arms) > 1.0);
    }
}
