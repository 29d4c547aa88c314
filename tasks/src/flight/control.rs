//! Attitude and rate control, one step for each attitude (1 kHz).
//!
//! The [`DEADLINE`] counts from data-ready. Without a fresh setpoint the rotors stop.

use embassy_time::{Duration, Instant};
use sophie_control::attitude::rate_loop::Feedback;
use sophie_control::chain::{Command, Control};

use crate::deadline::note_run;
use crate::links::Links;
use crate::schedule::TaskId;
use sophie_control::chain::MixOutput;
use sophie_control::chain::setpoint::Setpoint;

/// Time from data-ready to the demand.
pub const DEADLINE: Duration = TaskId::Control.deadline();

/// Runs both loops at 1 kHz; returns only if the link has no receiver left.
pub async fn run(links: &Links) {
    let Some(mut attitude) = links.attitude.receiver() else {
        return;
    };
    let mut control = Control::new(&links.params);
    loop {
        let estimate = attitude.changed().await;
        let started = Instant::now();
        let command = links.setpoint.look(|message| Command {
            at_us: message.at.as_micros(),
            setpoint: if message.is_fresh(started, links.setpoint.stale_after) {
                message.value
            } else {
                Setpoint::Stop
            },
            gentle: links.gentle.look(|message| message.value).unwrap_or(false),
        });
        let command = command.unwrap_or_default();
        let feedback = links.mix.fresh_to(started, MixOutput::feedback);
        let feedback = feedback.unwrap_or(Feedback::NOTHING);
        let demand = control.step(&estimate.value, &command, &feedback);
        links.demand.send(estimate.at, demand);
        links.target.send(estimate.at, control.target());
        note_run(links, TaskId::Control, estimate.at, started, DEADLINE);
    }
}
