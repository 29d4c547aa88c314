//! How a run on a Cortex-M ends, whatever the chip: the motors stop first, then the message is kept, then the chip is
//! reset.
//!
//! A reset, because nothing after a fault can be trusted, and because it is the fastest way to motors that are
//! *commanded* to stop: the motor task's first act is a frame of zeros. The message is logged at the next start.
//!
//! A second fault on the way comes here again and goes straight to the reset. Within the handler of a hard fault it
//! locks the processor up instead: the motors' pins are low by then, and the watchdog resets the chip. Either way the
//! next start finds the words that were kept before the message was made.
//!
//! The crate knows no chip and no board, so that an image for QEMU runs the very code that flies. Empty on the host.

#![no_std]
#![cfg(target_os = "none")]
#![allow(
    unsafe_code,
    reason = "a fault handler's entry and the core's registers; each use has its reason beside it"
)]

mod hard_fault;

use core::fmt::Arguments;
use core::sync::atomic::{AtomicBool, Ordering};

/// What is kept while the message is made.
const UNTOLD: &str = "a fault, and another one while it was to be told";

/// A run is ending. Set by [`stop_and_restart`]; a reset clears it.
pub static ENDING: AtomicBool = AtomicBool::new(false);

/// What a board does at the end of a run. Called with interrupts off, from any handler, on any depth of the stack.
pub trait Machine {
    /// Drives the motors' pins low by plain accesses to registers: nothing that can fault.
    fn stop_motors();

    /// Keeps `message` for the next start. May fault where the message does.
    fn keep(message: Arguments<'_>);

    /// Restarts the chip.
    fn reset() -> !;
}

/// Stops the motors, keeps `message` for the next start and restarts the machine `M`.
pub fn stop_and_restart<M: Machine>(message: Arguments<'_>) -> ! {
    cortex_m::interrupt::disable();
    // Nothing that can fault stands before the motors.
    M::stop_motors();
    if !ENDING.load(Ordering::Relaxed) {
        ENDING.store(true, Ordering::Relaxed);
        M::keep(format_args!("{UNTOLD}"));
        M::keep(message);
    }
    M::reset()
}

/// Ends the run as the image has said with [`ends_with!`].
pub fn end_of_run(message: Arguments<'_>) -> ! {
    unsafe extern "Rust" {
        // SAFETY: `ends_with!` defines it with this signature; an image without one does not link.
        safe fn sophie_end_of_run(message: Arguments<'_>) -> !;
    }
    sophie_end_of_run(message)
}

/// Says how the runs of an image end that a fault or a panic gives up: a function `fn(fmt::Arguments<'_>) -> !`. Once
/// in an image.
#[macro_export]
macro_rules! ends_with {
    ($end:path) => {
        #[allow(unsafe_code, reason = "a symbol that the fault handlers call")]
        const _: () = {
            // SAFETY: the only symbol of this name, with the signature that `sophie_fault::end_of_run` calls.
            #[unsafe(no_mangle)]
            fn sophie_end_of_run(message: core::fmt::Arguments<'_>) -> ! {
                $end(message)
            }
        };
    };
}
