//! Motor output, one frame for each mix (1 kHz); stops the motors when mixes cease. Maps rotors to outputs.
//!
//! The [`DEADLINE`] of the frame counts from data-ready: the response is that of the whole chain.

use embassy_time::{Duration, Instant, with_deadline, with_timeout};

use crate::deadline::record_run_until;
use crate::links::Links;
use crate::links::link::Stamped;
use crate::schedule::TaskId;
use sophie_control::allocation::motor_map::at_outputs;
use sophie_control::allocation::wrench::PerArm;
use sophie_ports::actuators::Motors;

/// Time from data-ready to the frame.
pub const DEADLINE: Duration = TaskId::Motors.deadline();
/// Time-out of a frame; the slowest, of DShot150, takes 0.107 ms.
pub const FRAME_LIMIT: Duration = Duration::from_millis(3);

/// Drives the motors; returns, motors stopped, only if the link has no receiver left.
pub async fn run(links: &Links, mut port: impl Motors) {
    write(&mut port, [0.0; 4], Instant::now()).await;
    let Some(mut mix) = links.mix.receiver() else {
        return;
    };
    let rotors = links.params.motor_map.rotors();
    loop {
        // `fresh` beside the timeout: a mix from an old sample must not spin a motor.
        let next = mix.changed_to(|mix| Stamped {
            at: mix.at,
            value: mix.value.commands,
        });
        match with_timeout(links.mix.stale_after, next).await {
            Ok(message) => {
                let started = Instant::now();
                let commands = message
                    .fresh_at(started, links.mix.stale_after)
                    .unwrap_or([0.0; 4]);
                let commands = commands.map(|c| if c.is_finite() { c } else { 0.0 });
                let began = write(&mut port, at_outputs(&rotors, &commands), started).await;
                // An unsent frame is late by the whole wait.
                let began = began.unwrap_or_else(Instant::now);
                record_run_until(links, TaskId::Motors, message.at, started, began, DEADLINE);
                // The frame is out: adds what the earlier stages noted.
                links.timing.settle();
            }
            Err(_) => {
                write(&mut port, [0.0; 4], Instant::now()).await;
            }
        }
    }
}

/// Sends one frame and returns its start; `None` if it hangs: the next follows within 1 ms.
async fn write(port: &mut impl Motors, commands: PerArm<f32>, now: Instant) -> Option<Instant> {
    with_deadline(now + FRAME_LIMIT, port.write(commands)).await.ok()
}
