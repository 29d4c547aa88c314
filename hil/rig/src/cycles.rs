//! The core's cycle counter, which no driver uses.

use cortex_m::peripheral::{DWT, Peripherals};

/// Starts the counter, before anything else takes the core's peripherals.
///
/// # Panics
/// When called later.
pub fn start() {
    let Some(mut core) = Peripherals::take() else {
        panic!("the core's peripherals are taken");
    };
    core.DCB.enable_trace();
    // A Cortex-M7 ignores writes to the counter before that.
    DWT::unlock();
    core.DWT.enable_cycle_counter();
}

/// Core cycles; wraps around.
pub fn now() -> u32 {
    DWT::cycle_count()
}
