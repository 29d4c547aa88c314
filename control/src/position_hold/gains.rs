//! Gains of the lateral feedback: the steady solution of a Riccati equation for the loops in force
//! (docs/design/position-hold.md).

use super::lag::Loops;
use super::riccati::{self, Square};
use crate::attitude::gains::Gains as LoopGains;
use crate::maths::scalar;
use crate::params::Params;

/// Number of states: position, velocity, acceleration of the tilt, its rate, its second derivative, second and first
/// stage of the setpoint's filter, disturbance.
pub const STATES: usize = 8;
/// The states, and the input as one more that nothing moves: exponential and equation have one order, and the board one
/// copy of their arithmetic.
const ORDER: usize = STATES + 1;
/// Period of the law, s.
const PERIOD: f32 = 0.01;
/// Deviations that weigh alike, of loops at full pace: m, m/s, m/s² of acceleration beyond what holds against the
/// disturbance. Slower loops get larger ones, so that a margin of 1.6 is left on what a tilt gives.
const POSITION: f32 = 0.08;
const VELOCITY: f32 = 0.5;
const EFFORT: f32 = 1.0;
/// Correlation time of the gusts, s.
const GUST: f32 = 1.0;
/// Size of each state and of the input: single precision solves the equation of states of about one.
const SIZES: [f32; ORDER] = [0.08, 0.5, 1.0, 5.0, 30.0, 1.0, 1.0, 1.0, 1.0];

/// Gains of the lateral feedback.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// On position (1/s²), velocity (1/s), acceleration of the tilt (1), its rate (s), its second derivative (s²), second
    /// and first stage of the setpoint's filter (1), disturbance (1).
    pub state: [f32; STATES],
    /// Pace of the loops below, 0 to 1.
    pub pace: f32,
    /// Those loops.
    pub loops: Loops,
}

/// Gains of a hold, and those for a vehicle that swings with them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoldGains {
    /// Those of a vehicle that does not swing.
    pub usual: Gains,
    /// Those over gentle loops.
    pub gentle: Gains,
}

impl HoldGains {
    /// Both for the loops of `p`: 1 ms of a processor at 168 MHz, before the tasks run.
    pub fn of(p: &Params) -> Self {
        Self {
            usual: Gains::of(p),
            gentle: Gains::gentle(p),
        }
    }
}

impl Gains {
    /// Gains for the loops of `p`: some 60,000 instructions, once at start-up. Zero, which holds no position, for loops
    /// that do not turn the vehicle.
    pub fn of(p: &Params) -> Self {
        Self::over(p, &LoopGains::of(p))
    }

    /// Gains over [gentle loops](LoopGains::gentle), for a vehicle that swings with the others.
    pub fn gentle(p: &Params) -> Self {
        Self::over(p, &LoopGains::gentle(p))
    }

    fn over(p: &Params, loops: &LoopGains) -> Self {
        let pace = loops.pace;
        let (a, b) = sampled(loops);
        let per = |size: f32, weight: f32| (size / weight) * (size / weight);
        let [position, velocity, ..] = SIZES;
        let mut weights = [0.0; ORDER];
        let [on_position, on_velocity, ..] = &mut weights;
        *on_position = per(position, POSITION / pace);
        *on_velocity = per(velocity, VELOCITY * scalar::inv_sqrt(pace));
        let solved = riccati::gains(&a, &b, &weights, EFFORT.recip() * EFFORT.recip());
        let mut state = [0.0; STATES];
        for ((gain, solved), size) in state.iter_mut().zip(solved).zip(SIZES) {
            *gain = solved / size;
        }
        // The input that the equation sees is u + d.
        let [.., disturbance] = &mut state;
        *disturbance += 1.0;
        let finite = state.iter().all(|gain| gain.is_finite());
        Self {
            state: if finite && p.rate_pitch_p.min(p.rate_roll_p) > 0.0 {
                state
            } else {
                [0.0; STATES]
            },
            pace,
            loops: Loops::of(loops),
        }
    }
}

