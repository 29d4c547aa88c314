//! The firmware except the tasks' code: start, levels, background tasks, lights and log.
//!
//! A package of its own, since generic code and futures are compiled with the package that makes them concrete: these
//! for size, those of `sophie_flight` for speed (`Cargo.toml`). Chip code is in `sophie_boards`. On the host the
//! package is empty.

#![cfg_attr(target_os = "none", no_std)]
#![cfg(target_os = "none")]

mod grip;
mod levels;
mod lights;
mod report;
mod tasks;
mod timing;
#[cfg(feature = "trace")]
mod trace;

use embassy_executor::Spawner;
use sophie_control::gripper::retained_grip::GripMemory;
use sophie_control::params::Params;
use sophie_ports::chip_check::ChipCheck;
use sophie_ports::storage::Loaded;
use sophie_tasks::links::Links;
use sophie_tasks::start::Start;
use sophie_tasks::storage::parameters;
use static_cell::StaticCell;

use sophie_boards::retained::{self, Kept, Memory, ResetCause};

use self::levels::Levels;

sophie_boards::ends_with!(sophie_boards::stop_and_restart);

static LINKS: StaticCell<Links> = StaticCell::new();

/// The image's entry: starts the board and spawns every task.
#[embassy_executor::main(entry = "cortex_m_rt::entry")]
async fn main(background: Spawner) {
    let (beginning, memory) = begin();
    // Logged before the clocks start: if a clock fails to start, the log still has the end of the previous run.
    greet(&beginning);
    // Parameters before ports: a pin's function may depend on them.
    let board = sophie_boards::take().await;
    let links = links(board.params, beginning.start);
    loaded(links, board.loaded);
    looked(links, board.chip.checks);
    let at_rest = beginning.cause == ResetCause::PowerOn;
    let levels = Levels::new(background);

    if tasks::spawn(&levels, links, board, memory, at_rest).is_err() {
        sophie_boards::stop_and_restart(format_args!("a task was spawned twice"));
    }
}

/// State at start-up, before clocks and log run.
struct Beginning {
    cause: ResetCause,
    /// State that the tasks resume from.
    start: Start,
    kept: Kept,
}

/// Takes the reset cause, the last run's state and the memory for the next. Called once, before all else.
fn begin() -> (Beginning, Memory) {
    let cause = sophie_boards::take_reset_cause();
    sophie_boards::enter_or_leave_loader(cause);
    let (kept, memory) = retained::start(cause);
    let start = Start::new(cause.with_record(kept.last_words.is_some()), &kept.copies);
    (Beginning { cause, start, kept }, memory)
}

/// The links, without messages. Called once. Out of line: their 14 KiB are built on the stack, and the frame of `main`
/// lies below the flight level while the tasks are spawned.
#[inline(never)]
fn links(params: Params, start: Start) -> &'static Links {
    LINKS.init_with(|| Links::starting(params, start))
}

/// Logs version, board, reset cause and the state retained from the last run.
fn greet(beginning: &Beginning) {
    let Beginning { cause, start, kept } = beginning;
    defmt::info!(
        "SOPHIE {=str} on {=str}, start after {}",
        env!("CARGO_PKG_VERSION"),
        // As one text in the image, by which programs identify its board.
        core::hint::black_box(sophie_boards::NAME),
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
        defmt::error!("previous run ended with: {=str}", words.as_str());
    }
    let calibrated = start
        .retained
        .is_some_and(|retained| retained.gyro_bias.is_some());
    match start.retained.map(|retained| retained.grip_memory) {
        Some(GripMemory::Controlled(_)) => defmt::warn!("arms closed: gripper state restored"),
        Some(GripMemory::HeldByGears(_)) => defmt::warn!("arms closed: left to the servos' gears"),
        _ => {}
    }
    if calibrated {
        defmt::info!("gyro calibration restored");
    }
}

/// Logs the result of reading the parameters; unreadable storage inhibits arming.
fn loaded(links: &Links, loaded: Loaded) {
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
fn looked(links: &Links, checks: &[ChipCheck]) {
    for look in checks {
        if let (Some(inhibit), false) = (look.inhibits, look.ok) {
            links.report(inhibit, true);
        }
    }
}
