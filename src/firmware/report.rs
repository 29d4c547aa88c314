//! What the firmware tells over defmt while it runs. Background: logging never delays a flight.
//!
//! A line when the state or the reason changes, and for each arm of a proven grip; once a second, for every task whose count of overruns grew, its worst
//! times; every ten seconds the depth of the stack.

use embassy_time::{Duration, Ticker};
use sophie_tasks::deadline::TaskId;
use sophie_tasks::links::{Links, Status};

use super::grip::GripReport;
use crate::board::cortex_m::stack;

/// Time between two looks.
const PERIOD: Duration = Duration::from_millis(50);
/// Looks between two reports of the tasks' timing.
const TIMING_EVERY: u32 = 20;
/// Looks between two reports of the stack.
const STACK_EVERY: u32 = 200;

/// Reports for ever.
pub async fn run(links: &Links) -> ! {
    let mut ticker = Ticker::every(PERIOD);
    let mut shown: Option<Status> = None;
    let mut overruns = [0; TaskId::COUNT];
    let mut grip = GripReport::default();
    let mut looks = 0u32;
    loop {
        ticker.next().await;
        looks = looks.wrapping_add(1);
        if let Some(status) = links.status.latest().map(|m| m.value)
            && shown != Some(status)
        {
            shown = Some(status);
            match status.reason {
                "" => defmt::info!("{=str}", status.mode.name()),
                reason => defmt::warn!("{=str}: {=str}", status.mode.name(), reason),
            }
        }
        grip.look(links);
        if looks.is_multiple_of(TIMING_EVERY) {
            timing(links, &mut overruns);
        }
        if looks.is_multiple_of(STACK_EVERY) {
            let (size, free) = stack::size_and_free();
            defmt::info!(
                "stack: {=usize} of {=usize} bytes used at most",
                size - free,
                size
            );
        }
    }
}

fn timing(links: &Links, shown: &mut [u32; TaskId::COUNT]) {
    for (task, shown) in TaskId::ALL.into_iter().zip(shown) {
        let t = links.timing(task);
        if t.overruns != *shown {
            *shown = t.overruns;
            defmt::warn!(
                "{=str}: {=u32} overruns in {=u32} runs; worst: {=u32} us late, {=u32} us response, {=u32} us execution",
                task.name(),
                t.overruns,
                t.runs,
                t.worst_lateness_us,
                t.worst_response_us,
                t.worst_execution_us
            );
        }
    }
}
