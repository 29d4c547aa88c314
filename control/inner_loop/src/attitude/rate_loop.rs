//! Rate control, 1 kHz: PID on the body rates, with gains in 1/s, independent of the inertia.
//!
//! The derivative acts on the filtered measured rate. Integrators stop where the mixer could not give the demand,
//! unless they unwind. Yaw passes a notch at the arms' bending mode, roll and pitch a lead where the motors are slow
//! ([`super::gains`]).

use core::f32::consts::TAU;

use super::gains::Gains;
use crate::maths::filter::{Biquad, Coefficients, LowPass};
use crate::maths::scalar;
use crate::maths::vector::Vec3;
use crate::params::Params;

/// Largest angular acceleration that an integrator may hold, rad/s².
const INTEGRAL_MAX: Vec3 = Vec3::new(15.0, 15.0, 3.0);
/// Share of a demand below which it counts as not given.
const GIVEN: f32 = 0.999;

/// Given part of the last demand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback {
    /// Share of roll and pitch, 0..1.
    pub roll_pitch: f32,
    /// Share of yaw, 0..1.
    pub yaw: f32,
    /// Yaw was given up altogether.
    pub yaw_gated: bool,
}

impl Feedback {
    /// No mix: nothing may wind up.
    pub const NOTHING: Self = Self {
        roll_pitch: 0.0,
        yaw: 0.0,
        yaw_gated: true,
    };
}

/// The rate loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateLoop {
    p: Vec3,
    i: Vec3,
    d: Vec3,
    last: Vec3,
    started: bool,
    d_rate: f32,
    inertia: Vec3,
    integral: Vec3,
    derivative: [LowPass; 3],
    notch: Biquad,
    /// Amplification of fast moments about roll and pitch, less 1; remaining lag of the motors, s; slow part of each.
    lead: f32,
    lag: f32,
    slow: [LowPass; 2],
}

impl RateLoop {
    /// A loop at rest for steps at `rate_hz` (Hz, > 0).
    pub fn new(p: &Params, rate_hz: f32) -> Self {
        let gains = Gains::of(p);
        let ([roll_p, pitch_p], [roll_i, pitch_i]) = (gains.rate_p, gains.rate_i);
        Self {
            p: Vec3::new(roll_p, pitch_p, p.rate_yaw_p),
            i: Vec3::new(roll_i, pitch_i, p.rate_yaw_i),
            d: Vec3::new(p.rate_d, p.rate_d, 0.0),
            d_rate: TAU * p.rate_d_cutoff,
            inertia: Vec3::new(p.inertia_roll, p.inertia_pitch, p.inertia_yaw),
            integral: Vec3::ZERO,
            derivative: [LowPass::default(); 3],
            last: Vec3::ZERO,
            started: false,
            lead: gains.lead,
            lag: gains.lag,
            slow: [LowPass::default(); 2],
            notch: Biquad::new(Coefficients::notch(
                p.notch_hz,
                p.notch_zeta_zero,
                p.notch_zeta_pole,
                rate_hz,
            )),
        }
    }

    /// Takes other gains of roll and pitch.
    pub fn change(&mut self, gains: &Gains) {
        let ([roll_p, pitch_p], [roll_i, pitch_i]) = (gains.rate_p, gains.rate_i);
        (self.p, self.i) = (
            Vec3::new(roll_p, pitch_p, self.p.z),
            Vec3::new(roll_i, pitch_i, self.i.z),
        );
    }

    /// Clears integrals, derivatives and notch.
    pub fn reset(&mut self) {
        self.integral = Vec3::ZERO;
        self.derivative = [LowPass::default(); 3];
        self.last = Vec3::ZERO;
        self.started = false;
        self.slow = [LowPass::default(); 2];
        self.notch.reset(0.0);
    }

