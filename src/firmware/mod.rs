//! What the firmware has besides the tasks of `sophie_tasks`: their static wrappers, the greeting, lights and the log.
//!
//! Nothing here knows the chip; that is [`crate::board`]'s.

mod grip;
mod lights;
mod report;
pub mod tasks;

use sophie_control::params::Params;
use sophie_tasks::links::Links;
use static_cell::StaticCell;

use crate::board;
use crate::board::cortex_m::retained::{self, ResetCause};

/// Every link of the vehicle.
static LINKS: StaticCell<Links> = StaticCell::new();

/// The links, without messages. Called once.
pub fn links() -> &'static Links {
    LINKS.init_with(|| Links::new(Params::default()))
}

/// Says who this is and why it starts, with what the run before left behind; returns why.
pub fn greet() -> ResetCause {
    let cause = board::take_reset_cause();
    defmt::info!(
        "SOPHIE {=str} on {=str}, start after {}",
        env!("CARGO_PKG_VERSION"),
        board::NAME,
        cause
    );
    let kept = retained::start(cause);
    if kept.faults > 0 {
        defmt::warn!(
            "{=u32} starts since power-on, {=u32} of them after a fault",
            kept.starts,
            kept.faults
        );
    }
    if let Some(words) = kept.last_words {
        defmt::error!("the run before ended with: {=str}", words.as_str());
    }
    cause
}
