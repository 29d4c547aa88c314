//! A restart of the chip, on command or at the end of a run.

use cortex_m::peripheral::SCB;
use sophie_tasks::ports::Restart;

use crate::board;

/// Restarts the chip.
pub struct Restarter;

impl Restart for Restarter {
    fn restart(&mut self) {
        board::stop_motors();
        reset()
    }
}

/// Resets the chip, whatever its motors do.
pub fn reset() -> ! {
    SCB::sys_reset()
}
