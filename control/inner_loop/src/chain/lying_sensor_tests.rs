//! Inertial sensors that saturate, shake or step in their bias: what filter and estimator make of them.

extern crate std;

use std::println;

use super::sensing::Sensing;
use crate::attitude::estimator::Estimator;
use crate::attitude::messages::{Attitude, ImuReading, ImuSample};
use crate::attitude::motion::Motion;
use crate::maths::scalar::{GRAVITY, deg};
use crate::maths::vector::{Quat, Vec3};
use crate::params::Params;

/// Readings each second, and full scales, m/s² and rad/s.
const RATE: f64 = 4000.0;
const FORCE: f32 = 16.0 * GRAVITY;
const TURN: f32 = deg(2000.0);

/// Sensing and estimator on a part with full scales, beside the truth.
struct Rig {
    sensing: Sensing,
    estimator: Estimator,
    attitude: Attitude,
    sample: ImuSample,
    truth: Quat,
    n: u64,
}

impl Rig {
    /// Calibrated at rest.
    fn new() -> Self {
        let mut rig = Self::bare();
        rig.run(2.1, |_| (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO));
        assert!(rig.estimator.calibrated());
        rig
    }

    fn bare() -> Self {
        let p = Params::default();
        Self {
            sensing: Sensing::new(&p, RATE as f32),
            estimator: Estimator::new(&p),
            attitude: Attitude::default(),
            sample: ImuSample::default(),
            truth: Quat::IDENTITY,
            n: 0,
        }
    }

    /// For `seconds`: what `f` makes of the time into it, s: true rate, shaking of the accelerometer beside gravity, and
    /// what the gyro reads too much.
    fn run(&mut self, seconds: f64, f: impl Fn(f64) -> (Vec3, Vec3, Vec3)) {
        let readings = (seconds * RATE) as u64;
        for i in 0..readings {
            let (rate, shake, error) = f(i as f64 / RATE);
            self.turn(rate);
            let felt = self.truth.rotate_inverse(Vec3::new(0.0, 0.0, -GRAVITY)) + shake;
            let at_scale = |v: Vec3, most: f32| v.map(|x| x.clamp(-most, most));
            let reading = ImuReading {
                gyro: at_scale(rate + error, TURN),
                accel: at_scale(felt, FORCE),
            };
            self.n += 1;
            let at_us = self.n * 250;
            if self.sensing.take(at_us, &[reading], &mut self.sample) {
                self.estimator.estimate(&self.sample, &mut self.attitude);
            }
        }
    }

    fn turn(&mut self, rate: Vec3) {
        let h = rate * (0.5 / RATE as f32);
        let q = self.truth
            * Quat {
                w: 1.0,
                x: h.x,
                y: h.y,
                z: h.z,
            };
        let k = 1.0 / (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z).sqrt();
        self.truth = Quat {
            w: q.w * k,
            x: q.x * k,
            y: q.y * k,
            z: q.z * k,
        };
    }

    /// Angle between true and estimated vertical, deg.
    fn off(&self) -> f32 {
        let cos = self.truth.down_in_body().dot(self.attitude.q.down_in_body());
        cos.clamp(-1.0, 1.0).acos().to_degrees()
    }
}

/// Sine of `size` m/s² at `hz`.
fn sine(t: f64, hz: f64, size: f32) -> f32 {
    size * f64::sin(core::f64::consts::TAU * hz * t) as f32
}

/// Degrees off after 20 s of a sine of `g` on all axes at `hz`.
fn shaken(g: f32, hz: f64) -> (Rig, f32) {
    let mut r = Rig::new();
    r.run(20.0, |t| {
        let s = sine(t, hz, g * GRAVITY);
        (Vec3::ZERO, Vec3::new(s, 0.5 * s, s), Vec3::ZERO)
    });
    let off = r.off();
    println!("{g} g at {hz} Hz: {off:.2} deg");
    (r, off)
}

#[test]
fn vibration_short_of_full_scale_leans_the_attitude_by_what_the_docs_say() {
    // docs/design/inertial-sensor.md.
    for (g, hz, most) in [
        (2.0, 60.0, 1.5),
        (5.0, 60.0, 8.0),
        (2.0, 95.0, 0.7),
        (5.0, 95.0, 3.0),
        (2.0, 150.0, 0.3),
        (5.0, 150.0, 0.5),
        (10.0, 150.0, 0.5),
    ] {
        let (r, off) = shaken(g, hz);
        assert!(off < most && !r.attitude.clipped, "{g} g at {hz} Hz: {off}");
    }
}

