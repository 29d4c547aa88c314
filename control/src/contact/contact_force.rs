//! Evidence from the inertial sensor that a support carries the vehicle.
//!
//! [`ContactForce::step`] runs at 100 Hz in the mode logic. Forces are along the body's thrust axis (N). A missed step
//! delays the evidence; 50 ms without an inertial sample end it.
//!
//! In free air, mass times specific force along the thrust axis is the thrust; on the ground or the pipe it is about
//! the weight. The difference is the support:
//!
//!   support = -m f_z - Σ T_i cos α_i
//!
//! In hover, an error of 5 % in mass or thrust gives less than 1 N.

use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar::{GRAVITY, PI, clamp};
use crate::params::Params;

/// Support of a resting vehicle, N.
pub const RESTING_FORCE: f32 = 3.0;
/// Support below which the vehicle no longer rests, N.
pub const LEAVING_FORCE: f32 = 1.5;
/// Support above which the failsafe tries a reduced thrust, N.
pub const HINT_FORCE: f32 = 1.8;
/// Time above [`RESTING_FORCE`] that proves a touch, s: three steps.
pub const TOUCH_TIME: f32 = 0.03;
/// Time below [`LEAVING_FORCE`] after which a touch has ended, s.
pub const LIFT_TIME: f32 = 0.3;
/// Time that the support must last, s.
pub const RESTING_TIME: f32 = 0.3;
/// Share of the weight of a grounded vehicle, rotors stopped or idle.
const GROUNDED_SHARE: f32 = 0.7;
/// Time for which it must last, s.
pub const GROUNDED_TIME: f32 = 0.5;
/// Largest body rate for evidence, rad/s.
const RATE_MAX: f32 = 0.7;
/// Cut-off of the support's low-pass filter, Hz.
const CUTOFF: f32 = 5.0;
/// Sensor silence that resets the evidence, s.
const SILENCE_MAX: f32 = 0.05;
/// Decay time of the sink rate, s: bounds an integrated bias.
const SINK_MEMORY: f32 = 20.0;
/// Largest sink rate accepted, m/s.
const SINK_MAX: f32 = 10.0;

/// Measurements of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertialSample {
    /// Specific force along body z, m/s²; -9.81 at rest.
    pub specific_force_z: f32,
    /// Acceleration along world down, m/s².
    pub down: f32,
    /// Size of the angular rate, rad/s, >= 0.
    pub rate: f32,
    /// Thrust demanded of the rotors along -z, N, >= 0.
    pub lift: f32,
}

/// The support filter.
#[derive(Clone, Copy, Debug)]
pub struct ContactForce {
    mass: f32,
    motor_tau: f32,
    lift: f32,
    force: f32,
    sink: f32,
    pressed: HoldTimer,
    unloaded: HoldTimer,
    full: HoldTimer,
    silent: HoldTimer,
    resting: bool,
}

impl ContactForce {
    /// No evidence yet.
    pub fn new(params: &Params) -> Self {
        Self {
            mass: params.mass,
            motor_tau: params.motor_tau,
            lift: 0.0,
            force: 0.0,
            sink: 0.0,
            pressed: HoldTimer::default(),
            unloaded: HoldTimer::default(),
            full: HoldTimer::default(),
            silent: HoldTimer::default(),
            resting: false,
        }
    }

