//! The caches of a Cortex-M7.

/// Switches the instruction cache on. Called once, at the start.
///
/// Only that one: with the data cache on, what DMA writes would have to be invalidated by hand.
pub fn enable_instruction_cache() {
    // SAFETY: nothing else uses the core's cache control, and nothing else runs yet.
    unsafe { cortex_m::Peripherals::steal() }.SCB.enable_icache();
}
