//! A restart on command.

use cortex_m::peripheral::SCB;
use sophie_tasks::ports::Restart;

use crate::board;

/// Restarts the chip.
pub struct Restarter;

impl Restart for Restarter {
    fn restart(&mut self) {
        board::stop_motors();
        SCB::sys_reset()
    }
}
