//! Ranges that stand still and ranges that only seem to, in millimetres and centimetres, at 24 to 100 readings a second.

extern crate std;
use crate::maths::vector::Quat;
use crate::navigation::flow_range::FlowRangeFault;
use crate::navigation::flow_range_sample::Range;
use crate::navigation::frozen_range::Frozen;
use crate::navigation::position_estimator::*;

const STEP_US: u64 = 5_000;

/// White noise of deviation 1, repeatable.
fn white(k: u64) -> f32 {
    let uniform = |k: u64| {
        let mut x = k.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x51;
        for _ in 0..3 {
            x = (x ^ (x >> 31)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        }
        (x >> 40) as f32 / (1u64 << 24) as f32
    };
    (0..12).map(|i| uniform(12 * k + i)).sum::<f32>() - 6.0
}

/// A module: its step, m, its noise, m, how often it measures, and how often it sends, Hz.
#[derive(Clone, Copy, Debug)]
struct Module {
    step: f32,
    noise: f32,
    measures: u64,
    sends: u64,
}

const MODULES: [Module; 8] = [
    Module {
        step: 0.001,
        noise: 0.015,
        measures: 50,
        sends: 50,
    },
    Module {
        step: 0.001,
        noise: 0.003,
        measures: 24,
        sends: 24,
    },
    Module {
        step: 0.001,
        noise: 0.003,
        measures: 24,
        sends: 100,
    },
    Module {
        step: 0.001,
        noise: 0.003,
        measures: 100,
        sends: 100,
    },
    Module {
        step: 0.01,
        noise: 0.003,
        measures: 24,
        sends: 24,
    },
    Module {
        step: 0.01,
        noise: 0.003,
        measures: 24,
        sends: 50,
    },
    Module {
        step: 0.01,
        noise: 0.003,
        measures: 24,
        sends: 100,
    },
    Module {
        step: 0.01,
        noise: 0.003,
        measures: 100,
        sends: 100,
    },
];

/// Height, m up, and upward acceleration, m/s², at a time, s.
type Motion = (fn(f64) -> f64, fn(f64) -> f64);

/// Flies for `seconds` s at a height, m up, of `height` and an upward acceleration, m/s², of `felt`; from `stuck` s on the module
/// stands still. When `range frozen` was named first, s.
fn named(module: Module, seconds: u64, stuck: f64, (height, felt): Motion) -> Option<f64> {
    let mut estimator = PositionEstimator::new(&Params::default());
    let mut held = None;
    for step in 200..seconds * 200 {
        let at_us = step * STEP_US;
        let t = at_us as f64 * 1e-6;
        let late = at_us - 25_000;
        let sent = late * module.sends / 1_000_000;
        let until = sent * 1_000_000 / module.sends;
        let index = until * module.measures / 1_000_000;
        let measured = index as f64 / module.measures as f64;
        let distance = height(measured) as f32 + module.noise * white(index);
        let mut distance = (distance / module.step).round() * module.step;
        if t > stuck {
            distance = *held.get_or_insert(distance);
        }
        let view = GroundView {
            flow: Some(Flow {
                until_us: until,
                seconds: 1.0 / module.sends as f32,
                angle: [1e-3 * white(sent), 1e-3 * white(sent + 7)],
                quality: 100,
            }),
            range: Some(Range {
                at_us: until,
                distance: Some(distance),
                reach: (0.02, 8.0),
            }),
        };
        let inertial = Inertial {
            at_us,
            q: Quat::IDENTITY,
            accel: Vec3::new(0.0, 0.0, -GRAVITY - felt(t) as f32),
        };
        let _ = estimator.step(&inertial, 17.7, None, Some(&view));
        if estimator.fault() == Some(Fault::FlowRange(FlowRangeFault::RangeFrozen)) {
            return Some(t);
        }
    }
    None
}

/// In the middle of a centimetre and at its edge, as still as none flies, and rising and sinking by 1 cm.
#[test]
fn a_sound_range_of_a_vehicle_that_stands_is_not_frozen() {
    let flights: [Motion; 3] = [
        (|_| 1.0, |_| 0.0),
        (|_| 1.005, |_| 0.0),
        (|t| 1.0 + 0.01 * t.sin(), |t| -0.01 * t.sin()),
    ];
    for module in MODULES {
        for (i, flight) in flights.into_iter().enumerate() {
            let found = named(module, 120, f64::MAX, flight);
            assert_eq!(found, None, "{module:?} {i}");
        }
    }
}

/// It sinks by 0.28 m/s, as on the way down to a pipe, from 20.5 s on; the module sticks at 21 s. In millimetres 25 readings, or
/// as long as 20.7 of its usual runs, or by the way.
#[test]
fn a_range_that_sticks_on_the_way_is_named_soon() {
    let sinks: Motion = (
        |t| {
            let (faster, after) = ((t - 20.0).clamp(0.0, 0.5), (t - 20.5).max(0.0));
            2.2 - 0.28 * (faster * faster + after) - 0.02 * (2.0 * t).sin()
        },
        |t| 0.08 * (2.0 * t).sin() - if (20.0..20.5).contains(&t) { 0.56 } else { 0.0 },
    );
    for module in MODULES {
        let found = named(module, 26, 21.0, sinks);
        std::println!("on the way {module:?}: {:?}", found.map(|t| t - 21.0));
        assert!(
            found.is_some_and(|t| (21.0..21.6).contains(&t)),
            "{module:?} {found:?}"
        );
    }
}

/// One that sticks while the vehicle stands costs nothing at once, and is named all the same.
#[test]
fn a_range_that_sticks_in_still_air_is_named() {
    for module in MODULES {
        let found = named(module, 40, 20.0, (|_| 1.0, |_| 0.0));
        std::println!("in still air {module:?}: {:?}", found.map(|t| t - 20.0));
        // What it read when it stuck may have stood for up to a run.
        let limit = if module.step < 0.005 { 1.6 } else { 9.0 };
        assert!(found.is_some_and(|t| t - 20.0 < limit), "{module:?} {found:?}");
    }
}

/// At 0.1 m over a pipe a range that stood still was none: the vehicle rose and sank beside it, onto an arm.
#[test]
fn near_what_is_below_a_range_that_stands_still_is_frozen_where_the_vehicle_flies() {
    for (distance, flies, named_after) in [
        (0.2, false, Some(25)),
        (0.2, true, Some(25)),
        (0.096, true, Some(50)),
        (0.096, false, None),
    ] {
        let mut frozen = Frozen::default();
        // It shows millimetres.
        frozen.take(distance + 0.001, 980_000, flies);
        let named = (0..200u64).find(|i| {
            frozen.take(distance, 1_000_000 + i * 20_000, flies);
            frozen.holds()
        });
        assert_eq!(named, named_after, "{distance} {flies}");
    }
}

/// On the ground a module in centimetres, whose lens is high, stands still for good.
#[test]
fn a_vehicle_that_stands_on_the_ground_has_no_frozen_range_in_centimetres() {
    let mut frozen = Frozen::default();
    for i in 0..10_000u64 {
        let distance = if i < 3 { 0.13 } else { 0.12 };
        frozen.take(distance, 1_000_000 + i * 20_000, false);
        assert!(!frozen.holds(), "{i}");
    }
}
