//! The laws' response to a body rate: gyro filter, rate loop and attitude loop, as flown.

use sophie_control::attitude::attitude_loop::{AttitudeLoop, AttitudeSetpoint};
use sophie_control::attitude::imu_filter::ImuFilter;
use sophie_control::attitude::rate_loop::{Feedback, RateLoop};
use sophie_control::chain::{CONTROL_RATE_HZ, ImuReading};
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::params::Params;

use super::response::{Complex, Response, difference, quotient};

/// Step of the laws, s.
const DT: f32 = 1.0 / CONTROL_RATE_HZ;
/// Impulses in rad/s and rad, small enough to reach no limit.
const RATE: f32 = 0.1;
const ANGLE: f32 = 0.01;
/// Settling of gyro filter and rate loop: 20 Hz and a notch at 1 Hz.
const FILTER_STEPS: usize = 500;
const LOOP_STEPS: usize = 4000;
const ALL_GIVEN: Feedback = Feedback {
    roll_pitch: 1.0,
    yaw: 1.0,
    yaw_gated: false,
};

/// The laws about roll, pitch and yaw.
#[derive(Clone, Debug)]
pub struct Laws {
    /// Filtered over measured rate.
    filter: Response,
    axes: [AxisLaws; 3],
}

#[derive(Clone, Debug)]
struct AxisLaws {
    /// Moment over measured rate, N·m·s/rad.
    by_rate: Response,
    /// Moment over rate setpoint, N·m·s/rad.
    by_setpoint: Response,
    /// Rate setpoint over angle, 1/s.
    attitude: f64,
}

impl Laws {
    /// Identifies the laws with `params`.
    #[must_use]
    pub fn of(params: &Params) -> Self {
        let (by_rate, by_setpoint) = (rate_loop(params, false), rate_loop(params, true));
        Self {
            filter: filter(params),
            axes: std::array::from_fn(|axis| AxisLaws {
                by_rate: Response::of(&by_rate[axis]),
                by_setpoint: Response::of(&by_setpoint[axis]),
                attitude: attitude(params, axis),
            }),
        }
    }

    /// Moment over rate about `axis` at `angle` rad a step, N·m·s/rad: F (C_r + C_s p T / (1 - z⁻¹)), since the angle
    /// sums the rates.
    #[must_use]
    pub fn at(&self, axis: usize, angle: f64) -> Complex {
        let law = &self.axes[axis];
        let turned = quotient(Complex::new(law.attitude * f64::from(DT), 0.0), difference(angle));
        let moment = law.by_rate.at(angle) + law.by_setpoint.at(angle).rotate(turned);
        self.filter.at(angle).rotate(moment)
    }
}

/// As on a board: samples interpolated between two steps, each a sample late.
fn filter(params: &Params) -> Response {
    let rate = params.imu_rate.number();
    let per_step = (rate / CONTROL_RATE_HZ).max(1.0) as usize;
    let mut filter = ImuFilter::new(params.gyro_cutoff, rate);
    let reading = |gyro: f32| ImuReading {
        gyro: Vec3::new(gyro, 0.0, 0.0),
        accel: Vec3::ZERO,
    };
    let (mut newest, mut waiting) = (reading(0.0), reading(0.0));
    // Settles before the impulse.
    filter.batch(&[waiting], Vec3::ZERO, &mut newest);
    let mut last = 0.0;
    let answer: Vec<f64> = (0..FILTER_STEPS)
        .map(|step| {
            let now = if step == 0 { RATE } else { 0.0 };
            for k in 1..=per_step {
                let share = k as f32 / per_step as f32;
                let sample = reading(last + (now - last) * share);
                let late = std::mem::replace(&mut waiting, sample);
                filter.batch(&[late], Vec3::ZERO, &mut newest);
            }
            last = now;
            f64::from(newest.gyro.x / RATE)
        })
        .collect();
    Response::of(&answer)
}

/// Moments (N·m·s/rad) after an impulse of measured rate or setpoint, about all axes at once: they are independent.
fn rate_loop(params: &Params, setpoint: bool) -> [Vec<f64>; 3] {
    let mut law = RateLoop::new(params, CONTROL_RATE_HZ);
    let mut answers: [Vec<f64>; 3] = Default::default();
    // The first step has no slope yet.
    law.step(Vec3::ZERO, Vec3::ZERO, ALL_GIVEN, true, DT);
    for step in 0..LOOP_STEPS {
        let impulse = if step == 0 {
            Vec3::new(RATE, RATE, RATE)
        } else {
            Vec3::ZERO
        };
        let (wanted, rate, sign) = if setpoint {
            (impulse, Vec3::ZERO, 1.0)
        } else {
            (Vec3::ZERO, impulse, -1.0)
        };
        let moment = law.step(wanted, rate, ALL_GIVEN, true, DT).to_array();
        for (answer, moment) in answers.iter_mut().zip(moment) {
            answer.push(f64::from(sign * moment / RATE));
        }
    }
    answers
}

/// Rate setpoint (rad/s) per rad of turn about `axis`, from a turn of [`ANGLE`].
fn attitude(params: &Params, axis: usize) -> f64 {
    let mut law = AttitudeLoop::new(params);
    law.reset(Quat::IDENTITY);
    law.aim(AttitudeSetpoint::default());
    let mut turn = [0.0; 3];
    turn[axis] = 0.5 * ANGLE;
    let [x, y, z] = turn;
    let turned = Quat { w: 1.0, x, y, z }.normalised();
    f64::from(-law.step(turned, DT).to_array()[axis] / ANGLE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_rates_meet_the_gains_and_fast_ones_the_filter() {
        let p = Params {
            notch_zeta_zero: 0.8,
            // Motors that need no lead.
            motor_tau: 0.05,
            ..Params::default()
        };
        let laws = Laws::of(&p);
        // p 20 1/s, i 50 1/s², attitude 4.5 1/s: at 1 rad/s (20 + 50/j)(1 + 4.5/j) 0.021 = (-205 - 140 j) 0.021.
        let slow = laws.at(0, 1e-3) / 0.021;
        assert!((slow - Complex::new(-205.0, -140.0)).length() < 1.0, "{slow}");
        // Yaw: (3 + 1.5/j)(1 + 1.2/j) 0.063 = (1.2 - 5.1 j) 0.063, without notch.
        let yaw = laws.at(2, 1e-3) / 0.063;
        assert!((yaw - Complex::new(1.2, -5.1)).length() < 0.03, "{yaw}");
        // At the filter's cut-off of 90 Hz the gain is 0.707 of 0.42 and the phase beyond -90°.
        let fast = laws.at(0, std::f64::consts::TAU * 0.09);
        assert!(
            (fast.length() / 0.42 - 0.707).abs() < 0.02 && fast.to_angle() < -1.6,
            "{fast}"
        );
    }
}
