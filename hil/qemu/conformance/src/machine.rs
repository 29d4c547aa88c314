//! The `Machine` at the end of a run, without a board.

use core::fmt::Arguments;
use core::sync::atomic::Ordering::Relaxed;

use sophie_fault::Machine;

use crate::core_under_test::faults;
use crate::kept_message;

struct Bare;

impl Machine for Bare {
    fn stop_motors() {
        faults::STOPPED.store(true, Relaxed);
    }

    fn keep(message: Arguments<'_>) {
        kept_message::keep(message);
    }

    /// Continues with the next scenario.
    fn reset() -> ! {
        faults::go_on()
    }
}

fn stop_and_restart(message: Arguments<'_>) -> ! {
    sophie_fault::stop_and_restart::<Bare>(message)
}

sophie_fault::ends_with!(stop_and_restart);
