//! Stability margins (docs/results.md): the roll loop on the pipe; and for each allocation the yaw loop over its gain
//! and over arms that differ from the stack's model, with the heading error at the gain that the worst arms allow
//! (`cargo run --release -p sophie-sim --example margins`).

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use std::f64::consts::TAU;

use sophie_control::allocation::wrench::Configuration::{self, A, B};
use sophie_control::params::Params;
use sophie_sim::check::loops::{
    Hovering, Laws, Margins, Place, Response, margins, margins_of, resting_margins, slide,
};
use sophie_sim::mixers::Variant::{self, Flexible, Rigid};
use sophie_sim::parallel;
use sophie_sim::scenario::Scenario;
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::flight_level::{Rig, level, vehicle};

/// Number of mismatched arms tried, besides the matched ones.
const ARMS: u64 = 40;
/// Largest errors: of the arms' softness, share, of their tilt, degrees, and of K, share.
const SOFTNESS: f64 = 0.20;
const TILT: f64 = 3.0;
const K_ERROR: f64 = 0.15;
/// Yaw gains tried, 1/s; the integral is half, as by default.
const GAINS: [f32; 10] = [0.4, 0.61, 1.0, 1.5, 2.0, 3.0, 4.5, 6.0, 8.0, 10.0];
/// Disk margin at which the allocations are compared: a factor of 1.67 and 28 degrees at once.
const EQUAL: f64 = 0.5;
const YAW: usize = 2;

/// Sample number `sample` of mismatched arms of `nominal`; 0: matched arms.
fn mismatched(nominal: &Scenario, sample: u64) -> Scenario {
    let mut s = nominal.clone();
    if sample > 0 {
        let streams = Streams::new(sample);
        let within = |name: String, most: f64| streams.within(&name, -most, most);
        for arm in 0..4 {
            s.vehicle.arm_gain[arm] = 1.0 + within(format!("arm gain {arm}"), SOFTNESS);
            s.vehicle.arm_offset[arm] = within(format!("arm offset {arm}"), TILT).to_radians();
        }
        s.vehicle.gain_k *= 1.0 + within("K".to_owned(), K_ERROR);
    }
    s
}

fn with_gain(params: &Params, gain: f32) -> Params {
    Params {
        rate_yaw_p: gain,
        rate_yaw_i: 0.5 * gain,
        ..*params
    }
}

/// Margin of the matched arms, and the least of all samples.
struct Row {
    nominal: Margins,
    worst: f64,
}

fn rows(nominal: &Scenario, responses: &[Response]) -> Vec<Row> {
    GAINS
        .iter()
        .map(|gain| {
            let laws = Laws::of(&with_gain(&nominal.params, *gain));
            let margins: Vec<Margins> = responses.iter().map(|r| margins_of(r, &laws, YAW)).collect();
            Row {
                nominal: margins[0],
                worst: margins.iter().map(|m| m.disk).fold(f64::INFINITY, f64::min),
            }
        })
        .collect()
}

/// RMS heading error in the gusts of the mixers' table, degrees, and the swing of rotor 1, N; `None` for a lost
/// vehicle.
fn hover(s: &Scenario, gain: f32) -> Option<(f64, f64)> {
    let mut s = s.clone();
    s.world.gust_force = 0.35;
    s.world.gust_moment = 0.015;
    s.params = with_gain(&s.params, gain);
    let e = Rig::new(&s).fly(40.0, level);
    (e.worst_yaw <= 60.0).then_some((e.rms_yaw, e.swing))
}

