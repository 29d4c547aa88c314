//! Jumpers between pads. The listener is a servo's pad, taken from its timer.

use sophie_boards::{Pad, Pupdr, WIRING};

use crate::cycles;

/// Whether the second pad follows the first against its pull, both ways.
pub fn joined([from, to]: [Pad; 2]) -> bool {
    let (driver, listener) = (from.take(), to.take());
    let follows = |high| {
        listener.listen(if high { Pupdr::PULL_DOWN } else { Pupdr::PULL_UP });
        driver.drive(high);
        // A pull of 40 kOhm on a lead takes some microseconds.
        settle(50);
        to.is_high() == high
    };
    follows(true) && follows(false)
}

/// Waits for `us` µs without yielding.
pub fn settle(us: u32) {
    let start = cycles::now();
    while cycles::now().wrapping_sub(start) < us * (WIRING.core_hz / 1_000_000) {}
}
