//! 1000 random touches of the pipe, half of them cancelled: none ends on the ground.

use sophie_control::gripper::grip_fault::GripFault;
use sophie_control::mode::{Mode, Reason};
use sophie_control::pilot::rc::ArmChoice;
use sophie_research::study::touch::{End, STAY, Touch, Touched, fly, fly_as};
use sophie_sim::parallel;
use sophie_sim::scenario::Scenario;

/// docs/lab/2026-11-24-touches.md has a longer run.
const COUNT: u64 = 1000;
/// Deepest fall of an escape, m; 0.5 is wanted.
const DROP_MAX: f64 = 0.3;

#[test]
fn no_touch_ends_on_the_ground() {
    let seeds: Vec<u64> = (1..=COUNT).collect();
    let flown: Vec<(Touch, Touched)> = parallel::each(&seeds, |&seed| {
        let touch = Touch::random(seed);
        (touch, fly(&touch).expect("the vehicle arms"))
    });
    let bad: Vec<_> = flown
        .iter()
        .filter(|(_, touched)| touched.end == End::Lost || touched.drop >= DROP_MAX)
        .collect();
    assert!(bad.is_empty(), "{bad:#?}");
    let of = |end| flown.iter().filter(|(_, t)| t.end == end).count();
    // Both ways out occur: escape, and release after a perch.
    assert!(flown.iter().filter(|(_, t)| t.escaped).count() > 200);
    assert!(of(End::Released) > 20, "{} released", of(End::Released));
}

fn central(seed: u64) -> Touch {
    Touch {
        offset: 0.01,
        lean: 0.03,
        sink: 0.2,
        sideways: 0.0,
        yaw: 0.0,
        diameter: 0.3,
        friction: 0.6,
        gust: 0.05,
        throttle: 0.3,
        cancel: f64::INFINITY,
        stay: STAY,
        seed,
    }
}

#[test]
fn a_touch_on_the_crown_perches_and_lets_go_without_an_escape() {
    for seed in 1..=20 {
        let touched = fly(&central(seed)).expect("the vehicle arms");
        assert!(
            touched.end == End::Released && !touched.escaped,
            "seed {seed}: {touched:?}"
        );
    }
}

#[test]
fn a_closing_that_is_called_off_on_the_crown_flies_away() {
    for (seed, cancel) in (1..=20).map(|i| (i, 0.3 * i as f64)) {
        let touch = Touch {
            cancel,
            ..central(seed)
        };
        let touched = fly(&touch).expect("the vehicle arms");
        assert!(
            touched.end != End::Lost && touched.drop < 0.1,
            "called off at {cancel:.1} s: {touched:?}"
        );
        assert!(
            touched.mode == Mode::Flight || touched.end == End::Released,
            "{touched:?}"
        );
    }
}

/// Called off when the belly slides already and no arm presses: a slow rise of the collective lost this one.
#[test]
fn a_closing_that_is_called_off_in_a_slide_leaves_at_once() {
    let touch = Touch {
        offset: -0.0557,
        lean: -0.0158,
        sink: 0.346,
        sideways: 0.0528,
        yaw: 0.0023,
        diameter: 0.2905,
        friction: 0.328,
        gust: 0.037,
        throttle: 0.29,
        cancel: 0.695,
        stay: STAY,
        seed: 1209,
    };
    let touched = fly(&touch).expect("the vehicle arms");
    assert!(
        touched.escaped && touched.end == End::Away && touched.drop < 0.3,
        "{touched:?}"
    );
}