    /// Moments (N·m) from `rate` to `setpoint` (rad/s) in a step of `dt` s, > 0; `integrate` is false while resting.
    #[inline(always)]
    pub fn step(&mut self, setpoint: Vec3, rate: Vec3, feedback: Feedback, integrate: bool, dt: f32) -> Vec3 {
        let error = setpoint - rate;
        let per_second = if self.started { 1.0 / dt } else { 0.0 };
        let slope = (rate - self.last) * per_second;
        self.last = rate;
        self.started = true;
        // A non-finite slope makes the moment so, which resets everything.
        let gain = LowPass::gain(self.d_rate, dt);
        let [dx, dy, dz] = &mut self.derivative;
        let slope = Vec3::new(
            dx.blend(slope.x, gain),
            dy.blend(slope.y, gain),
            dz.blend(slope.z, gain),
        );
        let free = !feedback.yaw_gated;
        let (tilt_given, yaw_given) = (feedback.roll_pitch > GIVEN, feedback.yaw > GIVEN && free);
        let step = error.scale_by(self.i) * if integrate { dt } else { 0.0 };
        let add = |sum: f32, step: f32, limit: f32, given: bool| {
            // A limited integral may only unwind.
            let step = if given | (sum * step < 0.0) { step } else { 0.0 };
            scalar::clamp_abs(sum + step, limit)
        };
        let yaw_integral = if free { self.integral.z } else { 0.0 };
        self.integral = Vec3::new(
            add(self.integral.x, step.x, INTEGRAL_MAX.x, tilt_given),
            add(self.integral.y, step.y, INTEGRAL_MAX.y, tilt_given),
            add(yaw_integral, step.z, INTEGRAL_MAX.z, yaw_given),
        );
        let acceleration = error.scale_by(self.p) + self.integral - slope.scale_by(self.d);
        let mut moment = acceleration.scale_by(self.inertia);
        if self.lead > 0.0 {
            let gain = LowPass::gain(1.0 / self.lag, dt);
            let [slow_x, slow_y] = &mut self.slow;
            moment.x += self.lead * (moment.x - slow_x.blend(moment.x, gain));
            moment.y += self.lead * (moment.y - slow_y.blend(moment.y, gain));
        }
        let yaw = self.notch.step(moment.z);
        let moment = Vec3::new(moment.x, moment.y, if free { yaw } else { 0.0 });
        if !free {
            self.notch.reset(0.0);
        }
        if !moment.is_finite() {
            self.reset();
            return Vec3::ZERO;
        }
        moment
    }

    /// Integrators, rad/s², within ±15 for roll and pitch and ±3 for yaw.
    pub const fn integral(&self) -> Vec3 {
        self.integral
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FREE: Feedback = Feedback {
        roll_pitch: 1.0,
        yaw: 1.0,
        yaw_gated: false,
    };

    /// Parameters of motors that need no lead.
    const UNLED: Params = Params {
        motor_tau: 0.05,
        ..Params::DEFAULT
    };

    fn rate_loop() -> RateLoop {
        RateLoop::new(&UNLED, 1000.0)
    }

    #[test]
    fn proportional_moment_by_hand() {
        // 0.5 rad/s of error: 0.5 · 20 1/s · 0.021 kg·m² = 0.21 N·m, plus one step of integral.
        let m = rate_loop().step(Vec3::new(0.5, 0.0, 0.0), Vec3::ZERO, FREE, true, 1e-3);
        assert!((m.x - 0.21).abs() < 6e-4 && m.y.abs() < 1e-9);
    }

    #[test]
    fn slow_motors_make_the_moment_that_others_make() {
        let made = |motor_tau: f32| {
            let p = Params { motor_tau, ..UNLED };
            let mut l = RateLoop::new(&p, 1000.0);
            let mut made = Vec3::ZERO;
            (0..200).map(move |ms| {
                let rate = Vec3::new(0.5, -0.3, 0.0) * if ms < 100 { 1.0 } else { -1.0 };
                let moment = l.step(rate, Vec3::ZERO, FREE, true, 1e-3);
                made = made + (moment - made) * (1e-3 / (1e-3 + motor_tau));
                made
            })
        };
        for (usual, slow) in made(0.05).zip(made(0.12)) {
            assert!((usual - slow).norm() < 1e-4, "{usual:?} {slow:?}");
        }
    }

    #[test]
    fn the_integral_grows_at_its_gain() {
        let mut l = rate_loop();
        for _ in 0..1000 {
            l.step(Vec3::new(0.0, 0.2, 0.0), Vec3::ZERO, FREE, true, 1e-3);
        }
        assert!((l.integral().y - 1.6).abs() < 1e-3);
    }

    #[test]
    fn what_was_not_given_does_not_wind_up_but_unwinds() {
        let mut l = rate_loop();
        let held = Feedback {
            roll_pitch: 0.5,
            yaw: 0.0,
            yaw_gated: false,
        };
        for _ in 0..500 {
            l.step(Vec3::new(1.0, 0.0, 1.0), Vec3::ZERO, held, true, 1e-3);
        }
        assert!(l.integral() == Vec3::ZERO);
        for _ in 0..500 {
            l.step(Vec3::new(1.0, 0.0, 0.0), Vec3::ZERO, FREE, true, 1e-3);
        }
        let wound = l.integral().x;
        for _ in 0..100 {
            l.step(Vec3::new(-1.0, 0.0, 0.0), Vec3::ZERO, held, true, 1e-3);
        }
        assert!(l.integral().x < wound - 0.5);
    }

    #[test]
    fn a_setpoint_step_gives_no_derivative_kick_and_motion_is_damped() {
        let mut l = RateLoop::new(&Params { rate_d: 0.1, ..UNLED }, 1000.0);
        l.step(Vec3::ZERO, Vec3::ZERO, FREE, false, 1e-3);
        let m = l.step(Vec3::new(1.0, 0.0, 0.0), Vec3::ZERO, FREE, false, 1e-3);
        assert!((m.x - 0.42).abs() < 2e-4);
        let damped = l.step(
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.05, 0.0, 0.0),
            FREE,
            false,
            1e-3,
        );
        assert!(damped.x < 0.95 * 0.42);
    }

