//! The end of a test.

use core::fmt;

use defmt::Display2Format;

/// Reports that `what` is missing; the test then has no result.
///
/// # Panics
/// With the feature `wired`.
pub fn absent(what: fmt::Arguments<'_>) {
    if cfg!(feature = "wired") {
        panic!("not found: {what}");
    }
    defmt::warn!("ignored: not found: {}", Display2Format(&what));
}

/// Passes a test after its reset, when the probe does not wait for its return.
pub fn passed() -> ! {
    semihosting::process::exit(0)
}

/// Ends the test at a panic or fault, without reset: the motors stop, the probe gets the verdict.
pub fn end_of_run(message: fmt::Arguments<'_>) -> ! {
    cortex_m::interrupt::disable();
    sophie_boards::stop_motors();
    defmt::error!("{}", Display2Format(&message));
    semihosting::process::abort()
}
