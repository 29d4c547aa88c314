//! The loop of the position hold, opened where an acceleration becomes motion.
//!
//! The law (100 Hz), attitude and rate loop, allocation and plant answer an impulse of the estimate's position, velocity and
//! disturbance in turn, each by a level acceleration: Q_p, Q_v, Q_d. An acceleration w that lasts a period T makes
//!
//!   v' = v + T w,   p' = p + T v + T²/2 w,   d' = d + g (w - d),
//!
//! with g of the estimator's low pass, and the loop is L = -(Q_p P + Q_v V + Q_d D). Its gain margin is the factor by which a
//! tilt may give more or less acceleration than this vehicle's; the estimate itself is taken to be true.

use sophie_control::chain::Control;
use sophie_control::maths::filter::LowPass;
use sophie_control::maths::vector::Vec3;
use sophie_control::navigation::estimate::Estimate;
use sophie_control::navigation::position_estimator::LATERAL_CUTOFF;
use sophie_control::position_hold::gains::Gains;
use sophie_control::position_hold::{BodyMotion, PositionHold, VelocityCommand};

use super::margins::Margins;
use super::response::{Complex, Response, difference, quotient};
use super::vehicle::Hovering;
use super::{LOWEST, rising};
use crate::plant::GRAVITY;
use crate::scenario::Scenario;

/// Period of the law, s, and of the loops below it in it.
const PERIOD: f64 = 0.01;
const STEPS: usize = 10;
/// Impulses: m, m/s, m/s²; the law asks for 0.3 m/s² at most, a tenth of its limit.
const IMPULSES: [f64; 3] = [0.05, 0.05, 0.2];
/// Periods until the loops have settled on the hover, and of an answer: after 2.5 s the learnt wind alone is left, whose 4 s
/// are far below the loop's 3 rad/s.
const SETTLING: usize = 100;
const ANSWERED: usize = 250;

/// Margins of the hold forward and to the right, of the vehicle of `scenario`.
#[must_use]
pub fn hold_margins(scenario: &Scenario) -> [Margins; 2] {
    let mut settled = Holding::of(scenario);
    for _ in 0..SETTLING {
        settled.period([0.0; 3]);
    }
    // Forward and to the right at once: the axes hardly know of each other.
    let answers = IMPULSES.into_iter().enumerate().map(|(which, size)| {
        let answer = |sign: f64| -> Vec<[f64; 2]> {
            let mut holding = settled.clone();
            let mut impulse = [0.0; 3];
            impulse[which] = sign * size;
            (0..ANSWERED)
                .map(|k| holding.period(if k == 0 { impulse } else { [0.0; 3] }))
                .collect()
        };
        let (there, back) = (answer(1.0), answer(-1.0));
        [0, 1].map(|axis| {
            let half = there
                .iter()
                .zip(&back)
                .map(|(t, b)| 0.5 * (t[axis] - b[axis]) / size);
            Response::of(&half.collect::<Vec<_>>())
        })
    });
    let answers: Vec<[Response; 2]> = answers.collect();
    [0, 1].map(|axis| {
        let curve: Vec<_> = rising(LOWEST, std::f64::consts::PI / PERIOD)
            .map(|omega| {
                let angle = omega * PERIOD;
                let [p, v, d] = motion(angle);
                let gain = [p, v, d]
                    .iter()
                    .zip(&answers)
                    .fold(Complex::ZERO, |sum, (part, answer)| {
                        sum - part.rotate(answer[axis].at(angle))
                    });
                (omega, gain)
            })
            .collect();
        Margins::of(&curve, PERIOD)
    })
}

/// Position, velocity and disturbance by an acceleration of 1, at `angle` rad a period.
fn motion(angle: f64) -> [Complex; 3] {
    let later = Complex::from_angle(-angle);
    let sum = difference(angle);
    let velocity = quotient(later * PERIOD, sum);
    let position = quotient(
        later.rotate(velocity) * PERIOD + later * (0.5 * PERIOD * PERIOD),
        sum,
    );
    let follow = follow();
    let disturbance = quotient(later * follow, Complex::X - later * (1.0 - follow));
    [position, velocity, disturbance]
}

/// Share of its way that the estimator's low pass of the disturbance makes in a period.
fn follow() -> f64 {
    f64::from(LowPass::gain(LATERAL_CUTOFF, PERIOD as f32))
}

/// A vehicle under the hold's law, over loops at their gains, that stays where it is.
#[derive(Clone)]
struct Holding {
    vehicle: Hovering,
    law: PositionHold,
    /// Acceleration of the tilt behind the estimator's low pass, forward and right, m/s²: no disturbance.
    leaned: [f64; 2],
}

impl Holding {
    fn of(scenario: &Scenario) -> Self {
        let mut vehicle = Hovering::of(scenario);
        vehicle.take_over(Control::new(&scenario.params));
        let motion = vehicle.motion();
        let full = 4.0 * scenario.params.thrust_max;
        let gains = Gains::of(&scenario.params);
        let law = PositionHold::begin(&scenario.params, &gains, full, &Estimate::default(), &motion);
        let leaned = tilt(&motion);
        Self { vehicle, law, leaned }
    }

    /// A period with `off` added to position, velocity and disturbance of both axes; returns the mean acceleration forward and to
    /// the right, m/s².
    fn period(&mut self, off: [f64; 3]) -> [f64; 2] {
        let motion = self.vehicle.motion();
        for (leaned, tilt) in self.leaned.iter_mut().zip(tilt(&motion)) {
            *leaned += (tilt - *leaned) * follow();
        }
        let [position, velocity, disturbance] = off;
        let level = |[x, y]: [f64; 2]| Vec3::new(x as f32, y as f32, 0.0);
        let [ahead, right] = self.leaned;
        let estimate = Estimate {
            position: level([position; 2]),
            velocity: level([velocity; 2]),
            disturbance: level([disturbance - ahead, disturbance - right]),
            ..Estimate::default()
        };
        let setpoint = self.law.step(
            &estimate,
            &motion,
            &VelocityCommand::default(),
            true,
            PERIOD as f32,
        );
        let gained = self.vehicle.fly(setpoint, STEPS);
        [gained.x / PERIOD, gained.y / PERIOD]
    }
}

/// Acceleration that a tilt stands for, forward and right, m/s².
fn tilt(motion: &BodyMotion) -> [f64; 2] {
    let down = motion.q.down_in_body();
    [down.x, down.y].map(|part| GRAVITY * f64::from(part / down.z))
}