/// Once 0.37 to 0.58 m deep, or with a propeller in the pipe. The first four fell beside it under the pilot's throttle (in the
/// third and fourth the switch was off already, the fifth got his throttle back only within 0.5 s); the last two slid off
/// with arms bent by 90 to 106°, which carry nothing until they are open.
#[test]
fn what_falls_beside_the_pipe_is_caught_with_its_propellers_clear() {
    for (offset, lean, sink, sideways, heading, diameter, friction, gust, throttle, cancel, seed, drop) in [
        (
            -0.1389, -24.11f64, 0.113, -0.218, 2.94f64, 0.390, 0.784, 0.088, 0.236, 1.480, 1891, 0.15,
        ),
        (
            -0.1035,
            -20.27,
            0.071,
            -0.172,
            4.88,
            0.216,
            0.358,
            0.083,
            0.282,
            f64::INFINITY,
            767,
            0.15,
        ),
        (
            0.1124, 11.67, 0.082, 0.238, -4.32, 0.322, 0.615, 0.006, 0.256, 0.147, 579, 0.2,
        ),
        (
            -0.1010, -4.82, 0.131, 0.179, -4.36, 0.296, 0.525, 0.078, 0.189, 0.272, 1073, 0.2,
        ),
        (
            0.1048,
            -18.99,
            0.180,
            -0.202,
            -2.69,
            0.319,
            0.300,
            0.041,
            0.341,
            f64::INFINITY,
            1543,
            0.25,
        ),
        (
            0.0747,
            2.35,
            0.081,
            0.009,
            3.35,
            0.400,
            0.600,
            0.1,
            0.300,
            f64::INFINITY,
            1200,
            0.3,
        ),
        (
            0.0345,
            -1.88,
            0.092,
            0.001,
            -4.98,
            0.200,
            0.600,
            0.1,
            0.300,
            f64::INFINITY,
            708,
            0.15,
        ),
    ] {
        let touch = Touch {
            offset,
            lean: lean.to_radians(),
            sink,
            sideways,
            yaw: heading.to_radians(),
            diameter,
            friction,
            gust,
            throttle,
            cancel,
            ..central(seed)
        };
        let touched = fly(&touch).expect("the vehicle arms");
        assert!(
            touched.end == End::Away && touched.drop < drop && touched.clearance > 0.0,
            "seed {seed}: {touched:?}"
        );
    }
}

/// Headed 12 to 19° off the pipe: touches that once ended on the ground, for the lean watch knew roll alone (the first), and for
/// the vehicle rose with arms still bent by up to 146° round the pipe, which hooked it and turned it (the others).
#[test]
fn touches_headed_off_the_pipe_are_left_without_a_fall() {
    for (offset, lean, sink, sideways, heading, diameter, friction, seed) in [
        (-0.0442, -1.0f64, 0.125, -0.025, 12.4f64, 0.300, 0.30, 3043),
        (0.0304, -25.0, 0.557, 0.007, 15.5, 0.202, 0.75, 69),
        (-0.0124, 0.0, 0.08, 0.01, -19.0, 0.200, 0.60, 618),
        (-0.0669, -0.6, 0.176, 0.001, -19.2, 0.400, 0.60, 350),
    ] {
        let touch = Touch {
            offset,
            lean: lean.to_radians(),
            sink,
            sideways,
            yaw: heading.to_radians(),
            diameter,
            friction,
            gust: 0.1,
            ..central(seed)
        };
        let touched = fly(&touch).expect("the vehicle arms");
        assert!(
            touched.end == End::Away && touched.drop < 0.3,
            "seed {seed}: {touched:?}"
        );
    }
}

/// Offset (m), lean (degrees, to the same side), sink and sideways speed (m/s, outward) of touches that flights of the
/// default mission once failed with (docs/lab/2026-11-24-missions.md): planted 5 cm beside the crown, where an arm struck the flank while
/// the vehicle slid (seeds 100263 and 100858), and slid off before an arm closed (seed 770011 at 8 %).
const ONCE_FAILED: [(f64, f64, f64, f64); 6] = [
    (0.050, 2.0, 0.25, 0.00),
    (-0.052, -3.0, 0.25, 0.02),
    (0.017, 1.0, 0.25, 0.11),
    (-0.035, -2.0, 0.25, 0.08),
    (0.050, 3.0, 0.25, 0.05),
    (-0.069, -3.0, 0.25, 0.02),
];
/// What the judge allows an arm that closes, and one that bumps into the pipe, Pa.
const CLOSING_MAX: f64 = 1500.0;
const BUMP_MAX: f64 = 3000.0;

#[test]
fn touches_that_once_failed_hold_or_are_flown_away_from() {
    for (i, (offset, lean, sink, outward)) in ONCE_FAILED.into_iter().enumerate() {
        for seed in 1..=3 {
            let touch = Touch {
                offset,
                lean: lean.to_radians(),
                sink,
                sideways: outward.copysign(offset),
                gust: 0.1,
                ..central(seed)
            };
            let touched = fly(&touch).expect("the vehicle arms");
            let what = format!("{i}, seed {seed}: {touched:?}");
            assert!(touched.end != End::Lost && touched.drop < DROP_MAX, "{what}");
            assert!(touched.pressure < BUMP_MAX, "{what}");
            assert!(
                !touched.proven || touched.closing_pressure < CLOSING_MAX,
                "{what}"
            );
            assert!(touched.proven || touched.mode == Mode::Flight, "{what}");
        }
    }
}

