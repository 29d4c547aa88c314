//! Beyond the paper: every mixer over infill, gain and configuration; arm sensor gain; the softest airframe.

mod configuration_a;
mod grid;
mod sensors;
mod soft;

use crate::study::rig::Demand;
use glam::DVec3;
use sophie_control::allocation::wrench::Configuration;
use sophie_control::params::Params;
use sophie_sim::scenario::Scenario;

use super::printed::Printed;
use crate::results::model::Section;
use grid::{FAIR, FLEXIBLE, Grid, Job, PAPER, RIGID, SIGN_AWARE};

/// Compliance of real arms over the model's.
const ARM_GAIN: [f64; 4] = [1.15, 0.85, 0.9, 1.1];
/// Tilt of real arms less the model's, degrees.
const ARM_OFFSET: [f64; 4] = [3.0, -3.0, 2.0, -2.0];

fn mismatch(s: &mut Scenario) {
    s.vehicle.arm_gain = ARM_GAIN;
    s.vehicle.arm_offset = ARM_OFFSET.map(f64::to_radians);
}

/// In 20 s: hover in gusts, a roll of 15° to either side, a turn of 30°, a push of 1.5 N.
fn programme(t: f64) -> Demand {
    let mut demand = Demand::default();
    match t {
        t if (4.0..5.5).contains(&t) => demand.roll = 15f64.to_radians(),
        t if (5.5..7.0).contains(&t) => demand.roll = -15f64.to_radians(),
        t if (10.0..11.05).contains(&t) => demand.yaw_rate = 0.5,
        t if (14.0..16.0).contains(&t) => demand.push = DVec3::new(0.0, 1.5, 0.0),
        _ => {}
    }
    demand
}

/// Beyond the paper.
pub fn section(p: &Printed) -> Section {
    let mut s = Section::new("beyond", "Beyond the paper: who flies what");
    let k = f64::from(Params::default().gain_k);
    s.text(
        "One programme for all: hover in gusts of 0.35 N and 0.015 N·m RMS, a roll to 15° on either side, a turn of 30°, a \
         sideways push of 1.5 N for 2 s. Gains are those of the stack, the same for every mixer; in B the rigid mixer's yaw \
         commands come out 1 - C times larger, so its tighter yaw is a higher gain, not a better allocation: the third mixer \
         is the rigid one with its yaw gain divided by that. Errors of yaw are against the heading that was asked for, also \
         where a stack has given yaw up.",
    );
    let grid = Grid::fly(k);
    s.table(grid.tracking(k));
    grid.maps(&mut s);
    sensors::compare(&mut s, k);
    soft::explore(&mut s, p, k);
    configuration_a::explain(&mut s, p, k);
    s.finding = finding(&grid, p.text.infill_percent, k);
    s
}

/// Cases flown by each mixer, and the cost of mismatched arms.
fn finding(grid: &Grid, infill: f64, k: f64) -> String {
    let kept = |configuration, mixer| grid.kept(configuration, mixer);
    let yaw = |mixer: usize, mismatched: bool| {
        let job = Job {
            configuration: Configuration::B,
            infill,
            gain_k: k,
            mixer,
            mismatched,
        };
        grid.of(job)
            .and_then(|f| f.yaw)
            .map_or("lost".to_owned(), |e| format!("{e:.1}°"))
    };
    format!(
        "In B every mixer flies every infill from 4 % on: {}, {}, {} and {} cases of the map for rigid, paper, rigid at the \
         same true gain, flexible. Mismatched arms take yaw from {} to {} for the rigid mixer at the same true gain and from \
         {} to {} for the flexible one. In A rigid, paper and flexible keep {}, {} and {}; an allocation that knows where yaw \
         authority has turned round keeps {}.",
        kept(Configuration::B, RIGID),
        kept(Configuration::B, PAPER),
        kept(Configuration::B, FAIR),
        kept(Configuration::B, FLEXIBLE),
        yaw(FAIR, false),
        yaw(FAIR, true),
        yaw(FLEXIBLE, false),
        yaw(FLEXIBLE, true),
        kept(Configuration::A, RIGID),
        kept(Configuration::A, PAPER),
        kept(Configuration::A, FLEXIBLE),
        kept(Configuration::A, SIGN_AWARE)
    )
}
