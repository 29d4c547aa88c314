//! Attitude estimator, 1 kHz: quaternion integration, a slow pull towards the accelerometer's vertical, gyro bias.
//!
//! In free flight the accelerometer feels thrust, not gravity, so the pull is weak (default time constant 10 s) and
//! fades when the specific force is not 1 g. Without a compass, heading is integrated.

use crate::attitude::messages::{Attitude, ImuSample};
use crate::maths::scalar::{self, GRAVITY};
use crate::maths::vector::{Quat, Vec3};
use crate::params::Params;

/// Duration of the calibration at rest, s.
pub const CALIBRATION_TIME: f32 = 2.0;
/// Rate above which the vehicle is moving, rad/s: above any part's bias.
const REST_RATE: f32 = 0.15;
/// Departure from the running mean in motion, rad/s: on soft arms the wind rocks the vehicle by half of this.
const REST_DEVIATION: f32 = 0.08;
/// Specific force of rest, share of gravity: what weighs nothing falls, what weighs twice as much is no sound sensor's.
const REST_FORCE: core::ops::RangeInclusive<f32> = 0.5..=1.5;
/// Specific force error at which the pull has faded out, share of gravity.
const ACCEL_FADE: f32 = 0.15;
/// Largest gyro bias accepted, rad/s.
const BIAS_MAX: f32 = 0.1;
/// Averaging time of the accelerometer's attitude with a known gyro bias, s: a pipe sways.
pub const RESUME_TIME: f32 = 0.5;
/// Largest specific force error of gravity then, share of gravity.
const RESUME_ERROR: f32 = 0.3;

/// Attitude estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimator {
    q: Quat,
    bias: Vec3,
    kp: f32,
    ki: f32,
    rest_time: f32,
    rest_gyro: Vec3,
    rest_accel: Vec3,
    known_bias: Option<Vec3>,
    calibrated: bool,
}

impl Estimator {
    /// An estimator to be calibrated at rest.
    pub fn new(p: &Params) -> Self {
        Self {
            q: Quat::IDENTITY,
            bias: Vec3::ZERO,
            kp: p.estimator_kp,
            ki: p.estimator_ki,
            rest_time: 0.0,
            rest_gyro: Vec3::ZERO,
            rest_accel: Vec3::ZERO,
            known_bias: None,
            calibrated: false,
        }
    }

    /// Resumes after a restart with the gyro bias (rad/s). The attitude comes from the accelerometer over
    /// [`RESUME_TIME`], also in motion; heading restarts at 0.
    pub fn resume(p: &Params, bias: Vec3) -> Self {
        Self {
            known_bias: bias
                .is_finite()
                .then(|| bias.map(|b| scalar::clamp_abs(b, BIAS_MAX))),
            ..Self::new(p)
        }
    }

    /// True once calibration at rest has ended.
    pub const fn calibrated(&self) -> bool {
        self.calibrated
    }

    /// Body to world; heading 0 is where the nose pointed at calibration.
    pub const fn attitude(&self) -> Quat {
        self.q
    }

    /// Gyro bias, rad/s.
    pub const fn bias(&self) -> Vec3 {
        self.bias
    }

    /// One step; writes the result into `attitude`, as so long a message is costly to copy.
    // Not inlined: its caller is built for size.
    #[inline(never)]
    pub fn estimate(&mut self, sample: &ImuSample, attitude: &mut Attitude) {
        if !self.calibrated {
            self.calibrate(sample, attitude);
            return;
        }
        let (q, rate, gyro_bias) = self.follow(sample);
        *attitude = Attitude {
            q,
            rate,
            accel: sample.accel,
            gyro_bias,
            calibrated: true,
            clipped: sample.clipped,
            dt: sample.dt,
        };
    }

