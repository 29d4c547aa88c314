//! Model of the unmeasured lag from setpoint to tilt: the setpoint's filter, and the motors.

use crate::attitude::gains::Gains;
use crate::maths::filter::LowPass;
use crate::maths::scalar;

/// Steps of the filter in one step of the law: it runs at 1 kHz.
const SUBSTEPS: u8 = 10;
/// Limit of the modelled second derivative of the tilt, m/s⁴.
const TURNING_MAX: f32 = 500.0;

/// The loops that it models, one for both directions: that of the slower turn, as of the hold's gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loops {
    /// Cut-off of the setpoint's filter, rad/s.
    pub cutoff: f32,
    /// Angle to rate, 1/s.
    pub attitude_p: f32,
    /// Rate to angular acceleration, 1/s.
    pub rate_p: f32,
    /// Lag of a moment behind its demand, s.
    pub lag: f32,
}

impl Loops {
    /// Of loops with `gains`.
    pub fn of(gains: &Gains) -> Self {
        let [roll_p, pitch_p] = gains.rate_p;
        Self {
            cutoff: gains.setpoint_cutoff,
            attitude_p: gains.attitude_p,
            rate_p: roll_p.min(pitch_p),
            lag: gains.lag,
        }
    }
}

/// State of the model, forward and right, m/s² and m/s⁴.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// First stage of the filter.
    pub first: [f32; 2],
    /// Second stage.
    pub second: [f32; 2],
    /// Second derivative of the tilt, by the motors' thrust.
    pub turning: [f32; 2],
}

impl Lag {
    /// At rest at the tilt `a`, m/s².
    pub fn at(a: [f32; 2]) -> Self {
        Self {
            first: a,
            second: a,
            turning: [0.0; 2],
        }
    }

    /// A step of `dt` s over `loops` with the setpoint `u`, from the tilt `a` (m/s²) and its rate (m/s³).
    pub fn step(&mut self, loops: &Loops, u: [f32; 2], a: [f32; 2], rate: [f32; 2], dt: f32) {
        let gain = LowPass::gain(loops.cutoff, dt / f32::from(SUBSTEPS));
        let follow = LowPass::gain(1.0 / loops.lag, dt);
        let stages = self.first.iter_mut().zip(&mut self.second).zip(&mut self.turning);
        for (((first, second), turning), ((u, a), rate)) in stages.zip(u.into_iter().zip(a).zip(rate)) {
            for _ in 0..SUBSTEPS {
                *first += (u - *first) * gain;
                *second += (*first - *second) * gain;
            }
            let asked = loops.rate_p * (loops.attitude_p * (*second - a) - rate);
            *turning = scalar::clamp_abs(*turning + (asked - *turning) * follow, TURNING_MAX);
        }
    }
}
