//! The friction that a builder finds by drawing a sled along the simulated pipe with a luggage scale.

use sophie_fit::friction;
use sophie_fit::friction_data::Pull;
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::sled::drawn;

const GRAVITY: f64 = 9.806_65;

/// What a builder writes down of twelve pulls: loads by a kitchen scale to 1 g and 0.5 %, pulls by a luggage scale to
/// 10 g and 1 %, that swing by 5 % in his hand.
fn pulls(kinetic: f64, static_share: f64, streams: Streams) -> Vec<Pull> {
    let within = |what: &str, half: f64| streams.within(what, -half, half);
    let (kitchen, luggage) = (1.0 + within("kitchen", 0.005), 1.0 + within("luggage", 0.01));
    let mut rows = Vec::new();
    for grams in [500.0, 1000.0, 1500.0] {
        let shown = (grams * kitchen + within(&format!("load {grams}"), 0.5)).round();
        for pull in 0..2 {
            let (most, last) = drawn(kinetic, static_share, 1e-3 * grams * GRAVITY);
            let read = |what: &str, newton: f64| {
                let swings = 1.0 + within(&format!("{what} {grams} {pull}"), 0.05);
                (newton / GRAVITY * luggage * swings * 100.0).round() / 100.0 * GRAVITY
            };
            rows.push(Pull {
                load: 1e-3 * shown * GRAVITY,
                sliding: read("slides", last),
                starting: Some(read("starts", most)),
                wet: false,
            });
        }
    }
    rows
}

/// The error of docs/uncertainty.md.
#[test]
fn the_sliding_friction_of_drawn_pipes_is_found_within_its_interval() {
    let count = 1000;
    let (mut off, mut within, mut sticks) = (Vec::new(), 0, 0);
    for seed in 0..count {
        let streams = Streams::new(seed);
        let kinetic = streams.within("friction", 0.2, 0.8);
        let share = streams.within("static", 1.0, 1.5);
        let surfaces = friction::fit(&pulls(kinetic, share, streams)).unwrap();
        let found = surfaces[0].sliding;
        off.push(found.value / kinetic - 1.0);
        within += i32::from((found.value - kinetic).abs() <= found.half);
        let starts = surfaces[0].sticking.unwrap();
        sticks += i32::from((starts.value - kinetic * share).abs() <= starts.half);
    }
    off.sort_by(f64::total_cmp);
    let [least, most] = [0.025, 0.975].map(|share| off[((off.len() - 1) as f64 * share) as usize]);
    println!("{within} {sticks} of {count}: {least} {most}");
    assert!(
        (0.93..0.99).contains(&(f64::from(within) / count as f64)),
        "{within}"
    );
    assert!(
        (0.93..0.99).contains(&(f64::from(sticks) / count as f64)),
        "{sticks}"
    );
    assert!(
        (-0.08..-0.05).contains(&least) && (0.05..0.08).contains(&most),
        "{least} {most}"
    );
}
