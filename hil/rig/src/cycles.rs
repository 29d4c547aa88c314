//! The core's cycle counter: the finest clock there is, and one that no driver uses.

use cortex_m::peripheral::{DWT, Peripherals};

/// Starts the counter. Called once, before anything else takes the core's peripherals.
///
/// # Panics
/// When called later.
pub fn start() {
    let Some(mut core) = Peripherals::take() else {
        panic!("the core's peripherals are taken");
    };
    core.DCB.enable_trace();
    // A Cortex-M7 takes no writes to the counter before that.
    DWT::unlock();
    core.DWT.enable_cycle_counter();
}

/// Cycles of the core; wraps around.
pub fn now() -> u32 {
    DWT::cycle_count()
}
