//! The end of a run: whatever happens, the motors stop first, then the message is kept, then the chip is reset.
//!
//! A reset, because nothing after a fault can be trusted, and because it is the fastest way to motors that are *commanded*
//! to stop: the motor task's first act is a frame of zeros. The message is logged at the next start.
//!
//! A second fault on the way comes here again and goes straight to the reset. Within the handler of a hard fault it
//! locks the processor up instead: the motors' pins are low by then, and the watchdog resets the chip. Either way the
//! next start finds the words that were kept before the message was made.

use core::fmt;
use core::sync::atomic::{AtomicBool, Ordering};

use super::{restart, retained};
use crate::board;

/// What is kept while the message is made.
const UNTOLD: &str = "a fault, and another one while it was to be told";

/// A run is ending.
pub static ENDING: AtomicBool = AtomicBool::new(false);

/// Stops the motors, keeps `message` for the next start and restarts the chip.
pub fn stop_and_restart(message: fmt::Arguments<'_>) -> ! {
    cortex_m::interrupt::disable();
    // Clock and pins, by plain accesses to registers: nothing that can fault stands before them.
    board::stop_motors();
    if !ENDING.load(Ordering::Relaxed) {
        ENDING.store(true, Ordering::Relaxed);
        retained::leave(format_args!("{UNTOLD}"));
        retained::leave(message);
    }
    restart::reset()
}
