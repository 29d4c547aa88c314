//! Tracking of each allocation in docs/lab/2026-11-23-allocation.md: hover in gusts with matched and mismatched arms over the yaw gain,
//! and whole missions (`cargo run --release -p sophie-sim --example mixers`).

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use sophie_control::allocation::wrench::Configuration::{self, A, B};
use sophie_control::mode::Mode;
use sophie_sim::flight::fly;
use sophie_sim::mixers::Variant::{self, Flexible, Frozen, Paper, Rigid};
use sophie_sim::record::{Sample, Silent};
use sophie_sim::test_stands::flight_level::{Rig, level, vehicle};

const SEEDS: u64 = 10;

/// Hover of 40 s in gusts of 0.35 N and 0.015 N·m RMS; yaw gain in 1/s.
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

fn rms(samples: &[&Sample], axis: usize) -> f64 {
    let square = |s: &&Sample| {
        let error = s.attitude[axis] - s.attitude_setpoint[axis];
        let error = libm::atan2(libm::sin(error), libm::cos(error));
        error * error
    };
    (samples.iter().map(square).sum::<f64>() / samples.len().max(1) as f64)
        .sqrt()
        .to_degrees()
}

/// The default mission over the seeds: number accomplished, tracking in free flight.
fn missions(configuration: Configuration, gain_k: f64, mixer: Variant) {
    let mut s = vehicle(configuration, gain_k, 6.9, mixer);
    let (mut accomplished, mut tracking, mut reason) = (0, [0.0; 3], String::new());
    for seed in 1..=SEEDS {
        s.seed = seed;
        let record = fly(&s, &mut Silent);
        let flown = |s: &&Sample| {
            s.mode == Mode::Flight && s.attitude_setpoint[0].is_finite() && s.position[2] < -0.5
        };
        let samples: Vec<&Sample> = record.samples.iter().filter(flown).collect();
        for (axis, sum) in tracking.iter_mut().enumerate() {
            *sum += rms(&samples, axis) / SEEDS as f64;
        }
        if record.outcome.accomplished {
            accomplished += 1;
        } else {
            reason = record.outcome.reason;
        }
    }
    let [roll, pitch, yaw] = tracking.map(|rms| {
        if accomplished > 0 {
            format!("{rms:.2}°")
        } else {
            "-".to_owned()
        }
    });
    println!(
        "| {configuration:?} | {gain_k} | {mixer:?} | {accomplished}/{SEEDS} | {roll} | {pitch} | {yaw} | {reason} |"
    );
}

fn main() {
    println!("default mission, seeds 1 to {SEEDS}, RMS of setpoint less truth in free flight\n");
    println!("| configuration | K | mixer | accomplished | roll | pitch | yaw | last reason |");
    println!("|---|---|---|---|---|---|---|---|");
    for mixer in [Flexible, Rigid, Paper, Frozen] {
        missions(B, 7.75, mixer);
    }
    for mixer in [Flexible, Rigid, Paper] {
        missions(A, 7.75, mixer);
    }
    println!();
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
