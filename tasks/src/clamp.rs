//! The loops that close the arms on the pipe and let them go.
//!
//! Steady level, 100 Hz, to be done before the next step. What happens when an input is old:
//!
//! - the command (200 ms): forces and the last judgement are held; before the first one, what the run before left;
//! - the pressure (20 ms): that arm's force is held and it is faulty until there is one again;
//! - an arm's tilt (100 ms): its force is held, and after half a second it is faulty;
//! - the thrusts (10 ms): the motors have stopped by then, so the thrust fed forward is none;
//! - the tension (200 ms): the force asked for counts as given, and nothing is proven free.
//!
//! No force is sent before one is known: after power-on the arms may be closed, and the servos' gears hold them as long
//! as no pulse opens them.

use crate::retained_state::RetainedState;
use embassy_time::{Duration, Instant};
use sophie_control::grip_memory::GripMemory;
use sophie_control::gripper::{ArmInput, Config, Gripper, Pressure};
use sophie_control::wrench::PerArm;

use crate::deadline::{FixedRate, TaskId};
use crate::links::{ClampCommand, GripState, Links, TendonForces};

/// Time between two steps.
pub const PERIOD: Duration = Duration::from_millis(10);

/// Runs the clamp loops; never returns.
pub async fn run(links: &Links) -> ! {
    let mut rate = FixedRate::new(links, TaskId::Clamp, PERIOD, PERIOD);
    let config = Config::from_params(&links.params);
    let (mut gripper, mut forces) = begin(links.start.retained);
    let mut grip = None;
    let mut found = false;
    loop {
        let tick = rate.next().await;
        if let Some(command) = links.clamp_command.fresh() {
            let close = match command {
                ClampCommand::Release | ClampCommand::Keep => [false; 4],
                ClampCommand::Close { arms } => arms.mask(),
            };
            let out = gripper.step(&config, &inputs(links, close), tick.dt);
            let pressed = |grip: GripState| {
                let mut arms = grip.arms.iter();
                arms.any(|arm| arm.pressure > links.params.release_pressure)
            };
            let now = GripState {
                proven: out.proven,
                released: out.released,
                arms: out.arms.map(|arm| arm.grip),
            };
            grip = Some(now);
            if command == ClampCommand::Keep {
                found = pressed(now);
            } else {
                forces = Some(TendonForces {
                    force: out.arms.map(|arm| arm.grip.force),
                    found,
                    stay: out.arms.map(|arm| arm.hold_position),
                });
            }
        }
        let now = Instant::now();
        if let Some(forces) = forces {
            links.tendons.send(now, forces);
        }
        if let Some(grip) = grip {
            links.grip.send(now, grip);
        }
    }
}

/// Loops and forces at the start: those of closed arms go on, all others wait for a command.
fn begin(retained: Option<RetainedState>) -> (Gripper, Option<TendonForces>) {
    match retained {
        Some(RetainedState {
            grip_memory: GripMemory::Controlled(_),
            force,
            fault,
            ..
        }) => (
            Gripper::resume(force, fault),
            Some(TendonForces {
                force,
                found: false,
                stay: [true; 4],
            }),
        ),
        _ => (Gripper::default(), None),
    }
}

/// What each arm is to do, and what is known of it now.
fn inputs(links: &Links, close: PerArm<bool>) -> PerArm<ArmInput> {
    let mut inputs = close.map(|close| ArmInput {
        close,
        ..ArmInput::default()
    });
    if let Some(contact) = links.contact.fresh() {
        for ((input, pressure), fault) in inputs.iter_mut().zip(contact.pressure).zip(contact.fault) {
            input.pressure = if fault {
                Pressure::Faulty
            } else {
                Pressure::Known(pressure)
            };
        }
    }
    if let Some(arms) = links.arms.fresh() {
        for (input, tilt) in inputs.iter_mut().zip(arms.tilt) {
            input.tilt = tilt;
        }
    }
    if let Some(mix) = links.mix.fresh().filter(|m| m.running) {
        for (input, thrust) in inputs.iter_mut().zip(mix.thrusts) {
            input.thrust = thrust;
        }
    }
    if let Some(tension) = links.tension.fresh() {
        for (input, tension) in inputs.iter_mut().zip(tension) {
            input.tension = Some(tension);
        }
    }
    inputs
}
