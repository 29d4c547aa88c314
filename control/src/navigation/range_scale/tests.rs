//! Ranges of motions that are known, as long as they say and not.

extern crate std;
use std::f64::consts::TAU;

use super::{Below, RangeScale};
use crate::navigation::vertical_speed::VerticalState;

const STEP_US: u64 = 5_000;
const RANGE_US: u64 = 20_000;
const LATE_US: u64 = 30_000;

/// Height and what is felt downwards, m and m/s², at a time, s.
type Motion = fn(f64) -> [f64; 2];

/// Rises and sinks by `size` m about 1 m, one time in `period` s.
fn swing(t: f64, size: f64, period: f64) -> [f64; 2] {
    let w = TAU / period;
    [1.0 + size * (w * t).sin(), size * w * w * (w * t).sin()]
}

fn held(t: f64) -> [f64; 2] {
    let ([a, da], [b, db]) = (swing(t, 0.02, 3.1), swing(t, 0.015, 4.7));
    [a + b - 1.0, da + db]
}

fn climbing(t: f64) -> [f64; 2] {
    swing(t, 0.25, 8.0)
}

/// White noise of a deviation of one.
fn noise(n: u64) -> f64 {
    // Twelve even ones make a normal one.
    let even = |k: u64| {
        let x = (n * 12 + k + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let x = (x ^ (x >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        (x >> 40) as f64 / (1u64 << 24) as f64
    };
    (0..12).map(even).sum::<f64>() - 6.0
}

struct Rig {
    scale: RangeScale,
    now: u64,
    motion: Motion,
    /// What the range makes of a height at a time, m and s.
    range: fn(f64, f64) -> f64,
    below: Below,
    /// Bias of what is felt, m/s².
    bias: f64,
}

impl Rig {
    fn new(motion: Motion, range: fn(f64, f64) -> f64) -> Self {
        Self {
            scale: RangeScale::default(),
            now: 1_000_000,
            motion,
            range,
            below: Below::Plain,
            bias: 0.08,
        }
    }

    /// Runs `seconds`; when it was found wrong, s from the beginning.
    fn run(&mut self, seconds: f64) -> Option<f64> {
        let begun = self.now;
        let mut found = None;
        for _ in 0..(seconds * 1e6) as u64 / STEP_US {
            self.now += STEP_US;
            let t = self.now as f64 * 1e-6;
            let [_, down] = (self.motion)(t);
            self.scale.predict(
                self.now,
                Some((down + self.bias) as f32),
                &VerticalState::default(),
            );
            let at = self.now - LATE_US;
            if self.now.is_multiple_of(RANGE_US) {
                let t = at as f64 * 1e-6;
                let [height, _] = (self.motion)(t);
                let seen = (self.range)(height, t) + 0.015 * noise(self.now / RANGE_US);
                self.scale.update(seen as f32, LATE_US as f32 * 1e-6, self.below);
            }
            if self.scale.wrong() && found.is_none() {
                found = Some((self.now - begun) as f64 * 1e-6);
            }
        }
        found
    }
}

#[test]
fn a_sound_range_is_never_wrong() {
    for motion in [held as Motion, climbing] {
        for below in [Below::Plain, Below::Narrow] {
            let mut r = Rig::new(motion, |h, _| h);
            r.below = below;
            assert_eq!(r.run(120.0), None);
        }
    }
}

#[test]
fn a_wrong_range_scale_is_detected_in_a_climb() {
    for range in [(|h, _| 1.6 * h) as fn(f64, f64) -> f64, |h, _| 0.6 * h] {
        let found = Rig::new(climbing, range).run(30.0);
        assert!(found.is_some_and(|after| after < 6.0), "{found:?}");
    }
}

#[test]
fn small_errors_of_the_scale_are_tolerated() {
    for range in [(|h, _| 1.15 * h) as fn(f64, f64) -> f64, |h, _| 0.87 * h] {
        assert_eq!(Rig::new(climbing, range).run(60.0), None);
    }
}

/// Held in gusts it rises and sinks by 2 cm: enough to see it move by 1.6 times as much.
#[test]
fn a_range_scale_too_long_is_detected_in_a_hold_too() {
    let found = Rig::new(held, |h, _| 1.6 * h).run(30.0);
    assert!(found.is_some_and(|after| after < 15.0), "{found:?}");
}

/// Drifting over a round back the vehicle follows it, as it would a scale. Over a floor it would be one.
#[test]
fn what_a_round_back_does_is_no_scale() {
    let range = |h: f64, t: f64| h + 0.02 * (TAU / 3.1 * t).sin();
    let mut r = Rig::new(held, range);
    r.below = Below::Narrow;
    assert_eq!(r.run(60.0), None);
    assert!(Rig::new(held, range).run(60.0).is_some());
}

#[test]
fn a_range_is_used_again_once_its_scale_fits_a_climb() {
    let mut r = Rig::new(climbing, |h, _| 1.6 * h);
    assert!(r.run(10.0).is_some());
    r.run(20.0);
    assert!(r.scale.wrong(), "while it lasts");
    r.range = |h, _| h;
    r.run(8.0);
    assert!(!r.scale.wrong());
    // At rest nothing says that it is right again.
    let mut r = Rig::new(climbing, |h, _| 1.6 * h);
    r.run(10.0);
    (r.motion, r.range) = (|_| [1.0, 0.0], |h, _| h);
    r.run(30.0);
    assert!(r.scale.wrong());
}

/// Nothing that is not flown, or that is a shock, counts.
#[test]
fn on_the_ground_and_in_a_shock_nothing_is_judged() {
    let mut r = Rig::new(climbing, |h, _| 1.6 * h);
    for _ in 0..40 {
        r.run(0.4);
        r.scale.predict(r.now, None, &VerticalState::default());
        r.run(0.4);
        r.scale.predict(r.now, Some(9.0), &VerticalState::default());
        assert!(!r.scale.wrong());
    }
}

/// A surface that is new begins all anew, one that was there before only the height.
#[test]
fn a_step_onto_something_is_no_scale() {
    let mut r = Rig::new(climbing, |h, _| h);
    for i in 0..20 {
        assert_eq!(r.run(1.3), None);
        r.range = if i % 2 == 0 { |h, _| h - 0.4 } else { |h, _| h };
        r.scale
            .update(1.0, 0.03, if i < 10 { Below::New } else { Below::Known });
    }
}

#[test]
fn no_number_breaks_it() {
    let mut r = Rig::new(climbing, |h, _| h);
    for number in [f32::NAN, f32::INFINITY, f32::MAX, -1e30, 0.0] {
        r.scale.predict(r.now, Some(number), &VerticalState::default());
        r.scale.update(number, 0.03, Below::Plain);
        r.scale.update(1.0, number, Below::Plain);
        r.run(1.0);
        assert!(!r.scale.wrong());
    }
    r.range = |h, _| 1.6 * h;
    assert!(r.run(20.0).is_some());
}