    /// One step with finite body rate and specific force, calibrated; returns attitude, unbiased rate and bias, rad/s.
    #[inline(always)]
    fn follow(&mut self, sample: &ImuSample) -> (Quat, Vec3, Vec3) {
        let ImuSample {
            gyro,
            accel,
            dt,
            clipped,
        } = *sample;
        let rate = gyro - self.bias;
        // Measured down (minus specific force) against estimated down.
        let norm2 = accel.norm_squared();
        // Not finite without force: weight and the check below handle both.
        let inv = scalar::inv_sqrt_normal(norm2);
        let excess = norm2 * inv * (1.0 / GRAVITY) - 1.0;
        // What has clipped is cut off on one side, and leans: it has no weight.
        let most = if clipped { 0.0 } else { 1.0 };
        let weight = most - excess.abs() * (1.0 / ACCEL_FADE);
        let weight = scalar::clamp(weight, 0.0, 1.0);
        let error = (accel * -inv).cross(self.q.down_in_body()) * weight;
        let error = if error.is_finite() { error } else { Vec3::ZERO };
        let bias = (self.bias - error * (self.ki * dt)).map(|b| scalar::clamp_abs(b, BIAS_MAX));
        let q = self.integrated(rate + error * self.kp, dt);
        (self.q, self.bias) = (q, bias);
        (q, rate, bias)
    }

