//! Half-hours on the pipe, flown in full and in the minute of the rule of holding: what each arm is left with.
//!
//! `cargo run --release -p sophie-research --example half_hours -- [FIRST_SEED [COUNT]]` prints the table of
//! docs/lab/2026-11-26-half-hours.md.

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use sophie_research::study::half_hour::{Hung, Pace, fly};
use sophie_sim::parallel;

fn main() {
    let mut args = std::env::args()
        .skip(1)
        .map(|a| a.parse::<u64>().expect("a number"));
    let first = args.next().unwrap_or(1);
    let count = args.next().unwrap_or(20);
    let seeds: Vec<u64> = (first..first + count).collect();
    let flown = parallel::each(&seeds, |&seed| {
        [Pace::Full, Pace::Lapse].map(|pace| fly(seed, pace))
    });
    let mut largest: f64 = 0.0;
    for (seed, both) in seeds.iter().zip(&flown) {
        let [Some(full), Some(lapse)] = both else {
            println!("{seed}: does not hang on the pipe");
            continue;
        };
        let show = |hung: &Hung| {
            format!(
                "{:.0?} Pa {:.1?} N {}",
                hung.pressure,
                hung.tension,
                if hung.accomplished { "holds" } else { &*hung.reason }
            )
        };
        println!("{seed}: before {:.0?} Pa", full.before);
        println!("    full  {}", show(full));
        println!("    lapse {}", show(lapse));
        for (full, lapse) in full.pressure.iter().zip(&lapse.pressure) {
            largest = largest.max((full - lapse).abs());
        }
    }
    println!("largest difference of a pressure: {largest:.0} Pa");
}
