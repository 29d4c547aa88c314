//! 1000 random touches of the pipe, half of them cancelled: none ends on the ground.

use sophie_control::mode::Mode;
use sophie_paper::study::touch::{End, Touch, Touched, fly};
use sophie_sim::parallel;

/// docs/results.md has a longer run.
const COUNT: u64 = 1000;
/// Deepest fall of an escape, m.
const DROP_MAX: f64 = 0.5;

#[test]
fn no_touch_ends_on_the_ground() {
    let seeds: Vec<u64> = (1..=COUNT).collect();
    let flown: Vec<(Touch, Touched)> = parallel::each(&seeds, |&seed| {
        let touch = Touch::random(seed);
        (touch, fly(&touch).expect("the vehicle arms"))
    });
    for (touch, touched) in &flown {
        assert!(touched.end != End::Lost, "{touch:?}\n{touched:?}");
        assert!(touched.drop < DROP_MAX, "{touch:?}\n{touched:?}");
    }
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
