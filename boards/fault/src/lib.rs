//! End of a run on a Cortex-M: stops the motors, keeps the message, resets the chip.
//!
//! After a fault nothing can be trusted. A reset leads fastest to *commanded* stops, the motor task's first frame; the
//! next start logs the message.
//!
//! A second fault resets at once. In a hard fault handler it locks the processor up, with the motors' pins already low,
//! until the watchdog resets the chip; the next start then finds a substitute text.
//!
//! The same for every chip and board, so an image for QEMU runs it too. Empty on the host.

#![no_std]
#![cfg(target_os = "none")]
#![allow(
    unsafe_code,
    reason = "a fault handler's entry and the core's registers; each use has its reason beside it"
)]

mod hard_fault;

use core::fmt::Arguments;
use core::sync::atomic::{AtomicBool, Ordering};

/// Kept while the message is made.
const NESTED: &str = "a fault, and another one while it was to be told";

/// The run is ending; only a reset clears it.
pub static ENDING: AtomicBool = AtomicBool::new(false);

/// A board's part in the end of a run. Called with interrupts off, from any handler, at any stack depth.
pub trait Machine {
    /// Drives the motors' pins low by register accesses that cannot fault.
    fn stop_motors();

    /// Keeps `message` for the next start. May fault while formatting it.
    fn keep(message: Arguments<'_>);

    /// Restarts the chip.
    fn reset() -> !;
}

/// Stops the motors, keeps `message` for the next start, restarts `M`.
pub fn stop_and_restart<M: Machine>(message: Arguments<'_>) -> ! {
    cortex_m::interrupt::disable();
    // Nothing before this can fault.
    M::stop_motors();
    if !ENDING.load(Ordering::Relaxed) {
        ENDING.store(true, Ordering::Relaxed);
        M::keep(format_args!("{NESTED}"));
        M::keep(message);
    }
    M::reset()
}

/// Ends the run as the image defines with [`ends_with!`].
pub fn end_of_run(message: Arguments<'_>) -> ! {
    unsafe extern "Rust" {
        // SAFETY: `ends_with!` defines it with this signature; an image without one does not link.
        safe fn sophie_end_of_run(message: Arguments<'_>) -> !;
    }
    sophie_end_of_run(message)
}

/// Defines a function `fn(fmt::Arguments<'_>) -> !` as the end of an image's run after a fault or panic. Once per
/// image.
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
