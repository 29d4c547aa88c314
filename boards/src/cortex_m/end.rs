//! The end of a run on the boards.

use core::fmt::Arguments;

use sophie_fault::Machine;

use super::{restart, retained};
use crate::stop_motors;

struct Here;

impl Machine for Here {
    fn stop_motors() {
        stop_motors();
    }

    fn keep(message: Arguments<'_>) {
        retained::leave(message);
    }

    fn reset() -> ! {
        restart::reset()
    }
}

/// Stops the motors, keeps `message` for the next start, restarts.
pub fn stop_and_restart(message: Arguments<'_>) -> ! {
    sophie_fault::stop_and_restart::<Here>(message)
}
