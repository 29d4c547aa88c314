//! Motor output, one frame for each mix; stops the motors by itself when mixes stop coming.
//!
//! Flight level. Deadline: the frame starts within 600 µs of data-ready.

use embassy_time::{Duration, Instant, with_timeout};

use crate::deadline::{TaskId, record_run};
use crate::links::Links;
use crate::ports::Motors;

/// Time from data-ready to the frame.
pub const DEADLINE: Duration = Duration::from_micros(600);

/// Serves the motors for ever; returns, motors stopped, only if the link has no receiver left.
pub async fn run(links: &Links, mut port: impl Motors) {
    port.write([0.0; 4]).await;
    let Some(mut mix) = links.mix.receiver() else {
        return;
    };
    loop {
        // `fresh` beside the timeout: a mix that was computed from an old sample must not spin a motor.
        match with_timeout(links.mix.stale_after, mix.changed()).await {
            Ok(message) => {
                let started = Instant::now();
                let commands = message
                    .fresh(links.mix.stale_after)
                    .map_or([0.0; 4], |m| m.commands);
                port.write(commands.map(|c| if c.is_finite() { c } else { 0.0 }))
                    .await;
                record_run(links, TaskId::Motors, message.at, started, DEADLINE);
            }
            Err(_) => port.write([0.0; 4]).await,
        }
    }
}
