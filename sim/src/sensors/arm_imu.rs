//! Sensor at an arm's tip: the BNO055's fused gravity vector, after its datasheet.
//!
//! [`TiltErrors`] adds those that users report, off by default: a fusion that stands still while the sensor turns slowly,
//! steps of the running calibration, and the vibration of the arm's rotor.

mod shaken;
mod steps;
mod still;

use std::collections::VecDeque;
use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;
use sophie_control::allocation::wrench::SIDE;
use sophie_control::maths::vector::Vec3;

use self::shaken::Shaken;
use self::steps::Steps;
use self::still::Still;
use crate::normal::StandardNormal;
use crate::streams::Streams;

/// Fusion steps per second (datasheet).
pub const RATE_HZ: f64 = 100.0;
/// Delay, steps: 20 ms (assumed).
const LATENCY: usize = 2;
/// Resolution, m/s² (datasheet).
const LSB: f64 = 0.01;
/// Noise of the fused vector, m/s² RMS (assumed).
const NOISE: f64 = 0.03;
/// Largest mounting error, rad (assumed, 0.5°).
const MOUNTING: f64 = 0.0087;
/// Share of the acceleration that leaks into the vector, and its time constant, s (assumed).
const LEAK: (f64, f64) = (0.1, 0.3);

/// Errors of a sensor that its data sheet leaves out; zero: none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TiltErrors {
    /// Rate below which the fused vector stands still, rad/s.
    pub dead_zone: f64,
    /// Largest error that a step of the running calibration leaves, rad.
    pub step: f64,
    /// Amplitude of the tip by its rotor's imbalance at 600 rad/s, m/s².
    pub vibration: f64,
}

/// A fault of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TiltBreak {
    /// It does not answer.
    Silent,
    /// It repeats its last vector.
    Stuck,
}

/// One arm's sensor.
#[derive(Clone, Debug)]
pub struct ArmImu {
    side: f64,
    mounting: f64,
    leaked: DVec3,
    still: Still,
    calibration: Steps,
    shaken: Shaken,
    pipeline: VecDeque<Vec3>,
    rng: Pcg64Mcg,
    /// Fault to come, and the number of fusion steps until it begins.
    breaks: Option<(TiltBreak, u64)>,
    steps: u64,
    last: Vec3,
}

impl ArmImu {
    /// Sensor of `arm`, 0 to 3, with the mounting error of `streams`.
    #[must_use]
    pub fn new(arm: usize, streams: Streams) -> Self {
        let name = format!("arm_imu.{}", arm + 1);
        Self {
            side: f64::from(SIDE[arm]),
            mounting: streams.within(&format!("{name}.mounting"), -MOUNTING, MOUNTING),
            leaked: DVec3::ZERO,
            still: Still::new(0.0),
            calibration: Steps::new(0.0, streams.of(&format!("{name}.calibration"))),
            shaken: Shaken::new(0.0, TAU * streams.unit(&format!("{name}.imbalance"))),
            pipeline: VecDeque::with_capacity(LATENCY + 1),
            rng: streams.of(&name),
            breaks: None,
            steps: 0,
            last: Vec3::default(),
        }
    }

    /// The same with an added `offset`, rad, and with a fault from a time, s after power-up, on.
    #[must_use]
    pub fn with_fault(mut self, offset: f64, fault: Option<(TiltBreak, f64)>) -> Self {
        self.mounting += offset;
        self.breaks = fault.map(|(broken, at)| (broken, (at * RATE_HZ) as u64));
        self
    }

    /// The same with `errors`.
    #[must_use]
    pub fn with_errors(self, errors: TiltErrors) -> Self {
        Self {
            still: Still::new(errors.dead_zone),
            calibration: self.calibration.up_to(errors.step),
            shaken: self.shaken.with(errors.vibration),
            ..self
        }
    }

    /// The present fault, if any.
    #[must_use]
    pub fn broken(&self) -> Option<TiltBreak> {
        let (broken, at) = self.breaks?;
        (self.steps > at).then_some(broken)
    }

    /// A fusion step at tilt `tilt` rad, body at `attitude` under `specific_force` (m/s², body), the arm's rotor at `rotor`
    /// rad/s; returns delayed gravity, m/s², arm axes.
    pub fn sample(&mut self, attitude: DQuat, tilt: f64, specific_force: DVec3, rotor: f64) -> Vec3 {
        self.steps += 1;
        if self.broken().is_none() {
            self.last = self.fuse(attitude, tilt, specific_force, rotor);
        }
        self.last
    }

