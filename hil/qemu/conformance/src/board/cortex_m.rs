//! The end of a run and the handler of hard faults, as they fly.

#[path = "../../../../../src/board/cortex_m/end.rs"]
pub mod end;
#[path = "../../../../../src/board/cortex_m/hard_fault.rs"]
mod hard_fault;

/// What a run leaves for the next.
pub mod retained {
    use core::cell::RefCell;
    use core::fmt::{Arguments, Write};

    use cortex_m::interrupt::{self, Mutex};

    use crate::core_under_test::faults::Left;

    static LEFT: Mutex<RefCell<Left>> = Mutex::new(RefCell::new(Left::new()));

    /// Keeps `message`, which may fault on the way.
    pub fn leave(message: Arguments<'_>) {
        let mut left = Left::new();
        let _ = left.write_fmt(message);
        interrupt::free(|cs| LEFT.borrow(cs).replace(left));
    }

    /// Shows what was kept last.
    pub fn with<R>(show: impl FnOnce(&Left) -> R) -> R {
        interrupt::free(|cs| show(&LEFT.borrow(cs).borrow()))
    }
}

/// In place of a reset.
pub mod restart {
    /// Goes on with the next scenario.
    pub fn reset() -> ! {
        crate::core_under_test::faults::go_on()
    }
}
