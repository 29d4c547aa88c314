//! Random touches of the pipe: counts that end perched, away, or on the ground.
//!
//! `cargo run --release -p sophie-research --example touches -- [FIRST_SEED [COUNT]]` prints the table of docs/results.md.

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use sophie_research::study::touch::{End, Touch, Touched, fly};
use sophie_sim::parallel;

fn main() {
    let mut args = std::env::args()
        .skip(1)
        .map(|a| a.parse::<u64>().expect("a number"));
    let first = args.next().unwrap_or(1);
    let count = args.next().unwrap_or(1000);
    let seeds: Vec<u64> = (first..first + count).collect();
    let flown: Vec<(Touch, Touched)> = parallel::each(&seeds, |&seed| {
        let touch = Touch::random(seed);
        (touch, fly(&touch).expect("the vehicle arms"))
    });
    for end in [End::Perched, End::Released, End::Away, End::Lost] {
        let of: Vec<_> = flown.iter().filter(|(_, t)| t.end == end).collect();
        let most = |f: fn(&Touched) -> f64| of.iter().map(|(_, t)| f(t)).fold(0.0, f64::max);
        println!(
            "{end:?}: {} of {}, {} escapes, drop {:.2} m, lean {:.0} deg, pressure {:.0} N/m2",
            of.len(),
            flown.len(),
            of.iter().filter(|(_, t)| t.escaped).count(),
            most(|t| t.drop),
            most(|t| t.lean).to_degrees(),
            most(|t| t.pressure),
        );
    }
    for (touch, touched) in flown.iter().filter(|(_, t)| t.end == End::Lost) {
        println!("lost: {touch:?} {touched:?}");
    }
}