    fn fuse(&mut self, attitude: DQuat, tilt: f64, specific_force: DVec3, rotor: f64) -> Vec3 {
        let down = attitude.conjugate() * DVec3::new(0.0, 0.0, 9.806_65);
        let motion = -specific_force - down;
        self.leaked += (motion * LEAK.0 - self.leaked) * (1.0 / (RATE_HZ * LEAK.1));
        let error = self.mounting + self.calibration.step(1.0 / RATE_HZ);
        let arm = DQuat::from_rotation_x(self.side * (tilt + error));
        let seen = match self.still.step(1.0 / RATE_HZ, arm.conjugate() * down) {
            Some(fused) => fused + arm.conjugate() * self.leaked,
            None => arm.conjugate() * (down + self.leaked),
        };
        let seen = seen + self.shaken.step(arm.conjugate() * down, rotor);
        let mut axis = |x: f64| {
            let n: f64 = StandardNormal.sample(&mut self.rng);
            (((x + n * NOISE) / LSB).round() * LSB) as f32
        };
        self.pipeline
            .push_back(Vec3::new(axis(seen.x), axis(seen.y), axis(seen.z)));
        if self.pipeline.len() > LATENCY {
            self.pipeline.pop_front().unwrap_or_default()
        } else {
            self.pipeline.front().copied().unwrap_or_default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilted_arm_sees_gravity_turned_20_ms_late() {
        let mut imu = ArmImu::new(0, Streams::new(5));
        let rest = DVec3::new(0.0, 0.0, -9.806_65);
        for _ in 0..10 {
            imu.sample(DQuat::IDENTITY, 0.0, rest, 0.0);
        }
        let old = imu.sample(DQuat::IDENTITY, 0.5, rest, 0.0);
        assert!(old.y.abs() < 0.25, "{old:?}");
        imu.sample(DQuat::IDENTITY, 0.5, rest, 0.0);
        let new = imu.sample(DQuat::IDENTITY, 0.5, rest, 0.0);
        // Left arm, tip up: +0.5 rad about x, so y = g sin 0.5.
        assert!(
            (f64::from(new.y) - 9.806_65 * libm::sin(0.5f64)).abs() < 0.25,
            "{new:?}"
        );
    }

    #[test]
    fn a_slow_closing_is_seen_late_and_a_quick_one_at_once() {
        let rest = DVec3::new(0.0, 0.0, -9.806_65);
        // Tilts by a radian at `rate` (rad/s); the largest error on the way, rad.
        let lags = |rate: f64, dead_zone: f64| {
            let mut imu = ArmImu::new(0, Streams::new(5)).with_errors(TiltErrors {
                dead_zone,
                ..TiltErrors::default()
            });
            let steps = (RATE_HZ / rate) as u32;
            (0..steps).fold(0.0_f64, |most, step| {
                let tilt = f64::from(step) * rate / RATE_HZ;
                let seen = imu.sample(DQuat::IDENTITY, tilt, rest, 0.0);
                most.max(tilt - libm::atan2(f64::from(seen.y), seen.z.into()))
            })
        };
        let dead = 3.0_f64.to_radians();
        assert!(lags(0.04, dead) > lags(0.04, 0.0) + 0.1, "{}", lags(0.04, dead));
        assert!((lags(0.3, dead) - lags(0.3, 0.0)).abs() < 0.02);
    }

    #[test]
    fn a_stuck_sensor_sends_its_last_vector_from_when_it_breaks() {
        let mut imu = ArmImu::new(1, Streams::new(5)).with_fault(0.0, Some((TiltBreak::Stuck, 0.1)));
        let rest = DVec3::new(0.0, 0.0, -9.806_65);
        let sent: Vec<Vec3> = (0..30)
            .map(|_| imu.sample(DQuat::IDENTITY, 0.2, rest, 0.0))
            .collect();
        let changes = sent.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert!((5..=9).contains(&changes), "{changes}");
        assert!(sent[10..].iter().all(|v| *v == sent[9]));
        assert_eq!(imu.broken(), Some(TiltBreak::Stuck));
    }
}
