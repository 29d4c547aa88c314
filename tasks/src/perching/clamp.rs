//! Gripper control, 100 Hz: closes the arms on the pipe and releases them.
//!
//! A step ends before the next begins. Forces and grip state are stamped with the conversion of the pressures, or
//! without fresh pressure with the command. Reaction to an input that is stale by its link's limit:
//!
//! - command: no step is made and nothing is sent, so forces and grip state turn stale: the servos hold, the grip is
//!   unknown. Loops and forces are kept for the next command; before the first, those of the previous run;
//! - pressure: that arm's force is held, and the arm is faulty until its pressure returns;
//! - an arm's tilt: its force is held, and after 0.5 s it is faulty;
//! - thrusts: the motors have stopped, so the feed-forward is zero;
//! - tension: the demanded force is assumed to act, and no arm is proven free.
//!
//! Nothing is sent before the first known force: at power-up the servos' gears hold closed arms until a pulse opens
//! them.

use crate::start::retained_state::RetainedState;
use embassy_time::Instant;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::gripper::{ArmInput, Config, Gripper, Pressure, tendon_stiffness};

use crate::deadline::FixedRate;
use crate::links::Links;
use crate::links::link::{Newest, Stamped};
use crate::links::messages::Contact;
use crate::links::tendon_order::{TendonForce, TendonForces, TendonOrder};
use crate::schedule::TaskId;
use sophie_control::gripper::clamp_command::ClampCommand;
use sophie_control::gripper::contact_pressure::SensorLine;
use sophie_control::gripper::grip::GripState;

/// Runs the gripper; never returns.
pub async fn run(links: &Links) -> ! {
    let mut rate = FixedRate::of(links, TaskId::Clamp);
    let config = Config::from_params(&links.params);
    let mut gripper = begin(links);
    loop {
        let tick = rate.next().await;
        let Some(Newest::Fresh(command)) = links.clamp_command.newest() else {
            continue;
        };
        let close = match command.value {
            ClampCommand::Release | ClampCommand::Keep | ClampCommand::Place(_) => [false; 4],
            ClampCommand::Close { arms } | ClampCommand::Tighten { arms, .. } => arms.mask(),
        };
        let contact = match links.contact.newest() {
            Some(Newest::Fresh(contact)) => Some(contact),
            Some(Newest::Held(_)) | None => None,
        };
        let config = match command.value {
            ClampCommand::Tighten { times, .. } => config.tightened(times),
            _ => config,
        };
        let inputs = inputs(links, close, contact);
        let out = match command.value {
            ClampCommand::Keep => gripper.step_without_pulses(&config, &inputs, tick.dt),
            _ => gripper.step(&config, &inputs, tick.dt),
        };
        let at = contact.map_or(command.at, |contact| contact.at);
        let grip = GripState {
            proven: out.proven,
            misfit: out.misfit,
            released: out.released,
            arms: out.arms.map(|arm| arm.grip),
        };
        if command.value != ClampCommand::Keep {
            let forces = TendonForces {
                arms: out.arms.map(|arm| TendonForce {
                    force: arm.grip.force,
                    stiffness: tendon_stiffness(arm.grip.response),
                    hold_position: arm.hold_position,
                }),
                wound_at_power_on: out.wound_at_power_on,
            };
            let order = match command.value {
                ClampCommand::Place(place) => TendonOrder::Placed { forces, place },
                _ if contact.is_some() => TendonOrder::Measured(forces),
                _ => TendonOrder::Blind(forces),
            };
            links.tendons.send(at, order);
        }
        links.grip.send(at, grip);
    }
}

/// Initial loops. Those of closed arms resume with their servos at the retained position; all others wait for a
/// command.
fn begin(links: &Links) -> Gripper {
    match links.start.retained {
        Some(RetainedState {
            grip_memory: GripMemory::Controlled(_),
            force,
            fault,
            response,
            ..
        }) => {
            let mut arms = force.map(|force| TendonForce {
                force,
                stiffness: 1.0,
                hold_position: true,
            });
            for (arm, response) in arms.iter_mut().zip(response) {
                arm.stiffness = tendon_stiffness(response);
            }
            let forces = TendonForces {
                arms,
                wound_at_power_on: false,
            };
            links.tendons.send(Instant::now(), TendonOrder::Resumed(forces));
            Gripper::resume(force, fault, response)
        }
        _ => Gripper::default(),
    }
}

fn inputs(links: &Links, close: PerArm<bool>, contact: Option<Stamped<Contact>>) -> PerArm<ArmInput> {
    let mut inputs = close.map(|close| ArmInput {
        close,
        ..ArmInput::default()
    });
    for (arm, input) in inputs.iter_mut().enumerate() {
        input.turn_on = SensorLine::from_params(&links.params, arm).turn_on();
    }
    if let Some(Stamped { value: contact, .. }) = contact {
        for (input, pressure) in inputs.iter_mut().zip(contact.arms) {
            input.pressure = pressure.map_or(Pressure::Faulty, Pressure::Known);
        }
    }
    for (input, tilt) in inputs.iter_mut().zip(links.tilts().values()) {
        input.tilt = tilt;
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
