//! The gripper against scripted arms.

mod all_arms;
mod ceiling_watch;
mod closing;
mod faults;
mod forces;
mod response;

use super::arm::Phase;
use super::pressure_loop::LAG_MAX;
use super::*;
use crate::maths::scalar;
use crate::params::Params;

const DT: f32 = 0.01;

fn config() -> Config {
    Config::from_params(&Params::default())
}

fn close(a: f32, b: f32, tolerance: f32) -> bool {
    (a - b).abs() <= tolerance
}

/// An arm that bends by its model, tension equal to force.
fn input(cfg: &Config, arm: &ArmGripper, pressure: f32) -> ArmInput {
    ArmInput {
        close: true,
        pressure: Pressure::Known(pressure),
        turn_on: 0.0,
        thrust: 0.0,
        tension: Some(arm.force),
        tilt: Some(scalar::clamp(-0.2 - cfg.bend_per_force * arm.force, -2.5, 0.0)),
    }
}

fn released(input: ArmInput) -> ArmInput {
    ArmInput {
        close: false,
        ..input
    }
}

fn run(arm: &mut ArmGripper, cfg: &Config, pressure: f32, seconds: f32) -> ArmGrip {
    let mut grip = ArmGrip::default();
    for _ in 0..(seconds / DT + 0.5) as u32 {
        let i = input(cfg, arm, pressure);
        grip = arm.step(cfg, &i, DT);
    }
    grip
}

fn holding(cfg: &Config) -> ArmGripper {
    let mut arm = ArmGripper::default();
    run(&mut arm, cfg, 0.0, 1.5);
    assert!(run(&mut arm, cfg, 950.0, 2.0).state == ArmState::Holding);
    arm
}
