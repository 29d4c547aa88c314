//! The firmware besides `sophie_tasks`: static task wrappers, levels, start-up log, lights and log. Chip code is in
//! [`sophie_boards`].

mod grip;
mod levels;
mod lights;
mod report;
pub mod tasks;
mod timing;
#[cfg(feature = "trace")]
pub mod trace;

use sophie_control::grip_memory::GripMemory;
use sophie_control::params::Params;
use sophie_tasks::links::Links;
use sophie_tasks::parameters;
use sophie_tasks::ports::{Loaded, Look};
use sophie_tasks::start::Start;
use static_cell::StaticCell;

use sophie_boards::retained::{self, Kept, Memory, ResetCause};

pub use self::levels::Levels;

sophie_boards::ends_with!(sophie_boards::stop_and_restart);

static LINKS: StaticCell<Links> = StaticCell::new();

/// State at start-up, before clocks and log run.
pub struct Beginning {
    pub cause: ResetCause,
    /// State that the tasks resume from.
    pub start: Start,
    kept: Kept,
}

/// Takes the reset cause, the last run's state and the memory for the next. Called once, before all else.
pub fn begin() -> (Beginning, Memory) {
    let cause = sophie_boards::take_reset_cause();
    let (kept, memory) = retained::start(cause);
    let start = Start::new(cause.told(kept.last_words.is_some()), &kept.copies);
    (Beginning { cause, start, kept }, memory)
}

/// The links, without messages. Called once.
pub fn links(params: Params, start: Start) -> &'static Links {
    LINKS.init_with(|| Links::starting(params, start))
}

/// Logs version, board, reset cause and what the last run left.
pub fn greet(beginning: &Beginning) {
    let Beginning { cause, start, kept } = beginning;
    defmt::info!(
        "SOPHIE {=str} on {=str}, start after {}",
        env!("CARGO_PKG_VERSION"),
        sophie_boards::NAME,
        cause
    );
    if kept.faults > 0 {
        defmt::warn!(
            "{=u32} starts since power-on, {=u32} of them after a fault",
            kept.starts,
            kept.faults
        );
    }
    if let Some(words) = &kept.last_words {
        defmt::error!("the run before ended with: {=str}", words.as_str());
    }
    let calibrated = start
        .retained
        .is_some_and(|retained| retained.gyro_bias.is_some());
    match start.retained.map(|retained| retained.grip_memory) {
        Some(GripMemory::Controlled(_)) => defmt::warn!("arms closed: they go on from where they were"),
        Some(GripMemory::HeldByGears(_)) => defmt::warn!("arms closed: left to the servos' gears"),
        _ => {}
    }
    if calibrated {
        defmt::info!("goes on with the calibration of the run before");
    }
}

/// Logs the result of reading the parameters; unreadable storage inhibits arming.
pub fn loaded(links: &Links, loaded: Loaded) {
    defmt::info!("parameters: {=u16} from storage", loaded.taken);
    if loaded.refused > 0 {
        defmt::warn!(
            "parameters: {=u16} left out, unknown or no longer allowed",
            loaded.refused
        );
    }
    match loaded {
        Loaded {
            foreign: Some(other), ..
        } => defmt::error!(
            "parameters: the storage holds {=str}'s data; 'save' at the console replaces them",
            other
        ),
        Loaded { unreadable: true, .. } => defmt::error!("parameters: storage unreadable"),
        _ => {}
    }
    parameters::report(links, loaded);
}

/// Inhibits arming for failed checks of the chip.
pub fn looked(links: &Links, looks: &[Look]) {
    for look in looks {
        if let (Some(inhibit), false) = (look.inhibits, look.ok) {
            links.report(inhibit, true);
        }
    }
}