/// Headed across a pipe of 0.3 m: what an oblique one presses is refused, and one lengthwise lets go again.
#[test]
fn an_oblique_pipe_is_no_grip_and_the_reason_is_named() {
    for (heading, proven, why) in [
        (-5.0f64, true, None),
        (5.0, true, None),
        (20.0, false, Some(Reason::PipeOblique)),
        (-26.0, false, Some(Reason::PipeOblique)),
        (30.0, false, Some(Reason::PipeOblique)),
        // The arms lie along the pipe: nothing stops them where they feel something.
        (90.0, false, Some(Reason::ArmFault(Some(GripFault::Unfelt)))),
    ] {
        let touch = Touch {
            yaw: heading.to_radians(),
            offset: 0.0,
            ..central(7)
        };
        let touched = fly(&touch).expect("the vehicle arms");
        let end = if proven { End::Released } else { End::Away };
        assert!(
            touched.proven == proven && touched.end == end && touched.drop < 0.1,
            "{heading}: {touched:?}"
        );
        assert_eq!(touched.why, why, "{heading}: {touched:?}");
    }
}

/// Friction falls to what a vehicle beside the crown is no longer held by: tightened arms let go into a lift-off.
#[test]
fn a_grip_that_has_slipped_lets_go_without_a_fall() {
    let mut tightened = 0;
    for (offset, least) in [
        (0.0, 0.22),
        (0.03, 0.22),
        (0.03, 0.27),
        (0.045, 0.32),
        (-0.03, 0.25),
    ] {
        for seed in 1..=3 {
            let touch = Touch {
                offset,
                lean: 0.0,
                sink: 0.15,
                gust: 0.1,
                stay: 10.0,
                ..central(seed)
            };
            let mut perched = None;
            let mut shown = Vec::new();
            let touched = fly_as(Scenario::default_mission(), &touch, |t, plant, stack| {
                let Some(status) = stack.links.status.latest().map(|s| s.value) else {
                    return;
                };
                if status.mode == Mode::Perched {
                    perched.get_or_insert(t);
                }
                if let Some(since) = perched.map(|from| t - from) {
                    plant.wet((0.5 - 0.04 * (since - 1.0).max(0.0)).max(least));
                }
                if let Some(why) = status.reason.filter(|why| shown.last() != Some(why)) {
                    shown.push(why);
                }
            })
            .expect("the vehicle arms");
            let what = format!("{offset} m, friction {least}, seed {seed}: {touched:?} {shown:?}");
            assert!(touched.proven && touched.end == End::Released, "{what}");
            // What was tightened leaves at once, and says so; the others slide as the rotors spool up, and once fell 0.67 m.
            let answered = shown.contains(&Reason::TightensOnce);
            assert!(touched.drop < 0.2, "{what}");
            assert!(
                !answered || touched.escaped && shown.contains(&Reason::LiftsOff),
                "{what}"
            );
            tightened += u32::from(answered);
        }
    }
    // The others stand: friction holds them, if only just.
    assert!(tightened >= 2, "{tightened} of 15");
}

/// Friction falls under a perched vehicle 30 mm beside the crown: the arms tighten, and it stays.
#[test]
fn a_slip_is_answered_by_tightening_and_held() {
    answered_and_held(ArmChoice::All);
}

/// A pair rocks twice as far before that is a slip; sliding, it is noticed all the same.
#[test]
fn so_is_that_of_a_pair() {
    answered_and_held(ArmChoice::Front);
}

fn answered_and_held(arms: ArmChoice) {
    let scenario = Scenario {
        arms,
        ..Scenario::default_mission()
    };
    let touch = Touch {
        offset: 0.03,
        lean: 0.0,
        sink: 0.15,
        gust: 0.0,
        stay: 18.0,
        ..central(7)
    };
    let (mut perched, mut before, mut after) = (None, 0.0f64, 0.0f64);
    let mut shown = Vec::new();
    let touched = fly_as(scenario, &touch, |t, plant, stack| {
        let Some(status) = stack.links.status.latest().map(|s| s.value) else {
            return;
        };
        if status.mode != Mode::Perched {
            return;
        }
        let since = t - *perched.get_or_insert(t);
        plant.wet((0.45 - 0.02 * (since - 1.0).max(0.0)).max(0.22));
        let lean = plant.euler()[0].to_degrees();
        if since < 1.0 {
            before = lean;
        } else if since > 16.0 {
            after = after.max(lean);
        }
        if let Some(why) = status.reason.filter(|why| shown.last() != Some(why)) {
            shown.push(why);
        }
    });
    assert!(touched.is_some_and(|t| t.proven), "{touched:?}");
    assert!(
        before > 8.0 && after < before + 4.0,
        "{before:.1}, then {after:.1} deg: {shown:?}"
    );
    assert!(
        shown.starts_with(&[Reason::TightensOnce, Reason::TightensLast]),
        "{shown:?}"
    );
}