    /// One step of `dt` s; `None` without a fresh inertial sample.
    pub fn step(&mut self, sample: Option<InertialSample>, dt: f32) {
        let sample = sample.filter(|f| {
            f.specific_force_z.is_finite() && f.down.is_finite() && f.rate.is_finite() && f.lift.is_finite()
        });
        let silent = self.silent.step(sample.is_none(), dt) >= SILENCE_MAX;
        let Some(sample) = sample else {
            if silent {
                (self.pressed, self.unloaded, self.full) = Default::default();
                self.resting = false;
            }
            return;
        };
        self.lift += (sample.lift - self.lift) * dt / (dt + self.motor_tau);
        let contact_force = -self.mass * sample.specific_force_z - self.lift;
        self.force += (contact_force - self.force) * dt / (dt + 1.0 / (2.0 * PI * CUTOFF));
        self.sink = clamp(
            self.sink + (sample.down - self.sink / SINK_MEMORY) * dt,
            -SINK_MAX,
            SINK_MAX,
        );

        let still = sample.rate < RATE_MAX;
        let pressed = self.pressed.step(still && self.force > RESTING_FORCE, dt);
        let unloaded = self.unloaded.step(self.force < LEAVING_FORCE, dt);
        self.full
            .step(still && self.force > GROUNDED_SHARE * self.weight(), dt);
        if pressed >= RESTING_TIME {
            self.resting = true;
        } else if unloaded >= RESTING_TIME {
            self.resting = false;
        }
    }

    /// Weight, N.
    pub fn weight(&self) -> f32 {
        self.mass * GRAVITY
    }

    /// Force not from the rotors, N, low-passed; negative if pulling down.
    pub fn force(&self) -> f32 {
        self.force
    }

    /// True from [`RESTING_TIME`] above [`RESTING_FORCE`] until as long below [`LEAVING_FORCE`].
    pub fn resting(&self) -> bool {
        self.resting
    }

    /// True once the support has lasted for [`TOUCH_TIME`].
    pub fn touched(&self) -> bool {
        self.pressed.time() >= TOUCH_TIME
    }

    /// True once the support has been absent for [`LIFT_TIME`].
    pub fn lifted(&self) -> bool {
        self.unloaded.time() >= LIFT_TIME
    }

    /// True once nearly all of the weight was carried for [`GROUNDED_TIME`] without tumbling.
    pub fn grounded(&self) -> bool {
        self.full.time() >= GROUNDED_TIME
    }