#[test]
fn what_clips_is_not_taken_for_gravity() {
    // 6.5 degrees after 20 s at 40 g before clipped readings were left out.
    for (g, hz) in [(20.0, 150.0), (40.0, 150.0), (40.0, 300.0), (100.0, 95.0)] {
        let (mut r, off) = shaken(g, hz);
        assert!(off < 0.1 && r.attitude.clipped, "{g} g at {hz} Hz: {off}");
        assert!(r.estimator.bias().norm() < 1e-4);
        r.run(0.6, |_| (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO));
        assert!(!r.attitude.clipped, "half a second later it is over");
    }
    // Knocks on one side, as of a board that hits its stop: no mean but for what is cut off.
    let mut r = Rig::new();
    r.run(20.0, |t| {
        let x = if (t * 80.0) % 1.0 < 0.04 {
            20.0
        } else {
            -0.04 * 20.0 / 0.96
        };
        (Vec3::ZERO, Vec3::new(x as f32 * GRAVITY, 0.0, 0.0), Vec3::ZERO)
    });
    println!("knocks of 20 g: {:.2} deg", r.off());
    assert!(r.off() < 0.1 && r.attitude.clipped);
}

#[test]
fn a_clipped_accelerometer_does_not_calibrate() {
    let mut r = Rig::bare();
    r.run(5.0, |t| {
        let s = sine(t, 150.0, 40.0 * GRAVITY);
        (Vec3::ZERO, Vec3::new(s, 0.0, s), Vec3::ZERO)
    });
    assert!(!r.attitude.calibrated);
    r.run(2.6, |_| (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO));
    assert!(r.attitude.calibrated && r.off() < 0.5);
    // Nor one that reads twice what there is.
    let mut r = Rig::bare();
    r.run(5.0, |_| (Vec3::ZERO, Vec3::new(0.0, 0.0, -GRAVITY), Vec3::ZERO));
    assert!(!r.attitude.calibrated);
}

#[test]
fn a_turn_beyond_the_gyros_scale_is_off_by_what_it_hid() {
    // The modes stop the rotors after 30 degrees at full scale; nothing of the flight level can know more.
    for (dps, seconds, off) in [(2500.0, 0.02, 10.0), (3000.0, 0.1, 100.0)] {
        let mut r = Rig::new();
        let rate = Vec3::new(deg(dps), 0.0, 0.0);
        r.run(seconds, |_| (rate, Vec3::ZERO, Vec3::ZERO));
        r.run(0.05, |_| (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO));
        println!("{dps} deg/s for {seconds} s: {:.1} deg", r.off());
        assert!((r.off() - off).abs() < 0.1 * off);
    }
}

#[test]
fn a_step_of_the_gyros_bias_at_rest_is_learnt_and_shows_until_then() {
    for (step, worst_expected) in [(0.01, 4.4), (0.03, 13.2), (0.1, 47.4)] {
        let mut r = Rig::new();
        let (mut worst, mut at, mut refused) = (0.0, 0.0, None);
        for i in 0..1200 {
            r.run(0.1, |_| (Vec3::ZERO, Vec3::ZERO, Vec3::new(step, 0.0, 0.0)));
            let seconds = 0.1 * i as f32;
            if r.off() > worst {
                (worst, at) = (r.off(), seconds);
            }
            let motion = Motion {
                q: r.attitude.q,
                accel: r.attitude.accel,
                ..Default::default()
            };
            let seen = motion.leans_unseen();
            assert!(seen == (r.off() > 10.0) || (r.off() - 10.0).abs() < 0.1);
            if seen {
                let (first, _) = refused.unwrap_or((seconds, 0.0));
                refused = Some((first, seconds));
            }
        }
        println!(
            "bias step {step} rad/s: {worst:.1} deg after {at:.1} s, arming refused {refused:?}, {:.2} deg after 120 s",
            r.off()
        );
        assert!((worst - worst_expected).abs() < 0.2 && (20.0..25.0).contains(&at));
        assert!(r.off() < 5.0 && refused.is_some() == (worst > 10.0));
    }
}
