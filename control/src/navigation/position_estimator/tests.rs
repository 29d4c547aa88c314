//! The estimator against motions that are known.

mod baro_height;
mod external_pose;
mod flow_range;
mod flow_range_fuzz;
mod frozen_range;

extern crate std;
use super::*;
use crate::maths::vector::Quat;
use crate::navigation::history::LENGTH;

const STEP_US: u64 = 5_000;
/// Time between two fixes, µs.
const FIX_US: u64 = 20_000;

/// A level vehicle that moves along the sender's axes, seen late.
pub(super) struct Rig {
    pub(super) estimator: PositionEstimator,
    pub(super) now: u64,
    pub(super) yaw: f32,
    /// Heading of the sender's axes.
    pub(super) yaw_offset: f32,
    /// Bias of the accelerometer, m/s², body.
    pub(super) bias: Vec3,
    pub(super) lag_us: u64,
    pub(super) silent: bool,
    pub(super) origin: Vec3,
    pub(super) resets: u8,
    /// What the source makes of a sound fix.
    pub(super) spoil: fn(Fix) -> Fix,
    pub(super) out: Option<Estimate>,
}

impl Rig {
    pub(super) fn new() -> Self {
        Self {
            estimator: PositionEstimator::new(&Params::default()),
            now: 1_000_000,
            yaw: 0.0,
            yaw_offset: 0.0,
            bias: Vec3::ZERO,
            lag_us: 30_000,
            silent: false,
            origin: Vec3::ZERO,
            resets: 0,
            spoil: |fix| fix,
            out: None,
        }
    }

    /// A swing of 0.3 m at 2 rad/s along the sender's first two axes and down: position, velocity, acceleration.
    pub(super) fn truth(us: u64) -> [Vec3; 3] {
        let (t, w) = (us as f64 * 1e-6, 2.0);
        let (sin, cos) = ((w * t).sin() as f32, (w * t).cos() as f32);
        let swing = |x: f32, y: f32| Vec3::new(0.3 * x, 0.3 * y, 0.1 * x);
        [
            swing(sin, cos),
            swing(2.0 * cos, -2.0 * sin),
            swing(-4.0 * sin, -4.0 * cos),
        ]
    }

    fn felt(&self) -> Inertial {
        let [_, _, acceleration] = Self::truth(self.now);
        let q = Quat::from_euler(0.0, 0.0, self.yaw);
        let world = about_down(acceleration, -self.yaw_offset) - Vec3::new(0.0, 0.0, GRAVITY);
        Inertial {
            at_us: self.now,
            q,
            accel: q.rotate_inverse(world) + self.bias,
        }
    }

    pub(super) fn fix(&self) -> Option<Fix> {
        // The newest that has arrived.
        let at_us = (self.now - self.lag_us) / FIX_US * FIX_US;
        (!self.silent).then(|| {
            (self.spoil)(Fix {
                at_us,
                position: Self::truth(at_us)[0] + self.origin,
                heading: scalar::wrap_pi(self.yaw + self.yaw_offset),
                variance: None,
                resets: self.resets,
            })
        })
    }

    pub(super) fn step(&mut self, fix: Option<Fix>) {
        self.now += STEP_US;
        let weight = 9.806_65 * Params::default().mass;
        self.out = self.estimator.step(&self.felt(), weight, fix.as_ref(), None);
    }

    pub(super) fn run(&mut self, seconds: f32) {
        for _ in 0..(seconds * 1e6) as u64 / STEP_US {
            let fix = self.fix();
            self.step(fix);
        }
    }

    /// Errors of position and velocity, m and m/s.
    pub(super) fn errors(&self) -> [f32; 2] {
        let [position, velocity, _] = Self::truth(self.now);
        let e = self.out.expect("an estimate");
        [
            (e.position - position - self.origin).norm(),
            (e.velocity - velocity).norm(),
        ]
    }
}

#[test]
fn late_fixes_give_the_present_position_whatever_their_axes() {
    for (yaw_offset, yaw) in [(0.0, 0.0), (1.0, 0.4), (-2.9, 3.0)] {
        let mut r = Rig {
            yaw_offset,
            yaw,
            ..Rig::new()
        };
        r.run(10.0);
        let [p, v] = r.errors();
        // Without their lag the fixes would be 18 mm off at this speed.
        assert!(p < 0.006 && v < 0.03, "{yaw_offset} {yaw}: {p} {v}");
        let off = scalar::wrap_pi(r.out.unwrap().yaw_offset - yaw_offset);
        assert!(off.abs() < 5e-3, "{off}");
    }
}