    /// Attitude after `dt` s of `rate`, rad/s.
    #[inline(always)]
    fn integrated(&self, rate: Vec3, dt: f32) -> Quat {
        let h = rate * (0.5 * dt);
        let d = self.q
            * Quat {
                w: 0.0,
                x: h.x,
                y: h.y,
                z: h.z,
            };
        let q = Quat {
            w: self.q.w + d.w,
            x: self.q.x + d.x,
            y: self.q.y + d.y,
            z: self.q.z + d.z,
        };
        // One Newton step keeps a nearly unit quaternion unit.
        let k = 1.5 - 0.5 * (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
        let q = Quat {
            w: q.w * k,
            x: q.x * k,
            y: q.y * k,
            z: q.z * k,
        };
        if q.is_finite() { q } else { self.q }
    }

    /// One step of calibration, whole: the flight's step then keeps what it writes in registers.
    #[cold]
    #[inline(never)]
    fn calibrate(&mut self, sample: &ImuSample, attitude: &mut Attitude) {
        self.collect_rest(sample);
        *attitude = Attitude {
            q: self.q,
            rate: Vec3::ZERO,
            accel: sample.accel,
            gyro_bias: self.bias,
            calibrated: self.calibrated,
            clipped: sample.clipped,
            dt: sample.dt,
        };
    }

    /// Collects rest, which motion restarts. With a known bias, not falling is enough.
    fn collect_rest(&mut self, sample: &ImuSample) {
        let ImuSample {
            gyro,
            accel,
            dt,
            clipped,
        } = *sample;
        if let Some(bias) = self.known_bias {
            let g = accel.norm() * (1.0 / GRAVITY);
            if clipped || !((1.0 - RESUME_ERROR)..=(1.0 + RESUME_ERROR)).contains(&g) {
                self.rest_time = 0.0;
                return;
            }
            self.rest_time += dt;
            let k = dt / self.rest_time;
            self.rest_accel += (accel - self.rest_accel) * k;
            if self.rest_time >= RESUME_TIME {
                self.start(bias);
            }
            return;
        }
        let limit = |v: Vec3, l: f32| v.to_array().iter().all(|x| (-l..=l).contains(x));
        let still = limit(gyro, REST_RATE)
            && !clipped
            && (self.rest_time < 0.2 || limit(gyro - self.rest_gyro, REST_DEVIATION));
        if !still {
            self.rest_time = 0.0;
            return;
        }
        if self.rest_time <= 0.0 {
            self.rest_time = dt;
            self.rest_gyro = gyro;
            self.rest_accel = accel;
            return;
        }
        self.rest_time += dt;
        let k = dt / self.rest_time;
        self.rest_gyro += (gyro - self.rest_gyro) * k;
        self.rest_accel += (accel - self.rest_accel) * k;
        let g = self.rest_accel.norm() * (1.0 / GRAVITY);
        if self.rest_time >= CALIBRATION_TIME && REST_FORCE.contains(&g) {
            self.start(self.rest_gyro);
        }
    }

    /// Starts with the attitude of the collected specific force.
    fn start(&mut self, bias: Vec3) {
        self.bias = bias;
        let up = self.rest_accel;
        let roll = scalar::atan2(-up.y, -up.z);
        let pitch = scalar::atan2(up.x, scalar::sqrt(up.y * up.y + up.z * up.z));
        self.q = Quat::from_euler(roll, pitch, 0.0);
        self.calibrated = true;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    impl Estimator {
        fn step(&mut self, gyro: Vec3, accel: Vec3, dt: f32) {
            let sample = ImuSample {
                gyro,
                accel,
                dt,
                clipped: false,
            };
            self.estimate(&sample, &mut Attitude::default());
        }
    }

    fn at_rest(roll: f32, pitch: f32) -> Vec3 {
        Quat::from_euler(roll, pitch, 0.0).rotate_inverse(Vec3::new(0.0, 0.0, -GRAVITY))
    }

    fn calibrated(gyro: Vec3, accel: Vec3) -> Estimator {
        let mut e = Estimator::new(&Params::default());
        for _ in 0..2100 {
            e.step(gyro, accel, 1e-3);
        }
        assert!(e.calibrated());
        e
    }

    #[test]
    fn rest_gives_bias_and_tilt() {
        let bias = Vec3::new(0.02, -0.01, 0.03);
        let e = calibrated(bias, at_rest(0.1, -0.2));
        let (roll, pitch, yaw) = e.attitude().to_euler();
        assert!((e.bias() - bias).norm() < 1e-4);
        assert!((roll - 0.1).abs() < 0.01 && (pitch + 0.2).abs() < 0.01 && yaw.abs() < 0.01);
    }

    #[test]
    fn a_level_bench_shows_the_accelerometers_bias_as_docs_calibration_says() {
        // docs/calibration.md: a degree is 0.171 m/s²; x by the pitch, y by the roll turned round.
        const PER_DEGREE: f32 = 0.171;
        let bias = Vec3::new(0.2, -0.3, 0.1);
        let felt = bias + Vec3::new(0.0, 0.0, -GRAVITY);
        let mut e = calibrated(Vec3::ZERO, felt);
        for _ in 0..60_000 {
            e.step(Vec3::ZERO, felt, 1e-3);
        }
        let (roll, pitch, _) = e.attitude().to_euler();
        let [x, y] = [pitch, -roll].map(|lean| PER_DEGREE * lean.to_degrees());
        assert!((x - bias.x).abs() < 0.02 && (y - bias.y).abs() < 0.02, "{x} {y}");
    }

    #[test]
    fn a_known_bias_needs_no_rest_but_gravity() {
        let bias = Vec3::new(0.02, -0.05, 0.01);
        let mut e = Estimator::resume(&Params::default(), bias);
        // Falls, lands, then sways on a pipe at 1 Hz by 0.1 rad/s.
        for _ in 0..1000 {
            e.step(Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 0.0, -0.5), 1e-3);
        }
        for _ in 0..100 {
            e.step(Vec3::ZERO, Vec3::new(0.0, 0.0, -30.0), 1e-3);
        }
        e.step(Vec3::ZERO, Vec3::new(f32::NAN, 0.0, 0.0), 1e-3);
        assert!(!e.calibrated());
        let mut steps = 0;
        while !e.calibrated() && steps < 2000 {
            let sway = 0.1 * scalar::sin(6e-3 * steps as f32);
            e.step(bias + Vec3::new(sway, 0.0, 0.0), at_rest(0.15, -0.1), 1e-3);
            steps += 1;
        }
        assert!((499..=502).contains(&steps), "{steps}");
        let (roll, pitch, _) = e.attitude().to_euler();
        assert!(e.bias() == bias && (roll - 0.15).abs() < 0.01 && (pitch + 0.1).abs() < 0.01);
        let nan = Vec3::new(f32::NAN, 0.0, 0.0);
        assert!(Estimator::resume(&Params::default(), nan) == Estimator::new(&Params::default()));
        assert!(
            Estimator::resume(&Params::default(), Vec3::new(5.0, 0.0, 0.0))
                .known_bias
                .is_some_and(|b| b.x <= BIAS_MAX)
        );
    }

    #[test]
    fn motion_holds_calibration_off() {
        let mut e = Estimator::new(&Params::default());
        for i in 0..5000 {
            let wobble = if (i / 500) % 2 == 0 { 0.1 } else { -0.1 };
            e.step(Vec3::new(wobble, 0.0, 0.0), at_rest(0.0, 0.0), 1e-3);
        }
        assert!(!e.calibrated());
    }

    #[test]
    fn a_turn_is_integrated() {
        let mut e = calibrated(Vec3::ZERO, at_rest(0.0, 0.0));
        for _ in 0..1000 {
            e.step(Vec3::new(0.0, 0.0, 0.5), at_rest(0.0, 0.0), 1e-3);
        }
        let (_, _, yaw) = e.attitude().to_euler();
        assert!((yaw - 0.5).abs() < 0.01);
    }

    #[test]
    fn a_wrong_tilt_is_pulled_in_the_right_direction_in_ten_seconds() {
        let mut e = calibrated(Vec3::ZERO, at_rest(0.3, 0.0));
        // Levelled unnoticed.
        for _ in 0..10_000 {
            e.step(Vec3::ZERO, at_rest(0.0, 0.0), 1e-3);
        }
        let (roll, _, _) = e.attitude().to_euler();
        assert!((0.03..0.16).contains(&roll), "{roll}");
    }

    #[test]
    fn the_pull_towards_the_vertical_fades_with_what_is_not_gravity() {
        // Estimated level, truly rolled by 0.1 rad: at 0.1 1/s 0.01 rad in a second, half of that at 1.075 or 0.925 g,
        // nothing from 15 % on.
        for (g, pulled) in [
            (1.0, 0.0095),
            (1.075, 0.0049),
            (0.925, 0.0049),
            (1.16, 0.0),
            (0.84, 0.0),
            (2.0, 0.0),
        ] {
            let mut e = calibrated(Vec3::ZERO, at_rest(0.0, 0.0));
            for _ in 0..1000 {
                e.step(Vec3::ZERO, at_rest(0.1, 0.0) * g, 1e-3);
            }
            let q = e.attitude();
            // Twice the vector part: micromath's arc tangent is too coarse.
            assert!((2.0 * q.x - pulled).abs() < 2e-4, "{g}: {}", 2.0 * q.x);
            assert!(q.y.abs() < 1e-5 && q.z.abs() < 1e-5, "{g}: {q:?}");
            // 0.002 1/s² of an error of 0.095 rad on average: a bias of -0.0002 rad/s in a second.
            assert!((e.bias().x + 0.02 * pulled).abs() < 2e-5, "{g}: {:?}", e.bias());
        }
    }

    #[test]
    fn no_bias_beyond_a_tenth_is_accepted() {
        let p = Params {
            estimator_ki: 1.0,
            ..Params::default()
        };
        for (roll, bias) in [(0.5, -0.1), (-0.5, 0.1)] {
            let mut e = Estimator::new(&p);
            for i in 0..4000 {
                let truth = if i < 2500 { 0.0 } else { roll };
                e.step(Vec3::ZERO, at_rest(truth, 0.0), 1e-3);
            }
            assert!(
                e.calibrated() && (e.bias().x - bias).abs() < 1e-6,
                "{:?}",
                e.bias()
            );
        }
    }

    #[test]
    fn calibration_takes_two_seconds_of_rest_and_starts_afresh_with_every_motion() {
        let steps = |disturb: &dyn Fn(i32) -> Vec3| {
            let mut e = Estimator::new(&Params::default());
            (1..6000).find(|i| {
                e.step(disturb(*i), at_rest(0.0, 0.0), 1e-3);
                e.calibrated()
            })
        };
        let within = |steps: Option<i32>, from: i32| steps.is_some_and(|s| (from - 2..from + 5).contains(&s));
        assert!(within(steps(&|_| Vec3::ZERO), 2000));
        // A bias of 0.14 rad/s is rest, on any axis; 0.16 rad/s is motion.
        for turn in [
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.0, -1.0, 0.0),
            Vec3::new(0.0, 0.0, 1.0),
        ] {
            assert!(within(steps(&|_| turn * 0.14), 2000));
            assert!(steps(&|_| turn * 0.16).is_none());
            // One jolt after 1.5 s: two more seconds.
            assert!(within(steps(&|i| turn * if i == 1500 { 1.0 } else { 0.0 }), 3500));
            // Once 0.2 s have given the mean, 0.07 rad/s off it is rocking, 0.09 rad/s is motion.
            assert!(within(
                steps(&|i| turn * if i == 1500 { 0.07 } else { 0.0 }),
                2000
            ));
            assert!(within(
                steps(&|i| turn * if i == 1500 { 0.09 } else { 0.0 }),
                3500
            ));
            assert!(within(steps(&|i| turn * if i == 150 { 0.09 } else { 0.0 }), 2000));
        }
    }

