//! The end of a run: whatever happens, the motors stop first, then the message is kept, then the chip is reset.
//!
//! A reset, because nothing after a fault can be trusted, and because it is the fastest way to motors that are *told*
//! to stop: the motor task's first act is a frame of zeros. The message is logged at the next start.

use core::fmt;

use cortex_m::peripheral::SCB;

use crate::board;
use crate::board::cortex_m::retained;

/// Ends the run with `message`.
pub fn end_of_run(message: fmt::Arguments<'_>) -> ! {
    cortex_m::interrupt::disable();
    board::stop_motors();
    retained::leave(message);
    SCB::sys_reset()
}