fn compare(configuration: Configuration, gain_k: f64, mixer: Variant, samples: &[u64]) {
    let nominal = vehicle(configuration, gain_k, 6.9, mixer);
    let responses = parallel::each(samples, |sample| {
        Hovering::of(&mismatched(&nominal, *sample)).response(YAW)
    });
    let rows = rows(&nominal, &responses);
    for (gain, row) in GAINS.iter().zip(&rows) {
        println!(
            "| {configuration:?} | {gain_k} | {mixer:?} | {gain} | {:.1} | {:.0}° | {:.2} | {:.2} | {:.1} | {:.1} |",
            row.nominal.gain,
            row.nominal.phase.to_degrees(),
            row.nominal.disk,
            row.worst,
            row.nominal.crossover / TAU,
            row.nominal.critical / TAU
        );
    }
    let allowed = GAINS.iter().zip(&rows).rev().find(|(_, row)| row.worst >= EQUAL);
    let Some((gain, _)) = allowed else {
        println!("{configuration:?} K {gain_k} {mixer:?}: no gain has {EQUAL} with its worst arms");
        return;
    };
    let mut flown: Vec<_> = parallel::each(&samples[..samples.len().min(13)], |sample| {
        hover(&mismatched(&nominal, *sample), *gain)
    });
    let matched = flown.remove(0);
    let lost = flown.iter().filter(|f| f.is_none()).count();
    let worst = flown
        .iter()
        .flatten()
        .fold((0.0_f64, 0.0_f64), |most, f| (most.0.max(f.0), most.1.max(f.1)));
    let cell = |f: Option<(f64, f64)>| {
        f.map_or("lost".to_owned(), |(yaw, swing)| {
            format!("{yaw:.2}° / {swing:.2} N")
        })
    };
    println!(
        "{configuration:?} K {gain_k} {mixer:?}: gain {gain}: matched {}, worst of {} arms {}, {lost} lost",
        cell(matched),
        flown.len(),
        cell(Some(worst)),
    );
}

/// Arms that ring: margins in hover over infill and damping ratio.
fn springy() {
    println!("| infill % | damping ratio | pitch: gain, disk, at Hz | yaw: gain, disk, at Hz |");
    println!("|---|---|---|---|");
    for infill in [4.0, 5.0, 6.9, 10.0] {
        for damping in [0.02, 0.05, 0.10, 0.15] {
            let mut s = vehicle(B, 7.75, infill, Flexible);
            s.vehicle.arm_damping = damping;
            let [_, pitch, yaw] = margins(&s);
            let cell = |m: Margins| format!("{:.2}, {:.2}, {:.1}", m.gain, m.disk, m.critical / TAU);
            println!("| {infill} | {damping} | {} | {} |", cell(pitch), cell(yaw));
        }
    }
    println!();
}

/// Margins of the roll loop while the vehicle comes to rest on a pipe, and the growth rate of a slide.
fn resting(samples: &[u64]) {
    println!("| where | weight on the rotors | gain, phase, disk | worst arms: gain, disk |");
    println!("|---|---|---|---|");
    let nominal = Scenario::default_mission();
    // A bounce is over before the thrust has fallen to that of the closing.
    let places: [(Place, &[f64]); 2] = [
        (Place::Air, &[1.0, 0.9, 0.6]),
        (Place::Standing, &[0.9, 0.6, 0.375]),
    ];
    for (place, shares) in places {
        for &share in shares {
            let all = parallel::each(samples, |sample| {
                resting_margins(&mismatched(&nominal, *sample), place, share)
            });
            let least = |of: fn(&Margins) -> f64| all.iter().map(of).fold(f64::INFINITY, f64::min);
            println!(
                "| {place:?} | {share} | {:.1}, {:.0}°, {:.2} | {:.1}, {:.2} |",
                all[0].gain,
                all[0].phase.to_degrees(),
                all[0].disk,
                least(|m| m.gain),
                least(|m| m.disk),
            );
        }
    }
    println!();
    for diameter in [0.2, 0.3, 0.4] {
        let (with, without) = slide(&nominal, diameter);
        println!(
            "a slide without friction on {diameter} m grows at {with:.1} 1/s, without the loop at {without:.1} 1/s"
        );
    }
    println!();
}

fn main() {
    let samples: Vec<u64> = (0..=ARMS).collect();
    resting(&samples);
    springy();
    println!(
        "| configuration | K | mixer | yaw gain 1/s | gain margin | phase margin | disk margin | worst arms | crossover Hz | least there, Hz |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for (configuration, gain_k) in [(B, 7.75), (B, 1.0), (A, 1.0)] {
        for mixer in [Flexible, Rigid] {
            compare(configuration, gain_k, mixer, &samples);
        }
    }
}
