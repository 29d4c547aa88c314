//! Gains of attitude and rate loop in force: those of the parameters, with a lead that makes up for motors that lag more than
//! 0.05 s, and slower where the lead would be too large.
//!
//! A moment that passes (motor_tau s + 1) / (T s + 1) before motors of motor_tau comes as by motors of T, 0.05 s: loops, hold
//! and pilot have one vehicle to deal with. The lead amplifies the gyro's noise, and steps towards the rotors' limits, by
//! motor_tau / T; beyond 2.4 times, the loops are slowed instead. A loop whose every time is
//! stretched by k keeps its margins: rates per second shrink by k, those per second squared by k², and the derivative
//! gain, a pure number, stays.

use core::f32::consts::TAU;

use crate::maths::scalar::clamp;
use crate::params::Params;

/// Lag of the motors that the loops are made for, s.
const USUAL_LAG: f32 = 0.05;
/// Largest amplification by the lead: motors of 0.12 s.
const LEAD_MAX: f32 = 2.4;
/// Lag beside the motors', s. With it the phase margin of pitch, the least, stays within 1 deg of its 27 deg for loops that are
/// slowed by half (`sophie check`): gyro filter, frames, and the arms, which bend with thrust at 4.75 Hz.
const OTHER_LAG: f32 = 0.03;

/// Pace of gentle loops over that of the others: that for motors which lag twice as much as the loops are made for, 0.62.
const GENTLE: f32 = (USUAL_LAG + OTHER_LAG) / (2.0 * USUAL_LAG + OTHER_LAG);

/// Gains of roll and pitch in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Angle to rate, 1/s.
    pub attitude_p: f32,
    /// Cut-off of the setpoint's prefilter, rad/s.
    pub setpoint_cutoff: f32,
    /// Rate to angular acceleration, roll and pitch, 1/s.
    pub rate_p: [f32; 2],
    /// Integral of the rate to angular acceleration, roll and pitch, 1/s².
    pub rate_i: [f32; 2],
    /// Amplification of fast moments, less 1: 0 to 1.4.
    pub lead: f32,
    /// Lag of a moment behind its demand, s, lead and motors together.
    pub lag: f32,
    /// Pace over that of the parameters, 0.5 to 1: 1 up to 0.12 s.
    pub pace: f32,
}

impl Gains {
    /// Gains for `p`.
    pub fn of(p: &Params) -> Self {
        let amplified = clamp(p.motor_tau / USUAL_LAG, 1.0, LEAD_MAX);
        let lag = p.motor_tau / amplified;
        let pace = clamp((USUAL_LAG + OTHER_LAG) / (lag + OTHER_LAG), 0.0, 1.0);
        Self {
            attitude_p: pace * p.attitude_p,
            setpoint_cutoff: pace * TAU * p.setpoint_lpf_hz,
            rate_p: [pace * p.rate_roll_p, pace * p.rate_pitch_p],
            rate_i: [pace * pace * p.rate_roll_i, pace * pace * p.rate_pitch_i],
            lead: amplified - 1.0,
            lag,
            pace,
        }
    }

    /// Slower gains, for a vehicle that swings with the others.
    pub fn gentle(p: &Params) -> Self {
        let usual = Self::of(p);
        Self {
            attitude_p: GENTLE * usual.attitude_p,
            setpoint_cutoff: GENTLE * usual.setpoint_cutoff,
            rate_p: usual.rate_p.map(|gain| GENTLE * gain),
            rate_i: usual.rate_i.map(|gain| GENTLE * GENTLE * gain),
            pace: GENTLE * usual.pace,
            ..usual
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(motor_tau: f32) -> Gains {
        Gains::of(&Params {
            motor_tau,
            ..Params::DEFAULT
        })
    }

    #[test]
    fn motors_up_to_the_usual_lag_fly_the_parameters() {
        let p = Params::DEFAULT;
        for motor_tau in [0.02, 0.05] {
            let gains = of(motor_tau);
            assert_eq!(
                (gains.attitude_p, gains.rate_p, gains.rate_i),
                (
                    p.attitude_p,
                    [p.rate_roll_p, p.rate_pitch_p],
                    [p.rate_roll_i, p.rate_pitch_i]
                )
            );
            assert_eq!((gains.lead, gains.lag), (0.0, motor_tau));
        }
    }

    #[test]
    fn slower_motors_are_led() {
        let gains = of(0.1);
        assert!(
            (gains.lead - 1.0).abs() < 1e-5 && (gains.lag - 0.05).abs() < 1e-6,
            "{gains:?}"
        );
        assert!(gains.pace > 0.9999 && gains.rate_p[1] > 9.999, "{gains:?}");
    }

    #[test]
    fn gentle_loops_are_those_of_motors_that_lag_twice_as_much() {
        let p = Params::DEFAULT;
        let (usual, gentle) = (Gains::of(&p), Gains::gentle(&p));
        // 0.08 s of 0.13 s.
        let close = |x: f32, y: f32| (x / y - 1.0).abs() < 1e-5;
        assert!(close(gentle.pace, 0.08 / 0.13 * usual.pace), "{gentle:?}");
        assert!(close(gentle.attitude_p, gentle.pace * p.attitude_p), "{gentle:?}");
        assert!(
            close(gentle.setpoint_cutoff, gentle.pace * usual.setpoint_cutoff),
            "{gentle:?}"
        );
        assert!(
            close(gentle.rate_p[1], gentle.pace * p.rate_pitch_p),
            "{gentle:?}"
        );
        assert!(
            close(gentle.rate_i[0], gentle.pace * gentle.pace * p.rate_roll_i),
            "{gentle:?}"
        );
        assert_eq!((gentle.lead, gentle.lag), (usual.lead, usual.lag));
    }

    /// Twice the usual loop's lag, 0.08 s, is left: everything takes twice the time.
    #[test]
    fn motors_that_are_slower_still_stretch_the_loops() {
        let gains = of(0.13 * LEAD_MAX);
        assert!((gains.lead - 1.4).abs() < 1e-5, "{gains:?}");
        assert!((gains.rate_p[1] / 10.0 - gains.pace).abs() < 1e-6, "{gains:?}");
        assert!((gains.pace - 0.5).abs() < 1e-4, "{gains:?}");
        assert!((gains.rate_i[1] - 2.0).abs() < 1e-3, "{gains:?}");
    }
}
