//! The pressure of the air as the height of last resort.

extern crate std;
use super::Rig;
use crate::navigation::position_estimator::*;

/// Between two pressures, µs, and how late they are.
const EACH_US: u64 = 40_000;
const LATE_US: u64 = 12_000;

/// Pa a metre down at sea level, by the barometric formula.
const PER_METRE: f32 = 101_325.0 / 8_434.0;

/// Runs `seconds` with pressures as `make` gives them at a time, µs, of a height, m down; largest step of the estimated
/// height between two steps beyond the true one, m.
fn run(r: &mut Rig, seconds: f32, mut make: impl FnMut(u64, f32) -> f32) -> f32 {
    let mut step: f32 = 0.0;
    for _ in 0..(seconds * 200.0) as u32 {
        let at_us = (r.now - LATE_US) / EACH_US * EACH_US;
        let down = Rig::truth(at_us)[0].z + r.origin.z;
        let air = AirPressure {
            at_us,
            pascal: make(at_us, down),
            celsius: 31.0,
        };
        r.estimator.hear(&air);
        let before = r.out.map(|e| e.position.z - Rig::truth(r.now)[0].z);
        let fix = r.fix();
        r.step(fix);
        if let (Some(before), Some(e)) = (before, r.out) {
            step = step.max((e.position.z - Rig::truth(r.now)[0].z - before).abs());
        }
    }
    step
}

/// Of sound air with some noise, 2.3 hPa off.
fn sound(at_us: u64, down: f32) -> f32 {
    let noise = ((at_us / EACH_US).wrapping_mul(2_654_435_761) % 1000) as f32 * 1e-3 - 0.5;
    101_555.0 + PER_METRE * down + noise
}

/// A vehicle that feels 0.15 m/s² too much down, as with a slope of its bias, after ten seconds of poses.
fn learnt() -> Rig {
    let mut r = Rig::new();
    run(&mut r, 10.0, sound);
    assert!(!r.out.unwrap().by_pressure && r.estimator.fault().is_none());
    r.silent = true;
    r.bias.z += 0.15;
    r
}

fn height_error(r: &Rig) -> f32 {
    let z = r.out.expect("an estimate").position.z;
    (z - Rig::truth(r.now)[0].z - r.origin.z).abs()
}

#[test]
fn where_the_poses_end_the_height_goes_on_by_pressure_without_a_step() {
    let mut without = learnt();
    without.run(8.0);
    let mut with = learnt();
    let step = run(&mut with, 8.0, sound);
    let [without, with] = [&without, &with].map(|r| (height_error(r), r.out.unwrap().by_pressure));
    assert!(!without.1 && without.0 > 3.0, "{without:?}");
    assert!(with.1 && with.0 < 0.5, "{with:?}");
    assert!(step < 0.02, "{step}");
}

#[test]
fn a_height_by_pose_counts_again_as_soon_as_there_is_one() {
    let mut r = learnt();
    run(&mut r, 3.0, sound);
    r.silent = false;
    r.bias.z = 0.0;
    run(&mut r, 4.0, sound);
    assert!(
        !r.out.unwrap().by_pressure && height_error(&r) < 0.02,
        "{}",
        height_error(&r)
    );
}

#[test]
fn pressures_change_nothing_while_poses_give_the_height() {
    let (mut with, mut without) = (Rig::new(), Rig::new());
    run(&mut with, 6.0, sound);
    without.run(6.0);
    assert_eq!(with.out, without.out);
    assert!(with.out.is_some());
}

#[test]
fn what_was_not_learnt_long_enough_is_not_used() {
    let mut r = Rig::new();
    r.run(8.0);
    run(&mut r, 1.5, sound);
    r.silent = true;
    run(&mut r, 2.0, sound);
    assert!(!r.out.unwrap().by_pressure);
}

#[test]
fn where_the_origin_jumps_it_is_learnt_anew() {
    let mut r = Rig::new();
    run(&mut r, 6.0, sound);
    r.origin.z = -3.0;
    r.resets += 1;
    // Air knows no origin: only what is off against it is another.
    let air = |at: u64, down: f32| sound(at, down + 3.0);
    run(&mut r, 3.0, air);
    r.silent = true;
    let step = run(&mut r, 4.0, air);
    let off = (r.out.unwrap().position.z - Rig::truth(r.now)[0].z + 3.0).abs();
    assert!(
        r.out.unwrap().by_pressure && off < 0.2 && step < 0.02,
        "{off} {step}"
    );
}