    #[test]
    fn a_jolt_that_ends_the_rest_is_no_part_of_the_bias() {
        let mut e = Estimator::new(&Params::default());
        for i in 0..4000 {
            let turn = if i == 1500 { 10.0 } else { 0.0 };
            e.step(Vec3::new(turn, 0.0, 0.0), at_rest(0.0, 0.0), 1e-3);
        }
        assert!(e.calibrated() && e.bias().norm() < 1e-6, "{:?}", e.bias());
    }

    #[test]
    fn what_weighs_nothing_is_not_at_rest() {
        for (g, rests) in [(0.45, false), (0.55, true)] {
            let mut e = Estimator::new(&Params::default());
            for _ in 0..3000 {
                e.step(Vec3::ZERO, at_rest(0.0, 0.0) * g, 1e-3);
            }
            assert_eq!(e.calibrated(), rests, "{g}");
        }
        // After a restart, within 30 % counts as gravity.
        for (g, gravity) in [(0.68, false), (0.72, true), (1.28, true), (1.32, false)] {
            let mut e = Estimator::resume(&Params::default(), Vec3::ZERO);
            for _ in 0..600 {
                e.step(Vec3::ZERO, at_rest(0.0, 0.0) * g, 1e-3);
            }
            assert_eq!(e.calibrated(), gravity, "{g}");
        }
    }

