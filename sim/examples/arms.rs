//! Effect of the tendon on a bending arm, free and on a pipe, over infill and lever; bending modes; and the example
//! bench data of docs/paper.md (`cargo run --release -p sophie-sim --example arms [-- bench]`).

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use sophie_sim::plant::beam::rest::{DAMPING, SlowArm, pipe_under};
use sophie_sim::plant::beam::{BeamSpec, Masses, TENDON_LEVER};
use sophie_sim::plant::body::BodySpec;
use sophie_sim::plant::hinged::link::ArmSpec;

/// Grip pressure, Pa.
const GRIP: f64 = 950.0;
/// Radius of the reel, m, and kgcm per N·m.
const REEL: f64 = 0.015;
const KGCM: f64 = 10.197;
/// Time to rest under a new force, s.
const REST: f64 = 2.0;
/// Thrust of a closing, N.
const CLOSING: f64 = 2.5;
const INFILLS: [f64; 3] = [6.0, 6.9, 8.0];

/// An arm under test.
#[derive(Clone, Copy)]
struct Tried {
    infill: f64,
    lever: f64,
}

impl Tried {
    fn arm(&self, thrust: f64, diameter: Option<f64>) -> SlowArm {
        let print = ArmSpec::new(self.infill, 7.75, 1.0, 0.0, DAMPING);
        let beam = BeamSpec::of(&print, Masses::of(&BodySpec::default()), DAMPING);
        let pipe = diameter.map(|d| pipe_under(0.5 * d, 0.0));
        SlowArm::new(2, beam, self.lever, thrust, pipe)
    }

    /// Force (N) that presses with `pressure` Pa.
    fn presses(&self, thrust: f64, diameter: f64, pressure: f64) -> f64 {
        self.arm(thrust, Some(diameter))
            .pull_to(pressure)
            .unwrap_or(f64::NAN)
    }

    /// Tilt (°) and pressure (Pa) at rest under `force` N, reached without a bounce.
    fn rests(&self, thrust: f64, diameter: Option<f64>, force: f64) -> (f64, f64) {
        let mut arm = self.arm(thrust, diameter);
        for share in 1..=20 {
            arm.hold(force * f64::from(share) / 20.0, 0.2);
        }
        arm.hold(force, REST);
        (arm.tilt().to_degrees(), arm.pressure)
    }

    /// °/N.
    fn free(&self) -> f64 {
        (self.rests(0.0, None, 10.0).0 - self.rests(0.0, None, 20.0).0) / 10.0
    }

    fn print(&self) {
        println!("infill {} %, lever {:.1} mm", self.infill, 1e3 * self.lever);
        let free = self.free();
        println!("  free arm by tendon        {free:.3} deg/N");
        for diameter in [0.2, 0.3, 0.4] {
            let still = self.presses(0.0, diameter, GRIP);
            let turning = self.presses(CLOSING, diameter, GRIP);
            let (tilt, pressure) = self.rests(0.0, Some(diameter), still);
            let (more_tilt, more) = self.rests(0.0, Some(diameter), still + 1.0);
            println!(
                "  on {diameter} m: {still:.1} N stopped ({:.2} kgcm, {tilt:.1} deg), {turning:.1} N at {CLOSING} N \
                 ({:.2} kgcm); {:.2} N/N, {:.0} Pa/N, on pipe over free {:.2}",
                still * REEL * KGCM,
                turning * REEL * KGCM,
                (turning - still) / CLOSING,
                more - pressure,
                (tilt - more_tilt) / free,
            );
        }
    }

    /// Rows as a person with spring scales would write them.
    fn bench(&self) {
        for force in [5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0] {
            let (tilt, _) = self.rests(0.0, None, force);
            println!("{},{force:.1},0.0,{tilt:.1},0", self.infill);
        }
        for thrust in [0.0, 1.5, 3.0] {
            for pressure in [800.0, 950.0, 1100.0] {
                let force = (2.0 * self.presses(thrust, 0.3, pressure)).round() / 2.0;
                let (tilt, pressure) = self.rests(thrust, Some(0.3), force);
                println!("{},{force:.1},{thrust:.1},{tilt:.1},{pressure:.0}", self.infill);
            }
        }
    }
}

fn main() {
    if std::env::args().nth(1).as_deref() == Some("bench") {
        println!("# Of the simulated beam, lever 15 mm, pipe of 0.3 m: forces to 0.5 N, tilts to 0.1 deg.");
        println!("infill_percent,force_n,thrust_n,tilt_deg,pressure_pa");
        for infill in INFILLS {
            let lever = TENDON_LEVER;
            Tried { infill, lever }.bench();
        }
        return;
    }
    for infill in INFILLS {
        for lever in [0.0125, TENDON_LEVER, 0.020, 0.025] {
            Tried { infill, lever }.print();
        }
    }
    let print = ArmSpec::new(6.9, 7.75, 1.0, 0.0, 0.15);
    let beam = BeamSpec::of(&print, Masses::of(&BodySpec::default()), 0.15);
    for thrust in [1.0, 4.425] {
        let [first, second] = beam.modes(thrust);
        println!("infill 6.9 %, {thrust} N: {first:.2} and {second:.1} Hz");
    }
}