#[test]
fn a_pressure_that_ends_is_used_no_longer() {
    let mut r = learnt();
    run(&mut r, 1.0, sound);
    assert!(r.out.unwrap().by_pressure);
    r.run(0.5);
    assert!(!r.out.unwrap().by_pressure);
}

/// Time until `fault` is named, s.
fn named(r: &mut Rig, fault: PressureFault, mut make: impl FnMut(u64, f32) -> f32) -> f32 {
    let mut seconds = 0.0;
    while r.estimator.fault() != Some(Fault::Pressure(fault)) {
        run(r, 0.1, &mut make);
        seconds += 0.1;
        assert!(seconds < 20.0, "{fault:?} was not found");
    }
    seconds
}

#[test]
fn a_barometer_that_stands_still_jumps_or_drifts_is_named_and_left_out() {
    let from = |r: &Rig| r.now;
    for silent in [false, true] {
        let mut r = learnt();
        r.silent = silent;
        let found = named(&mut r, PressureFault::Frozen, |_, _| 101_540.0);
        assert!(found < 1.2, "{found}");
        let mut r = learnt();
        r.silent = silent;
        let begins = from(&r);
        let found = named(&mut r, PressureFault::Jumps, |at, down| {
            let high = (at.saturating_sub(begins) / 200_000).is_multiple_of(2);
            sound(at, down) + if high { 24.0 } else { 0.0 }
        });
        assert!(found < 1.5, "{found}");
        run(&mut r, 0.1, sound);
        assert!(!r.out.unwrap().by_pressure);
    }
    let mut r = learnt();
    r.silent = false;
    r.bias.z = 0.0;
    let begins = from(&r);
    let drifts = |at: u64, down: f32| sound(at, down) + 1e-6 * at.saturating_sub(begins) as f32 * PER_METRE;
    let found = named(&mut r, PressureFault::Disagrees, drifts);
    assert!(found < 5.0, "{found}");
    let beside = r;
    // Where nothing else says the height, the inertial sensor does for some seconds.
    let mut r = learnt();
    r.bias.z = 0.0;
    let began = from(&r);
    let found = named(&mut r, PressureFault::Disagrees, |at, down| {
        sound(at, down) + 1e-6 * at.saturating_sub(began) as f32 * PER_METRE
    });
    assert!(
        found < 3.0 && height_error(&r) < 1.0,
        "{found} {}",
        height_error(&r)
    );
    run(&mut r, 4.0, sound);
    assert!(!r.out.unwrap().by_pressure);
    let mut r = beside;
    // It is left out where the poses end, and taken again once it has been sound beside them.
    r.silent = true;
    run(&mut r, 1.0, drifts);
    assert!(!r.out.unwrap().by_pressure);
    r.silent = false;
    run(&mut r, 20.0, sound);
    assert_eq!(r.estimator.fault(), None);
    r.silent = true;
    run(&mut r, 1.0, sound);
    assert!(r.out.unwrap().by_pressure);
}

#[test]
fn no_single_pressure_moves_the_height() {
    let mut r = learnt();
    let mut count = 0;
    let step = run(&mut r, 4.0, |at, down| {
        count += 1;
        let far = (count / 8) % 12 == 0;
        sound(at, down) + if far { 5_000.0 } else { 0.0 }
    });
    assert!(
        step < 0.03 && height_error(&r) < 0.6,
        "{step} {}",
        height_error(&r)
    );
}

#[test]
fn whatever_the_barometer_says_the_estimate_stays_finite_and_near() {
    let wild = [
        f32::NAN,
        f32::INFINITY,
        -f32::INFINITY,
        f32::MAX,
        -1.0,
        0.0,
        30_000.0,
        120_000.0,
        101_325.0,
        f32::MIN_POSITIVE,
    ];
    let mut state = 1_u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    for round in 0..40 {
        let mut r = learnt();
        r.bias.z = 0.0;
        for _ in 0..400 {
            let late = [0, LATE_US, 10 * LATE_US, 1_000_000, r.now][random() % 5];
            let early = [0, 1, 60_000_000][random() % 3];
            let air = AirPressure {
                at_us: r.now.saturating_sub(late) + early,
                pascal: wild[random() % wild.len()],
                celsius: if random().is_multiple_of(5) {
                    f32::NAN
                } else {
                    20.0
                },
            };
            r.estimator.hear(&air);
            let fix = r.fix().filter(|_| round % 2 == 0);
            r.step(fix);
            assert!(r.out.is_none_or(|e| e.is_finite()));
        }
        assert!(height_error(&r) < 1.0, "{round}: {}", height_error(&r));
    }
}