    #[test]
    fn a_drifting_bias_is_found_in_roll() {
        let p = Params {
            estimator_ki: 0.02,
            estimator_kp: 0.3,
            ..Params::default()
        };
        let mut e = Estimator::new(&p);
        for i in 0..240_000 {
            let drift = if i < 3000 { 0.0 } else { 0.01 };
            e.step(Vec3::new(drift, 0.0, 0.0), at_rest(0.0, 0.0), 1e-3);
        }
        assert!((e.bias().x - 0.01).abs() < 1e-3, "{:?}", e.bias());
    }

    #[test]
    fn an_accelerometer_without_a_number_teaches_nothing() {
        let mut e = calibrated(Vec3::ZERO, at_rest(0.1, 0.0));
        let before = e;
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            e.step(Vec3::ZERO, Vec3::new(bad, 0.0, bad), 1e-3);
        }
        assert!(e.bias() == before.bias());
        assert!((e.attitude().to_euler().0 - before.attitude().to_euler().0).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn stays_a_unit_quaternion_for_any_motion(rates in prop::collection::vec(prop::array::uniform3(-30.0f32..30.0), 1..200)) {
            let mut e = calibrated(Vec3::ZERO, at_rest(0.0, 0.0));
            for r in rates {
                e.step(Vec3::from(r), Vec3::from(r), 1e-3);
                let q = e.attitude();
                prop_assert!((q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1.0).abs() < 1e-3);
            }
        }
    }
}
