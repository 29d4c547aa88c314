//! Sources of poses that fail, on a vehicle that swings.

extern crate std;
use super::Rig;
use crate::maths::vector::Quat;
use crate::navigation::position_estimator::*;
use std::string::String;
use std::vec::Vec;

/// White noise of three values, within ±`most`, from the time.
fn noise(at_us: u64, most: f32) -> Vec3 {
    let one = |k: u64| {
        let mut x = (at_us / 20_000).wrapping_mul(3).wrapping_add(k);
        for _ in 0..3 {
            x = (x ^ (x >> 31)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        }
        ((x >> 40) as f32 / (1 << 23) as f32 - 1.0) * most
    };
    Vec3::new(one(0), one(1), one(2))
}

fn noisy(fix: Fix) -> Fix {
    // As wide as 3 mm of deviation.
    let position = fix.position + noise(fix.at_us, 5.2e-3);
    Fix { position, ..fix }
}

/// Poses by a square tag on the way, of which one in twenty is taken for its mirror image.
fn mirrored_at_times(fix: Fix) -> Fix {
    let sound = noisy(fix);
    if noise(fix.at_us + 1_000_000, 1.0).z < -0.9 {
        let Vec3 { x, y, z } = sound.position;
        Fix {
            position: Vec3::new(0.6 - x, -y, z),
            heading: fix.heading + 0.4,
            ..sound
        }
    } else {
        sound
    }
}

fn times(fix: Fix, factors: Vec3) -> Fix {
    let fix = noisy(fix);
    Fix {
        position: fix.position.scale_by(factors),
        ..fix
    }
}

/// Each fault: name, what it makes of a fix, what it is called and within how many seconds.
type Spoil = fn(Fix) -> Fix;
const FAULTS: [(&str, Spoil, PoseFault, f32); 9] = [
    (
        "frozen",
        |fix| Fix {
            position: Vec3::new(0.1, 0.1, 0.0),
            heading: 0.2,
            ..fix
        },
        PoseFault::Frozen,
        0.3,
    ),
    (
        "jumping",
        |fix| {
            let high = (fix.at_us / 300_000).is_multiple_of(2);
            let mut fix = noisy(fix);
            fix.position.x += if high { 0.6 } else { 0.0 };
            fix
        },
        PoseFault::Jumps,
        0.5,
    ),
    (
        "resetting",
        |fix| Fix {
            resets: (fix.at_us / 200_000) as u8,
            ..noisy(fix)
        },
        PoseFault::Jumps,
        2.5,
    ),
    (
        "north turned round",
        |fix| times(fix, Vec3::new(-1.0, 1.0, 1.0)),
        PoseFault::Disagrees,
        1.5,
    ),
    (
        "east turned round",
        |fix| times(fix, Vec3::new(1.0, -1.0, 1.0)),
        PoseFault::Disagrees,
        1.5,
    ),
    (
        "up for down",
        |fix| times(fix, Vec3::new(1.0, 1.0, -1.0)),
        PoseFault::Disagrees,
        1.5,
    ),
    (
        "too large",
        |fix| times(fix, Vec3::new(2.5, 2.5, 2.5)),
        PoseFault::Disagrees,
        2.5,
    ),
    (
        "too small",
        |fix| times(fix, Vec3::new(0.3, 0.3, 0.3)),
        PoseFault::Disagrees,
        2.5,
    ),
    (
        "turned by 45 degrees",
        |fix| Fix {
            heading: fix.heading + 0.8,
            ..noisy(fix)
        },
        PoseFault::Disagrees,
        1.5,
    ),
];

fn fault(r: &Rig) -> Option<PoseFault> {
    match r.estimator.fault() {
        Some(Fault::Pose(fault)) => Some(fault),
        _ => None,
    }
}

/// After how many seconds `done`, within `most`.
fn until(r: &mut Rig, most: f32, done: impl Fn(&Rig) -> bool) -> Option<f32> {
    for i in 0..(most * 100.0) as u32 {
        if done(r) {
            return Some(i as f32 * 0.01);
        }
        r.run(0.01);
    }
    None
}

#[test]
fn each_fault_is_named_in_time_left_out_and_taken_again_when_it_is_over() {
    let mut wrong = Vec::new();
    for (name, spoil, called, limit) in FAULTS {
        let mut r = Rig::new();
        (r.spoil, r.yaw_offset, r.yaw) = (noisy, 0.7, 0.3);
        r.run(12.0);
        assert_eq!(fault(&r), None, "{name}");
        r.spoil = spoil;
        // A jump may come first where the fault makes one.
        let named = until(&mut r, limit, |r| fault(r) == Some(called));
        let fresh = called == PoseFault::Disagrees && r.out.is_some_and(|e| e.age < 1.3);
        assert!(!fresh, "{name}: what it spoilt is coasted on");
        r.run(2.0);
        let age = r.out.map_or(f32::NAN, |e| e.age);
        let stays = fault(&r).is_some();
        r.spoil = noisy;
        let again = until(&mut r, 8.0, |r| fault(r).is_none());
        r.run(1.0);
        let [p, _] = r.errors();
        std::println!(
            "{name}: named after {named:?} s, age {age:.2} s, taken again after {again:?} s, {p:.3} m"
        );
        let back = again.is_some_and(|s| (0.9..6.0).contains(&s)) && p < 0.03;
        if named.is_none() || !stays || age.is_nan() || age < 0.3 || !back {
            wrong.push(String::from(name));
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn a_fault_from_the_first_pose_on_is_named_too_and_no_estimate_outlives_it() {
    for (name, spoil, called, _) in FAULTS {
        let mut r = Rig::new();
        r.spoil = spoil;
        assert!(
            until(&mut r, 5.0, |r| fault(r) == Some(called)).is_some(),
            "{name}"
        );
        r.run(LOST_AGE + 0.5);
        // Without a sound pose the estimate ends; what is wrong is still said.
        assert!(r.out.is_none() && fault(&r).is_some(), "{name}");
    }
}

#[test]
fn a_new_origin_that_no_one_announced_is_named_before_it_counts() {
    let mut r = Rig::new();
    r.spoil = noisy;
    r.run(12.0);
    r.origin = Vec3::new(3.0, -2.0, 0.5);
    let named = until(&mut r, 1.0, |r| fault(r) == Some(PoseFault::Jumps)).expect("named");
    assert!(named < 0.15 && r.out.unwrap().reset_count == 0, "{named}");
    let again = until(&mut r, 3.0, |r| fault(r).is_none()).expect("taken again");
    r.run(0.5);
    let [p, v] = r.errors();
    assert!(
        (0.9..1.2).contains(&again) && r.out.unwrap().reset_count == 1,
        "{again}"
    );
    assert!(p < 0.02 && v < 0.1, "{p} {v}");
}

#[test]
fn sound_poses_are_blamed_for_nothing_however_noisy_rare_and_late() {
    let sources: [(Spoil, u64); 6] = [
        (noisy, 30_000),
        (mirrored_at_times, 30_000),
        (
            |fix| Fix {
                position: fix.position + noise(fix.at_us, 0.05),
                variance: Some(Vec3::new(1.0, 1.0, 1.0) * 8.3e-4),
                ..fix
            },
            30_000,
        ),
        (
            // A small tag from afar, whose sender gives no variance.
            |fix| Fix {
                position: fix.position + noise(fix.at_us, 0.07),
                ..fix
            },
            30_000,
        ),
        (
            // Covered for 0.2 s every 3 s.
            |fix| {
                let covered = fix.at_us % 3_000_000 < 200_000;
                Fix {
                    at_us: if covered { 0 } else { fix.at_us },
                    ..noisy(fix)
                }
            },
            30_000,
        ),
        (
            // Whole millimetres.
            |fix| Fix {
                position: fix.position.map(|x| (x * 1e3).round() * 1e-3),
                ..fix
            },
            200_000,
        ),
    ];
    for (spoil, lag_us) in sources {
        let mut r = Rig::new();
        (r.spoil, r.lag_us, r.yaw_offset) = (spoil, lag_us, -2.0);
        r.bias = Vec3::new(0.2, -0.15, 0.3);
        for _ in 0..120 {
            r.run(0.5);
            assert_eq!(fault(&r), None, "{lag_us} {:?}", r.fix());
        }
        // A gap, and another origin after a silence that is longer than what is coasted.
        r.silent = true;
        r.run(0.6);
        r.silent = false;
        r.run(3.0);
        assert_eq!(fault(&r), None);
        r.silent = true;
        r.run(2.0);
        (r.silent, r.origin) = (false, Vec3::new(2.0, 0.0, 0.0));
        r.run(1.0);
        assert_eq!(fault(&r), None);
        assert_eq!(r.out.unwrap().reset_count, 1);
    }
}

#[test]
fn on_the_ground_equal_poses_are_no_fault_and_in_the_air_at_once() {
    let mut estimator = PositionEstimator::new(&Params::default());
    let mut step = |i: u64, lift: f32| {
        let at_us = i * 5_000;
        let fix = Fix {
            at_us: at_us / 20_000 * 20_000,
            ..Fix::default()
        };
        let felt = Inertial {
            at_us,
            q: Quat::IDENTITY,
            accel: Vec3::new(0.0, 0.0, -GRAVITY),
        };
        estimator.step(&felt, lift, Some(&fix), None);
        estimator.fault()
    };
    assert!((1..400).all(|i| step(i, 1.0).is_none()));
    assert!((400..410).any(|i| step(i, 17.0) == Some(Fault::Pose(PoseFault::Frozen))));
}

fn turned(fix: Fix) -> Fix {
    Fix {
        heading: fix.heading + 0.8,
        ..noisy(fix)
    }
}

#[test]
fn a_step_of_the_pose_heading_alone_leaves_the_estimate_dead_reckoning_on_its_axes() {
    let mut r = Rig::new();
    (r.spoil, r.yaw_offset) = (noisy, 0.7);
    r.run(12.0);
    r.spoil = turned;
    let named = until(&mut r, 1.0, |r| fault(r) == Some(PoseFault::Jumps)).expect("named");
    r.run(1.0 - named);
    let e = r.out.unwrap();
    let [p, v] = r.errors();
    assert!(named < 0.15 && (0.9..1.1).contains(&e.age), "{named} {}", e.age);
    assert!(
        (e.yaw_offset - 0.7).abs() < 0.06 && p < 0.05 && v < 0.1,
        "{} {p} {v}",
        e.yaw_offset
    );
    // The way does not agree with that heading: no longer a jump.
    assert!(until(&mut r, 0.5, |r| fault(r) == Some(PoseFault::Disagrees)).is_some());
    r.run(5.0);
    assert_eq!(fault(&r), Some(PoseFault::Disagrees));
}

#[test]
fn axes_that_turn_with_the_way_are_taken_once_it_agrees() {
    let mut r = Rig::new();
    (r.spoil, r.yaw_offset) = (noisy, 0.7);
    r.run(12.0);
    r.yaw_offset = 1.5;
    assert!(until(&mut r, 0.2, |r| fault(r) == Some(PoseFault::Jumps)).is_some());
    assert!(until(&mut r, 6.0, |r| fault(r).is_none()).is_some());
    r.run(0.1);
    let e = r.out.unwrap();
    assert!(
        e.reset_count == 1 && (e.yaw_offset - 1.5).abs() < 0.05,
        "{} {}",
        e.reset_count,
        e.yaw_offset
    );
    // The next turn is measured from them.
    r.spoil = turned;
    assert!(until(&mut r, 0.2, |r| fault(r) == Some(PoseFault::Jumps)).is_some());
}

#[test]
fn axes_that_have_turned_in_a_silence_are_taken_at_once() {
    let mut r = Rig::new();
    (r.spoil, r.yaw_offset) = (noisy, 0.7);
    r.run(12.0);
    r.silent = true;
    r.run(1.1);
    (r.silent, r.yaw_offset) = (false, 1.5);
    r.run(0.1);
    let e = r.out.unwrap();
    assert_eq!((fault(&r), e.reset_count), (None, 1));
    assert!((e.yaw_offset - 1.5).abs() < 0.05, "{}", e.yaw_offset);
}

/// A pipe does not let it move: only the heading can say that it is sound again.
#[test]
fn a_heading_that_comes_back_is_taken_by_a_vehicle_that_stands_still() {
    let mut estimator = PositionEstimator::new(&Params::default());
    let mut run = |from: u64, to: u64, lift: f32, spoil: Spoil| -> Vec<_> {
        let step = |i: u64| {
            let at_us = i * 5_000;
            let fix = Fix {
                at_us: at_us.saturating_sub(30_000) / 20_000 * 20_000,
                ..Fix::default()
            };
            let felt = Inertial {
                at_us,
                q: Quat::IDENTITY,
                accel: Vec3::new(0.0, 0.0, -GRAVITY),
            };
            estimator.step(&felt, lift, Some(&spoil(fix)), None);
            estimator.fault()
        };
        (from..to).map(step).collect()
    };
    let none = |faults: Vec<Option<Fault>>| faults.iter().all(Option::is_none);
    // Carried about, any heading is as good.
    assert!(none(run(1, 400, 1.0, noisy)) && none(run(400, 800, 1.0, turned)));
    assert!(none(run(800, 1200, 1.0, noisy)) && none(run(1200, 1600, 17.0, noisy)));
    let flying = run(1600, 1650, 17.0, turned);
    assert_eq!(flying.last(), Some(&Some(Fault::Pose(PoseFault::Jumps))));
    assert!(run(1650, 4000, 1.0, turned).iter().all(Option::is_some));
    let back = run(4000, 4400, 1.0, noisy);
    let soon = back.iter().position(Option::is_none).expect("taken again");
    assert!((190..230).contains(&soon), "{soon}");
    assert!(none(run(4400, 5000, 17.0, noisy)));
}

mod any {
    use proptest::prelude::*;

    use super::*;

    /// Numbers that a line can carry: small, huge and none.
    fn number() -> impl Strategy<Value = f32> {
        prop_oneof![4 => -0.5f32..0.5, 2 => -20.0f32..20.0, 1 => any::<f32>()]
    }

    /// A stretch of fixes: how many, how they are spoilt, and numbers for it.
    fn stretch() -> impl Strategy<Value = (u32, u8, [f32; 4], u8)> {
        (1u32..40, 0u8..6, prop::array::uniform4(number()), any::<u8>())
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

        /// Whatever poses a source sends, sound, frozen, jumping, mirrored, scaled or none at all: numbers stay finite, the
        /// estimate near what the vehicle can have flown, and sound poses are taken again.
        #[test]
        fn poses_of_any_kind_leave_the_estimate_finite_and_are_got_over(stretches in prop::collection::vec(stretch(), 0..12)) {
            let mut r = Rig::new();
            r.spoil = noisy;
            r.run(4.0);
            for (count, kind, [x, y, z, w], resets) in stretches {
                let held = r.fix().unwrap();
                for i in 0..4 * count {
                    let mut fix = noisy(r.fix().unwrap());
                    let by = Vec3::new(x, y, z);
                    match kind {
                        0 => fix = Fix { at_us: fix.at_us, ..held },
                        1 if i / 12 % 2 == 0 => fix.position += by,
                        2 => fix.position = fix.position.scale_by(by),
                        3 => (fix.position, fix.heading) = (by, w),
                        4 => (fix.variance, fix.resets) = (Some(by), resets),
                        _ => fix.heading += w,
                    }
                    r.step(Some(fix));
                    if let Some(e) = r.out {
                        prop_assert!(e.is_finite(), "{e:?}");
                        prop_assert!(e.velocity.norm() < 36.0, "{e:?}");
                    }
                }
            }
            r.run(16.0);
            prop_assert!(r.estimator.fault().is_none(), "{:?}", r.estimator.pose_monitor);
            let [p, v] = r.errors();
            prop_assert!(p < 0.05 && v < 0.15, "{p} {v}");
        }
    }
}
