//! The `Machine` at the end of a run, without a board.

use core::cell::RefCell;
use core::fmt::{Arguments, Write};
use core::sync::atomic::Ordering::Relaxed;

use cortex_m::interrupt::{self, Mutex};
use sophie_fault::Machine;

use crate::core_under_test::faults::{self, Left};

static LEFT: Mutex<RefCell<Left>> = Mutex::new(RefCell::new(Left::new()));

struct Bare;

impl Machine for Bare {
    fn stop_motors() {
        faults::STOPPED.store(true, Relaxed);
    }

    fn keep(message: Arguments<'_>) {
        let mut left = Left::new();
        let _ = left.write_fmt(message);
        interrupt::free(|cs| LEFT.borrow(cs).replace(left));
    }

    /// Continues with the next scenario.
    fn reset() -> ! {
        faults::go_on()
    }
}

pub fn with_kept<R>(show: impl FnOnce(&Left) -> R) -> R {
    interrupt::free(|cs| show(&LEFT.borrow(cs).borrow()))
}

fn stop_and_restart(message: Arguments<'_>) -> ! {
    sophie_fault::stop_and_restart::<Bare>(message)
}

sophie_fault::ends_with!(stop_and_restart);
