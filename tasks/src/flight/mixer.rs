//! Allocation at the arms' present tilt, one step for each demand (1 kHz). The [`DEADLINE`] counts from data-ready.

use embassy_time::{Duration, Instant};
use sophie_control::chain::{ArmReading, MixOutput, Mixing, MixingStep, Surroundings};
use sophie_control::params::Params;

use crate::deadline::note_run;
use crate::links::Links;
use crate::schedule::TaskId;

/// Time from data-ready to the motor commands.
pub const DEADLINE: Duration = TaskId::Mixer.deadline();

/// Allocates at 1 kHz; returns only if the link has no receiver left.
pub async fn run<A: MixingStep>(links: &Links, allocation: impl FnOnce(&Params) -> A) {
    let Some(mut demand) = links.demand.receiver() else {
        return;
    };
    let mut mixing = Mixing::new(&links.params, allocation(&links.params));
    let mut mix = MixOutput::default();
    loop {
        let message = demand.changed().await;
        let started = Instant::now();
        // Copied only while new, once in ten steps.
        let new = links.arms.look(|angles| mixing.awaits(angles.at.as_micros()));
        let angles = new.filter(|new| *new).and_then(|_| links.arms.latest());
        let arms = angles.map(|angles| ArmReading {
            at_us: angles.at.as_micros(),
            tilt: angles.value.within(links.arms.stale_after).values(),
        });
        let surroundings = Surroundings {
            battery_ratio: links.battery.look(|battery| battery.value.ratio),
            thrust_root: links.thrust_factor.look(|factor| factor.value.root),
            arms,
        };
        mixing.step(message.at.as_micros(), &message.value, &surroundings, &mut mix);
        links.mix.send(message.at, mix);
        note_run(links, TaskId::Mixer, message.at, started, DEADLINE);
    }
}
