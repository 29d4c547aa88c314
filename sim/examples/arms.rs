//! The two models of an arm side by side: bending by thrust and by tendon, modes, and what a tendon takes on a pipe
//! (`cargo run --release -p sophie-sim --example arms`).

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use glam::{DQuat, DVec3};
use sophie_sim::plant::arm::ArmSpec;
use sophie_sim::plant::beam::{BeamArm, BeamSpec, Masses};
use sophie_sim::plant::body::{BodySpec, Load};
use sophie_sim::plant::contact::{BELLY_Z, Pipe, Pose};
use sophie_sim::plant::flexible::{Acceleration, Carrier, Drive, Flexible, Nearby};
use sophie_sim::plant::hinged::HingedArm;
use sophie_sim::plant::tendon::TendonSpec;
use sophie_sim::plant::{GRAVITY, STEP};
use sophie_sim::scenario::ArmBending;

/// Damping ratio: an arm comes to rest soon.
const DAMPING: f64 = 0.8;
/// Time to rest, s, of which the tendon rises in the first half.
const REST: f64 = 4.0;
/// Grip pressure, Pa.
const GRIP: f64 = 950.0;
const POSE: Pose = Pose {
    position: DVec3::ZERO,
    attitude: DQuat::IDENTITY,
    velocity: DVec3::ZERO,
    omega: DVec3::ZERO,
};

/// An arm under test.
#[derive(Clone, Copy)]
struct Tried {
    bending: ArmBending,
    infill: f64,
    lever: f64,
}

/// At rest.
struct Rested {
    /// °.
    tilt: f64,
    /// Pa.
    pressure: f64,
}

impl Tried {
    fn arm(&self) -> Box<dyn Flexible> {
        let spec = ArmSpec::new(self.infill, 7.75, 1.0, 0.0, DAMPING);
        match self.bending {
            ArmBending::Hinge => Box::new(HingedArm::new(2, spec)),
            ArmBending::Beam => {
                let masses = Masses::of(&BodySpec::default());
                Box::new(BeamArm::new(2, BeamSpec::of(&spec, masses, DAMPING)))
            }
        }
    }

    fn rest(&self, thrust: f64, force: f64, pipe: Option<Pipe>) -> Rested {
        let mut arm = self.arm();
        let bench = Carrier {
            omega: DVec3::ZERO,
            gravity: DVec3::new(0.0, 0.0, GRAVITY),
            coupled: false,
        };
        let held = Acceleration {
            linear: DVec3::ZERO,
            angular: DVec3::ZERO,
        };
        let nearby = Nearby { pipe, ground: false };
        let steps = (REST / STEP) as u32;
        let mut pressure = 0.0;
        for i in 0..steps {
            let share = (2.0 * f64::from(i) / f64::from(steps)).min(1.0);
            let drive = Drive {
                dt: STEP,
                thrust,
                tendon: -self.lever * force * share,
                ..Drive::default()
            };
            pressure = arm.touch(STEP, &POSE, &nearby, &mut Load::default());
            arm.drive(&drive, &bench, &mut Load::default());
            arm.advance(STEP, &held, &bench);
        }
        Rested {
            tilt: arm.tilt().to_degrees(),
            pressure,
        }
    }

    /// Force (N) that presses with [`GRIP`].
    fn grips(&self, thrust: f64, diameter: f64) -> f64 {
        let (mut low, mut high) = (0.0, 200.0);
        for _ in 0..18 {
            let middle = 0.5 * (low + high);
            if self.rest(thrust, middle, Some(pipe(diameter))).pressure < GRIP {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    fn print(&self) {
        let name = match self.bending {
            ArmBending::Hinge => "hinge",
            ArmBending::Beam => "beam",
        };
        println!(
            "{name}, infill {} %, lever {:.0} mm",
            self.infill,
            1e3 * self.lever
        );
        let free = self.rest(0.0, 10.0, None).tilt - self.rest(0.0, 20.0, None).tilt;
        println!("  free arm by tendon        {:.3} deg/N", free / 10.0);
        for diameter in [0.2, 0.3, 0.4] {
            let (still, turning) = (self.grips(0.0, diameter), self.grips(2.5, diameter));
            let held = self.rest(0.0, still, Some(pipe(diameter)));
            let more = self.rest(0.0, still + 1.0, Some(pipe(diameter)));
            println!(
                "  on {diameter} m: {still:.1} N stopped ({:.2} kgcm, {:.1} deg), {turning:.1} N at 2.5 N; {:.2} N/N, \
                 {:.0} Pa/N, on pipe over free {:.2}",
                still * 0.015 * 10.197,
                held.tilt,
                (turning - still) / 2.5,
                more.pressure - held.pressure,
                (held.tilt - more.tilt) / (free / 10.0),
            );
        }
    }
}

/// Belly on the pipe's crown: pads 30 mm beside it, 0.6 mm deep.
fn pipe(diameter: f64) -> Pipe {
    let radius = 0.5 * diameter;
    Pipe {
        north: 0.0,
        half_length: 1.0,
        east: 0.0,
        down: BELLY_Z + (radius * radius - 0.03 * 0.03).sqrt() - 0.6e-3,
        radius,
        friction: 0.0,
    }
}

fn main() {
    for infill in [6.0, 6.9, 8.0] {
        for bending in [ArmBending::Hinge, ArmBending::Beam] {
            let lever = TendonSpec::of(bending).lever;
            Tried {
                bending,
                infill,
                lever,
            }
            .print();
        }
    }
    let beam = BeamSpec::of(
        &ArmSpec::new(6.9, 7.75, 1.0, 0.0, 0.15),
        Masses::of(&BodySpec::default()),
        0.15,
    );
    for thrust in [1.0, 4.425] {
        let [first, second] = beam.modes(thrust);
        println!("beam, infill 6.9 %, {thrust} N: {first:.2} and {second:.1} Hz");
    }
}