    #[test]
    fn what_the_rate_exceeds_the_setpoint_by_is_taken_away() {
        // (0.2 - 0.5) rad/s · 20 1/s · 0.021 kg·m².
        let m = rate_loop().step(
            Vec3::new(0.2, 0.0, 0.0),
            Vec3::new(0.5, 0.0, 0.0),
            FREE,
            false,
            1e-3,
        );
        assert!((m.x + 0.126).abs() < 1e-5, "{m:?}");
    }

    #[test]
    fn an_integral_winds_up_is_added_and_unwinds_at_the_same_rate() {
        let mut l = rate_loop();
        let mut m = Vec3::ZERO;
        for _ in 0..500 {
            m = l.step(Vec3::new(0.4, 0.0, 0.4), Vec3::ZERO, FREE, true, 1e-3);
        }
        // 50 1/s² · 0.4 rad/s · 0.5 s and 1.5 1/s² · 0.4 rad/s · 0.5 s.
        let sum = l.integral();
        assert!(
            (sum.x - 10.0).abs() < 0.02 && (sum.z - 0.3).abs() < 1e-3,
            "{sum:?}"
        );
        assert!((m.x - 0.021 * (8.0 + 10.0)).abs() < 1e-3, "{m:?}");
        for _ in 0..500 {
            l.step(Vec3::new(-0.4, 0.0, -0.4), Vec3::ZERO, FREE, true, 1e-3);
        }
        let sum = l.integral();
        assert!(sum.x.abs() < 0.01 && sum.z.abs() < 1e-3, "{sum:?}");
    }

    #[test]
    fn a_thousandth_less_than_all_is_not_given() {
        let wound = |roll_pitch, yaw| {
            let mut l = rate_loop();
            let feedback = Feedback {
                roll_pitch,
                yaw,
                yaw_gated: false,
            };
            l.step(Vec3::new(1.0, 1.0, 0.4), Vec3::ZERO, feedback, true, 1e-3);
            l.integral().to_array().map(|i| i > 0.0)
        };
        assert_eq!(wound(1.0, 1.0), [true; 3]);
        assert_eq!(wound(0.999, 1.0), [false, false, true]);
        assert_eq!(wound(1.0, 0.999), [true, true, false]);
        assert_eq!(wound(0.9995, 0.9995), [true; 3]);
    }

