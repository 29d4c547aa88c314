//! The loops that close the arms on the pipe and let them go.
//!
//! Steady level, 100 Hz, to be done before the next step. What happens when an input is old:
//!
//! - the command (200 ms): forces and the last judgement are held; before the first command, released;
//! - the pressure (20 ms): that arm's force is held and it is faulty until there is one again;
//! - an arm's tilt (100 ms): its force is held, and after half a second it is faulty;
//! - the thrusts (10 ms): the motors have stopped by then, so the thrust fed forward is none;
//! - the tension (200 ms): the force asked for counts as given, and nothing is proven free.

use embassy_time::{Duration, Instant};
use sophie_control::clamp::{ArmInput, Clamp, Config, Pressure};
use sophie_control::wrench::PerArm;

use crate::deadline::{FixedRate, TaskId};
use crate::links::{ClampCommand, GripState, Links, TendonForces};

/// Time between two steps.
pub const PERIOD: Duration = Duration::from_millis(10);

/// Runs the clamp loops for ever.
pub async fn run(links: &Links) -> ! {
    let mut rate = FixedRate::new(links, TaskId::Clamp, PERIOD, PERIOD);
    let config = Config::from_params(&links.params);
    let mut clamp = Clamp::default();
    let mut forces = TendonForces::default();
    let mut grip = GripState::default();
    loop {
        let tick = rate.next().await;
        let command = match links.clamp_command.latest() {
            None => Some(ClampCommand::Release),
            Some(_) => links.clamp_command.fresh(),
        };
        if let Some(command) = command {
            let close = match command {
                ClampCommand::Release => [false; 4],
                ClampCommand::Close { arms } => arms.mask(),
            };
            let out = clamp.step(&config, close, &inputs(links), tick.dt);
            forces = TendonForces { force: out.force };
            grip = GripState {
                proven: out.proven,
                released: out.released,
                arms: out.arms,
            };
        }
        let now = Instant::now();
        links.tendons.send(now, forces);
        links.grip.send(now, grip);
    }
}

/// What is known of each arm now.
fn inputs(links: &Links) -> PerArm<ArmInput> {
    let mut inputs = [ArmInput::default(); 4];
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