#[test]
fn the_bias_of_the_accelerometer_is_learnt_and_the_wind_stays() {
    let mut r = Rig {
        bias: Vec3::new(0.15, -0.1, 0.2),
        ..Rig::new()
    };
    r.run(60.0);
    let [p, v] = r.errors();
    assert!(p < 0.01 && v < 0.03, "{p} {v}");
    // Felt across the thrust axis is the swing's own acceleration: nothing else moves this level vehicle.
    let [_, _, acceleration] = Rig::truth(r.now);
    let d = r.out.unwrap().disturbance;
    let lag = (d - Vec3::new(acceleration.x, acceleration.y, d.z)).norm();
    assert!(lag < 0.15, "{d:?} {acceleration:?}");
}

#[test]
fn a_gap_is_coasted_through_and_aged() {
    let mut r = Rig::new();
    r.run(20.0);
    r.silent = true;
    r.run(1.0);
    let [p, _] = r.errors();
    let age = r.out.unwrap().age;
    assert!(p < 0.05 && (age - 1.03).abs() < 0.03, "{p} {age}");
    r.silent = false;
    r.run(1.0);
    assert!(r.errors()[0] < 0.006 && r.out.unwrap().age < 0.06);
    r.silent = true;
    r.run(LOST_AGE + 0.1);
    assert_eq!(r.out, None);
}

#[test]
fn nothing_comes_out_without_a_fix_or_before_it_is_sure() {
    let mut r = Rig::new();
    for _ in 0..200 {
        r.step(None);
        assert_eq!(r.out, None);
    }
    r.run(0.3);
    assert_eq!(r.out, None);
    r.run(0.5);
    assert!(r.out.is_some());
}

#[test]
fn an_outlier_is_refused_and_named_by_no_one() {
    let mut r = Rig::new();
    r.run(10.0);
    let mut wild = r.fix().unwrap();
    wild.at_us += FIX_US;
    wild.position.x += 1.0;
    r.now += 3 * STEP_US;
    r.step(Some(wild));
    r.run(0.1);
    assert!(r.errors()[0] < 0.01 && r.estimator.fault().is_none());
}

#[test]
fn a_jump_that_the_sender_tells_is_taken_at_once_with_its_turn() {
    let mut r = Rig::new();
    r.run(10.0);
    r.resets = 1;
    r.yaw_offset = 1.0;
    r.origin = Vec3::new(-4.0, 0.0, 0.0);
    let fix = r.fix();
    r.step(fix);
    r.run(0.5);
    let e = r.out.unwrap();
    assert!(e.reset_count == 1 && (e.yaw_offset - 1.0).abs() < 0.01, "{e:?}");
}

#[test]
fn what_is_no_number_or_too_old_changes_nothing() {
    let mut good = Rig::new();
    good.run(5.0);
    let spoilt: [fn(&mut Fix); 5] = [
        |f| f.position.y = f32::NAN,
        |f| f.heading = f32::INFINITY,
        |f| f.position.z = 2e4,
        |f| f.at_us -= LENGTH as u64 * STEP_US + 100_000,
        |f| f.at_us += 1_000_000,
    ];
    for spoil in spoilt {
        let mut r = Rig::new();
        r.run(5.0);
        for _ in 0..20 {
            let mut fix = r.fix().unwrap();
            spoil(&mut fix);
            r.step(Some(fix));
        }
        assert!(r.out.unwrap().is_finite() && r.out.unwrap().age > 0.1);
        assert!(r.errors()[0] < 0.01);
        r.run(0.5);
        assert!(r.errors()[0] < 0.006);
    }
    // An attitude that is none gives no position, and leaves none behind.
    let mut broken = good.felt();
    broken.accel.x = f32::NAN;
    broken.at_us += STEP_US;
    assert_eq!(good.estimator.step(&broken, 17.7, None, None), None);
    good.run(0.1);
    assert!(good.out.unwrap().is_finite());
}

#[test]
fn after_a_silent_inertial_sensor_it_begins_anew() {
    let mut r = Rig::new();
    r.run(5.0);
    r.now += 100_000;
    r.run(0.1);
    assert_eq!(r.out, None);
    r.run(1.0);
    assert!(r.errors()[0] < 0.02);
}

#[test]
fn a_thrust_that_is_less_than_asked_is_a_disturbance_down() {
    let mut estimator = PositionEstimator::new(&Params::default());
    let mut felt = Inertial {
        accel: Vec3::new(0.0, 0.0, -GRAVITY),
        ..Inertial::default()
    };
    let weight = GRAVITY * Params::default().mass;
    let mut out = None;
    for i in 1..1000_u64 {
        let fix = Fix {
            at_us: (i / 4) * 4 * STEP_US,
            // No source says twice the same of a vehicle in the air.
            position: Vec3::new(0.0, 0.0, 1e-5 * (i / 4 % 2) as f32),
            ..Fix::default()
        };
        felt.at_us = i * STEP_US;
        out = estimator.step(&felt, 1.1 * weight, Some(&fix), None);
    }
    let d = out.unwrap().disturbance;
    assert!((d.z - 0.1 * GRAVITY).abs() < 0.02 && d.x.abs() < 1e-3, "{d:?}");
}