    /// Sink rate, m/s, downwards positive, within ±10 m/s: decaying integral of the accelerometer, good for damping a
    /// descent, not for controlling its speed.
    pub fn sink(&self) -> f32 {
        self.sink
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(s: &mut ContactForce, specific_force_z: f32, lift: f32, seconds: f32) {
        for _ in 0..(seconds * 100.0) as u32 {
            let down = GRAVITY + specific_force_z;
            s.step(
                Some(InertialSample {
                    specific_force_z,
                    down,
                    rate: 0.0,
                    lift,
                }),
                0.01,
            );
        }
    }

    #[test]
    fn free_air_gives_no_support_at_any_thrust() {
        let p = Params::default();
        let mut s = ContactForce::new(&p);
        for share in [0.0, 0.3, 0.6, 1.0] {
            let lift = share * 4.0 * p.thrust_max;
            run(&mut s, -lift / p.mass, lift, 2.0);
            assert!(
                s.force().abs() < 0.05 && !s.resting() && !s.grounded(),
                "{share}: {}",
                s.force()
            );
        }
    }

    #[test]
    fn the_pipe_carries_what_the_rotors_do_not() {
        let p = Params::default();
        let mut s = ContactForce::new(&p);
        run(&mut s, -GRAVITY, 10.0, 0.25);
        assert!(!s.resting(), "too soon");
        run(&mut s, -GRAVITY, 10.0, 2.0);
        assert!(
            (s.force() - 7.701).abs() < 0.01,
            "1.805 kg of 9.80665 m/s² less 10 N: {}",
            s.force()
        );
        assert!(s.resting() && !s.grounded());
        run(&mut s, -GRAVITY, 0.0, 1.0);
        assert!(s.grounded());
        run(&mut s, -GRAVITY, 17.5, 1.0);
        assert!(!s.resting(), "the rotors carry nearly all again");
    }

    #[test]
    fn a_bump_a_tumble_and_a_silent_sensor_are_no_rest() {
        let p = Params::default();
        let mut s = ContactForce::new(&p);
        run(&mut s, -2.0 * GRAVITY, 17.7, 0.1);
        run(&mut s, -GRAVITY, 17.7, 0.5);
        assert!(!s.resting(), "a bump of 0.1 s");
        for _ in 0..300 {
            s.step(
                Some(InertialSample {
                    specific_force_z: -GRAVITY,
                    down: 0.0,
                    rate: 2.0,
                    lift: 5.0,
                }),
                0.01,
            );
        }
        assert!(!s.resting(), "turning");
        run(&mut s, -GRAVITY, 5.0, 1.0);
        assert!(s.resting());
        s.step(None, 0.01);
        assert!(s.resting(), "one late sample");
        for _ in 0..5 {
            s.step(None, 0.01);
        }
        assert!(!s.resting() && !s.grounded());
        s.step(
            Some(InertialSample {
                specific_force_z: f32::NAN,
                down: 0.0,
                rate: 0.0,
                lift: 5.0,
            }),
            0.01,
        );
        assert!(s.force().is_finite());
    }

    #[test]
    fn the_support_follows_with_five_hertz() {
        // 32 ms: a step of 10 ms goes 0.01/(0.01 + 0.0318) = 0.239 of the way, three of them 0.559 of 17.701 N.
        let mut s = ContactForce::new(&Params::default());
        run(&mut s, -GRAVITY, 0.0, 0.031);
        assert!((s.force() - 9.90).abs() < 0.03, "{}", s.force());
    }

    #[test]
    fn what_no_longer_rests_must_not_rest_for_as_long_as_what_rests_must() {
        let p = Params::default();
        let mut s = ContactForce::new(&p);
        run(&mut s, -GRAVITY, 5.0, 1.0);
        assert!(s.resting());
        // 17.701 N of weight less 15.7 N: 2.0 N neither begins nor ends resting.
        run(&mut s, -GRAVITY, 15.7, 5.0);
        assert!((s.force() - 2.0).abs() < 0.01 && s.resting(), "{}", s.force());
        // A bounce of the soft arms: 0.2 N for less than the 0.3 s below 1.5 N. Motor and filter take 0.08 s to return.
        let bounce = |s: &mut ContactForce, steps: i32| {
            let mut below = 0;
            while below < steps {
                run(s, -GRAVITY, 17.5, 0.011);
                below += i32::from(s.force() < 1.5);
                assert!(s.resting(), "given up after {below} steps of 10 ms");
            }
        };
        bounce(&mut s, 15);
        run(&mut s, -GRAVITY, 15.7, 1.0);
        assert!(s.resting());
        // The time starts again; once full, the rest ends.
        bounce(&mut s, 28);
        run(&mut s, -GRAVITY, 17.5, 0.041);
        assert!(!s.resting());
        run(&mut s, -GRAVITY, 15.7, 5.0);
        assert!(!s.resting());
    }

    #[test]
    fn a_tumble_under_full_weight_is_not_the_ground() {
        let p = Params::default();
        let mut s = ContactForce::new(&p);
        let mut turn = |rate, seconds: f32| {
            for _ in 0..(seconds * 100.0) as u32 {
                s.step(
                    Some(InertialSample {
                        specific_force_z: -GRAVITY,
                        down: 0.0,
                        rate,
                        lift: 0.0,
                    }),
                    0.01,
                );
            }
            (s.force() > 0.99 * s.weight(), s.grounded())
        };
        assert!(turn(2.0, 3.0) == (true, false), "all of the weight, but turning");
        assert!(turn(0.0, 0.4) == (true, false), "the time starts over");
        assert!(turn(0.0, 0.2) == (true, true));
        assert!(turn(2.0, 0.02) == (true, false), "and is broken by a tumble");
    }

    #[test]
    fn the_sink_rate_follows_a_short_fall() {
        let p = Params::default();
        let mut s = ContactForce::new(&p);
        run(&mut s, -0.9 * GRAVITY, 0.9 * 17.7, 1.0);
        assert!(
            (s.sink() - 0.957).abs() < 0.02,
            "0.98 m/s less what is forgotten: {}",
            s.sink()
        );
    }
}
