//! Deliberate restart.

use cortex_m::peripheral::SCB;

/// Resets the chip, whatever its motors do.
pub fn reset() -> ! {
    SCB::sys_reset()
}