    #[test]
    fn a_reset_leaves_nothing_of_the_past() {
        let p = Params {
            rate_d: 0.1,
            ..Params::default()
        };
        let mut l = RateLoop::new(&p, 1000.0);
        for i in 0..200 {
            let rate = Vec3::new(0.01, -0.02, 0.005) * i as f32;
            l.step(Vec3::new(1.0, -1.0, 0.4), rate, FREE, true, 1e-3);
        }
        assert!(l.integral().norm() > 1.0);
        l.reset();
        assert!(l == RateLoop::new(&p, 1000.0));
    }

    #[test]
    fn yaw_is_notched_at_the_arms_mode_and_the_notch_forgets_where_yaw_is_gated() {
        // 4.75 Hz, 1 rad/s: 0.2/0.8 of 3 1/s · 0.063 kg·m² is left, 0.0473 N·m.
        let mut l = rate_loop();
        let mut peak = 0.0f32;
        let sine = |i: i32| {
            Vec3::new(
                0.0,
                0.0,
                crate::maths::scalar::sin(TAU * 4.75e-3 * (i % 4000) as f32),
            )
        };
        for i in 0..4000 {
            let m = l.step(sine(i), Vec3::ZERO, FREE, false, 1e-3);
            peak = if i > 2000 { peak.max(m.z.abs()) } else { 0.0 };
        }
        assert!((peak - 0.0473).abs() < 0.003, "{peak}");
        let gated = Feedback {
            yaw_gated: true,
            ..FREE
        };
        assert!(l.step(sine(50), Vec3::ZERO, gated, false, 1e-3) == Vec3::ZERO);
        assert!(l.step(Vec3::ZERO, Vec3::ZERO, FREE, false, 1e-3) == Vec3::ZERO);
    }

    #[test]
    fn each_axis_has_a_derivative_of_its_own() {
        let p = Params {
            rate_d: 0.1,
            ..Params::default()
        };
        for axis in 0..3 {
            let mut l = RateLoop::new(&p, 1000.0);
            let mut rate = [0.0; 3];
            for _ in 0..200 {
                rate[axis] += 0.01;
                let rate = Vec3::from(rate);
                // No error: only the derivative is left.
                let m = l.step(rate, rate, FREE, false, 1e-3).to_array();
                for (other, m) in m.into_iter().enumerate() {
                    assert!(other == axis || m == 0.0, "{axis} -> {other}: {m}");
                }
            }
            for (other, d) in l.derivative.iter().enumerate() {
                let slope = if other == axis { 10.0 } else { 0.0 };
                assert!(
                    (d.value() - slope).abs() < 0.01,
                    "{axis} -> {other}: {}",
                    d.value()
                );
            }
        }
    }

    #[test]
    fn a_gated_yaw_is_silent_and_forgets() {
        let mut l = rate_loop();
        for _ in 0..500 {
            l.step(Vec3::new(0.0, 0.0, 0.4), Vec3::ZERO, FREE, true, 1e-3);
        }
        let gated = Feedback {
            yaw_gated: true,
            ..FREE
        };
        let m = l.step(Vec3::new(0.0, 0.0, 0.4), Vec3::ZERO, gated, true, 1e-3);
        assert!(m.z == 0.0 && l.integral().z == 0.0);
    }

    proptest! {
        #[test]
        fn no_nan_comes_out_and_the_loop_recovers(bits in prop::collection::vec(any::<[u32; 6]>(), 1..20)) {
            let mut l = rate_loop();
            for b in bits {
                let f = |i: usize| f32::from_bits(b[i]);
                let m = l.step(Vec3::new(f(0), f(1), f(2)), Vec3::new(f(3), f(4), f(5)), FREE, true, 1e-3);
                prop_assert!(m.to_array().iter().all(|x| x.is_finite()));
            }
            // One step may still have the last bad rate in its slope.
            l.step(Vec3::ZERO, Vec3::ZERO, FREE, true, 1e-3);
            for _ in 0..2000 {
                let m = l.step(Vec3::ZERO, Vec3::ZERO, FREE, true, 1e-3).to_array();
                prop_assert!(m.iter().all(|x| x.is_finite()));
            }
            prop_assert!(l.integral().to_array().iter().all(|x| x.is_finite()));
        }
    }
}
