//! The `Machine` at the end of a run, without a board.

use core::fmt::{Arguments, Write};
use core::sync::atomic::Ordering::Relaxed;

use sophie_fault::Machine;

use crate::core_under_test::faults;
use crate::traces::{self, Left, STOPPED};

struct Bare;

impl Machine for Bare {
    fn stop_motors() {
        STOPPED.store(true, Relaxed);
    }

    fn keep(message: Arguments<'_>) {
        let mut left = Left::new();
        let _ = left.write_fmt(message);
        traces::keep(left);
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