/// The discrete model in units of [`SIZES`], with u = v - d.
fn sampled(loops: &LoopGains) -> (Square<ORDER>, [f32; ORDER]) {
    let mut a = riccati::exponential(&continuous(loops), PERIOD);
    let mut b = [0.0; ORDER];
    for (row, reach) in a.iter_mut().zip(&mut b).take(STATES) {
        let [.., disturbance, input] = row;
        *reach = core::mem::take(input);
        *disturbance -= *reach;
    }
    (a, b)
}

/// The continuous model with its input, of the whole state, in units of [`SIZES`].
fn continuous(loops: &LoopGains) -> Square<ORDER> {
    let &LoopGains {
        attitude_p,
        setpoint_cutoff: filter,
        rate_p: [roll_p, pitch_p],
        lag,
        ..
    } = loops;
    let motor = 1.0 / lag;
    // One law for both directions, made for the slower turn: the faster one leaves it more room.
    let rate = motor * roll_p.min(pitch_p);
    let angle = rate * attitude_p;
    let gust = 1.0 / GUST;
    let mut rows = [
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, -angle, -rate, -motor, angle, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, -filter, filter, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -filter, 0.0, filter],
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -gust, 0.0],
        [0.0; ORDER],
    ];
    for (row, own) in rows.iter_mut().zip(SIZES) {
        row.iter_mut().zip(SIZES).for_each(|(x, size)| *x *= size / own);
    }
    rows
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::params::Params;

    type Matrix = Vec<Vec<f64>>;

    /// Period of the law, s.
    const DT: f64 = PERIOD as f64;

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
    fn model(p: &Params) -> Matrix {
        model_of(&LoopGains::of(p))
    }

    /// The same of any loops.
    fn model_of(loops: &LoopGains) -> Matrix {
        let filter = f64::from(loops.setpoint_cutoff);
        let (angle, rate) = (f64::from(loops.attitude_p), f64::from(loops.rate_p[1]));
        let motor = 1.0 / f64::from(loops.lag);
        let mut m = zeros(STATES + 1, STATES + 1);
        m[0][1] = 1.0;
        (m[1][2], m[1][7]) = (1.0, 1.0);
        m[2][3] = 1.0;
        m[3][4] = 1.0;
        (m[4][5], m[4][2]) = (motor * rate * angle, -motor * rate * angle);
        (m[4][3], m[4][4]) = (-motor * rate, -motor);
        (m[5][6], m[5][5]) = (filter, -filter);
        (m[6][8], m[6][6]) = (filter, -filter);
        m[7][7] = -1.0 / f64::from(GUST);
        m
    }

    /// exp(m dt) by the series of dt/1024, squared ten times.
    fn exponential_of(m: &Matrix, dt: f64) -> Matrix {
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
    fn discrete(m: &Matrix) -> (Matrix, Matrix) {
        let e = exponential_of(m, DT);
        let rows = || e.iter().take(STATES);
        (
            rows().map(|row| row[..STATES].to_vec()).collect(),
            rows().map(|row| std::vec![row[STATES]]).collect(),
        )
    }

    /// The equation iterated to rest in double precision, with the cost of u + d as it stands.
    fn iterated(p: &Params) -> Vec<f64> {
        let (a, b) = discrete(&model(p));
        let pace = f64::from(LoopGains::of(p).pace);
        let mut q = zeros(STATES, STATES);
        q[0][0] = (pace / f64::from(POSITION)).powi(2);
        q[1][1] = pace / f64::from(VELOCITY).powi(2);
        // (input + disturbance)²: what holds against a gust costs nothing.
        let effort = f64::from(EFFORT).powi(-2);
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

    /// Largest share of the state's length left after 90 s where a tilt gives `share` of its acceleration.
    fn left(p: &Params, share: f64) -> f64 {
        left_leaning(p, share, 0.0)
    }

    /// The same where the arms push by `arms` s² of the tilt's second derivative, which the law takes for a disturbance.
    fn left_leaning(p: &Params, share: f64, arms: f64) -> f64 {
        let mut m = model(p);
        (m[1][2], m[1][4]) = (share, arms);
        left_of(&Gains::of(p), &m, arms)
    }

    /// The same of any `gains` over the model `m`.
    fn left_of(gains: &Gains, m: &Matrix, arms: f64) -> f64 {
        let gains = gains.state.map(f64::from);
        let (a, b) = discrete(m);
        let step = |x: &Vec<f64>| -> Vec<f64> {
            let mut seen = x.clone();
            seen[7] += arms * x[4];
            let u: f64 = -gains.iter().zip(&seen).map(|(k, x)| k * x).sum::<f64>();
            let row = |(row, b): (&Vec<f64>, &Vec<f64>)| {
                row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() + b[0] * u
            };
            a.iter().zip(&b).map(row).collect()
        };
        (0..STATES)
            .map(|i| {
                let mut x = std::vec![0.0; STATES];
                x[i] = 1.0;
                for _ in 0..9000 {
                    x = step(&x);
                }
                x.iter().map(|x| x * x).sum::<f64>().sqrt()
            })
            .fold(0.0, f64::max)
    }

    /// Parameters that a builder may set.
    fn others() -> [Params; 8] {
        let p = Params::DEFAULT;
        [
            Params { attitude_p: 3.0, ..p },
            Params { attitude_p: 8.0, ..p },
            Params {
                rate_pitch_p: 7.0,
                ..p
            },
            Params {
                rate_pitch_p: 16.0,
                ..p
            },
            Params {
                motor_tau: 0.025,
                ..p
            },
            Params { motor_tau: 0.12, ..p },
            Params {
                setpoint_lpf_hz: 1.1,
                ..p
            },
            Params {
                setpoint_lpf_hz: 5.0,
                ..p
            },
        ]
    }

    #[test]
    fn the_gains_solve_the_equation_to_a_thousandth() {
        for p in [&[Params::DEFAULT][..], &others()].concat() {
            let (found, wanted) = (Gains::of(&p), iterated(&p));
            for (k, wanted) in found.state.iter().zip(&wanted) {
                assert!(
                    (f64::from(*k) / wanted - 1.0).abs() < 1e-3,
                    "{found:?} {wanted:?}"
                );
            }
        }
    }

    #[test]
    fn loops_of_any_parameters_give_finite_gains() {
        for attitude_p in [0.5, 12.0] {
            for rate_pitch_p in [0.0, 0.1, 40.0] {
                for motor_tau in [0.005, 0.3] {
                    for setpoint_lpf_hz in [0.15, 16.0] {
                        let p = Params {
                            attitude_p,
                            rate_pitch_p,
                            motor_tau,
                            setpoint_lpf_hz,
                            ..Params::DEFAULT
                        };
                        let gains = Gains::of(&p);
                        assert!(gains.state.iter().all(|k| k.is_finite()), "{p:?} {gains:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn loops_that_are_tuned_or_lag_otherwise_are_held() {
        for p in others() {
            // At 9 rad/s the arms' twist makes 1.26 of what a tilt gives.
            for share in [1.0, 1.3] {
                assert!(left(&p, share) < 1e-3, "{share}: {} {p:?}", left(&p, share));
            }
        }
        for motor_tau in [0.025, 0.05, 0.07, 0.09, 0.12] {
            let p = Params {
                motor_tau,
                ..Params::DEFAULT
            };
            assert!(left(&p, 1.6) < 0.5, "{motor_tau}: {}", left(&p, 1.6));
        }
    }

    /// The model of `loops` over motors that lag `times` as much as they are made for.
    fn lagging(loops: &LoopGains, times: f64) -> Matrix {
        let mut m = model_of(loops);
        m[4].iter_mut().for_each(|x| *x /= times);
        m
    }

    #[test]
    fn a_gentle_hold_bears_what_the_other_does_not() {
        let p = Params::DEFAULT;
        let worst = |gains: &Gains, loops: &LoopGains| {
            let times = (10..60).map(|i| 0.1 * f64::from(i));
            times
                .take_while(|times| left_of(gains, &lagging(loops, *times), 0.0) < 1e-2)
                .last()
        };
        let usual = worst(&Gains::of(&p), &LoopGains::of(&p));
        let gentle = worst(&Gains::gentle(&p), &LoopGains::gentle(&p));
        assert!(
            usual
                .zip(gentle)
                .is_some_and(|(usual, gentle)| gentle > 1.25 * usual),
            "{usual:?} {gentle:?}"
        );
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
