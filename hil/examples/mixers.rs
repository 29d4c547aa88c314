//! What each allocation costs in yaw tracking: hover in gusts, arms matched and mismatched, over the yaw gain.
//!
//! `cargo run --release -p sophie-hil --example mixers` prints the table of docs/results.md.

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

#[path = "../tests/rig/mod.rs"]
mod rig;

use rig::{Rig, level, vehicle};
use sophie_control::mixer::Variant::{self, Flexible, Frozen, Paper, Rigid};
use sophie_control::wrench::Configuration::{self, A, B};

/// Hover of 40 s in gusts of 0.35 N and 0.015 N·m RMS, with the yaw gain `gain` (1/s).
fn hover(configuration: Configuration, gain_k: f64, mixer: Variant, gain: f32, mismatched: bool) -> String {
    let mut s = vehicle(configuration, gain_k, 6.9, mixer);
    s.world.gust_force = 0.35;
    s.world.gust_moment = 0.015;
    if mismatched {
        s.vehicle.arm_gain = [1.15, 0.85, 0.9, 1.1];
        s.vehicle.arm_offset = [3.0, -3.0, 2.0, -2.0].map(f64::to_radians);
    }
    s.params.rate_yaw_p = gain;
    s.params.rate_yaw_i = 0.5 * gain;
    let e = Rig::new(&s).fly(40.0, level);
    if e.worst_yaw > 60.0 {
        "lost".to_owned()
    } else {
        format!("{:.2}° / {:.2} N", e.rms_yaw, e.swing)
    }
}

fn main() {
    println!("yaw RMS / swing of rotor 1; seed 1, ρ 6.9 %, gusts 0.35 N and 0.015 N·m RMS, 35 s of hover\n");
    println!("| configuration | K | mixer | yaw gain 1/s | matched arms | mismatched arms |");
    println!("|---|---|---|---|---|---|");
    for (configuration, gain_k) in [(B, 7.75), (B, 1.0), (A, 7.75), (A, 1.0)] {
        for (mixer, gains) in [
            (Flexible, &[3.0, 6.0, 10.0][..]),
            (Rigid, &[0.61, 3.0, 6.0]),
            (Paper, &[0.61, 3.0]),
            (Frozen, &[3.0]),
        ] {
            for gain in gains {
                let cell = |mismatched| hover(configuration, gain_k, mixer, *gain, mismatched);
                println!(
                    "| {configuration:?} | {gain_k} | {mixer:?} | {gain} | {} | {} |",
                    cell(false),
                    cell(true)
                );
            }
        }
    }
}
